"""The clock of a retime: which moment of the take is shown when.

Between pins the clock is a monotone cubic (Fritsch and Butland, "A method for constructing local
monotone piecewise cubic interpolants", 1984), so that speed changes without a jerk and time never
runs backwards. At the ends of the range it joins the take's own time at its own speed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles, Times
from faceedit_app.editing.edits.edit import Edit

# Seconds on either side of a cut in which both sides are mixed, so that the face does not jump.
CROSSFADE = 0.08
_STEEPEST = 3.0  # times the mean speed between two pins: with more, a cubic would turn back
_HALVINGS = 36  # to invert the clock to a nanosecond, over a minute


@dataclass(frozen=True)
class Moments:
    """Moments of the take that are shown at N times.

    Attributes:
        first, second: (N,) seconds of the take. They differ only around a cut.
        share: (N,) in 0..1 of the second.
        speed: (N,) seconds of the take per second.
    """

    first: Doubles
    second: Doubles
    share: Doubles
    speed: Doubles


class Clock:
    """The clock of one retime.

    Args:
        edit: the retime. Its strength, up to 1, is how far the clock goes from the take's own
            time to the pins.
    """

    def __init__(self, edit: Edit) -> None:
        ends = (edit.start, edit.start), (edit.end, edit.end)
        was, now = np.array([ends[0], *edit.pins, ends[1]], np.float64).T
        # Rounding may have brought pins a little out of the range, or out of order.
        was, now = (np.maximum.accumulate(t.clip(edit.start, edit.end)) for t in (was, now))
        now = was + min(edit.strength, 1.0) * (now - was)
        same = (np.diff(was, prepend=-np.inf) == 0) & (np.diff(now, prepend=-np.inf) == 0)
        self._was, self._now = was[~same], now[~same]
        self.start, self.end = edit.start, edit.end
        self._fit()

    def _fit(self) -> None:
        """The cubics from `_now` to `_was`: the slopes at both ends of each piece."""
        width = np.diff(self._now)
        cuts = width <= 0
        mean = np.diff(self._was) / np.where(cuts, 1.0, width)
        left, right = mean.copy(), mean.copy()
        for i in range(1, len(mean)):
            if not (cuts[i - 1] or cuts[i]):
                left[i] = right[i - 1] = _joint_slope(width[i - 1 : i + 1], mean[i - 1 : i + 1])
        if len(mean):
            left[0] = min(1.0, _STEEPEST * mean[0])
            right[-1] = min(1.0, _STEEPEST * mean[-1])
        self._width, self._left, self._right = width, left, right
        self._cuts = np.flatnonzero(cuts)
        # Neighbouring cuts share the room between them: what is mixed does not overlap.
        room = np.diff([self.start, *self._now[self._cuts], self.end])
        room[1:-1] *= 0.5
        self._half = np.minimum(np.minimum(room[:-1], room[1:]), CROSSFADE)

    def moments(self, times: Times) -> Doubles:
        """(N,) seconds of the take that are shown at `times` (N,); without mixing at cuts."""
        return self._at(times)[0]

    def mixed(self, times: Times) -> Moments:
        """What is shown at `times` (N,), with both sides of each cut mixed around it."""
        first, speed = self._at(times)
        second, share = first.copy(), np.zeros(len(times))
        for cut, half in zip(self._cuts.tolist(), self._half.tolist(), strict=True):
            at = self._now[cut]
            near = np.abs(times - at) < half
            if not near.any():
                continue
            apart = times[near] - at
            # Each side goes on through what was cut at its own speed, at most that of the take.
            before = min(float(self._right[cut - 1]), 1.0) if cut else 1.0
            after = min(float(self._left[cut + 1]), 1.0) if cut + 1 < len(self._left) else 1.0
            ahead, back = self._was[cut] + before * apart, self._was[cut + 1] + after * apart
            second[near] = np.where(apart < 0, back, first[near])
            first[near] = np.where(apart < 0, first[near], ahead)
            along = 0.5 + 0.5 * apart / half
            share[near] = along * along * (3.0 - 2.0 * along)
        return Moments(first, second, share, speed)

    def _at(self, times: Times) -> tuple[Doubles, Doubles]:
        """(N,) each: seconds of the take, and seconds of the take per second."""
        if len(self._now) < 2:
            return times.astype(np.float64), np.ones(len(times))
        piece = np.clip(np.searchsorted(self._now, times, side="right") - 1, 0, len(self._now) - 2)
        width = np.where(self._width[piece] > 0, self._width[piece], 1.0)
        u = ((times - self._now[piece]) / width).clip(0.0, 1.0)
        a, b = self._was[piece], self._was[piece + 1]
        left, right = width * self._left[piece], width * self._right[piece]
        at = a + u * u * (3.0 - 2.0 * u) * (b - a)
        at += u * (1.0 - u) * ((1.0 - u) * left - u * right)
        slope = 6.0 * u * (1.0 - u) * (b - a)
        slope += (1.0 - u) * (1.0 - 3.0 * u) * left + u * (3.0 * u - 2.0) * right
        outside = (times <= self.start) | (times >= self.end)
        at = np.where(outside, times, np.maximum(np.minimum(at, b), a))
        return at, np.where(outside, 1.0, slope / width)

    @property
    def mixes(self) -> float:
        """Seconds of the take by which a cut reads beyond its sides; 0 without cuts."""
        return CROSSFADE if len(self._cuts) else 0.0

    def cuts_out(self, moments: Times) -> Bools:
        """(N,) whether moments (N,) of the take are never shown, because a cut removes them."""
        removed = np.zeros(len(moments), np.bool_)
        for cut in self._cuts.tolist():
            removed |= (moments > self._was[cut]) & (moments < self._was[cut + 1])
        return removed

    def shown(self, moments: Times) -> Doubles:
        """(N,) when the moments (N,) of the take are shown: the inverse of `moments`.

        A moment that is held is shown first at the time given; one that is cut, never: then the
        time of the cut is given.
        """
        low = np.full(len(moments), self.start)
        high = np.full(len(moments), self.end)
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            early = self.moments(middle) < moments
            low, high = np.where(early, middle, low), np.where(early, high, middle)
        outside = (moments <= self.start) | (moments >= self.end)
        return np.where(outside, moments, high)


def _joint_slope(width: Doubles, mean: Doubles) -> float:
    """The slope where two pieces meet: between their mean slopes, 0 beside a piece that is held."""
    if (mean <= 0).any():
        return 0.0
    weight = (width[0] + 2.0 * width[1]) / (3.0 * width.sum())
    return float(mean[0] * mean[1] / (weight * mean[1] + (1.0 - weight) * mean[0]))


@lru_cache(maxsize=256)
def clock_of(edit: Edit) -> Clock:
    """The clock of a retime."""
    return Clock(edit)
