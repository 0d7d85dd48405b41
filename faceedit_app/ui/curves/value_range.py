"""How many millimetres a plot shows.

pyqtgraph's own automatic range fits all data at each change. Ours must stand still under a hand,
and must not magnify what is only noise.
"""

from __future__ import annotations

from faceedit_app.ui.curves.scale import Interval

LEAST = 2.0  # mm: below this, tracking noise would look like acting
# Of the whole take's height: a quiet passage in view is drawn larger, but still looks quiet.
LEAST_SHARE = 0.2
MARGIN = 0.12  # of the data's height, above and below
SMALLEST, LARGEST = 0.2, 1000.0  # mm that the user may zoom to


def fitted(low: float, high: float, least: float = LEAST) -> Interval:
    """The range for values from `low` to `high`: a margin, and at least `least` mm of values."""
    height = max(high - low, least, LEAST)
    middle = 0.5 * (low + high)
    half = height * (0.5 + MARGIN)
    return middle - half, middle + half


def grown(shown: Interval, low: float, high: float) -> Interval:
    """`shown`, extended to hold values from `low` to `high`; it never shrinks, nor jumps."""
    room = 0.5 * MARGIN * (shown[1] - shown[0])
    first = shown[0] if low >= shown[0] else low - room
    last = shown[1] if high <= shown[1] else high + room
    return first, last


def stretched(shown: Interval, value: float) -> Interval:
    """`shown`, stretched as far as holds a dragged value with a margin, and no further.

    It starts where the value comes near the edge, and gives back all as the value comes back: a
    curve moves steadily under the hand, and never jumps.
    """
    margin = 0.5 * MARGIN
    first, last = shown
    last = max(last, (value - margin * first) / (1.0 - margin))
    first = min(first, (value - margin * last) / (1.0 - margin))
    return first, last
