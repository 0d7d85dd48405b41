"""An edit: one change to some curves, or some channels, over a time range, and its JSON."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from typing import Any

import numpy as np

from faceedit_app.core.arrays import Doubles, Times
from faceedit_app.core.controls import CONTROL_IDS, MIRRORED_CONTROL, SIGNED_CONTROLS
from faceedit_app.core.fields import (
    LARGEST,
    LONGEST_TEXT,
    FieldError,
    Fields,
    clean_text,
)
from faceedit_app.core.texts import did_you_mean
from faceedit_app.editing.edits.channels import channel_problem, mirrored_channels

Points = tuple[tuple[float, float], ...]

LONGEST_SMOOTH = 10.0  # seconds
STRONGEST = 1.5  # of `Edit.strength`
LONGEST_FILL = 4.0  # seconds that Fill makes at once
MOST_SEED = 999
MOST_POINTS = 200_000
MOST_PINS = 20_000
PIN_SLACK = 1e-6  # seconds by which rounding may bring pins out of the range
MOST_EDITS = 10_000  # of one take; with more, a drag could not be followed


class Op(StrEnum):
    """What an edit does to a curve by `Edit.value`."""

    OFFSET = "offset"  # add `value` mm
    SET = "set"  # go to `value` mm
    SCALE = "scale"  # multiply the distance from the take's median by `value`
    SMOOTH = "smooth"  # zero-phase Gaussian of `value` seconds standard deviation
    RESET = "reset"  # back to the take as tracked; `value` is ignored
    DRAW = "draw"  # follow `points`, mm; `value` is ignored
    ADD = "add"  # add `points`, mm; `value` is ignored
    # Replace the regions of its curves by other motion of the take; `value` is ignored, `points`
    # are the mouth opening that this motion should have, mm, if any (`solving/filling.py`).
    FILL = "fill"
    # Play the take in the range along another clock, `pins` (`clock.py`): all channels, head and
    # eyes; `value` is ignored.
    RETIME = "retime"
    # Of channels only; see `channels.py`.
    LIMIT = "limit"  # approach a ceiling of `value` smoothly
    NEUTRAL = "neutral"  # subtract a rest pose; `amounts`: rest and peak
    LEVELS = "levels"  # strength by channel; `amounts`: multiplier, offset and ceiling


class Company(StrEnum):
    """What an edit does to the companions of its curves (`companions.py`)."""

    YIELD = "yield"  # they follow, unless they have been edited themselves
    ALONG = "along"  # they always follow: the edit is an expression of the whole mouth
    STAY = "stay"  # they stay where they are


WITH_POINTS = (Op.DRAW, Op.ADD)
WITH_AMOUNTS = (Op.NEUTRAL, Op.LEVELS)
# They change the take that all other edits start from.
OF_THE_TAKE = (Op.FILL, Op.RETIME, Op.NEUTRAL)
WITHOUT_VALUE = (Op.RESET, Op.FILL, Op.RETIME, *WITH_POINTS, *WITH_AMOUNTS)


@dataclass(frozen=True)
class Edit:
    """One non-destructive change to one or more curves, or to one or more channels.

    Attributes:
        controls: ids of the curves that change; empty for an edit of channels.
        op: what is done.
        start, end: seconds; the hold, in which the edit acts in full.
        falloff: seconds over which the edit fades in before `start`, and out after `end`.
        value: see `Op`.
        falloff_out: seconds over which it fades out after `end`; None = `falloff`.
        strength: 0..1.5, how much of the edit is applied.
        enabled: an edit that is switched off stays in the list and changes nothing.
        name: the user's name for it; empty = `describe.describe(edit)`.
        about: mm that a `scale` leaves unchanged; None = the take's median of each control.
        points: (seconds of the take, mm) in order of time, for `draw` and `add`: interpolated
            linearly, constant before the first and after the last.
        companions: what happens to the companions of its curves.
        seed: which variation a `fill` is; 0 is the most likely one.
        pins: (was, is) seconds, for `retime`: what the take shows at `was` is shown at `is`. Both
            never fall and stay within the range, whose ends keep their time. Pins that share `is`
            cut what lies between them; pins that share `was` hold the face.
        channels: names of the channels that change, in place of curves. Then `value`, `about` and
            `points` are weights, or degrees for rotations.
        amounts: per channel, for `neutral` and `levels`; see `Op`.

    Raises:
        ValueError: a field is out of range; the text says which one, as a phrase.
    """

    controls: tuple[str, ...]
    op: Op
    start: float
    end: float
    falloff: float
    value: float = 0.0
    falloff_out: float | None = None
    strength: float = 1.0
    enabled: bool = True
    name: str = ""
    about: float | None = None
    points: Points = ()
    companions: Company = Company.YIELD
    seed: int = 0
    channels: tuple[str, ...] = ()
    amounts: tuple[tuple[float, ...], ...] = ()
    pins: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        if unknown := [c for c in self.controls if c not in CONTROL_IDS]:
            near = did_you_mean(unknown[0], CONTROL_IDS)
            raise ValueError(f"unknown control {unknown[0][:40]!r}{near}")
        if not self.controls and not self.channels:
            raise ValueError("it has no control")
        if self.controls and self.channels:
            raise ValueError("it names both curves and channels")
        if len(set(self.controls)) < len(self.controls):
            raise ValueError("it names a control twice")
        if problem := channel_problem(self.channels, self.op.value, self.value, self.amounts):
            raise ValueError(problem)
        numbers = (self.start, self.end, self.falloff, self.fade_out, self.value, self.about or 0.0)
        if not all(math.isfinite(number) and abs(number) <= LARGEST for number in numbers):
            raise ValueError(f"its numbers must be between -{LARGEST:.0f} and {LARGEST:.0f}")
        if self.end < self.start:
            raise ValueError("its end lies before its start")
        if self.falloff < 0 or self.fade_out < 0:
            raise ValueError("its falloff is negative")
        if not 0 <= self.strength <= STRONGEST:
            raise ValueError(f"its strength must be between 0 and {STRONGEST:g}")
        if self.op in (Op.SCALE, Op.SMOOTH) and self.value < 0:
            raise ValueError(f"a {self.op} needs a value of at least 0")
        if self.op is Op.SMOOTH and self.value > LONGEST_SMOOTH:
            raise ValueError(f"a smooth needs a value of at most {LONGEST_SMOOTH:.0f} seconds")
        if self.about is not None and self.op is not Op.SCALE:
            raise ValueError('only a scale can have "about"')
        if self.name != clean_text(self.name):
            raise ValueError(f"its name has a damaged character or over {LONGEST_TEXT} of them")
        if not 0 <= self.seed <= MOST_SEED or (self.seed and self.op is not Op.FILL):
            raise ValueError(f"only a fill can have a seed, 1 to {MOST_SEED}")
        if self.points or self.op in WITH_POINTS:
            self._check_points()
        if self.pins or self.op is Op.RETIME:
            self._check_pins()

    def _check_points(self) -> None:
        if self.op not in (*WITH_POINTS, Op.FILL):
            raise ValueError(f"a {self.op} has no points")
        if not 1 <= len(self.points) <= MOST_POINTS:
            raise ValueError(f"a {self.op} needs 1 to {MOST_POINTS} points")
        if not (np.isfinite(self.polyline).all() and np.abs(self.polyline).max() <= LARGEST):
            raise ValueError(f"its points must be between -{LARGEST:.0f} and {LARGEST:.0f}")
        if not (np.diff(self.polyline[0]) > 0).all():
            raise ValueError("its points are not in order of time")

    def _check_pins(self) -> None:
        if self.op is not Op.RETIME:
            raise ValueError(f"a {self.op} has no pins")
        if self.falloff or self.fade_out:
            raise ValueError("a retime has no falloff")
        if len(self.pins) > MOST_PINS:
            raise ValueError(f"a retime has at most {MOST_PINS} pins")
        pins = np.array([(self.start, self.start), *self.pins, (self.end, self.end)], np.float64)
        if not np.isfinite(pins).all():
            raise ValueError("its pins are not numbers")
        if (np.diff(pins, axis=0) < -PIN_SLACK).any():
            raise ValueError("its pins cross, or lie outside its range")

    @cached_property
    def polyline(self) -> Doubles:
        """(2, P) float64: the seconds and the millimetres of `points`."""
        return np.ascontiguousarray(np.array(self.points, np.float64).T)

    @cached_property
    def _hash(self) -> int:
        return hash(
            (
                *(self.controls, self.channels, self.op, self.start, self.end, self.falloff),
                *(self.value, self.points, self.seed, self.pins),
            )
        )

    def __hash__(self) -> int:
        return self._hash  # computed once: a drawn edit may have thousands of points

    @property
    def fade_out(self) -> float:
        """Seconds over which the edit fades out after `end`."""
        return self.falloff if self.falloff_out is None else self.falloff_out

    @property
    def span(self) -> tuple[float, float]:
        """First and last second of the edit: its hold and both falloffs."""
        return self.start - self.falloff, self.end + self.fade_out

    @cached_property
    def effect(self) -> Edit | None:
        """The edit without its name and defaults; None if it changes nothing.

        Edits that do the same have equal effects, so that renaming one computes nothing again.
        """
        if not self.enabled or self.strength == 0:
            return None
        if self.op is Op.RETIME and not any(was != now for was, now in self.pins):
            return None
        fade = None if self.falloff_out == self.falloff else self.falloff_out
        if not self.name and fade == self.falloff_out:
            return self
        return replace(self, name="", falloff_out=fade)

    def mask(self, times: Times) -> Doubles:
        """How much of the edit applies at `times` (T,), 0..1: 1 in the hold, cosine falloffs."""
        before, after = self.start - times, times - self.end
        if self.fade_out == self.falloff:
            return fade(np.maximum(before, after), self.falloff)
        return fade(before, self.falloff) * fade(after, self.fade_out)

    def shifted(self, seconds: float) -> Edit:
        """The edit moved by some seconds, with its points and pins."""
        return self._mapped(
            self.start + seconds, self.end + seconds, lambda second: second + seconds
        )

    def stretched(self, start: float, end: float) -> Edit:
        """The edit with another hold; its points and pins are scaled along."""
        width = self.end - self.start
        factor = (end - start) / width if width > 0 else 1.0
        if factor <= 0:  # a hold of no length: all points would fall together
            points = tuple((start, mm) for _, mm in self.points[:1])
            return replace(self, start=start, end=end, points=points, pins=())
        return self._mapped(start, end, lambda second: start + factor * (second - self.start))

    def _mapped(self, start: float, end: float, to: Callable[[float], float]) -> Edit:
        """The edit with another hold, and its points and pins at other times."""
        return replace(
            self,
            start=start,
            end=end,
            points=at_times((to(t) for t, _ in self.points), self.points),
            pins=tuple((to(was), to(now)) for was, now in self.pins),
        )

    def mirrored(self) -> Edit:
        """The edit on the other side of the face.

        One of signed curves changes its signs; together with others it cannot.
        """
        controls = tuple(MIRRORED_CONTROL[c] for c in self.controls)
        mirrored = replace(self, controls=controls, channels=mirrored_channels(self.channels))
        if not self.controls or not {*self.controls} <= {*SIGNED_CONTROLS}:
            return mirrored
        return replace(
            mirrored,
            value=-self.value if self.op in (Op.OFFSET, Op.SET) else self.value,
            about=None if self.about is None else -self.about,
            points=tuple((seconds, -mm) for seconds, mm in self.points),
        )


def fade(outside: Doubles, falloff: float) -> Doubles:
    """Seconds outside the hold (0 or less is inside) -> how much applies, 0..1."""
    # Half a nanosecond of slack counts a frame on the edge as inside.
    if falloff < 1e-9:
        return (outside <= 5e-10).astype(np.float64)
    inside = np.clip(1.0 - np.maximum(outside, 0.0) / falloff, 0.0, 1.0)
    return 0.5 - 0.5 * np.cos(np.pi * inside)


def at_times(times: Iterable[float], points: Points) -> Points:
    """Points at other times, in the same order.

    Those that rounding lets fall together, as in a hold of almost no length, become the last one.
    """
    return tuple(dict(zip(times, (mm for _, mm in points), strict=True)).items())


def to_json(edit: Edit) -> dict[str, Any]:
    """The edit as an entry of an edits file."""
    what, names = ("channel", edit.channels) if edit.channels else ("control", edit.controls)
    named: dict[str, Any] = {what: names[0]} if len(names) == 1 else {f"{what}s": [*names]}
    return (
        named
        | {
            "op": edit.op.value,
            "start": edit.start,
            "end": edit.end,
            "falloff": edit.falloff,
            "value": edit.value,
        }
        | _optional(edit)
    )


def _optional(edit: Edit) -> dict[str, Any]:
    """The fields that are written only if they differ from their defaults."""
    entry: dict[str, Any] = {}
    for name in ("falloff_out", "about"):
        if getattr(edit, name) is not None:
            entry[name] = getattr(edit, name)
    if edit.strength != 1:
        entry["strength"] = edit.strength
    if not edit.enabled:
        entry["enabled"] = False
    if edit.name:
        entry["name"] = edit.name
    if edit.companions is not Company.YIELD:
        entry["companions"] = edit.companions.value
    if edit.seed:
        entry["seed"] = edit.seed
    if edit.points:
        entry["points"] = [list(point) for point in edit.points]
    if edit.amounts:
        entry["amounts"] = [list(amounts) for amounts in edit.amounts]
    if edit.pins:
        entry["pins"] = [list(pin) for pin in edit.pins]
    return entry


def from_json(entry: Any) -> Edit:
    """Read one entry of an edits file.

    Raises:
        ValueError: the entry is wrong; the text says how, as a phrase.
    """
    fields = Fields(entry)
    op = fields.choice("op", Op)
    controls, channels = _what(fields)
    edit = Edit(
        controls=controls,
        op=op,
        start=fields.number("start"),
        end=fields.number("end"),
        falloff=fields.number("falloff", 0.0),
        value=fields.number("value", 0.0 if op in WITHOUT_VALUE else None),
        falloff_out=fields.number_or_none("falloff_out"),
        strength=fields.number("strength", 1.0),
        enabled=fields.flag("enabled", True),
        name=fields.text("name", ""),
        about=fields.number_or_none("about"),
        points=fields.pairs("points", MOST_POINTS),
        companions=fields.choice("companions", Company, Company.YIELD),
        seed=fields.whole("seed", high=MOST_SEED) if fields.has("seed") else 0,
        channels=channels,
        amounts=fields.rows("amounts"),
        pins=fields.pairs("pins", MOST_PINS),
    )
    fields.finish()
    return edit


def _what(fields: Fields) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The curves and the channels that an edit names; one of the two is empty."""
    given = [name for name in ("control", "controls", "channel", "channels") if fields.has(name)]
    if len(given) != 1:
        raise FieldError(
            'it needs "control" (a curve), "controls" (a list of curves), "channel" or "channels"'
        )
    names = fields.texts(given[0]) if given[0].endswith("s") else (fields.text(given[0]),)
    return (names, ()) if given[0].startswith("control") else ((), names)


def edits_from(fields: Fields, name: str = "edits") -> tuple[Edit, ...]:
    """Read a list of edits.

    Raises:
        FieldError: an edit is wrong; the text says which one and how.
    """
    edits = []
    for number, entry in enumerate(fields.items(name, most=MOST_EDITS), start=1):
        try:
            edits.append(from_json(entry))
        except ValueError as error:
            raise FieldError(f"edit {number}: {error}") from error
    return tuple(edits)
