"""Lowest and highest values of long signals, so that hours are drawn as fast as seconds."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

Values = NDArray[Any]
# Takes a slice of rows; returns the (N, C) values there.
ReadSlice = Callable[[slice], Values]

STEP = 4  # bins that make one bin of the next level
_BLOCK = 1 << 14  # rows that are read at a time


class Extremes:
    """A pyramid of minima and maxima over (T, C) values; an update reads only what has changed.

    The first level holds bins of `base` rows, the next bins of `base * STEP` rows, and so on.

    Args:
        source: reads the values.
        length: T.
        columns: C.
        dtype: of the values.
        base: rows in the smallest bin.
    """

    def __init__(
        self,
        source: ReadSlice,
        length: int,
        columns: int,
        dtype: DTypeLike = np.float32,
        base: int = 16,
    ) -> None:
        self._source, self._length, self.base = source, length, base
        self._levels: list[tuple[Values, Values]] = []
        bins = -(-length // base)
        while True:
            low, high = np.empty((2, bins, columns), dtype)
            self._levels.append((low, high))
            if bins <= STEP:
                break
            bins = -(-bins // STEP)
        self.update(0, length)

    def update(self, first: int, last: int) -> None:
        """Read rows `first` to `last` - 1 again."""
        if first >= last:
            return
        base, start = self.base, first - first % self.base
        block = -(-_BLOCK // base) * base
        while start < last:
            stop = min(start + block, -(-last // base) * base, self._length)
            values = self._source(slice(start, stop))
            bins = slice(start // base, -(-stop // base))
            self._put(0, bins, lowest(values, base), highest(values, base))
            start = stop
        first, last = first // base, -(-last // base)
        for level in range(1, len(self._levels)):
            low, high = self._levels[level - 1]
            first, last = first // STEP, -(-last // STEP)
            below = slice(first * STEP, min(last * STEP, len(low)))
            self._put(
                level, slice(first, last), lowest(low[below], STEP), highest(high[below], STEP)
            )

    def _put(self, level: int, bins: slice, low: Values, high: Values) -> None:
        self._levels[level][0][bins], self._levels[level][1][bins] = low, high

    def bin_size(self, wanted: int) -> int:
        """The largest bin size that `bins` supports, up to `wanted`.

        Args:
            wanted: rows; `base` or more.
        """
        step = self._level_for(wanted)[1]
        return wanted - wanted % step

    def _level_for(self, size: int) -> tuple[int, int]:
        """The coarsest level whose bins are not larger than `size` rows, and their size."""
        level, step = 0, self.base
        while step * STEP <= size and level + 1 < len(self._levels):
            level, step = level + 1, step * STEP
        return level, step

    def bins(self, first: int, last: int, size: int) -> tuple[Values, Values]:
        """The lowest and the highest values of bins, (N, C) each.

        Args:
            first, last: the first bin, and the one after the last bin.
            size: rows in each bin, as returned by `bin_size`.
        """
        level, step = self._level_for(size)
        together = size // step
        low, high = self._levels[level]
        part = slice(first * together, min(last * together, len(low)))
        return lowest(low[part], together), highest(high[part], together)


def lowest(values: Values, size: int) -> Values:
    """(N, C) -> (N / size, C), rounded up: the lowest of each group of rows."""
    return _grouped(np.minimum, values, size)


def highest(values: Values, size: int) -> Values:
    """(N, C) -> (N / size, C), rounded up: the highest of each group of rows."""
    return _grouped(np.maximum, values, size)


def _grouped(ufunc: np.ufunc, values: Values, size: int) -> Values:
    """The last group may be short."""
    whole = len(values) // size
    grouped: Values = ufunc.reduce(
        values[: whole * size].reshape(whole, size, values.shape[1]), axis=1
    )
    if whole * size < len(values):
        rest = ufunc.reduce(values[whole * size :], axis=0)
        grouped = np.concatenate([grouped, rest[None]])
    return grouped
