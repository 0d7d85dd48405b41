"""Reach: the smallest believable change of weights that brings controls to what was asked.

The networks answer an edit with a believable face that comes near the request; this closes the
rest of the way. It is a damped Gauss-Newton on the rig's distances in which "small" is measured
against how the channels of the region vary together in real performances: of all weight changes
that reach the request, the one that is most probable under that covariance (the maximum a
posteriori estimate with a Gaussian prior, re-linearised a few times, with bounds as an active
set).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.rig import Distances

Array = NDArray[np.float64]

ITERATIONS = 6
STEPS = (1.0, 0.7, 0.4, 0.2, 0.1, 0.0)
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

    targets: Array
    strength: Array
    asked: NDArray[np.bool_]


def reach(
    distances: Distances,
    weights: Array,
    channels: NDArray[np.intp],
    goal: Goal,
    covariance: Array,
    upper: Array,
    coupled: tuple[int, int] | None = None,
    naturalness: float = 1.0,
) -> Array:
    """Change the weights of one region so that its controls reach the goal.

    Args:
        distances: the region's C controls as a function of all 52 weights.
        weights: (N, 52) present weights; those outside `channels` are kept.
        channels: (K,) columns that may change.
        goal: see `Goal`.
        covariance: (K, K) of the channels in real performances.
        upper: (N, K) largest allowed weights; the smallest is 0.
        coupled: positions (a, b) in `channels` with weight a <= weight b (mouthClose, jawOpen).
        naturalness: 0 lifts the limit on the change's length, 1 keeps `NATURAL_LENGTH`.

    Returns:
        (N, K) the new weights of `channels`.
    """
    start = weights[:, channels]
    floor = np.minimum(start, 0.0)
    trial = weights.astype(np.float32)

    def bounded(change: Array) -> Array:
        """The nearest allowed change."""
        inside = np.clip(start + change, floor, upper)
        if coupled is not None:
            a, b = coupled
            slack = np.maximum(start[:, a] - start[:, b], 0.0)
            inside[:, a] = np.minimum(inside[:, a], inside[:, b] + slack)
        return inside - start

    def measure(change: Array) -> Array:
        trial[:, channels] = start + change
        return distances.measure(trial).astype(np.float64)

    targets = measure(np.zeros_like(start))
    targets += goal.strength * (goal.targets - targets)
    noise = np.where(goal.asked, ASKED_MM, FREE_MM) ** 2

    def cost(change: Array) -> Array:
        costs: Array = np.sum((targets - measure(change)) ** 2 / noise, axis=1)
        return costs

    def search(passed: bool) -> Array:
        change, frozen = np.zeros_like(start), np.zeros(start.shape, bool)
        for iteration in range(ITERATIONS):
            trial[:, channels] = start + change
            lengths, jacobian = distances.jacobian(trial, passed and iteration == 0)
            slopes = jacobian[:, :, channels].astype(np.float64)
            wanted = targets - lengths + np.einsum("nck,nk->nc", slopes, change)
            aim = _step(slopes, wanted, noise, covariance, change, frozen)
            aim *= _shortening(aim, covariance, naturalness)
            allowed = bounded(aim)
            frozen |= np.abs(allowed - aim) > 1e-9
            change = _line_search(change, allowed, cost)
        return change

    change = search(passed=False)
    # Pressed lips can have passed each other: opening them begins with what seems to close them.
    if np.any(goal.asked & (targets - measure(change) > MISSED_MM)):
        other = search(passed=True)
        change = np.where((cost(other) < cost(change))[:, None], other, change)
    # Rounding leaves weights such as -1e-17.
    return np.clip(start + change, floor, np.maximum(start, upper))


def _line_search(old: Array, new: Array, cost: Callable[[Array], Array]) -> Array:
    """Of some steps from `old` towards `new`, each frame's best.

    A full step can carry a pair of vertices through each other, where the distance grows again.
    """
    best = old
    least = np.full(len(old), np.inf)
    for step in STEPS:
        change = old + step * (new - old)
        costs = cost(change)
        better = costs < least
        best = np.where(better[:, None], change, best)
        least = np.where(better, costs, least)
    return best


def _step(
    jacobian: Array,
    wanted: Array,
    noise: Array,
    covariance: Array,
    change: Array,
    frozen: NDArray[np.bool_],
) -> Array:
    """The most probable change with J change = wanted; frozen channels keep theirs."""
    held = np.where(frozen, change, 0.0)
    rest = wanted - np.einsum("nck,nk->nc", jacobian, held)
    free = np.where(frozen[:, None, :], 0.0, jacobian)
    spread = free @ covariance  # (N, C, K)
    system = spread @ free.transpose(0, 2, 1)
    diagonal = np.arange(system.shape[1])
    system[:, diagonal, diagonal] += noise
    solved = np.linalg.solve(system, rest[:, :, None])[:, :, 0]
    moved = np.einsum("nck,nc->nk", spread, solved)
    return np.where(frozen, held, moved)


def _shortening(change: Array, covariance: Array, naturalness: float) -> Array:
    """(N, 1) factor that keeps each frame's change within the natural length."""
    if naturalness <= 0:
        return np.ones((len(change), 1))
    precision = np.linalg.inv(covariance + 1e-6 * np.eye(len(covariance)))
    length = np.sqrt(np.einsum("nk,kl,nl->n", change, precision, change))
    limit = NATURAL_LENGTH / naturalness
    factor: Array = np.minimum(1.0, limit / np.maximum(length, 1e-9))[:, None]
    return factor
