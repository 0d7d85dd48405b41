"""A cache of the networks' answers to the chunks of a take."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.arrays import Doubles, Floats

if TYPE_CHECKING:  # the grid_range is there before the networks
    from faceedit_app.networks.engine import Engine

GridRange = tuple[int, int]  # the first grid frame, and the one after the last

# Chunks of each region whose last answer is kept: a drag changes one or two chunks, and only in the
# regions whose curves it moves.
RECENT = 4


class Answers:
    """The networks' answers for one take.

    A cached answer equals a new one, because answers depend on nothing but the curves.

    Args:
        engine: the networks.
        grid: (M, C) mm: the take's controls as tracked, on the networks' grid.
    """

    def __init__(self, engine: Engine, grid: Doubles) -> None:
        self._engine, self._grid = engine, grid
        # The columns of the curves that each region listens to.
        self._columns = {name: model.columns for name, model in engine.models.items()}
        self._tracked: dict[tuple[str, int, float], Floats] = {}
        self._recent: dict[tuple[str, int, float], tuple[Doubles, Doubles]] = {}

    def to(
        self, regions: Sequence[str], grid_range: GridRange, curves: Doubles, naturalness: float
    ) -> dict[str, Doubles]:
        """(N, K) weights of each region for edited curves.

        Args:
            regions: `Region.id`s.
            grid_range: the first grid frame, and the one after the last.
            curves: (N, C) mm in that range.
            naturalness: see `Engine.answer`.
        """
        heard = {region: curves[:, self._columns[region]] for region in regions}
        known = {
            region: self._recent.pop((region, grid_range[0], naturalness), None) for region in heard
        }
        new = [
            region
            for region, entry in known.items()
            if entry is None or not np.array_equal(entry[0], heard[region])
        ]
        answers = self._engine.answers(new, curves, naturalness)
        for region, entry in known.items():
            kept = (heard[region], answers[region]) if region in answers else entry
            assert kept is not None
            self._recent[region, grid_range[0], naturalness] = kept
        while len(self._recent) > RECENT * len(self._columns):
            del self._recent[next(iter(self._recent))]  # the least recently used
        return {region: self._recent[region, grid_range[0], naturalness][1] for region in regions}

    def to_tracked(
        self, regions: Sequence[str], grid_range: GridRange, naturalness: float
    ) -> dict[str, Doubles]:
        """The same for the take as tracked; all answers are kept, for one naturalness."""
        if any(known != naturalness for _, _, known in self._tracked):
            self._tracked.clear()
        curves = self._grid[slice(*grid_range)]
        new = [name for name in regions if (name, grid_range[0], naturalness) not in self._tracked]
        for name, answer in self._engine.answers(new, curves, naturalness).items():
            self._tracked[name, grid_range[0], naturalness] = answer.astype(np.float32)
        return {
            name: self._tracked[name, grid_range[0], naturalness].astype(np.float64)
            for name in regions
        }
