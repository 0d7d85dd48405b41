"""Copy a range of curves, and paste it elsewhere or on the other side of the face."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.controls import (
    CONTROL_IDS,
    CONTROL_INDEX,
    MAIN_CONTROLS,
    MIRRORED_CONTROL,
    SIGNED_CONTROLS,
)
from faceedit_app.editing.edits.edit import Company, Edit, Op, Points
from faceedit_app.editing.session import EditSession

TOLERANCE = 0.02  # mm; far too small to see
PASTE_FALLOFF = 0.1  # seconds


class Copied(StrEnum):
    """What is copied of a range."""

    CHANGE = "change"  # the change that edits made, mm; paste adds it
    CURVE = "curve"  # the curve, mm; paste replaces the curve there


@dataclass(frozen=True)
class Clipboard:
    """A copied range of curves.

    Attributes:
        what: see `Copied`.
        seconds: the length of the range.
        curves: points (seconds from the start of the range, mm) by control id, in `CONTROL_IDS`
            order.
    """

    what: Copied
    seconds: float
    curves: tuple[tuple[str, Points], ...]

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing to paste: the range had no changes, or no frame."""
        return not self.curves

    def mirrored(self) -> Clipboard:
        """The same range with left and right swapped."""
        swapped = {
            MIRRORED_CONTROL[control]: _turned(points) if control in SIGNED_CONTROLS else points
            for control, points in self.curves
        }
        return replace(self, curves=tuple((c, swapped[c]) for c in CONTROL_IDS if c in swapped))

    def paste(self, at: float, falloff: float = PASTE_FALLOFF) -> tuple[Edit, ...]:
        """Edits that put the copied range at `at` seconds, with a falloff of `falloff` seconds."""
        alike: dict[Points, list[str]] = {}
        for control, points in self.curves:
            alike.setdefault(points, []).append(control)
        op = Op.ADD if self.what is Copied.CHANGE else Op.DRAW
        start = round(at, 6)
        return tuple(
            Edit(
                tuple(controls),
                op,
                start,
                round(start + self.seconds, 6),
                falloff,
                points=tuple((round(start + t, 6), mm) for t, mm in points),
                companions=Company.STAY,  # companions were copied as well
            )
            for points, controls in alike.items()
        )


def _turned(points: Points) -> Points:
    return tuple((seconds, -mm) for seconds, mm in points)


def copy_range(
    session: EditSession,
    start: float,
    end: float,
    controls: Sequence[str] = MAIN_CONTROLS,
    what: Copied = Copied.CHANGE,
) -> Clipboard:
    """Copy curves from `start` to `end` seconds.

    Of changes, curves without any are left out. Frames that fills give to gaps are copied as well.
    """
    frames = session.all_frames()
    times = frames.times
    rows = slice(*(int(i) for i in np.searchsorted(times, (start - 1e-9, end + 1e-9))))
    if rows.start == rows.stop:
        return Clipboard(what, max(end - start, 0.0), ())
    seconds = times[rows] - start
    curves = []
    for control in sorted(controls, key=CONTROL_INDEX.__getitem__):
        column = CONTROL_INDEX[control]
        if what is Copied.CHANGE:
            values = frames.asked[rows, column] - frames.tracked[rows, column]
            if not np.any(np.abs(values) > TOLERANCE):
                continue
        else:
            values = frames.achieved[rows, column]
        curves.append((control, simplify(seconds, values.astype(np.float64))))
    return Clipboard(what, end - start, tuple(curves))


def simplify(seconds: Doubles, values: Doubles, tolerance: float = TOLERANCE) -> Points:
    """Approximate a curve by as few points as possible (Ramer, Douglas and Peucker).

    Args:
        seconds: (N,), increasing; N at least 1.
        values: (N,) mm.
        tolerance: mm; how far straight lines between the points may be from the curve.
    """
    # The distance is measured along the value axis, for all runs at once: each run that is too
    # far from the curve is split where it is farthest.
    keep = np.zeros(len(seconds), np.bool_)
    keep[[0, -1]] = True
    while True:
        ends = np.flatnonzero(keep)
        off = np.abs(values - np.interp(seconds, seconds[ends], values[ends]))
        worst = np.maximum.reduceat(off, ends)
        missed = (off == np.repeat(worst, np.diff(ends, append=len(off)))) & (off > tolerance)
        if not missed.any():
            break
        keep |= missed
    # Rounded to 0.1 micrometres and to microseconds, so that files stay readable.
    return tuple(
        (round(float(t), 6), round(float(v), 4))
        for t, v in zip(seconds[keep], values[keep], strict=True)
    )
