"""Rotations of head and eyes by their names in a file, in radians or degrees.

Some files say which, in the names, a row of units or a field. The others do not. A head or an eye
goes only so far; numbers that often go beyond that, in radians, are degrees.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from faceedit_app.core.arkit import ROTATION_INDEX, ROTATIONS
from faceedit_app.core.arrays import Bools, Doubles, Floats
from faceedit_app.formats.files import shown
from faceedit_app.formats.lost_faces import letters

DEGREES = 180.0 / np.pi  # in a radian
_BY_LETTERS = {letters(name): name for name in ROTATIONS}
_WORDS = "(?:pose|rotations?|rot|orientation|eulers?|angles?)*"
_UNIT = "(?:in)?(?P<unit>degs?|degrees?|rads?|radians?)"
# Letters only, in lower case.
_NAMED = re.compile(
    rf"(?:(?P<head>head)|(?P<side>left|right)eye|eyes?(?P<last>left|right)){_WORDS}"
    rf"(?P<axis>yaw|pitch|roll){_WORDS}(?:{_UNIT})?"
)
_IS_UNIT = re.compile(_UNIT)
# The sign for degrees, the ordinal that is typed for it, and what becomes of the sign if it is
# saved in one encoding and read in another.
_SIGN = re.compile("Â?[°º]|(?<=[\\[(])\ufffd(?=[\\])])|^\ufffd$")
# What a line of text is about, and the units in it; a number of degrees is no unit.
_ABOUT = re.compile(
    r"\b(?:rotations?|orientation|angles?|eulers?|head|eyes?|gaze|pose|yaw|pitch|roll)", re.I
)
_UNITS = re.compile(r"(?<![\d.])(?<!\d )(?:\b(?:degrees?|degs?|radians?|rads?)\b|°)", re.I)
_LONGEST, _LONGEST_LINE = 100, 300  # characters of a name and of a line of text
# What turns: where its names begin, how far it does at most, how far only degrees go if those of
# something else in the file are degrees, and beyond what it is doubtful. A phone may lie on its
# side, even upside down; an eye that has turned by a right angle looks into the head.
_PARTS = (
    ("head", "head", np.pi, np.pi / 2, 1.6),
    ("eye", ("leftEye", "rightEye"), np.pi / 2, 1.0, 0.9),
)
_TURN = 2.01 * np.pi  # a full turn, of which some programs count all, not half to either side
_FARTHEST = 361.0  # degrees; what goes beyond is damage
_LONG_ENOUGH, _SHARE = 10, 0.01  # frames, and of all frames, that are no damage
_SWEEP = 2.6  # radians, from side to side or from up to down, that no head goes before a camera
_INNER = (1.0, 99.0)  # percentiles between which there is no damage


@dataclass(frozen=True)
class Turned:
    """The rotations in a file.

    Attributes:
        rotations: (T, 9) as in `Clip.rotations`; None if there are none, or one is not finite.
        degrees: the names of those that the file has in degrees.
        notes: what was assumed of them, and those that are doubtful.
    """

    rotations: Floats | None = None
    degrees: frozenset[str] = frozenset()
    notes: tuple[str, ...] = ()


def rotation_named(name: str) -> str | None:
    """The rotation that a name means, or None.

    It is headYaw for `HeadYaw`, `head_yaw`, `head.rotation.yaw` and `headYaw [°]`.
    """
    match = _match(name)
    if match is None:
        return None
    side = match["side"] or match["last"]
    return _BY_LETTERS[(f"{side}eye" if side else "head") + match["axis"]]


def _match(name: str) -> re.Match[str] | None:
    """The parts of the name of a rotation."""
    bare = letters(_SIGN.sub("", name)) if len(name) <= _LONGEST else ""
    return _NAMED.fullmatch(bare)


def unit_named(text: str) -> float | None:
    """What a unit has for a radian, by its name or sign; None if it is no unit of angles."""
    match = _IS_UNIT.fullmatch(letters(text))
    if match is None:
        return DEGREES if _SIGN.search(text) else None
    return DEGREES if match["unit"].startswith("d") else 1.0


def unit_in_name(name: str) -> float | None:
    """What the name of a rotation says that the file has for a radian; None if it does not."""
    match = _match(name)
    said = match["unit"] if match else None
    return unit_named(said) if said else DEGREES if _SIGN.search(name) else None


def unit_in_lines(lines: Iterable[str]) -> float | None:
    """What lines of text about rotations say that the file has for a radian; None if nothing."""
    about = (line for line in lines if len(line) <= _LONGEST_LINE and _ABOUT.search(line))
    found = {unit_named(text) for line in about for text in _UNITS.findall(line)}
    return found.pop() if len(found) == 1 else None


def found_rotations(names: Sequence[Any]) -> dict[str, int]:
    """Where names of a file mean rotations, in the order of `ROTATIONS`; none if two mean one.

    One with ARKit's name, and no unit, is meant rather than another; then one in radians.
    """
    found: dict[str, list[tuple[int, int]]] = {}
    for k, name in enumerate(names):
        meant = rotation_named(name) if isinstance(name, str) else None
        if meant is not None:
            unit = unit_in_name(name)
            is_own = unit is None and letters(name) == letters(meant)
            found.setdefault(meant, []).append((0 if is_own else 1 if unit == 1.0 else 2, k))
    best = {name: sorted(places) for name, places in found.items()}
    if any(len(places) > 1 and places[0][0] == places[1][0] for places in best.values()):
        return {}
    return {name: best[name][0][1] for name in ROTATIONS if name in best}


def read_rotations(
    values: Doubles,
    names: Sequence[str],
    own: Sequence[str],
    line_of: Callable[[int, int], int],
    said: Sequence[float | None] = (),
) -> Turned:
    """The rotations of T frames.

    Args:
        values: (T, N) as the file has them; NaN if missing.
        names: the N names, in the order of `ROTATIONS`.
        own: those in the file.
        line_of: the line in the file (from 1) of a number, by frame and name.
        said: (N) what the file says, elsewhere than in the names, that it has for a radian; None
            where it does not; empty if it never does.
    """
    if not names or not len(values) or not np.isfinite(values).all():
        return Turned()
    elsewhere = said or [None] * len(own)
    told = [unit_in_name(name) or one for name, one in zip(own, elsewhere, strict=True)]
    columns = {
        what: [k for k, name in enumerate(names) if name.startswith(begin)]
        for what, begin, *_ in _PARTS
    }
    untold = {what: [k for k in of if told[k] is None] for what, of in columns.items()}
    sure = {
        what
        for what, _, most, *_ in _PARTS
        if any(told[k] == DEGREES for k in columns[what])
        or _often(_only_degrees(values[:, untold[what]], most))
        or (what == "head" and _sweeps(values, names, untold[what]))
    }
    scales, notes = np.array([unit or 1.0 for unit in told]), list[str]()
    for what, _, _, likely, doubtful in _PARTS:
        of = untold[what]
        sizes = np.abs(values[:, of])
        beyond = (sizes > likely) & (sizes <= _FARTHEST)
        if of and (what in sure or (sure and _often(beyond))):
            scales[of] = DEGREES
            is_told = any(told[k] == DEGREES for k in columns[what])
            notes.append(_degrees_note(values[:, of], [own[k] for k in of], what, is_told))
        elif sure and sizes.any():
            notes.append(_unlike_note(values[:, of], [own[k] for k in of], sure))
        odd = np.abs(values) > doubtful * scales
        odd[:, [k for k in range(len(names)) if k not in columns[what]]] = False
        if odd.any():
            notes.append(_doubtful_note(values, odd, own, what, scales, told, line_of))
    out = np.zeros((len(values), len(ROTATIONS)), np.float32)
    out[:, [ROTATION_INDEX[name] for name in names]] = values / scales
    degrees = (name for name, scale in zip(names, scales, strict=True) if scale == DEGREES)
    return Turned(out, frozenset(degrees), tuple(notes))


def in_degrees(radians: Doubles | Floats) -> Doubles:
    """The degrees of some radians, without the digits that single precision does not have."""
    rounded: Doubles = np.degrees(radians.astype(np.float64)).round(5)
    return rounded


def _only_degrees(values: Doubles, most: float) -> Bools:
    """(T, N) which numbers are degrees, if what they turn goes as far as `most` radians."""
    sizes = np.abs(values)
    is_turned = (sizes > most) & (sizes < 2 * np.pi - most)  # not a little less than a full turn
    found: Bools = (is_turned | (sizes > _TURN)) & (sizes <= _FARTHEST)
    return found


def _often(found: Bools) -> bool:
    """Whether something is true in enough frames of (T, N), not for a moment."""
    count, frames = int(found.any(axis=1).sum()), len(found)
    return count > 0 and count >= max(min(_LONG_ENOUGH, frames / 2), _SHARE * frames)


def _sweeps(values: Doubles, names: Sequence[str], of: Sequence[int]) -> bool:
    """Whether a head would turn or nod too far in radians, without ever passing a half turn.

    It may be seen by a camera that lies on its side or is upside down, or from behind; but it does
    not go from one of these to another. A roll does, if a phone is turned.
    """
    for k in of:
        if names[k].endswith("Roll") or not _often(np.abs(values[:, [k]]) > np.pi / 2):
            continue
        low, high = np.percentile(np.unwrap(values[:, k]), _INNER)
        if high - low > _SWEEP:
            return True
    return False


def _degrees_note(values: Doubles, own: Sequence[str], what: str, is_told: bool) -> str:
    """The note about columns that are degrees, though the file does not say so of them."""
    if is_told:
        several = f"{shown(own[0])} and {len(own) - 1} more" if len(own) > 1 else own[0]
        return f"{several}: read as degrees, as the {what}'s others are, and written as degrees"
    several = f"{shown(own[0])} and {len(own) - 1} more go" if len(own) > 1 else f"{own[0]} goes"
    most = np.abs(values)[np.abs(values) <= _FARTHEST].max()
    return (
        f"{several} as far as {most:g}, which no {what} does in radians: "
        "read as degrees, and written as degrees"
    )


def _unlike_note(values: Doubles, own: Sequence[str], sure: set[str]) -> str:
    """The note about columns in radians in a file whose other rotations are degrees."""
    several = f"{shown(own[0])} and {len(own) - 1} more go" if len(own) > 1 else f"{own[0]} goes"
    return (
        f"{several} only as far as {np.abs(values).max():g}: read as radians, unlike those of the "
        f"{' and '.join(sorted(sure))}; {_if_not(own[0], 1.0)}"
    )


def _doubtful_note(
    values: Doubles,
    odd: Bools,
    own: Sequence[str],
    what: str,
    scales: Doubles,
    told: Sequence[float | None],
    line_of: Callable[[int, int], int],
) -> str:
    """The note about rotations (T, N), of some names, that are hardly possible in their units."""
    frame, k = map(int, np.unravel_index(np.argmax(odd * np.abs(values)), odd.shape))
    several = f"{odd.sum()} rotations are doubtful: " if odd.sum() > 1 else ""
    unit = "radians" if scales[k] == 1.0 else "degrees"
    more = ", as the file says" if told[k] else f"; {_if_not(own[k], scales[k])}"
    return (
        f"{several}{shown(own[k])} is {values[frame, k]:g} in line {line_of(frame, k)}, in {unit}, "
        f"farther than any {what} turns, and stays so{more}"
    )


def _if_not(own: str, unit: float) -> str:
    """What to do if columns are not in this unit."""
    other, end = ("degrees", "deg") if unit == 1.0 else ("radians", "rad")
    return f'if it is in {other}, name it "{shown(own)}_{end}"'
