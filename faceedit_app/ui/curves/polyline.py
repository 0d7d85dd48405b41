"""From a curve of any length to the few points that a screen can show."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from faceedit_app.ui.curves.axes import Span

Values = NDArray[np.floating]
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


@dataclass(frozen=True, eq=False)
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

    def changed_from(self, before: Polyline) -> Span | None:
        """First and last second between which they are drawn otherwise; None where nowhere."""
        if self is before:
            return None
        if self.x is before.x:
            rows = np.flatnonzero(self.y != before.y)
            if not len(rows):
                return None
            first, last = max(rows[0] - 1, 0), min(rows[-1] + 1, len(self.x) - 1)
            return float(self.x[first]), float(self.x[last])
        # With where a line begins all of its dashes move.
        ends = [float(x[i]) for x in (self.x, before.x) for i in (0, -1) if len(x)]
        return (min(ends), max(ends)) if ends else None


EMPTY = Polyline(np.empty(0), np.empty(0))


def run_of(x: Values, y: Values, shown: Mask, thinned: bool) -> Polyline:
    """The points (N,) of a curve that are shown, those next to each other joined."""
    if shown.all():
        return Polyline(x, y, None, thinned)
    if not shown.any():
        return EMPTY
    joined = np.append(shown[1:], False)[shown]
    every = bool(joined[:-1].all())
    return Polyline(x[shown], y[shown], None if every else joined, thinned)
