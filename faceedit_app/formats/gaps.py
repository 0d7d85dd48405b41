"""Gaps: frames that are missing, and rows in which the face was lost."""

from __future__ import annotations

import numpy as np

from faceedit_app.core.arrays import Bools, Times
from faceedit_app.core.clip import Gap
from faceedit_app.formats.changing_rates import in_slower_stretch
from faceedit_app.formats.timing import counted

_GAP = 1.5  # steps of at least this many frames have a frame missing


def find_gaps(times: Times, rate: float) -> tuple[Gap, ...]:
    """Where at least one frame is missing; a stretch of a lower rate has no gaps.

    Args:
        times: (T,) seconds, increasing.
        rate: frames per second.
    """
    steps = np.diff(times) * rate
    where = np.flatnonzero((steps >= _GAP) & ~in_slower_stretch(steps))
    return tuple(Gap(int(i), max(1, round(float(steps[i])) - 1)) for i in where)


def gap_notes(gaps: tuple[Gap, ...]) -> tuple[str, ...]:
    """A note with the number of gaps and missing frames; none if there are no gaps."""
    if not gaps:
        return ()
    missing = sum(gap.missing for gap in gaps)
    return (f"{counted(len(gaps), 'gap')}, {counted(missing, 'frame')} missing",)


def lost_notes(lost: Bools) -> tuple[str, ...]:
    """A note that counts the rows without a face (R,); none if there are none."""
    if not lost.any():
        return ()
    places = int((lost & ~np.concatenate([[False], lost[:-1]])).sum())
    what, where = counted(int(lost.sum()), "row"), counted(places, "place")
    return (f"the face was lost in {what} at {where}: no frames there, the rows are kept",)
