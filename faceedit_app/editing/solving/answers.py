"""A cache of the networks' answers to the chunks of a take."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.editing.solving.recent import Recent

if TYPE_CHECKING:  # the grid_range is there before the networks
    from faceedit_app.networks.engine import Engine

GridRange = tuple[int, int]  # the first grid frame, and the one after the last

# Answers that are kept for each region: a drag changes one or two chunks, and only in the regions
# whose curves it moves.
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
        self._recent = Recent[Doubles](RECENT * len(self._columns))
        self._recent_tracked = Recent[Doubles](RECENT * len(self._columns))

    def to(
        self, regions: Sequence[str], grid_range: GridRange, curves: Doubles, naturalness: float
    ) -> dict[str, Doubles]:
        """(N, K) weights of each region for edited curves; see `begin`."""
        begun = self.begin(regions, grid_range, curves, naturalness)
        return {region: answer() for region, answer in begun.items()}

    def begin(
        self, regions: Sequence[str], grid_range: GridRange, curves: Doubles, naturalness: float
    ) -> dict[str, Callable[[], Doubles]]:
        """Begin to answer edited curves.

        Args:
            regions: `Region.id`s, in the order in which the answers will be needed.
            grid_range: the first grid frame, and the one after the last.
            curves: (N, C) mm in that range.
            naturalness: see `Engine.answer`.

        Returns:
            By region, what waits for (N, K) weights. Each is called once.
        """
        first = grid_range[0]
        keys = {
            region: (region, first, naturalness, curves[:, self._columns[region]].tobytes())
            for region in regions
        }
        new = [region for region in regions if keys[region] not in self._recent]
        begun = self._engine.begin(new, curves, naturalness)

        def answer(region: str) -> Doubles:
            return self._engine.answer(region, curves, naturalness)

        return {
            region: partial(self.wait, key, begun.get(region, partial(answer, region)))
            for region, key in keys.items()
        }

    def wait(self, key: Hashable, make: Callable[[], Doubles]) -> Doubles:
        """A recent answer, or one that has been begun."""
        return self._recent.to(key, make)

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
        keys = {name: (name, grid_range[0], naturalness) for name in regions}
        return {
            name: self._recent_tracked.to(key, partial(self._tracked[key].astype, np.float64))
            for name, key in keys.items()
        }
