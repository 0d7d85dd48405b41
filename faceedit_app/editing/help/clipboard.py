"""Copying a range of curves and pasting it elsewhere, or onto the other half of the face."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX, MIRRORED_CONTROL
from faceedit_app.editing.edits.edit import Company, Edit, Op
from faceedit_app.editing.session import EditSession

Points = tuple[tuple[float, float], ...]

TOLERANCE = 0.02  # mm, far below what can be seen
PASTE_FALLOFF = 0.1  # seconds


class Copied(StrEnum):
    """What of a range is copied."""

    CHANGE = "change"  # what the edits changed, mm; pasted on top of what is there
    CURVE = "curve"  # the face itself, mm; pasted in place of what is there


@dataclass(frozen=True)
class Clipboard:
    """A range of curves.

    Attributes:
        what: see `Copied`.
        seconds: length of the range.
        curves: by control, (seconds from the start of the range, mm), in `CONTROL_IDS` order.
    """

    what: Copied
    seconds: float
    curves: tuple[tuple[str, Points], ...]

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing to paste: the range had no changes."""
        return not self.curves

    def mirrored(self) -> Clipboard:
        """Left and right change places."""
        swapped = {MIRRORED_CONTROL[control]: points for control, points in self.curves}
        return replace(self, curves=tuple((c, swapped[c]) for c in CONTROL_IDS if c in swapped))

    def paste(self, at: float, falloff: float = PASTE_FALLOFF) -> tuple[Edit, ...]:
        """The copied range as edits that begin at `at` seconds and fade over `falloff` seconds."""
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
                companions=Company.STAY,  # they were copied too
            )
            for points, controls in alike.items()
        )


def copy_range(
    session: EditSession,
    start: float,
    end: float,
    controls: Sequence[str] = CONTROL_IDS,
    what: Copied = Copied.CHANGE,
) -> Clipboard:
    """Copy curves from `start` to `end` seconds; controls without a change are left out."""
    times = session.take.clip.times
    rows = slice(*(int(i) for i in np.searchsorted(times, (start - 1e-9, end + 1e-9))))
    if rows.start == rows.stop:
        return Clipboard(what, max(end - start, 0.0), ())
    seconds = times[rows] - start
    curves = []
    for control in sorted(controls, key=CONTROL_INDEX.__getitem__):
        column = CONTROL_INDEX[control]
        if what is Copied.CHANGE:
            values = session.asked[rows, column] - session.tracked[rows, column]
            if not np.any(np.abs(values) > TOLERANCE):
                continue
        else:
            values = session.achieved[rows, column]
        curves.append((control, simplify(seconds, values.astype(np.float64))))
    return Clipboard(what, end - start, tuple(curves))


def simplify(seconds: Doubles, values: Doubles, tolerance: float = TOLERANCE) -> Points:
    """As few points as tell a curve to within `tolerance`.

    Args:
        seconds: (N,), rising; N at least 1.
        values: (N,) mm.
        tolerance: mm by which straight lines between the points may miss the curve.
    """
    # Ramer, Douglas and Peucker, with the distance along the value axis, all runs at a time:
    # each run that misses the curve is cut where it misses it most.
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
    # A tenth of a micrometre and a microsecond: files stay readable.
    return tuple(
        (round(float(t), 6), round(float(v), 4))
        for t, v in zip(seconds[keep], values[keep], strict=True)
    )
