"""The residual of a pose: what it has beyond what its curves say.

Networks and last layer say which weights this face has for its curves. A pose is never quite that;
the rest is its residual: a frown in a smile, squinting eyes. A small change of the curves leaves
it as it is. The farther they move, the less it belongs to the new pose: what was half a smile says
nothing about a closed mouth. It then gives way to the residual of the poses around the edit:

    answer += (1 - kept) * (residual around - residual),    kept = exp(-distance² / 2 L²)

So an edit knows the take at its place. This is simple kriging (Matheron 1963) in two steps: along
the curves, then along time, with a Gaussian and an exponential as correlation.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from functools import lru_cache

import numpy as np

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.resample import GRID_RATE
from faceedit_app.editing.solving.last_layer import LastLayer
from faceedit_app.editing.solving.recent import Recent

# The distance over which a residual is kept, in standard deviations of the take's curves.
LENGTH = 1.0
# Seconds over which residuals resemble each other, and beyond which they are not looked at: the
# networks' context reaches farther on either side of a chunk.
RESEMBLE, FARTHEST = 0.6, 1.2
# Grid frames of no residual at all that are weighed against those around.
NOTHING = 1.0
# Residuals that are kept: those of three regions of a chunk or two.
RECENT = 6


class Residuals:
    """The residuals of one take, of which the last ones are kept."""

    def __init__(self) -> None:
        self._recent = Recent[Doubles](RECENT)
        self._exchanged = Recent[Doubles](RECENT)

    def exchange(
        self,
        key: Hashable | None,
        layer: LastLayer,
        lacking: Callable[[], Doubles],
        curves: Doubles,
        change: Doubles,
    ) -> Doubles:
        """(M, K) what a request adds to the answer to a chunk, on the grid.

        Args:
            key: what `lacking` and `curves` depend on; None if that may change, as fills do.
            layer: the take's own last layer.
            lacking: (M, K) the tracked weights less the networks' answer to their curves.
            curves: (M, C) mm, as tracked.
            change: (M, C) mm, what is asked for.
        """

        def measured() -> Doubles:
            return lacking() - layer(curves)

        def exchanged() -> Doubles:
            share = kept(layer.distance(change))
            if (share == 1.0).all():
                return np.zeros((len(curves), len(layer.constant)))
            residual = measured() if key is None else self._recent.to(key, measured)
            return exchange(residual, share)

        if key is None:
            return exchanged()
        return self._exchanged.to((key, change.tobytes()), exchanged)


def kept(distance: Doubles) -> Doubles:
    """(N,) in 0..1: how far a residual stays as it is at a distance, see `LastLayer.distance`."""
    share: Doubles = np.exp(distance**2 / (-2.0 * LENGTH**2))
    return share


def exchange(residual: Doubles, share: Doubles) -> Doubles:
    """(M, K) what is added to the answer on the grid; 0 where all is kept.

    Args:
        residual: (M, K) of the tracked poses, at 25 fps.
        share: (M,) in 0..1, see `kept`.
    """
    # Poses that are edited themselves say little about what is around them.
    near, trust, rows = _resemblance(len(residual)), share**2, residual.T
    around = (rows * trust) @ near / (near @ trust + NOTHING)
    added: Doubles = (1.0 - share) * (around - rows)
    return added.T


@lru_cache(maxsize=4)
def _resemblance(frames: int) -> Doubles:
    """(M, M) how much the residuals of two grid frames resemble each other."""
    away = np.abs(np.subtract.outer(np.arange(frames), np.arange(frames))) / GRID_RATE
    resemblance: Doubles = np.where(away < FARTHEST, np.exp(-away / RESEMBLE), 0.0)
    return resemblance
