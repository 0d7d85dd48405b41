"""The jaw to the side: an answer for the control that is measured across the face.

Its channels come in pairs, left and right, and both of a pair are rarely above 0: what counts is
their difference. The chin moves with this difference of the jaw's pair in proportion, so that the
answer is exact, symmetric, and as smooth as what was asked for. The lips go along as far as they do
in the take, shrunk to what faces do in general.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.core.regions import JAW
from faceedit_app.core.rig import Distances
from faceedit_app.editing.solving.take_statistics import IDLE, Sample

# How far the lips go with the jaw, as weights; how many frames at 25 fps, with a jaw that varies by
# `_SPREAD`, that counts as; and the most that is believed.
_FOLLOW, _PRIOR_FRAMES, _SPREAD, _MOST = 0.3, 100.0, 0.1, 0.6


@dataclass(frozen=True)
class _Pair:
    """A channel to the left and the same to the right.

    Attributes:
        left, right: columns among the 52.
        low: the smallest weight of either in the take.
        slope: mm of the control per unit of difference.
    """

    left: int
    right: int
    low: float
    slope: float

    def difference(self, weights: Doubles) -> Doubles:
        """(N,) of weights (N, 52)."""
        difference: Doubles = weights[:, self.left] - weights[:, self.right]
        return difference

    def move(self, weights: Doubles, by: Doubles) -> None:
        """Change the difference by (N,), in place: first release one side, then move the other."""
        for towards, against, part in (
            (self.left, self.right, np.maximum(by, 0.0)),
            (self.right, self.left, np.maximum(-by, 0.0)),
        ):
            there, here = weights[:, against], weights[:, towards]
            released = np.minimum(part, np.maximum(there - self.low, 0.0))
            most = np.maximum(here, 1.0)
            weights[:, against] = np.where(part > 0, there - released, there)
            weights[:, towards] = np.where(
                part > 0, np.minimum(here + (part - released), most), here
            )


class Sideways:
    """Answers the control of the jaw's region in one take.

    Attributes:
        column: of the control, among all.
        limits: mm, the farthest to the right (below 0) and to the left.

    Args:
        distances: all controls as a function of the 52 weights.
        may: channels that may change, because the take has them.
        sample: of the take.
    """

    def __init__(self, distances: Distances, may: frozenset[str], sample: Sample) -> None:
        (control,) = JAW.own
        self.column = CONTROL_INDEX[control]
        slopes = distances.gradients[:, self.column, 0].astype(np.float64)
        self._jaw, self._lips = (
            self._pair(names, may, slopes, sample) for names in (JAW.channels[:2], JAW.channels[2:])
        )
        self._follow = self._gain(sample)
        self._mm = 0.0  # per unit of difference, with the lips
        if self._jaw is not None:
            lips = self._follow * self._lips.slope if self._lips is not None else 0.0
            self._mm = self._jaw.slope + lips
        rest = float(distances.offsets[self.column, 0])
        self.limits = (rest - abs(self._mm), rest + abs(self._mm))

    @staticmethod
    def _pair(
        names: tuple[str, ...], may: frozenset[str], slopes: Doubles, sample: Sample
    ) -> _Pair | None:
        """The pair, if the take has both channels."""
        left, right = (ARKIT_INDEX[name] for name in names)
        if not may.issuperset(names):
            return None
        low = max(float(min(sample.low[left], sample.low[right])), 0.0)
        return _Pair(left, right, low, 0.5 * float(slopes[left] - slopes[right]))

    def _gain(self, sample: Sample) -> float:
        """How far the lips go with the jaw; 0 if the take never moves them."""
        jaw, lips = self._jaw, self._lips
        if jaw is None or lips is None:
            return 0.0
        both = [lips.left, lips.right]
        if not (sample.high[both] - sample.low[both] > IDLE).any():
            return 0.0
        weights = np.concatenate(sample.weights)
        x, y = (d - d.mean() for d in (jaw.difference(weights), lips.difference(weights)))
        prior = _PRIOR_FRAMES * _SPREAD**2
        gain = float((x @ y + prior * _FOLLOW) / (x @ x + prior))
        return min(max(gain, 0.0), _MOST)

    def move(self, weights: Doubles, change: Doubles, hold: Doubles) -> None:
        """Change the control where it is asked for, in place.

        Args:
            weights: (N, 52).
            change: (N, C) mm, of which its own column counts. Where nothing asks for it, that may
                be what other channels, once smoothed, move the chin by.
            hold: (N, C) in 0..1, how firmly each curve is asked for.
        """
        if self._jaw is None or self._mm == 0.0:
            return
        before = self._jaw.difference(weights)
        asked = np.where(hold[:, self.column] > 0, change[:, self.column], 0.0)
        self._jaw.move(weights, asked / self._mm)
        if self._lips is not None and self._follow > 0:
            self._lips.move(weights, self._follow * (self._jaw.difference(weights) - before))
