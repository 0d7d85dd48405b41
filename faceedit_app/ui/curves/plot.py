"""One curve's plot: draws its three lines and marks, and passes the mouse on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QFocusEvent,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QWidget

from faceedit_app.core.regions import Control
from faceedit_app.ui.curves import paint, style
from faceedit_app.ui.curves.axes import Scale, Span, value_ticks
from faceedit_app.ui.curves.backdrop import Backdrop
from faceedit_app.ui.curves.line import WideLine
from faceedit_app.ui.curves.polyline import EMPTY
from faceedit_app.ui.curves.sight import Lines

_LINE = 5  # pixels at most from the middle of a line, the playhead or its dot to their edges


class Mouse(Protocol):
    """Who is told what the mouse does on a plot. Positions are pixels of the plot."""

    def press(self, plot: CurvePlot, event: QMouseEvent) -> None:
        """A button went down."""

    def move(self, plot: CurvePlot, event: QMouseEvent) -> None:
        """The pointer moved, with or without a button."""

    def release(self, plot: CurvePlot, event: QMouseEvent) -> None:
        """A button went up."""

    def wheel(self, plot: CurvePlot, event: QWheelEvent) -> None:
        """The wheel turned."""

    def leave(self, plot: CurvePlot) -> None:
        """The pointer went elsewhere."""

    def cancel(self) -> None:
        """Esc."""


@dataclass(frozen=True)
class Handle:
    """The point that would be or is dragged, and the numbers beside it."""

    time: float
    value: float
    held: bool = False
    text: tuple[str, ...] = ()


class CurvePlot(QWidget):
    """The plot of one control: its lines, with marks behind and before them.

    Signals:
        scale_changed(): its size, visible time or value axis changed.
        focus_changed(): the keyboard's focus came or went.
    """

    scale_changed = Signal()
    focus_changed = Signal()

    def __init__(self, control: Control, mouse: Mouse) -> None:
        super().__init__()
        self.control, self._mouse = control, mouse
        self.view: Span = (0.0, 1.0)
        self.span: Span = (0.0, 1.0)
        self.span_chosen = False  # by the user: nothing else then changes it
        self.close_up = False  # whether its span fits even the smallest movements
        self.shows_focus = False
        self.lines: Lines | None = None
        self._marks, self._playhead = paint.Marks(), 0.0
        self._handle: Handle | None = None
        self._dot: float | None = None
        self._tracked = WideLine(style.tracked_pen())
        self._face = WideLine(style.face_pen(control.region))
        self._asked = WideLine(style.asked_pen())
        self._bands, self._backdrop = Backdrop(self), Backdrop(self)
        self.setObjectName(f"plot_{control.id}")
        self.setAccessibleName(f"{control.label} curve")
        self.setAccessibleDescription(control.hint)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setCursor(Qt.CursorShape.SizeVerCursor)
        self.setMinimumHeight(style.ROW_HEIGHT)
        self.setMouseTracking(True)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)

    # --- what it shows ---------------------------------------------------------------------

    @property
    def current_scale(self) -> Scale:
        """How its pixels map to seconds and millimetres."""
        return Scale(self.width(), self.height(), self.view, self.span)

    def show_view(self, view: Span) -> None:
        """Make a range of seconds visible."""
        self.view = view
        self._apply_scale()

    def show_span(self, span: Span) -> None:
        """Make a range of millimetres visible."""
        if span != self.span:
            self.span = span
            self._apply_scale()

    def show_lines(self, lines: Lines | None) -> None:
        """Draw these curves."""
        self.lines = lines
        shown = (EMPTY,) * 3 if lines is None else (lines.tracked, lines.face, lines.asked)
        curves = self._tracked, self._face, self._asked
        changed = [curve.show_line(line) for curve, line in zip(curves, shown, strict=True)]
        spans = [span for span in changed if span is not None]
        if spans:
            self._update_between(min(span[0] for span in spans), max(span[1] for span in spans))

    def _update_between(self, first: float, last: float) -> None:
        """Paint what lies between two seconds anew."""
        scale, height = self.current_scale, self.height()
        left = max(round(scale.x_of(first)) - _LINE, 0)
        right = min(round(scale.x_of(last)) + _LINE, self.width())
        if left < right:
            self.update(left, 0, right - left, height)

    @property
    def columns(self) -> int:
        """Of the screen's pixels, across."""
        return round(self.width() * self.devicePixelRatioF())

    def show_marks(
        self, marks: paint.Marks, playhead: float, handle: Handle | None, dot: float | None
    ) -> None:
        """Draw bands, playhead (seconds) and handle; `dot` is the face's value at the playhead."""
        others = (marks, handle) != (self._marks, self._handle)
        moved = (playhead, dot) != (self._playhead, self._dot)
        before, self._marks, self._handle = self._playhead, marks, handle
        self._playhead, self._dot = playhead, dot
        if others:
            self.update()
        elif moved:  # all that changes in playback
            self._update_between(before, before)
            self._update_between(playhead, playhead)

    def _apply_scale(self) -> None:
        self.update()
        self.scale_changed.emit()

    # --- painting --------------------------------------------------------------------------

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint backdrop, lines and marks."""
        scale = self.current_scale
        # Bands stay as they are where a drag takes the value axis along; grid and take do not.
        still = self._marks, self.view, self._is_active
        with QPainter(self) as painter:

            def draw_backdrop(inside: QPainter, _rect: QRectF) -> None:
                self._bands.paint(inside, still, self._draw_bands)
                self._draw_grid(inside)
                inside.setTransform(scale.transform)
                self._tracked.paint(inside)

            looks = still, self.span, self.lines and self.lines.tracked
            self._backdrop.paint(painter, looks, draw_backdrop)
            painter.setTransform(scale.transform)
            for curve in (self._face, self._asked):
                curve.paint(painter)
            painter.resetTransform()
            self._draw_marks(painter, scale)

    @property
    def _is_active(self) -> bool:
        return self.shows_focus or self._handle is not None

    def _draw_bands(self, painter: QPainter, rect: QRectF) -> None:
        scale = self.current_scale
        painter.fillRect(rect, style.color(style.PLOT_ACTIVE if self._is_active else style.PLOT))
        if self._marks.selection is not None:
            paint.draw_selection(painter, scale, self._marks.selection)
        if self._marks.brush is not None:
            paint.draw_brush(painter, scale, self._marks.brush, self._marks.alpha)
        paint.draw_gaps(painter, scale, self._marks.gaps, alpha=90)

    def _draw_grid(self, painter: QPainter) -> None:
        scale = self.current_scale
        painter.setPen(style.hairline(style.GRID))
        for tick in value_ticks(scale.span, scale.height, style.VALUE_SPACING):
            y = round(scale.y_of(tick.at))
            painter.drawLine(QPointF(0, y), QPointF(scale.width, y))

    def _draw_marks(self, painter: QPainter, scale: Scale) -> None:
        color = style.REGION_COLORS[self.control.region]
        if self.lines is None:
            return
        if self.shows_focus:
            painter.setPen(style.hairline(style.FOCUS))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(QRectF(0, 0, scale.width - 1, scale.height - 1))
        paint.draw_playhead(painter, scale, self._playhead)
        if self._dot is not None:
            at = QPointF(scale.x_of(self._playhead), scale.y_of(self._dot))
            paint.draw_dot(painter, at, 2.5, color, color)
        if (handle := self._handle) is not None:
            at = QPointF(scale.x_of(handle.time), scale.y_of(handle.value))
            paint.draw_dot(painter, at, 5.0, color if handle.held else style.PLOT, style.ASKED)
            if handle.text:
                font = style.scaled_font(self, 0.9)
                paint.draw_tag(painter, scale, at, handle.text, font)

    # --- events: translated, nothing else --------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """A button went down."""
        self._mouse.press(self, event)
        event.accept()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """The second press of two is a press like any other."""
        self.mousePressEvent(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """The pointer moved."""
        self._mouse.move(self, event)
        event.accept()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """A button went up."""
        self._mouse.release(self, event)
        event.accept()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """The wheel turned."""
        self._mouse.wheel(self, event)
        event.accept()

    def leaveEvent(self, event: QEvent) -> None:
        """The pointer went elsewhere."""
        self._mouse.leave(self)
        event.accept()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Esc drops the drag in progress; all other keys are the window's."""
        if event.key() == Qt.Key.Key_Escape:
            self._mouse.cancel()
        event.ignore()

    def focusInEvent(self, event: QFocusEvent) -> None:
        """Who came by keyboard sees where; a click's place needs no mark."""
        reason = Qt.FocusReason
        keyboard = reason.TabFocusReason, reason.BacktabFocusReason, reason.ShortcutFocusReason
        self.shows_focus = event.reason() in keyboard
        self.focus_changed.emit()
        self.update()
        event.accept()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """The keyboard went elsewhere."""
        self.shows_focus = False
        self.focus_changed.emit()
        self.update()
        event.accept()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Another size needs other ticks and other points."""
        super().resizeEvent(event)
        self.scale_changed.emit()

    def sizeHint(self) -> QSize:
        """Room for a curve; plots then share what there is."""
        return QSize(400, 2 * style.ROW_HEIGHT)
