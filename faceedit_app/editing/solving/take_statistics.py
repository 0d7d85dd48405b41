"""What the channels of one region do in one take: which are used, how far, and how together.

An answer should look like the rest of the take. So every channel keeps to the range in which the
take's own tracker moves it, channels that the take never uses stay still, and a change is the most
probable one under the covariance of this take. The covariance is shrunk to that of other
performances: a take of two seconds says little, one of a minute nearly everything. Range and
covariance are symmetric under mirroring, because a smile to the left is as probable as one to the
right. Only quick movement is not: one side of a face may shake while the other is still.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles, Indices

# A channel that moves less than this in the whole take is idle.
IDLE = 0.02
# Seconds of a take before the absence of movement says anything.
ENOUGH_SECONDS = 1.0
# Weight of other performances in the covariance, in frames at 25 fps.
PRIOR_FRAMES = 20.0
# The same for quick movement, which a few frames show well enough.
QUICK_PRIOR_FRAMES = 2.0
# A channel this near to its smallest weight is at rest ...
AT_REST = 1e-3
# ... and rests if it is for such a share of the take.
OFTEN = 0.2
# A channel that rests does not leave its rest for less.
WAKES = 0.03
# Movement beyond the take's own range that any request may use.
MARGIN = 0.05


@dataclass(frozen=True)
class Sample:
    """Stretches of a take at 25 fps, and its extremes.

    Attributes:
        weights: (N, 52) of each stretch.
        frames: (N, 52) of each stretch, as tracked, at the take's own rate.
        curves: (N, C) mm of each stretch.
        low, high: (52,) the smallest and largest weights of the whole take.
        shortest, longest: (C,) mm, the same of its curves.
        seconds: the length of the take.
    """

    weights: list[Doubles]
    frames: list[Doubles]
    curves: list[Doubles]
    low: Doubles
    high: Doubles
    shortest: Doubles
    longest: Doubles
    seconds: float


@dataclass(frozen=True)
class TakeStatistics:
    """What K channels do in a take.

    Attributes:
        low, high: (K,) the smallest and the largest weight.
        used: (K,) whether the channel moves at all.
        rests: (K,) whether the channel is at its smallest weight for much of the take.
        covariance: (K, K) of the weights; 0 for idle channels.
        wide: (K, K) the mean of the take's covariance and that of other performances, idle
            channels included, for what the take itself cannot answer.
        fast: (K, K) covariance of quick movement (second differences), scaled to the
            trace of `covariance`; 0 for idle channels.
    """

    low: Doubles
    high: Doubles
    used: Bools
    rests: Bools
    covariance: Doubles
    wide: Doubles
    fast: Doubles

    @classmethod
    def of(
        cls,
        low: Doubles,
        high: Doubles,
        blocks: list[Doubles],
        frames: list[Doubles],
        prior: Doubles,
        mirror: Indices,
        needed: Bools,
        seconds: float,
    ) -> TakeStatistics:
        """Measure a take.

        Args:
            low, high: (K,) over the whole take.
            blocks: stretches (N, K) of the take at 25 fps.
            frames: the same at its own rate, at which shaking shows.
            prior: (K, K) covariance in other performances.
            mirror: (K,) the position of each channel's mirror image.
            needed: (K,) channels without which a curve cannot be answered; they count as used.
            seconds: the length of the take.
        """
        low, high = np.minimum(low, low[mirror]), np.maximum(high, high[mirror])
        used = (high - low > IDLE) | needed
        if seconds < ENOUGH_SECONDS:
            used = np.ones_like(used)
        weights = np.concatenate(blocks)
        even = _even(prior, mirror)
        own = _even(_covariance(weights), mirror)
        covariance = _shrunk(own, len(weights), even, PRIOR_FRAMES)
        changes = [np.diff(block, 2, axis=0) for block in frames if len(block) > 2]
        fast = covariance
        if changes:
            change = np.concatenate(changes)
            square = change.T @ change / len(change)
            size = np.trace(square)
            if size > 0:
                scaled = square * (np.trace(covariance) / size)
                fast = _shrunk(scaled, len(change), covariance, QUICK_PRIOR_FRAMES)
        live = np.outer(used, used)
        wide = 0.5 * (covariance + even)
        still = np.concatenate(frames) <= low + AT_REST
        rests = still.mean(axis=0) > OFTEN
        return cls(low, high, used, rests, covariance * live, wide, fast * live)

    def at_rest(self, weights: Doubles, channels: Indices | slice) -> Doubles:
        """(N, M) in 0..1: how far channels that rest are at rest, in weights (N, M) of some."""
        away = (weights - self.low[channels]) / WAKES
        at_rest: Doubles = np.minimum(np.maximum(1.0 - away, 0.0), 1.0)
        at_rest *= self.rests[channels]
        return at_rest

    def bounds(self, beyond: Doubles) -> tuple[Doubles, Doubles]:
        """The smallest and largest weights for requests on N frames, (N, K) or (1, K) each.

        Args:
            beyond: (N,) in 0..1: how far a request leaves what the take itself does. At 0 the
                channels keep to the take's range, at 1 to what a face can do.
        """
        low, high, falls, rises = self._ends
        if not beyond.any():
            return low.T, high.T
        return (low - falls * beyond).T, (high + rises * beyond).T

    @cached_property
    def _ends(self) -> tuple[Doubles, Doubles, Doubles, Doubles]:
        """(K, 1) each: the take's own ends, and how far those of a face are below and above."""
        high = np.maximum(self.high, np.minimum(self.high + MARGIN, 1.0))
        ends = self.low, high, np.maximum(self.low, 0.0), np.maximum(1.0 - high, 0.0)
        low, high, falls, rises = (each[:, None] for each in ends)
        return low, high, falls, rises


def _covariance(weights: Doubles) -> Doubles:
    centred = weights - weights.mean(axis=0)
    covariance: Doubles = centred.T @ centred / len(weights)
    return covariance


def _shrunk(own: Doubles, frames: int, prior: Doubles, prior_frames: float) -> Doubles:
    return (frames * own + prior_frames * prior) / (frames + prior_frames)


def _even(covariance: Doubles, mirror: Indices) -> Doubles:
    """The mean of a covariance and its mirror image."""
    even: Doubles = 0.5 * (covariance + covariance[np.ix_(mirror, mirror)])
    return even
