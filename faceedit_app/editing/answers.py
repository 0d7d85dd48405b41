"""The networks' answers to a take's chunks, with those kept that will be asked for again."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:  # the window is there before the networks
    from faceedit_app.networks.engine import Engine

Array = NDArray[np.float64]

# Chunks of each region whose last answer is kept: a drag touches one or two, and of those only
# the region whose curves it moves has to answer anew.
RECENT = 4


class Answers:
    """What the networks say to one take.

    An answer that is kept is the one that would be given: it depends on nothing but the curves.

    Args:
        engine: the networks.
        grid: (M, 8) mm: the take's controls as tracked, on the networks' grid.
    """

    def __init__(self, engine: Engine, grid: Array) -> None:
        self._engine, self._grid = engine, grid
        self._columns = {
            name: engine.columns(name) for name in engine.models
        }  # of the curves that a region listens to
        self._tracked: dict[tuple[str, int, float], NDArray[np.float32]] = {}
        self._recent: dict[tuple[str, int, float], tuple[Array, Array]] = {}

    def to(self, region: str, window: tuple[int, int], curves: Array, naturalness: float) -> Array:
        """(N, K) weights for edited curves.

        Args:
            region: `Region.id`.
            window: first grid frame, and the one after the last.
            curves: (N, 8) mm in the window.
            naturalness: see `Engine.answer`.
        """
        key, heard = (region, window[0], naturalness), curves[:, self._columns[region]]
        known = self._recent.pop(key, None)
        if known is None or not np.array_equal(known[0], heard):
            known = heard, self._engine.answer(region, curves[None], naturalness)[0]
        self._recent[key] = known
        if len(self._recent) > RECENT * len(self._columns):
            del self._recent[next(iter(self._recent))]  # the one not asked for for longest
        return known[1]

    def to_tracked(self, region: str, window: tuple[int, int], naturalness: float) -> Array:
        """The same for the take as tracked; all of them are kept, for one naturalness."""
        key = region, window[0], naturalness
        if key not in self._tracked:
            if any(known != naturalness for _, _, known in self._tracked):
                self._tracked.clear()
            curves = self._grid[None, slice(*window)]
            answer = self._engine.answer(region, curves, naturalness)[0]
            self._tracked[key] = answer.astype(np.float32)
        return self._tracked[key].astype(np.float64)
