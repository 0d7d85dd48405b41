"""Lowest and highest values of long curves, so that a picture of hours costs what one of seconds
does."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float32]
# Takes a slice of frames; returns the (N, C) values there.
Source = Callable[[slice], Values]

BASE = 16  # frames in the smallest bin
STEP = 4  # bins in one of the next level
_BLOCK = 1 << 14  # frames that are read at a time


class Envelope:
    """Bins over (T, C) values, at several sizes; a change costs what it touches.

    Args:
        source: what the values are.
        frames: T.
        curves: C.
    """

    def __init__(self, source: Source, frames: int, curves: int) -> None:
        self._source, self._frames = source, frames
        self._levels: list[tuple[Values, Values]] = []
        bins = -(-frames // BASE)
        while True:
            low, high = np.empty((2, bins, curves), np.float32)
            self._levels.append((low, high))
            if bins <= STEP:
                break
            bins = -(-bins // STEP)
        self.update(0, frames)

    def update(self, first: int, last: int) -> None:
        """Read the values of some frames again."""
        if first >= last:
            return
        start = first - first % BASE
        while start < last:
            stop = min(start + _BLOCK, -(-last // BASE) * BASE, self._frames)
            values = self._source(slice(start, stop))
            bins = slice(start // BASE, -(-stop // BASE))
            self._put(0, bins, lowest(values, BASE), highest(values, BASE))
            start = stop
        first, last = first // BASE, -(-last // BASE)
        for level in range(1, len(self._levels)):
            low, high = self._levels[level - 1]
            first, last = first // STEP, -(-last // STEP)
            below = slice(first * STEP, min(last * STEP, len(low)))
            bins = slice(first, last)
            self._put(level, bins, lowest(low[below], STEP), highest(high[below], STEP))

    def _put(self, level: int, bins: slice, low: Values, high: Values) -> None:
        self._levels[level][0][bins], self._levels[level][1][bins] = low, high

    @staticmethod
    def bin_size(wanted: int) -> int:
        """The largest size of bins that can be had, up to the one that is wanted.

        Args:
            wanted: frames, `BASE` or more.
        """
        step = BASE
        while step * STEP <= wanted:
            step *= STEP
        return wanted - wanted % step

    def bins(self, first: int, last: int, size: int) -> tuple[Values, Values]:
        """Lowest and highest values (N, C) of bins.

        Args:
            first, last: the first bin, and the one after the last.
            size: frames in each, as `bin_size` says.
        """
        level, step = 0, BASE
        while step * STEP <= size and level + 1 < len(self._levels):
            level, step = level + 1, step * STEP
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
