"""From a curve of any length to the few points that a screen can show."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.floating]
Indices = NDArray[np.intp]
Mask = NDArray[np.bool_]

# Below this many samples per pixel column all are drawn: thinning would cost more than it saves.
DENSE = 3


def visible_rows(times: Values, first: float, last: float) -> slice:
    """The frames from `first` to `last` seconds and one beyond each edge, so lines run off."""
    start = int(np.searchsorted(times, first)) - 1
    stop = int(np.searchsorted(times, last, side="right")) + 1
    return slice(max(start, 0), min(stop, len(times)))


def bin_size(rows: slice, columns: int) -> int:
    """Samples that share a pixel column; 1 where all of them are drawn."""
    count = rows.stop - rows.start
    return 1 if count <= DENSE * max(columns, 1) else -(-count // max(columns, 1))


def peaks(values: Values, rows: slice, size: int) -> Indices:
    """Indices of each bin's lowest and highest sample, in order of time.

    Bins start at multiples of `size` in the take, not at the edge of the view: peaks then do not
    flicker while the view is panned.
    """
    if size <= 1:
        return np.arange(rows.start, rows.stop)
    start = rows.start - rows.start % size
    whole = (rows.stop - start) // size
    bins = values[start : start + whole * size].reshape(whole, size)
    offsets = start + size * np.arange(whole)
    pair = np.stack([bins.argmin(axis=1), bins.argmax(axis=1)], axis=1)
    pair.sort(axis=1)
    found: Indices = (offsets[:, None] + pair).ravel()
    rest = np.arange(start + whole * size, rows.stop)
    if len(rest):
        tail = values[rest]
        ends = sorted((int(tail.argmin()), int(tail.argmax())))
        found = np.concatenate([found, rest[ends]])
    return found


@dataclass(frozen=True)
class Polyline:
    """Points to draw.

    Attributes:
        x, y: (N,) seconds and values.
        joined: (N,) whether a line goes from this point to the next; None if all are joined.
        thinned: whether each pixel column shows its extremes only.
    """

    x: Values
    y: Values
    joined: Mask | None = None
    thinned: bool = False

    def looks_like(self, other: Polyline) -> bool:
        """Whether both are drawn alike."""
        if self.thinned is not other.thinned or (self.joined is None) is not (other.joined is None):
            return False
        same = np.array_equal(self.y, other.y) and np.array_equal(self.x, other.x)
        if self.joined is None or other.joined is None:
            return same
        return same and np.array_equal(self.joined, other.joined)


EMPTY = Polyline(np.empty(0), np.empty(0))


def visible_polyline(
    times: Values,
    values: Values,
    first: float,
    last: float,
    columns: int,
    shown: Mask | None = None,
) -> Polyline:
    """The points to draw of a curve: every sample, or each pixel column's extremes.

    Args:
        times, values: (T,) seconds, increasing, and what is drawn.
        first, last: seconds that are visible.
        columns: pixels across.
        shown: (T,) which frames to draw; None draws all of them. A frame next to a shown one is
            drawn too, so that runs join what lies beside them.
    """
    rows = visible_rows(times, first, last)
    size = bin_size(rows, columns)
    if shown is not None and not shown[rows].any():
        return Polyline(times[:0], values[:0])
    index = peaks(values, rows, size)
    if shown is None:
        return Polyline(times[index], values[index], None, size > 1)
    keep = _near(shown, index, size)
    index = index[keep]
    joined = np.append(keep[1:], False)[keep]
    every = bool(joined[:-1].all())
    return Polyline(times[index], values[index], None if every else joined, size > 1)


def _near(shown: Mask, index: Indices, reach: int) -> Mask:
    """For each of `index`: is a frame shown within `reach` frames?"""
    low, high = int(index[0]) - reach, int(index[-1]) + reach + 1
    low, high = max(low, 0), min(high, len(shown))
    counts = np.concatenate([[0], np.cumsum(shown[low:high])])
    after = np.minimum(index + reach + 1, high) - low
    before = np.maximum(index - reach, low) - low
    near: Mask = counts[after] > counts[before]
    return near
