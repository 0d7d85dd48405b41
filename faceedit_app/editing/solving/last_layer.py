"""The take's own last layer: what the networks' answer lacks for this face and this tracker.

The networks know faces in general. The take shows what *this* face does with its channels, and it
shows it for every frame: the curves and the weights of the same moment. So their answer N(c) is
corrected by a small regression R on quadratic functions of the curves, fitted in closed form to
W - N(c), the weights that the networks did not foresee:

    answer to an edit = N(asked) - N(tracked) + R(asked) - R(tracked)

This is ridge regression (Hoerl and Kennard, "Ridge regression: biased estimation for nonorthogonal
problems", 1970) towards the networks: a take of a second hardly changes their answer, and one of a
minute nearly replaces it. It depends on nothing but the take.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from faceedit_app.core.arrays import Doubles, Indices

# How firmly the coefficients of the curves, and those of their products, are kept near 0, in
# frames at 25 fps.
LINEAR, QUADRATIC = 20.0, 200.0
# mm added to each curve's standard deviation: a curve that hardly moves says little.
LEAST_SPREAD = 0.3
# Standard deviations beyond the take's own range within which the correction still grows.
BEYOND = 0.5


@dataclass(frozen=True)
class LastLayer:
    """A correction to the answers for C curves, of K channels.

    Attributes:
        mean, spread: (C,) mm, the take's curves.
        low, high: (C,) the range of the standardised curves in which the take knows.
        coefficients: (F, K) of the functions of the curves.
    """

    mean: Doubles
    spread: Doubles
    low: Doubles
    high: Doubles
    coefficients: Doubles

    @classmethod
    def fit(cls, curves: Doubles, lacking: Doubles, weight: float = 1.0) -> LastLayer:
        """Fit the correction.

        Args:
            curves: (T, C) mm.
            lacking: (T, K) the weights less the networks' answer to the curves.
            weight: how much each frame counts.
        """
        mean, spread = curves.mean(axis=0), curves.std(axis=0) + LEAST_SPREAD
        standard = (curves - mean) / spread
        low, high = standard.min(axis=0) - BEYOND, standard.max(axis=0) + BEYOND
        functions = _functions(standard)
        penalty = np.full(functions.shape[1], QUADRATIC)
        penalty[: curves.shape[1]] = LINEAR
        # The constant cancels in the difference of two answers, so it is taken out beforehand.
        offset = functions - functions.mean(axis=0)
        system = offset.T @ offset + np.diag(penalty / weight)
        coefficients = np.linalg.solve(system, offset.T @ (lacking - lacking.mean(axis=0)))
        return cls(mean, spread, low, high, coefficients)

    def towards(self, other: LastLayer, share: float) -> LastLayer:
        """The layer between this and another of the same take, fitted to the same mix."""
        mixed = self.coefficients + share * (other.coefficients - self.coefficients)
        return replace(self, coefficients=mixed)

    def change(self, curves: Doubles, to: Doubles) -> Doubles:
        """(N, K) how the correction changes from curves (N, C) to others."""
        moved = self._standard(to), self._standard(curves)
        change: Doubles = (_functions(moved[0]) - _functions(moved[1])) @ self.coefficients
        return change

    def _standard(self, curves: Doubles) -> Doubles:
        standard = (curves - self.mean) / self.spread
        within: Doubles = np.minimum(np.maximum(standard, self.low), self.high)
        return within


@cache
def _pairs(curves: int) -> tuple[Indices, Indices]:
    first, second = np.triu_indices(curves)
    return first, second


def _functions(standard: Doubles) -> Doubles:
    """(N, C) -> (N, F): the curves and their products."""
    first, second = _pairs(standard.shape[1])
    return np.concatenate([standard, standard[:, first] * standard[:, second]], axis=1)
