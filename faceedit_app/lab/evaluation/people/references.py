"""Simple ways to answer an edit, without networks, that an editor has to beat.

Each turns the change of the asked-for curves into a change of a region's weights, frame by frame:
`ridge` by regression, `covariance` by one Gaussian step, `bump` on one channel. The first two
learn from takes of other sources.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Bools, Doubles, Floats, Indices
from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX, CONTROLS
from faceedit_app.core.regions import REGIONS, Region
from faceedit_app.core.rig import Distances, Rig
from faceedit_app.lab.training.data import Performance

NAMES = ("ridge", "covariance", "bump")
MOST_FRAMES = 20_000
RIDGE = 0.002  # of the number of frames, times the variance of a standardised curve
FARTHEST = 3.0  # standard deviations; a quadratic runs away beyond what it has seen
SPREAD_FLOOR = 0.3  # mm; a curve that hardly moves is not blown up
NOISE_MM = 0.1  # standard deviation with which a curve is trusted in the Gaussian step
_MOVED = 1e-4  # mm


@dataclass(frozen=True)
class Ridge:
    """A quadratic ridge regression of one frame: curves (T, C) mm -> weights (T, K)."""

    mean: Doubles
    spread: Doubles
    coefficients: Doubles

    @classmethod
    def fit(cls, curves: Doubles, weights: Doubles, seen: Bools) -> Ridge:
        """Fit to frames.

        Args:
            curves: (N, C) mm.
            weights: (N, K).
            seen: (N, K) bool; weights that a source does not capture are not learned from.
        """
        mean, spread = curves.mean(axis=0), curves.std(axis=0) + SPREAD_FLOOR
        features = _features((curves - mean) / spread)
        out = np.zeros((features.shape[1], weights.shape[1]))
        patterns, which = np.unique(seen.T, axis=0, return_inverse=True)
        for number, rows in enumerate(patterns):
            if not rows.any():
                continue
            columns = which.ravel() == number
            mine = features[rows]
            penalty = RIDGE * len(mine) * np.eye(mine.shape[1])
            penalty[0, 0] = 1e-9
            out[:, columns] = np.linalg.solve(
                mine.T @ mine + penalty, mine.T @ weights[rows][:, columns]
            )
        return cls(mean, spread, out)

    def __call__(self, curves: Doubles) -> Doubles:
        """(T, C) mm -> (T, K)."""
        near = np.clip((curves - self.mean) / self.spread, -FARTHEST, FARTHEST)
        answer: Doubles = _features(near) @ self.coefficients
        return answer


def _features(curves: Doubles) -> Doubles:
    i, j = np.triu_indices(curves.shape[1])
    return np.concatenate([np.ones((len(curves), 1)), curves, curves[:, i] * curves[:, j]], axis=1)


class References:
    """The references, with what they learned.

    Args:
        pool: takes of other sources than the one that is measured.
        rig: the character that the curves are measured on.
    """

    def __init__(self, pool: Sequence[Performance], rig: Rig) -> None:
        self._distances = rig.arkit_distances
        weights = np.concatenate([take.weights for take in pool])
        seen = np.concatenate([np.broadcast_to(take.captured, take.weights.shape) for take in pool])
        step = -(-len(weights) // MOST_FRAMES)
        self._weights, self._seen = weights[::step].astype(np.float64), seen[::step]
        self._curves = self._distances.measure(weights[::step]).astype(np.float64)
        self._ridge = lru_cache(maxsize=None)(self._fit_ridge)
        self._covariance = lru_cache(maxsize=None)(self._fit_covariance)

    def answer(
        self,
        name: str,
        weights: Floats,
        before: Floats,
        asked: Floats,
        edited: Collection[str] = CONTROL_IDS,
    ) -> Floats:
        """Answer a change of curves.

        Args:
            name: one of `NAMES`.
            weights: (T, 52) in ARKit order, before the change.
            before, asked: (T, C) mm, the curves before and as asked for, companions included.
            edited: ids of the curves that the user changed; a bump heeds no companion.

        Returns:
            (T, 52); frames and regions whose curves do not change stay as they are.
        """
        out = weights.copy()
        change = asked.astype(np.float64) - before
        for region in REGIONS:
            moved = [
                CONTROL_INDEX[c]
                for c in region.own
                if np.abs(change[:, CONTROL_INDEX[c]]).max(initial=0.0) > _MOVED
            ]
            if not moved:
                continue
            rows = np.flatnonzero(np.abs(change[:, moved]).max(axis=1) > _MOVED)
            columns = columns_of(region)
            now = weights[rows[:, None], columns].astype(np.float64)
            if name == "bump":
                moved = [control for control in moved if CONTROL_IDS[control] in edited]
            change_by = (weights[rows], before[rows], asked[rows])
            added = self._added(name, region, tuple(moved), *change_by)
            # What the tracker wrote beyond 0..1 may stay; an answer does not add to it.
            low, high = np.minimum(now, 0.0), np.maximum(now, 1.0)
            out[rows[:, None], columns] = np.clip(now + added, low, high)
        return out

    def _added(
        self,
        name: str,
        region: Region,
        moved: tuple[int, ...],
        weights: Floats,
        before: Floats,
        asked: Floats,
    ) -> Doubles:
        """(T, K): what is added to the region's weights."""
        columns = columns_of(region)
        if name == "ridge":
            ridge = self._ridge(region.id, moved)
            return ridge(asked[:, moved].astype(np.float64)) - ridge(
                before[:, moved].astype(np.float64)
            )
        change = (asked - before)[:, moved].astype(np.float64)
        if name == "covariance":
            slopes = self._distances.jacobian(weights)[1][:, moved][:, :, columns]
            slopes = slopes.astype(np.float64)
            likely = self._covariance(region.id)
            across = slopes @ likely  # (T, C, K)
            joint = across @ slopes.transpose(0, 2, 1) + NOISE_MM**2 * np.eye(len(moved))
            solved = np.linalg.solve(joint, change[:, :, None])
            step: Doubles = np.einsum("tck,tc->tk", across, solved[:, :, 0])
            return step
        return _bump(self._distances, moved, columns, change)

    def _fit_ridge(self, region: str, controls: tuple[int, ...]) -> Ridge:
        columns = columns_of(_region(region))
        rows = self._seen[:, columns].any(axis=1)
        return Ridge.fit(
            self._curves[rows][:, controls],
            self._weights[rows][:, columns],
            self._seen[rows][:, columns],
        )

    def _fit_covariance(self, region: str) -> Doubles:
        columns = columns_of(_region(region))
        rows = self._seen[:, columns].any(axis=1)
        joint: Doubles = np.cov(self._weights[rows][:, columns].T)
        return joint


def captures_all_regions(pool: Sequence[Performance]) -> bool:
    """Whether references can learn every region from these takes."""
    return all(any(take.captured[columns_of(r)].any() for take in pool) for r in REGIONS)


def columns_of(region: Region) -> list[int]:
    """A region's channels in ARKit order."""
    return [ARKIT_INDEX[c] for c in region.channels]


def _region(name: str) -> Region:
    return next(region for region in REGIONS if region.id == name)


def _bump(
    distances: Distances, moved: Sequence[int], columns: Sequence[int], change: Doubles
) -> Doubles:
    """The first curve that moves, and its mirror image: each on the channel that moves it most."""
    first = CONTROLS[moved[0]]
    out = np.zeros((len(change), len(columns)))
    slopes = distances.jacobian(np.zeros((1, len(ARKIT_INDEX)), np.float32))[1][0]
    mine: Indices = np.asarray(columns)
    for name in dict.fromkeys((first.id, first.mirror or first.id)):
        control = CONTROL_IDS.index(name)
        if control in moved:
            best = int(np.abs(slopes[control, mine]).argmax())
            out[:, best] += change[:, list(moved).index(control)] / slopes[control, mine[best]]
    return out
