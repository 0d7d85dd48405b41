"""Frames in the gaps of a take, as long as an edit is being answered.

Filters count frames, and the networks' grid has a straight line from one frame to the next. Across
a gap, what is asked for after it would therefore reach the frame before it at once. So gaps are
bridged by frames in even steps, at the take's rate, that lie between those on both sides; edits
act on them as on all others. They are in no result.

A gap that is longer than two `BESIDE` is bridged only beside its ends. Smooths leave the frames in
it out: the face after it follows on that before it, and a jump from one to the other can be
softened.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arrays import Bools, Doubles, Indices, Times
from faceedit_app.core.clip import Clip
from faceedit_app.core.resample import OffGrid, Resampling

# Seconds on either side of a long gap that have frames: more than any answer looks ahead. Two of
# them are less than what a fill bridges (`LONGEST_FILL`), after which jumps are softened.
BESIDE = 1.9

Values = TypeVar("Values", bound=NDArray[Any])
Rows = Indices | slice


@dataclass(frozen=True, eq=False)
class Bridged:
    """N frames of a take in a row, and among them those in their gaps: N' in all.

    Attributes:
        times: (N',) seconds.
        own: (N,) which of them are the take's; all of them as a slice if there are no gaps.
        added: which of them are in gaps.
        before: (N' - N,) the frame of the N before each of these.
        share: (N' - N, 1) where they lie between that one and the next, 0..1.
        far: (N',) those in long gaps, which smooths leave out; None if there are none.
    """

    times: Times
    own: Rows
    added: Indices
    before: Indices
    share: Doubles
    far: Bools | None

    def wide(self, values: Values) -> Values:
        """(N', C) values (N, C), with what lies between them in gaps."""
        if isinstance(self.own, slice):
            return values
        out = np.empty((len(self.times), values.shape[1]), values.dtype, order="F")
        out[self.own] = values
        one, other = values[self.before], values[self.before + 1]
        out[self.added] = (1.0 - self.share) * one + self.share * other
        return out  # type: ignore[return-value]  # of the same type

    def within(self, first: int, stop: int) -> tuple[slice, Rows]:
        """Where some of the N frames are among the N', and which of those between are the take's.

        Args:
            first, stop: the first of them, and the one after the last.
        """
        if isinstance(self.own, slice):
            return slice(first, stop), slice(None)
        inner = slice(int(self.own[first]), int(self.own[stop - 1]) + 1)
        if inner.stop - inner.start == stop - first:  # all rows as a slice are not copied
            return inner, slice(None)
        return inner, self.own[first:stop] - inner.start


class Bridging:
    """Bridges the gaps of one take.

    Args:
        clip: its times, rate and gaps.
    """

    def __init__(self, clip: Clip) -> None:
        self._times, self._rate = clip.times, clip.rate
        frames = np.array([gap.frame for gap in clip.gaps], np.intp)
        frames = np.unique(frames[frames < len(clip.times) - 1])
        steps = np.round((clip.times[frames + 1] - clip.times[frames]) * clip.rate)
        self._gaps, self._steps = frames[steps > 1], steps[steps > 1].astype(np.intp)

    def __call__(self, near: slice) -> Bridged:
        """Some frames of the take, with those in the gaps between them."""
        times = self._times[near]
        first, last = np.searchsorted(self._gaps, (near.start, near.start + len(times) - 1))
        none = np.zeros(0, np.intp)
        if first >= last:
            return Bridged(times, slice(None), none, none, np.zeros((0, 1)), None)
        steps, most = self._steps[first:last], max(round(BESIDE * self._rate), 1)
        counts = np.minimum(steps - 1, 2 * most)
        before = np.repeat(self._gaps[first:last] - near.start, counts)
        added = before + 1 + np.arange(len(before))
        number = np.arange(len(before)) - np.repeat(np.cumsum(counts) - counts, counts) + 1
        of, is_long = np.repeat(steps, counts), np.repeat(steps - 1 > 2 * most, counts)
        number = np.where(is_long & (number > most), of - 2 * most - 1 + number, number)
        share = number / of
        there = np.ones(len(times) + len(before), np.bool_)
        there[added] = False
        wide, far = np.empty(len(there)), np.zeros(len(there), np.bool_)
        wide[there] = times
        wide[added] = times[before] + share * (times[before + 1] - times[before])
        far[added] = is_long
        own = np.flatnonzero(there)
        return Bridged(wide, own, added, before, share[:, None], far if far.any() else None)


@dataclass(frozen=True, eq=False)
class Nearby:
    """The frames that a chunk is computed from, with their gaps bridged.

    Attributes:
        frames: which of the take's.
        bridged: the same with those in gaps, N' in all.
        inner: those of the N' from the chunk's first to its last.
        shown: which of these are the take's.
        way: from the N' frames to the grid frames that the networks answer.
        grid: the first of these, and the one after the last.
    """

    frames: slice
    bridged: Bridged
    inner: slice
    shown: Rows
    grid: tuple[int, int]

    @property
    def times(self) -> Times:
        """(N',) seconds."""
        return self.bridged.times

    @cached_property
    def way(self) -> Resampling:
        """From the N' frames to the grid frames that the networks answer, and back."""
        return Resampling(self.times, *self.grid)

    @cached_property
    def back(self) -> OffGrid:
        """From these grid frames to the frames `inner`."""
        return Resampling(self.times[self.inner], *self.grid).from_grid


def smoothed_without(
    values: Doubles, left_out: Bools | None, smooth: Callable[[Doubles], Doubles]
) -> Doubles:
    """Values (N, ...) smoothed as if some were not there; these come to lie between the others.

    Args:
        left_out: (N,) which; None = none.
        smooth: smooths values.
    """
    if left_out is None or not left_out.any() or left_out.all():
        return smooth(values)
    kept, every = np.flatnonzero(~left_out), np.arange(len(values))
    between: Doubles = np.apply_along_axis(
        lambda column: np.interp(every, kept, column), 0, smooth(values[kept])
    )
    return between
