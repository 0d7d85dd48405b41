"""Between a clip's own times and the networks' steady grid of 25 frames per second."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arrays import Doubles, Times

GRID_RATE = 25.0


def grid_length(times: Times) -> int:
    """How many grid frames (at 0, 0.04, 0.08 s, ...) cover a clip's `times` (T,)."""
    return int(np.ceil(times[-1] * GRID_RATE - 1e-6)) + 1


def to_grid(times: Times, values: NDArray[Any], start: int, stop: int) -> Doubles:
    """Bring a signal to grid frames `start..stop-1`.

    Each grid value is the mean of the linearly interpolated signal over the grid frame's own
    40 ms, so that nothing, not even a spike of one frame at 60 fps, falls between two grid
    frames. Before the first and after the last time the signal keeps its end value.

    Args:
        times: (T,) seconds, increasing.
        values: (T, C).

    Returns:
        (stop - start, C) float64.
    """
    if len(times) == 1:
        return np.repeat(values.astype(np.float64), stop - start, axis=0)
    edges = (np.arange(start, stop + 1) - 0.5) / GRID_RATE
    steps = np.diff(times)[:, None]
    areas = 0.5 * (values[1:] + values[:-1]) * steps
    integral = np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(areas, axis=0)])
    # The integral of the linear interpolant, evaluated exactly at the edges.
    inside = np.clip(edges, times[0], times[-1])
    i = np.clip(np.searchsorted(times, inside, side="right") - 1, 0, len(times) - 2)
    into = (inside - times[i])[:, None]
    slope = (values[i + 1] - values[i]) / steps[i]
    at = integral[i] + into * (values[i] + 0.5 * slope * into)
    at += np.minimum(edges - times[0], 0)[:, None] * values[0]
    at += np.maximum(edges - times[-1], 0)[:, None] * values[-1]
    grid: Doubles = np.diff(at, axis=0) * GRID_RATE
    return grid


def from_grid(values: NDArray[np.floating[Any]], start: int, times: Times) -> Doubles:
    """Read grid frames `values` (N, C), the first of which is grid frame `start`, at `times` (T,).

    Cubic (Catmull-Rom): passes through the grid values, smooth between, and local: a value
    shows only within two grid frames of its own.
    """
    position = np.clip(times * GRID_RATE - start, 0, len(values) - 1)
    i = np.minimum(position.astype(np.int64), max(len(values) - 2, 0))
    u = (position - i)[:, None]
    last = len(values) - 1
    before, a, b, after = (values[np.clip(i + k, 0, last)] for k in (-1, 0, 1, 2))
    slope_a, slope_b = 0.5 * (b - before), 0.5 * (after - a)
    square, cube = u * u, u * u * u
    result: Doubles = (
        (2 * cube - 3 * square + 1) * a
        + (cube - 2 * square + u) * slope_a
        + (3 * square - 2 * cube) * b
        + (cube - square) * slope_b
    )
    return result
