"""The axes of the curves panel: millimetres, times and frames."""

from __future__ import annotations

import math
from typing import Any

import pyqtgraph as pg
from PySide6.QtCore import QLineF, QRectF
from PySide6.QtGui import QPainter
from PySide6.QtWidgets import QStyleOptionGraphicsItem, QWidget

from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.scale import Interval
from faceedit_app.ui.curves.ticks import (
    frame_spacing,
    frame_ticks,
    nice_step,
    time_label,
    time_steps,
)
from faceedit_app.ui.curves.view_item import ViewItem
from faceedit_app.ui.look.guard import guarded
from faceedit_app.ui.state.time_display import TimeDisplay, Unit, label
from faceedit_app.ui.state.timed_rows import TimedRows

TickLevels = list[tuple[float, list[float]]]  # spacing and values of each level of ticks

_HALF_NUMBER = 6.0  # pixels: a value nearer to an edge has no room for its number
_FINER = 0.3  # of a step: less than half, so that the next finer round number is found
_FRAME_SPACING = 34.0  # pixels between two frame numbers
_FRAME_CLOSEST = 9.0  # least pixels between two marked frames
_TICK_CLOSEST = 5.0
_TICK, _FRAME_TICK = 9, 4  # pixels
_TIME_OFFSET = 9  # pixels between the ticks of the times and their numbers
_APART = 4.0  # pixels between two numbers: without, two timecodes read as one
_FROM_END = 12.0  # the same to one that was moved in from an end of the axis
_INSET = 4.0  # pixels between an end and its number, over which the playhead would lie
_BEYOND = 10_000  # pixels beyond the ends, where pyqtgraph omits a number


class ValueAxis(pg.AxisItem):
    """Millimetres left of a plot: only numbers, none of them cut off."""

    def __init__(self) -> None:
        super().__init__("left", textPen=style.MUTED)
        self.setPen(None)  # no line along it
        self.setCacheMode(self.CacheMode.DeviceCoordinateCache)
        self.enableAutoSIPrefix(False)
        self.setWidth(style.AXIS_WIDTH)
        self.setStyle(
            tickLength=0,
            tickTextOffset=6,
            maxTickLevel=0,
            maxTextLevel=0,
            hideOverlappingLabels=True,
        )

    def boundingRect(self) -> QRectF:
        """The axis itself, since all numbers are inside."""
        rect: QRectF = self.rect()
        return rect

    def generateDrawSpecs(self, painter: QPainter) -> Any:
        """The numbers alone: ticks without length would leave dots."""
        specs = super().generateDrawSpecs(painter)
        return None if specs is None else (specs[0], [], specs[2])

    def tickValues(self, low: float, high: float, size: float) -> TickLevels:
        """Round numbers, wide enough apart; a single level, without pyqtgraph's search for more.

        A low plot may have room for none of them; then it has a finer one near its middle.
        """
        step = nice_step((high - low) * style.VALUE_SPACING / size)
        values = _multiples(step, low, high)
        cut = (high - low) * _HALF_NUMBER / size
        if not any(low + cut <= value <= high - cut for value in values):
            step = nice_step(_FINER * step)
            inside = _multiples(step, low + cut, high - cut)
            middle = 0.5 * (low + high)
            values = sorted(inside, key=lambda value: abs(value - middle))[:1] or values
        return [(step, values)]


def _multiples(step: float, low: float, high: float) -> list[float]:
    """All multiples of a step from `low` to `high`."""
    return [step * n for n in range(math.ceil(low / step), math.floor(high / step) + 1)]


class GridLines(ViewItem):
    """A thin line across the plot at each number of an axis.

    The axis could draw them itself, but would measure and paint all of them for every change of
    a curve: 30 ms for eight plots.
    """

    def __init__(self, axis: ValueAxis) -> None:
        self._axis = axis
        self._lines: list[QLineF] | None = None
        super().__init__()

    def forget(self) -> None:
        """Redraw: the numbers have moved."""
        self._lines = None
        super().forget()

    @guarded
    def paint(
        self, painter: QPainter, _option: QStyleOptionGraphicsItem, widget: QWidget | None = None
    ) -> None:
        """Draw them."""
        if self._lines is None:
            rect = self.boundingRect()
            low, high = rect.top(), rect.bottom()
            levels = self._axis.tickValues(low, high, self._axis.height())
            ends = rect.left(), rect.right()
            self._lines = [QLineF(ends[0], y, ends[1], y) for _, at in levels for y in at]
        painter.setPen(style.hairline(style.GRID))
        painter.drawLines(self._lines)


class _InsideAxis(pg.AxisItem):
    """A time axis inside the view; keeps the first and last number inside, too.

    Args:
        color: of the numbers.
        tick: pixels of the ticks.
        offset: pixels from the ends of the ticks to the numbers above them.
    """

    def __init__(self, color: str, tick: int, offset: int) -> None:
        super().__init__("top", textPen=color, tickPen=style.TICK)
        self.setPen(None)
        self.rows: TimedRows | None = None
        self.enableAutoSIPrefix(False)
        self.setStyle(
            tickLength=tick,
            tickTextOffset=offset,
            maxTextLevel=0,
            tickAlpha=255,
            autoExpandTextSpace=False,
            hideOverlappingLabels=_BEYOND,
        )

    def show_rows(self, rows: TimedRows | None) -> None:
        """Number the frames of a take."""
        self.rows = rows
        self.renew()

    def renew(self) -> None:
        """Recompute the numbers."""
        self.picture = None
        self.update()

    def generateDrawSpecs(self, painter: QPainter) -> Any:
        """pyqtgraph's specifications, with all numbers inside and none overlapping."""
        specs = super().generateDrawSpecs(painter)
        if specs is None:
            return None
        axis, ticks, texts = specs
        kept: list[tuple[QRectF, Any, str]] = []
        was_moved = False  # the last one that is kept
        for rect, flags, text in texts:
            left = min(max(rect.left(), _INSET), self.width() - rect.width() - _INSET)
            is_moved = left != rect.left()
            rect.moveLeft(left)
            apart = _FROM_END if is_moved or was_moved else _APART
            if kept and left <= kept[-1][0].right() + apart:
                if is_moved or not was_moved:
                    continue
                kept.pop()  # rather the one that is not at its place
            kept.append((rect, flags, text))
            was_moved = is_moved
        return axis, ticks, kept

    def _at(self, frames: list[int]) -> list[float]:
        """The times of frames, in seconds."""
        assert self.rows is not None
        return [float(self.rows.clip.times[frame]) for frame in frames]


class TimeAxis(_InsideAxis):
    """Times in the chosen unit."""

    def __init__(self, display: TimeDisplay) -> None:
        super().__init__(style.LABEL, _TICK, _TIME_OFFSET)
        self._display = display

    def show_ticks(self, shown: bool) -> None:
        """Show or hide the ticks; the numbers stay in place."""
        length = _TICK if shown else 0
        if self.style["tickLength"] != length:
            self.setStyle(tickLength=length, tickTextOffset=_TIME_OFFSET + _TICK - length)

    def tickSpacing(self, first: float, last: float, size: float) -> list[tuple[float, float]]:
        """Seconds between numbers, and between ticks."""
        timecode = self._display.unit is Unit.TIMECODE
        room = style.TIMECODE_SPACING if timecode else style.TIME_SPACING
        step, fine = time_steps((last - first) * room / size)
        return [(step, 0.0), (fine, 0.0)]

    def tickValues(self, first: float, last: float, size: float) -> TickLevels:
        """Round times, or the times of frames with round numbers; none before the take."""
        if self._display.unit is not Unit.FRAMES or self.rows is None:
            levels: TickLevels = super().tickValues(first, last, size)
            return [(step, [at for at in times if at > -0.5 * step]) for step, times in levels]
        view, closest = (first, last), _TICK_CLOSEST
        numbered, marked = frame_ticks(
            self.rows.clip.times, view, size, style.TIME_SPACING, closest
        )
        return [(1.0, self._at(numbered)), (0.5, self._at(marked))]

    def tickStrings(self, values: list[float], scale: float, spacing: float) -> list[str]:
        """The labels of times."""
        unit = self._display.unit
        if unit is Unit.SECONDS or self.rows is None:
            return [time_label(seconds, spacing) for seconds in values]
        return [label(self.rows, seconds, unit) for seconds in values]


class FrameAxis(_InsideAxis):
    """Frame numbers under the times, if the frames are far enough apart."""

    def __init__(self) -> None:
        super().__init__(style.MUTED, _FRAME_TICK, 1)

    def has_room(self, view: Interval, width: float) -> bool:
        """Whether frames are far enough apart."""
        if self.rows is None:
            return False
        return frame_spacing(self.rows.clip.times, view, width) >= _FRAME_CLOSEST

    def tickValues(self, first: float, last: float, size: float) -> TickLevels:
        """The times of frames, with a number and without."""
        if self.rows is None:
            return []
        view, closest = (first, last), _FRAME_CLOSEST
        numbered, marked = frame_ticks(self.rows.clip.times, view, size, _FRAME_SPACING, closest)
        return [(1.0, self._at(numbered)), (0.5, self._at(marked))]

    def tickStrings(self, values: list[float], scale: float, spacing: float) -> list[str]:
        """The frame numbers."""
        assert self.rows is not None
        return [label(self.rows, seconds, Unit.FRAMES) for seconds in values]
