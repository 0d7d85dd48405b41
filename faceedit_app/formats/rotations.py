"""Rotations of head and eyes by their names in a file, in radians or degrees.

Files do not say which. A head or an eye goes only so far; numbers that often go beyond that, in
radians, are degrees.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from faceedit_app.core.arkit import ROTATION_INDEX, ROTATIONS
from faceedit_app.core.arrays import Bools, Doubles, Floats
from faceedit_app.formats.files import shown
from faceedit_app.formats.lost_faces import letters

DEGREES = 180.0 / np.pi  # in a radian
_BY_LETTERS = {letters(name): name for name in ROTATIONS}
# What turns: where its names begin, how far it does at most, and how far only degrees go if those
# of something else in the file are degrees. A phone may lie on its side, even upside down; an eye
# that has turned by a right angle looks into the head.
_PARTS = (("head", "head", np.pi, np.pi / 2), ("eye", ("leftEye", "rightEye"), np.pi / 2, 1.0))
_TURN = 2.01 * np.pi  # a full turn, of which some programs count all, not half to either side
_ROUNDED = 1.001  # a half turn with few digits
_FARTHEST = 361.0  # degrees; what goes beyond is damage
_LONG_ENOUGH, _SHARE = 10, 0.01  # frames, and of all frames, that are no damage


@dataclass(frozen=True)
class Turned:
    """The rotations in a file.

    Attributes:
        rotations: (T, 9) as in `Clip.rotations`; None if there are none, or one is not finite.
        degrees: the names of those that the file has in degrees.
        notes: what was assumed of them, and those that are impossible.
    """

    rotations: Floats | None = None
    degrees: frozenset[str] = frozenset()
    notes: tuple[str, ...] = ()


def rotation_named(name: str) -> str | None:
    """The rotation that a name means, such as headYaw for `HeadYaw` or `head_yaw`, or None."""
    return _BY_LETTERS.get(letters(name))


def found_rotations(names: Sequence[Any]) -> dict[str, int]:
    """Where names of a file mean rotations, in the order of `ROTATIONS`; none if two mean one."""
    meant = [rotation_named(name) if isinstance(name, str) else None for name in names]
    if any(meant.count(name) > 1 for name in ROTATIONS):
        return {}
    return {name: meant.index(name) for name in ROTATIONS if name in meant}


def read_rotations(
    values: Doubles, names: Sequence[str], own: Sequence[str], line_of: Callable[[int, int], int]
) -> Turned:
    """The rotations of T frames.

    Args:
        values: (T, N) as the file has them; NaN if missing.
        names: the N names, in the order of `ROTATIONS`.
        own: those in the file.
        line_of: the line in the file (from 1) of a number, by frame and name.
    """
    if not names or not len(values) or not np.isfinite(values).all():
        return Turned()
    parts = [
        (what, [k for k, name in enumerate(names) if name.startswith(begin)], most, likely)
        for what, begin, most, likely in _PARTS
    ]
    sure = {what for what, of, most, _ in parts if _often(_only_degrees(values[:, of], most))}
    degrees: set[str] = set()
    scales, notes = np.ones(len(names)), list[str]()
    for what, of, most, likely in parts:
        beyond = (np.abs(values[:, of]) > likely) & (np.abs(values[:, of]) <= _FARTHEST)
        if what in sure or (sure and _often(beyond)):
            scales[of] = DEGREES
            degrees.update(names[k] for k in of)
            notes.append(_degrees_note(values[:, of], [own[k] for k in of], what))
        odd = np.abs(values[:, of]) > _ROUNDED * most * scales[of]
        if odd.any():
            frame, k = np.unravel_index(np.argmax(odd * np.abs(values[:, of])), odd.shape)
            column = of[int(k)]
            several = f"{odd.sum()} rotations are impossible: " if odd.sum() > 1 else ""
            unit = "radians" if scales[column] == 1.0 else "degrees"
            notes.append(
                f"{several}{shown(own[column])} is {values[frame, column]:g} in line "
                f"{line_of(int(frame), column)}, in {unit}, farther than any {what} turns, "
                "and stays so"
            )
    out = np.zeros((len(values), len(ROTATIONS)), np.float32)
    out[:, [ROTATION_INDEX[name] for name in names]] = values / scales
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


def _degrees_note(values: Doubles, own: Sequence[str], what: str) -> str:
    """The note about columns that are degrees."""
    several = f"{shown(own[0])} and {len(own) - 1} more go" if len(own) > 1 else f"{own[0]} goes"
    most = np.abs(values)[np.abs(values) <= _FARTHEST].max()
    return (
        f"{several} as far as {most:g}, which no {what} does in radians: "
        "read as degrees, and written as degrees"
    )
