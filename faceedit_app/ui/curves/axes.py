"""Scales and ticks: pixels to seconds and millimetres and back, and where the numbers stand."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PySide6.QtGui import QTransform

Span = tuple[float, float]
Values = NDArray[np.floating]

SMALLEST_SPAN = 2.0  # mm: below this, tracking noise would look like acting
# Of the whole take's height: a quiet passage in view is drawn larger, but still looks quiet.
LEAST_SHARE = 0.2
MARGIN = 0.12  # of the data's height, above and below
_TIME_STEPS = (
    *(0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 30.0),
    *(60.0, 120.0, 300.0, 600.0, 1800.0, 3600.0),
)
_FRAME_STEPS = (1, 2, 5, 10, 20, 50)


@dataclass(frozen=True)
class Scale:
    """How a plot's pixels map to seconds and millimetres; y points down on the screen.

    Attributes:
        width, height: pixels.
        view: first and last visible second.
        span: lowest and highest visible millimetre.
    """

    width: float
    height: float
    view: Span
    span: Span

    @property
    def seconds_per_pixel(self) -> float:
        """Seconds that one pixel to the right stands for."""
        return (self.view[1] - self.view[0]) / max(self.width, 1.0)

    @property
    def mm_per_pixel(self) -> float:
        """Millimetres that one pixel up stands for."""
        return (self.span[1] - self.span[0]) / max(self.height, 1.0)

    @property
    def transform(self) -> QTransform:
        """From seconds and millimetres to pixels."""
        x, y = 1.0 / self.seconds_per_pixel, 1.0 / self.mm_per_pixel
        return QTransform(x, 0.0, 0.0, -y, -x * self.view[0], y * self.span[1])

    def time_at(self, x: float) -> float:
        """Seconds at a pixel."""
        return self.view[0] + x * self.seconds_per_pixel

    def x_of(self, seconds: float) -> float:
        """Pixel of a time."""
        return (seconds - self.view[0]) / self.seconds_per_pixel

    def value_at(self, y: float) -> float:
        """Millimetres at a pixel."""
        return self.span[1] - y * self.mm_per_pixel

    def y_of(self, value: float) -> float:
        """Pixel of a value."""
        return (self.span[1] - value) / self.mm_per_pixel


@dataclass(frozen=True)
class Tick:
    """A mark on an axis: where, and what is written there ("" for a mark alone)."""

    at: float
    label: str


def fitted_span(low: float, high: float, least: float = SMALLEST_SPAN) -> Span:
    """The value axis for data from `low` to `high`: a margin, and at least `least` mm of data."""
    wide = max(high - low, least, SMALLEST_SPAN)
    middle = 0.5 * (low + high)
    half = wide * (0.5 + MARGIN)
    return middle - half, middle + half


def grown_span(span: Span, low: float, high: float) -> Span:
    """`span`, extended to show data from `low` to `high`; it never shrinks, so it never jumps."""
    room = 0.5 * MARGIN * (span[1] - span[0])
    first = span[0] if low >= span[0] else low - room
    last = span[1] if high <= span[1] else high + room
    return first, last


def held_span(span: Span, value: float) -> Span:
    """`span`, stretched as far as shows a dragged value with a margin, and no further.

    It starts where the value comes near the edge, and gives back all as the value comes back: a
    curve moves steadily under the hand, and never jumps.
    """
    margin = 0.5 * MARGIN
    first, last = span
    last = max(last, (value - margin * first) / (1.0 - margin))
    first = min(first, (value - margin * last) / (1.0 - margin))
    return first, last


def zoomed_span(span: Span, factor: float, around: float) -> Span:
    """Scale a value axis; `around` stays where it is. Between 0.2 mm and 1 m are visible."""
    width = span[1] - span[0]
    factor = min(max(factor, 0.2 / width), 1000.0 / width)
    return around - (around - span[0]) * factor, around + (span[1] - around) * factor


def nice_step(smallest: float) -> float:
    """The least of 1, 2, 5, 10, 20, ... (and 0.5, 0.2, ...) that is not below `smallest`."""
    power = 10.0 ** math.floor(math.log10(smallest))
    return next(m * power for m in (1.0, 2.0, 5.0, 10.0) if m * power >= smallest * (1 - 1e-9))


def value_ticks(span: Span, height: float, spacing: float) -> list[Tick]:
    """Round millimetres that stand at least `spacing` pixels apart, all with equal decimals."""
    if height < spacing:
        return []
    step = nice_step((span[1] - span[0]) * spacing / height)
    decimals = max(0, -math.floor(math.log10(step) + 1e-9))
    first, last = math.ceil(span[0] / step), math.floor(span[1] / step)
    # + 0.0 turns -0.0 into 0.0
    return [Tick(n * step + 0.0, f"{n * step + 0.0:.{decimals}f}") for n in range(first, last + 1)]


def time_ticks(view: Span, width: float, spacing: float) -> tuple[list[Tick], list[float]]:
    """Labelled times at least `spacing` pixels apart, and unlabelled ones between them."""
    smallest = (view[1] - view[0]) * spacing / max(width, 1.0)
    step = next((s for s in _TIME_STEPS if s >= smallest), _TIME_STEPS[-1])
    first, last = math.ceil(view[0] / step - 1e-9), math.floor(view[1] / step + 1e-9)
    labelled = [Tick(n * step, time_label(n * step, step)) for n in range(first, last + 1)]
    fine = step / (5 if round(step / 10 ** math.floor(math.log10(step))) in (1, 5) else 4)
    first, last = math.ceil(view[0] / fine - 1e-9), math.floor(view[1] / fine + 1e-9)
    between = [n * fine for n in range(first, last + 1)]
    return labelled, between


def time_label(seconds: float, step: float) -> str:
    """`2 s`, `2.50 s`, `1:05`: as many decimals as the step between labels needs."""
    decimals = 0 if step >= 1 else (1 if step >= 0.1 else 2)
    if seconds < 60 - 1e-9:
        return f"{seconds:.{decimals}f} s"
    minutes, rest = divmod(round(seconds, decimals), 60)
    width = 2 if decimals == 0 else 3 + decimals
    hours, minutes = divmod(int(minutes), 60)
    tail = f"{rest:0{width}.{decimals}f}"
    return f"{hours}:{minutes:02d}:{tail}" if hours else f"{minutes}:{tail}"


def frame_ticks(
    times: Values, view: Span, width: float, spacing: float, closest: float
) -> list[Tick]:
    """At deep zoom, a mark at each visible frame and its number where there is room.

    Args:
        times: (T,) seconds of the frames.
        view: first and last visible second.
        width: pixels.
        spacing: least pixels between two numbers.
        closest: least pixels between two frames for their marks to be drawn at all.
    """
    start, stop = (int(i) for i in np.searchsorted(times, view))
    if stop - start < 2:
        return [Tick(float(times[i]), str(i + 1)) for i in range(start, stop)]
    pixels = float(times[stop - 1] - times[start]) / (stop - 1 - start)
    pixels *= width / (view[1] - view[0])
    if pixels < closest:
        return []
    step = next((s for s in _FRAME_STEPS if s * pixels >= spacing), _FRAME_STEPS[-1])
    # People count frames from 1.
    return [
        Tick(float(times[i]), str(i + 1) if (i + 1) % step == 0 or step == 1 else "")
        for i in range(start, stop)
    ]
