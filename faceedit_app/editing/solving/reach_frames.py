"""The frames of a search of reach: what it starts from, and where it has come to.

Arrays lie column by column in memory, so that those next to each other are the same on all frames.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arrays import Bools, Doubles, Indices


@dataclass(frozen=True)
class Reached:
    """The result of a change of weights, on N frames.

    Attributes:
        vectors: (N, C, 3) mm.
        lengths: (N, C) mm; negative once a pair of vertices has passed.
        costs: (N,) how far the lengths are from the targets.
    """

    vectors: Doubles
    lengths: Doubles
    costs: Doubles

    def at(self, rows: Indices) -> Reached:
        """Some of the frames."""
        return Reached(at(self.vectors, rows), at(self.lengths, rows), self.costs[rows])

    def put(self, rows: Indices, other: Reached, best: tuple[Indices, Indices]) -> None:
        """Replace some of the frames by the best of others."""
        self.vectors[rows] = other.vectors[best]
        self.lengths[rows], self.costs[rows] = other.lengths[best], other.costs[best]


@dataclass(frozen=True)
class Frames:
    """The input of a search, on N frames.

    Attributes:
        start, lower, upper: (N, K) weights and their bounds.
        vectors: (N, C, 3) mm.
        targets: (N, C) mm.
        noise: (N, C) mm², how exactly each target has to be met.
        limit: (N,) the longest change, in standard deviations.
        share: (N,) in 0..1, the part of the wide covariance.
    """

    start: Doubles
    lower: Doubles
    upper: Doubles
    vectors: Doubles
    targets: Doubles
    noise: Doubles
    limit: Doubles
    share: Doubles

    def at(self, rows: Indices) -> Frames:
        """Some of the frames."""
        arrays = (self.start, self.lower, self.upper, self.vectors)
        more = (self.targets, self.noise, self.limit, self.share)
        return Frames(*[at(array, rows) for array in (*arrays, *more)])

    def bounded(self, change: Doubles, coupled: tuple[int, int] | None) -> tuple[Doubles, Bools]:
        """The nearest allowed change (N, K), and where a bound has stopped it."""
        wanted = self.start + change
        inside = np.minimum(np.maximum(wanted, self.lower), self.upper)
        if coupled is not None:
            a, b = coupled
            slack = np.maximum(self.start[:, a] - self.start[:, b], 0.0)
            inside[:, a] = np.minimum(inside[:, a], inside[:, b] + slack)
        stopped: Bools = inside != wanted
        inside -= self.start
        return inside, stopped

    def cost(self, lengths: Doubles) -> Doubles:
        """How far lengths (..., N, C) are from the targets: (..., N).

        Pairs that have passed each other count as touching.
        """
        lengths = np.maximum(lengths, np.minimum(self.targets, 0.0))
        costs: Doubles = ((self.targets - lengths) ** 2 / self.noise).sum(axis=-1)
        return costs


def at(values: NDArray[Any], rows: Indices) -> NDArray[Any]:
    """Some of the frames of values (N, ...), column by column in memory."""
    return values.T.take(rows, axis=-1).T


def limited(values: Doubles) -> Doubles:
    """The values, not below 0 and not above 1."""
    inside: Doubles = np.minimum(np.maximum(values, 0.0), 1.0)
    return inside


def solved(system: Doubles, right: Doubles) -> Doubles:
    """(N, C) solutions of N systems (N, C, C), symmetric and positive, with right sides (N, C)."""
    if system.shape[1] != 2:
        return np.asarray(np.linalg.solve(system, right[:, :, None])[:, :, 0], np.float64)
    first, both, second = system[:, 0, 0], system[:, 0, 1], system[:, 1, 1]
    x, y = right.T
    pair = np.stack([second * x - both * y, first * y - both * x], axis=1)
    pair /= (first * second - both * both)[:, None]
    return pair
