"""How many millimetres a plot shows.

pyqtgraph's automatic range fits all data at each change. This one stays fixed during a drag, and
does not magnify noise.
"""

from __future__ import annotations

from faceedit_app.ui.curves.scale import Interval

LEAST = 2.0  # mm: with less, tracking noise would look like movement
# Of the whole take's height: a quiet passage in view is drawn larger, but still looks quiet.
LEAST_SHARE = 0.2
MARGIN = 0.12  # of the data's height, above and below
SMALLEST, LARGEST = 0.2, 1000.0  # mm: limits for the user's zoom


def fitted(low: float, high: float, least: float = LEAST) -> Interval:
    """The range for values from `low` to `high`, at least `least` mm, with a margin."""
    height = max(high - low, least, LEAST)
    middle = 0.5 * (low + high)
    half = height * (0.5 + MARGIN)
    return middle - half, middle + half


def grown(shown: Interval, low: float, high: float) -> Interval:
    """`shown`, extended to include `low` and `high`; it never shrinks or jumps."""
    room = 0.5 * MARGIN * (shown[1] - shown[0])
    first = shown[0] if low >= shown[0] else low - room
    last = shown[1] if high <= shown[1] else high + room
    return first, last


def stretched(shown: Interval, value: float) -> Interval:
    """`shown`, stretched just enough to include a dragged value with a margin.

    Stretching starts near the edge, and is undone as the value returns, so that a dragged curve
    moves steadily and never jumps.
    """
    margin = 0.5 * MARGIN
    first, last = shown
    last = max(last, (value - margin * first) / (1.0 - margin))
    first = min(first, (value - margin * last) / (1.0 - margin))
    return first, last
