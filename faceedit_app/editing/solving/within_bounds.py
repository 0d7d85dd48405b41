"""The most probable change of weights within bounds, each frame by itself.

The change has the least sum of squares, and its bounds are met exactly: the sum has one minimum,
which moves little if the frame does. Frames that are alike are answered alike, with no jump where
a weight comes to its bound or leaves it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles, Indices

# Guesses of which weights are at their bounds; most frames need three or four.
_TOGETHER, _ONE_BY_ONE = 10, 200
_SETTLED = 1e-6  # of a weight


@dataclass(frozen=True)
class Squares:
    """For N frames, sums of squares as functions of changes of K weights.

    Attributes:
        curvature: (N, K, K), symmetric and positive.
        slope: (N, K) by which the sum falls at no change.
        lower, upper: (N, K) the least and the greatest change.
    """

    curvature: Doubles
    slope: Doubles
    lower: Doubles
    upper: Doubles

    @classmethod
    def of(
        cls,
        precision: Doubles,
        slopes: Doubles,
        wanted: Doubles,
        noise: Doubles,
        bounds: tuple[Doubles, Doubles],
    ) -> Squares:
        """How improbable a change is, and how far it stays from what is wanted.

        Args:
            precision: (K, K) the inverse of the covariance of changes.
            slopes: (N, C, K) mm by which each weight moves each control.
            wanted: (N, C) mm by which the controls should move.
            noise: (N, C) mm², how exactly.
            bounds: (N, K) the least and the greatest change.
        """
        exact = slopes / noise[:, :, None]
        curvature = slopes.transpose(0, 2, 1) @ exact + precision
        slope = (wanted[:, None, :] @ exact)[:, 0]
        return cls(curvature, slope, *bounds)

    def at(self, rows: Indices) -> Squares:
        """Some of the frames."""
        return Squares(self.curvature[rows], self.slope[rows], self.lower[rows], self.upper[rows])

    def least(self) -> Doubles:
        """(N, K) the change within bounds with the least sum.

        It guesses which weights are at their bounds: one is held at a bound that it would cross,
        and let go once the others pull it back. All at once is quick, but may go round in circles;
        one at a time, always the last, comes to an end (Murty 1974, Júdice and Pires 1994).
        """
        change = np.zeros_like(self.slope)
        low, high = np.zeros_like(change, np.bool_), np.zeros_like(change, np.bool_)
        rows, part = np.arange(len(change)), self
        for guess in range(_TOGETHER + _ONE_BY_ONE):
            found = part._with_held(low, high)
            change[rows] = np.clip(found, part.lower, part.upper)
            pull = part.slope - (part.curvature @ found[:, :, None])[:, :, 0]
            below = np.where(low, pull < 0, found < part.lower - _SETTLED)
            above = np.where(high, pull > 0, found > part.upper + _SETTLED)
            wrong = (below != low) | (above != high)
            going = np.flatnonzero(wrong.any(axis=1))
            if not len(going):
                break
            if guess >= _TOGETHER:
                last = wrong.shape[1] - 1 - wrong[:, ::-1].argmax(axis=1)
                others = np.arange(wrong.shape[1]) != last[:, None]
                below, above = np.where(others, low, below), np.where(others, high, above)
            rows, low, high, part = rows[going], below[going], above[going], part.at(going)
        return change

    def _with_held(self, low: Bools, high: Bools) -> Doubles:
        """(N, K) the least sum, with some weights at their bounds and all others free."""
        held = low | high
        there = np.where(low, self.lower, np.where(high, self.upper, 0.0))
        right = self.slope - (self.curvature @ there[:, :, None])[:, :, 0]
        free = ~held
        system = self.curvature * (free[:, :, None] & free[:, None, :])
        places = np.arange(held.shape[1])
        system[:, places, places] += held
        found = np.linalg.solve(system, np.where(held, 0.0, right)[:, :, None])[:, :, 0]
        return np.where(held, there, found)
