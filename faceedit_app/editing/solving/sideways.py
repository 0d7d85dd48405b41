"""The jaw to the side: an answer for a control that is measured across the face.

Its channels come in pairs, left and right, and both of a pair are rarely above 0: what counts is
their difference. The chin moves with this difference of the jaw's pair in proportion, so that the
answer is exact, symmetric, and as smooth as what was asked for. The second pair of the region, the
lips, goes along as far as it does in the take, shrunk to what faces do in general.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.core.regions import Region
from faceedit_app.core.rig import Distances
from faceedit_app.editing.solving.take_statistics import IDLE, Sample

# How far the second pair goes with the first, as weights; how many frames at 25 fps, in which the
# first varies by `_SPREAD`, that counts as; and the most that is believed.
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
    """Answers the control of a region such as the jaw's in one take.

    Attributes:
        region: the region; it has one control, and one or two pairs of channels.
        column: of the control, among all.
        limits: mm, the farthest to the right (below 0) and to the left.

    Args:
        region: see above.
        distances: all controls as a function of the 52 weights.
        may: channels that may change, because the take has them.
        sample: of the take.
    """

    def __init__(
        self, region: Region, distances: Distances, may: frozenset[str], sample: Sample
    ) -> None:
        self.region = region
        (control,) = region.own
        self.column = CONTROL_INDEX[control]
        slopes = distances.gradients[:, self.column, 0].astype(np.float64)
        self._first, self._second = (
            self._pair(names, may, slopes, sample)
            for names in (region.channels[:2], region.channels[2:])
        )
        self._follow = self._gain(sample)
        self._mm = 0.0  # per unit of difference, with the second pair
        if self._first is not None:
            more = self._follow * self._second.slope if self._second is not None else 0.0
            self._mm = self._first.slope + more
        rest = float(distances.offsets[self.column, 0])
        self.limits = (rest - abs(self._mm), rest + abs(self._mm))

    @staticmethod
    def _pair(
        names: tuple[str, ...], may: frozenset[str], slopes: Doubles, sample: Sample
    ) -> _Pair | None:
        """The pair, if the region has it and the take has both channels."""
        if not names or not may.issuperset(names):
            return None
        left, right = (ARKIT_INDEX[name] for name in names)
        low = max(float(min(sample.low[left], sample.low[right])), 0.0)
        return _Pair(left, right, low, 0.5 * float(slopes[left] - slopes[right]))

    def _gain(self, sample: Sample) -> float:
        """How far the second pair goes with the first; 0 if the take never moves it."""
        first, second = self._first, self._second
        if first is None or second is None:
            return 0.0
        both = [second.left, second.right]
        if not (sample.high[both] - sample.low[both] > IDLE).any():
            return 0.0
        weights = np.concatenate(sample.weights)
        x, y = (d - d.mean() for d in (first.difference(weights), second.difference(weights)))
        prior = _PRIOR_FRAMES * _SPREAD**2
        gain = float((x @ y + prior * _FOLLOW) / (x @ x + prior))
        return min(max(gain, 0.0), _MOST)

    def move(self, weights: Doubles, change: Doubles, hold: Doubles) -> None:
        """Change the control where it is asked for, in place.

        Args:
            weights: (N, 52).
            change: (N, C) mm, of which its own column counts. Where nothing asks for it, that may
                be what other channels, once smoothed, move its points by.
            hold: (N, C) in 0..1, how firmly each curve is asked for.
        """
        if self._first is None or self._mm == 0.0:
            return
        before = self._first.difference(weights)
        asked = np.where(hold[:, self.column] > 0, change[:, self.column], 0.0)
        self._first.move(weights, asked / self._mm)
        if self._second is not None and self._follow > 0:
            self._second.move(weights, self._follow * (self._first.difference(weights) - before))
