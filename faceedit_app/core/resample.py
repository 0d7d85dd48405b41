"""Resample between a clip's own times and even ones: the networks' grid, or another frame rate."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arrays import Doubles, Times

GRID_RATE = 25.0


def grid_length(times: Times) -> int:
    """The number of grid frames (at 0, 0.04, 0.08 s, ...) that cover a clip's `times` (T,)."""
    return int(np.ceil(times[-1] * GRID_RATE - 1e-6)) + 1


def to_grid(
    times: Times, values: NDArray[Any], start: int, stop: int, rate: float = GRID_RATE
) -> Doubles:
    """Resample a signal to grid frames `start` to `stop` - 1; see `OnGrid`."""
    return OnGrid(times, start, stop, rate)(values)


class OnGrid:
    """Resamples signals at the same times to the same grid frames.

    Each grid value is the mean of the linearly interpolated signal over the grid frame's own time
    (40 ms at 25 fps), so that nothing is lost between grid frames, not even a spike of one frame
    at 60 fps. Before the first and after the last time the signal keeps its end value.

    Args:
        times: (T,) seconds, increasing.
        start, stop: the first grid frame, and the one after the last.
        rate: frames of the grid per second.
    """

    def __init__(self, times: Times, start: int, stop: int, rate: float = GRID_RATE) -> None:
        self._rate, self._count = rate, stop - start
        self._is_still = len(times) == 1
        if self._is_still:
            return
        edges = (np.arange(start, stop + 1) - 0.5) / rate
        self._steps = np.diff(times)
        inside = np.clip(edges, times[0], times[-1])
        i = np.clip(np.searchsorted(times, inside, side="right") - 1, 0, len(times) - 2)
        self._places, self._into = i, inside - times[i]
        self._before = np.minimum(edges - times[0], 0)
        self._after = np.maximum(edges - times[-1], 0)

    def __call__(self, values: NDArray[Any]) -> Doubles:
        """(stop - start, C) float64, of values (T, C); column by column in memory."""
        if self._is_still:
            return np.repeat(values.astype(np.float64), self._count, axis=0)
        i, into, steps, rows = self._places, self._into, self._steps, values.T
        areas = 0.5 * (rows[:, 1:] + rows[:, :-1]) * steps
        integral = np.zeros(rows.shape)
        np.cumsum(areas, axis=1, out=integral[:, 1:])
        # The integral of the linear interpolant, evaluated exactly at the edges.
        before = rows.take(i, axis=1)
        slope = (rows.take(i + 1, axis=1) - before) / steps[i]
        at = integral.take(i, axis=1) + into * (before + 0.5 * slope * into)
        at += self._before * rows[:, :1]
        at += self._after * rows[:, -1:]
        grid: Doubles = np.diff(at, axis=1) * self._rate
        return grid.T


class OffGrid:
    """Interpolates signals on the same grid frames at the same times.

    Cubic (Catmull-Rom): it passes through the grid values, is smooth between them, and local: a
    value has an effect only within two grid frames.

    Args:
        count: N, the number of grid frames.
        start: the first of them.
        times: (T,) seconds.
    """

    def __init__(self, count: int, start: int, times: Times) -> None:
        position = np.clip(times * GRID_RATE - start, 0, count - 1)
        i = np.minimum(position.astype(np.int64), max(count - 2, 0))
        u = position - i
        square, cube = u * u, u * u * u
        taps = (
            -0.5 * u + square - 0.5 * cube,
            1.0 - 2.5 * square + 1.5 * cube,
            0.5 * u + 2.0 * square - 1.5 * cube,
            0.5 * (cube - square),
        )
        self._taps = [
            (tap, np.clip(i + step, 0, count - 1)) for step, tap in enumerate(taps, start=-1)
        ]

    def __call__(self, values: NDArray[np.floating[Any]]) -> Doubles:
        """(T, C) of grid frames (N, C); column by column in memory."""
        rows = values.T
        result: Doubles = np.zeros((len(rows), len(self._taps[0][0])))
        for tap, places in self._taps:
            result += tap * rows.take(places, axis=1)
        return result.T


class Resampling:
    """From frames at the same times to the same grid frames, and back.

    The places of one in the other are found once: with every step of a drag, several signals go
    the same way.

    Args:
        times: (T,) seconds, increasing.
        start, stop: the first grid frame, and the one after the last.
    """

    def __init__(self, times: Times, start: int, stop: int) -> None:
        self._times, self._start, self._stop = times, start, stop

    @cached_property
    def to_grid(self) -> OnGrid:
        """Resamples signals (T, C) to the grid frames."""
        return OnGrid(self._times, self._start, self._stop)

    @cached_property
    def from_grid(self) -> OffGrid:
        """Interpolates signals on the grid frames at the times."""
        return OffGrid(self._stop - self._start, self._start, self._times)


def at_rate(times: Times, values: NDArray[Any], rate: float, own_rate: float) -> Doubles:
    """Resample a signal to another frame rate: values at 0, 1 / rate, 2 / rate, ... seconds.

    A lower rate takes the mean over each frame's own time, see `to_grid`, so that nothing is lost
    between two frames. A higher one, or the same, interpolates without overshoot by a monotone
    cubic (Fritsch and Butland, "A method for constructing local monotone piecewise cubic
    interpolants", 1984).

    Args:
        times: (T,) seconds from 0, increasing.
        values: (T, C).
        rate: frames per second.
        own_rate: nominal frames per second of the signal.

    Returns:
        (N, C) float64, as long as the signal to the nearest frame.
    """
    count = max(round((float(times[-1]) + 1 / own_rate) * rate), 1)
    if rate < 0.999 * own_rate:
        return to_grid(times, values, 0, count, rate)
    return interpolate(times, values, np.minimum(np.arange(count) / rate, times[-1]))


def interpolate(times: Times, values: NDArray[Any], wanted: Times) -> Doubles:
    """A signal at any times, by a monotone cubic: no overshoot, and exact on its own times.

    A value depends on the two frames before and the two after it (Fritsch and Butland, see
    `at_rate`). Before the first and after the last time the signal keeps its end value.

    Args:
        times: (T,) seconds, increasing.
        values: (T, C).
        wanted: (N,) seconds.

    Returns:
        (N, C) float64.
    """
    if len(times) == 1:
        return np.repeat(values.astype(np.float64), len(wanted), axis=0)
    wanted = np.clip(wanted, times[0], times[-1])
    i = np.clip(np.searchsorted(times, wanted, side="right") - 1, 0, len(times) - 2)
    steps = np.diff(times)[:, None]
    slopes = _monotone_slopes(steps, np.diff(values.astype(np.float64), axis=0) / steps)
    u = ((wanted - times[i]) / steps[i, 0])[:, None]
    u[np.abs(u) < 1e-6], u[np.abs(u - 1) < 1e-6] = 0.0, 1.0  # on a frame: exactly its value
    return _hermite(u, values[i], values[i + 1], slopes[i] * steps[i], slopes[i + 1] * steps[i])


def _monotone_slopes(steps: Doubles, rises: Doubles) -> Doubles:
    """(T, C) slopes at T points from the steps (T - 1, 1) and the rises (T - 1, C) between them."""
    slopes = np.zeros((len(rises) + 1, rises.shape[1]))
    before, after = rises[:-1], rises[1:]
    weight = (steps[:-1] + 2 * steps[1:]) / (3 * (steps[:-1] + steps[1:]))
    turns = before * after <= 0
    safe = np.where(turns, 1.0, weight * after + (1 - weight) * before)
    slopes[1:-1] = np.where(turns, 0.0, before * after / safe)
    return slopes


def _hermite(u: Doubles, a: Doubles, b: Doubles, slope_a: Doubles, slope_b: Doubles) -> Doubles:
    """The cubic from `a` at u = 0 to `b` at u = 1 with these slopes."""
    square, cube = u * u, u * u * u
    result: Doubles = (
        (2 * cube - 3 * square + 1) * a
        + (cube - 2 * square + u) * slope_a
        + (3 * square - 2 * cube) * b
        + (cube - square) * slope_b
    )
    return result
