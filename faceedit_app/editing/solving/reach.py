"""Reach: the smallest believable change of weights that brings controls to what was asked.

The networks answer an edit with a believable face that comes near the request; this closes the
rest of the way. It is a damped Gauss-Newton on the rig's distances in which "small" is measured
against how the channels of the region vary together in real performances: of all weight changes
that reach the request, the one that is most probable under that covariance (the maximum a
posteriori estimate with a Gaussian prior, re-linearised a few times, with bounds as an active
set).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arrays import Bools, Doubles, Indices
from faceedit_app.core.rig import Distances

ITERATIONS = 6
# Shorter steps, tried where a full one leads farther away.
STEPS = np.array([0.7, 0.4, 0.2, 0.1, 0.0])
# A frame is done when its weights moved by no more than this: the next step is a small part of
# that, far below what can be seen.
SETTLED = 2e-3
# It is also done when its controls are where they should be: an asked-for one within 0.016 mm.
MET = 0.1
# How exactly an asked-for control must be met, and how much the others may give way, in mm.
ASKED_MM = 0.05
FREE_MM = 1.5
# How much a control may lack, in mm, before it is tried from the other side.
MISSED_MM = 1.0
# Longest change that still counts as natural, in standard deviations of the prior.
NATURAL_LENGTH = 4.0


@dataclass(frozen=True)
class Goal:
    """Where the controls of one region should go, on N frames.

    Attributes:
        targets: (N, C), mm.
        strength: (N, C) in 0..1: how far to go from the present length to the target.
        asked: (N, C) bool: the user asked for this one; the others are to stay about where
            their target is, and give way.
    """

    targets: Doubles
    strength: Doubles
    asked: Bools


class Reach:
    """Brings the controls of one region to a goal, each frame by itself.

    Args:
        distances: the region's C controls as a function of all 52 weights.
        channels: (K,) columns that may change.
        covariance: (K, K) of the channels in real performances.
        coupled: positions (a, b) in `channels` with weight a <= weight b (mouthClose, jawOpen).
    """

    def __init__(
        self,
        distances: Distances,
        channels: Indices,
        covariance: Doubles,
        coupled: tuple[int, int] | None = None,
    ) -> None:
        self._distances, self._channels = distances, channels
        self._covariance, self._coupled = covariance, coupled
        gradients = distances.gradients[channels].astype(np.float64)  # (K, C, 3)
        self._moves = gradients.reshape(len(channels), -1)
        self._slopes = np.ascontiguousarray(gradients.transpose(1, 2, 0))  # (C, 3, K)
        self._precision = np.linalg.inv(covariance + 1e-6 * np.eye(len(covariance)))

    def __call__(
        self, weights: Doubles, goal: Goal, upper: Doubles, naturalness: float = 1.0
    ) -> Doubles:
        """The new weights (N, K) of the channels.

        Args:
            weights: (N, 52) present weights; those of other channels are kept.
            goal: see `Goal`.
            upper: (N, K) largest allowed weights; the smallest is 0.
            naturalness: 0 lifts the limit on the change's length, 1 keeps `NATURAL_LENGTH`.
        """
        start, vectors = weights[:, self._channels], self._distances.vectors(weights)
        targets = np.maximum(self._distances.lengths(vectors), 0.0)
        targets += goal.strength * (goal.targets - targets)
        noise = np.where(goal.asked, ASKED_MM, FREE_MM) ** 2
        frames = _Frames(start, np.minimum(start, 0.0), upper, vectors, targets, noise)
        limit = NATURAL_LENGTH / naturalness if naturalness > 0 else np.inf
        change, lengths = self._search(frames, limit, passed=False)
        # Pressed lips can have passed each other: opening them begins with what seems to close
        # them.
        missed = np.flatnonzero(np.any(goal.asked & (targets - lengths > MISSED_MM), axis=1))
        if len(missed):
            those = frames.at(missed)
            other, there = self._search(those, limit, passed=True)
            better = those.cost(there) < those.cost(lengths[missed])
            change[missed[better]] = other[better]
        # Rounding leaves weights such as -1e-17.
        return np.clip(start + change, frames.lower, np.maximum(start, upper))

    def _search(self, frames: _Frames, limit: float, passed: bool) -> tuple[Doubles, Doubles]:
        """The change of the channels (N, K), and the lengths (N, C) that it leads to.

        Args:
            limit: how long the change may be, in standard deviations.
            passed: begin as if each pair of vertices had passed each other.
        """
        found, there = np.empty_like(frames.start), np.empty_like(frames.targets)
        rows: slice | Indices = slice(None)  # of the frames that are not done yet
        change, frozen = np.zeros_like(frames.start), np.zeros(frames.start.shape, bool)
        here = self._place(frames, frames.vectors)
        for iteration in range(ITERATIONS):
            slopes, wanted = self._linear(frames, here, change, passed and iteration == 0)
            aim = self._step(slopes, wanted, frames.noise, change, frozen)
            aim *= self._shortening(aim, limit)
            allowed = frames.bounded(aim, self._coupled)
            stopped = frozen | (np.abs(allowed - aim) > 1e-9)
            new, here = self._line_search(frames, here, change, allowed)
            found[rows], there[rows] = new, here.lengths
            moving = (np.abs(new - change) > SETTLED) | (stopped != frozen)
            going = moving.any(axis=1) & (here.costs > MET)
            change, frozen = new, stopped
            if not going.any():
                break
            if not going.all():
                rows = np.arange(len(found))[rows][going]
                frames, here = frames.at(going), here.at(going)
                change, frozen = change[going], frozen[going]
        return found, np.maximum(there, 0.0)

    def _place(self, frames: _Frames, vectors: Doubles) -> _Place:
        lengths: Doubles = self._distances.lengths(vectors)
        return _Place(vectors, lengths, frames.cost(lengths))

    def _linear(
        self, frames: _Frames, here: _Place, change: Doubles, passed: bool
    ) -> tuple[Doubles, Doubles]:
        """Slopes J (N, C, K) at `change`, and what J times the whole change should be (N, C)."""
        directions = self._distances.directions(here.vectors, here.lengths, passed)
        by_control = np.ascontiguousarray(directions.transpose(1, 0, 2)) @ self._slopes
        slopes = np.ascontiguousarray(by_control.transpose(1, 0, 2))
        return slopes, frames.targets - here.lengths + np.einsum("nck,nk->nc", slopes, change)

    def _step(
        self,
        slopes: Doubles,
        wanted: Doubles,
        noise: Doubles,
        change: Doubles,
        frozen: Bools,
    ) -> Doubles:
        """The most probable change with J change = wanted; frozen channels keep theirs."""
        rest, free, held = wanted, slopes, change
        if frozen.any():
            held = np.where(frozen, change, 0.0)
            rest = wanted - np.einsum("nck,nk->nc", slopes, held)
            free = np.where(frozen[:, None, :], 0.0, slopes)
        spread = (free.reshape(-1, len(self._covariance)) @ self._covariance).reshape(free.shape)
        system = spread @ free.transpose(0, 2, 1)
        diagonal = np.arange(system.shape[1])
        system[:, diagonal, diagonal] += noise
        solved = np.linalg.solve(system, rest[:, :, None])  # (N, C, 1)
        moved: Doubles = (solved.transpose(0, 2, 1) @ spread)[:, 0]
        return np.where(frozen, held, moved)

    def _shortening(self, change: Doubles, limit: float) -> Doubles:
        """(N, 1) factor that keeps each frame's change within a length."""
        length = np.sqrt(((change @ self._precision) * change).sum(axis=1))
        factor: Doubles = np.minimum(1.0, limit / np.maximum(length, 1e-9))[:, None]
        return factor

    def _line_search(
        self, frames: _Frames, here: _Place, old: Doubles, new: Doubles
    ) -> tuple[Doubles, _Place]:
        """The way from `old` to `new`, or as much of it as leads nearer, each frame by itself.

        A full step can carry a pair of vertices through each other, where the distance grows
        again. Vectors are linear in the weights, so that those of all steps come from two.

        Returns:
            The change (N, K), and where it leads.
        """
        moves = (new @ self._moves).reshape(frames.vectors.shape)
        there = self._place(frames, frames.vectors + moves)
        worse = np.flatnonzero(there.costs > here.costs)
        if len(worse):
            before = here.vectors[worse]
            trials = before + STEPS[:, None, None, None] * (there.vectors[worse] - before)
            tried = self._place(frames.at(worse), trials)
            best = tried.costs.argmin(axis=0), np.arange(len(worse))
            step = STEPS[best[0]][:, None]
            new = new.copy()
            new[worse] = old[worse] + step * (new[worse] - old[worse])
            there.put(worse, tried.at(best))
        return new, there


@dataclass(frozen=True)
class _Place:
    """Where changes of weights lead to, on N frames.

    Attributes:
        vectors: (N, C, 3) mm.
        lengths: (N, C) mm; negative where a pair of vertices has passed each other.
        costs: (N,) how far that is from the targets.
    """

    vectors: Doubles
    lengths: Doubles
    costs: Doubles

    def at(self, rows: NDArray[Any] | tuple[NDArray[Any], ...]) -> _Place:
        """Some of the frames."""
        return _Place(self.vectors[rows], self.lengths[rows], self.costs[rows])

    def put(self, rows: Indices, other: _Place) -> None:
        """Lead elsewhere on some of the frames."""
        self.vectors[rows] = other.vectors
        self.lengths[rows], self.costs[rows] = other.lengths, other.costs


@dataclass(frozen=True)
class _Frames:
    """What is given of N frames.

    Attributes:
        start, lower, upper: (N, K) weights, and between what they may go.
        vectors: (N, C, 3) mm.
        targets: (N, C) mm.
        noise: (N, C) mm²: how exactly each target is to be met.
    """

    start: Doubles
    lower: Doubles
    upper: Doubles
    vectors: Doubles
    targets: Doubles
    noise: Doubles

    def at(self, rows: Indices | Bools) -> _Frames:
        """Some of the frames."""
        arrays = (self.start, self.lower, self.upper, self.vectors, self.targets, self.noise)
        return _Frames(*(array[rows] for array in arrays))

    def bounded(self, change: Doubles, coupled: tuple[int, int] | None) -> Doubles:
        """The nearest allowed change."""
        inside = np.minimum(np.maximum(self.start + change, self.lower), self.upper)
        if coupled is not None:
            a, b = coupled
            slack = np.maximum(self.start[:, a] - self.start[:, b], 0.0)
            inside[:, a] = np.minimum(inside[:, a], inside[:, b] + slack)
        return inside - self.start

    def cost(self, lengths: Doubles) -> Doubles:
        """How far lengths (..., N, C) are from the targets: (..., N).

        Pairs that have passed each other touch.
        """
        costs: Doubles = ((self.targets - np.maximum(lengths, 0.0)) ** 2 / self.noise).sum(axis=-1)
        return costs
