"""The plot of one control: a pyqtgraph plot with the curve's three lines and its marks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import pyqtgraph as pg
from PySide6.QtCore import QEvent, QObject, QPoint, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QContextMenuEvent, QFocusEvent, QKeyEvent, QMouseEvent, QPainter
from PySide6.QtWidgets import QSizePolicy

from faceedit_app.core.controls import Control
from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.axes import GridLines, ValueAxis
from faceedit_app.ui.curves.backdrop import Backdrop
from faceedit_app.ui.curves.gestures import Pointer, Span
from faceedit_app.ui.curves.lines import CurveLines
from faceedit_app.ui.curves.marks import (
    Gaps,
    Numbers,
    Pins,
    Playhead,
    Spans,
    dot,
)
from faceedit_app.ui.curves.scale import Interval, Scale
from faceedit_app.ui.curves.time_view import Mouse, TimeView
from faceedit_app.ui.curves.visible_curves import Lines
from faceedit_app.ui.state.timeline import Timeline

_GAP_ALPHA = 90


class CurveMouse(Protocol):
    """Handles the mouse on all plots; see `time_view.Mouse`."""

    @property
    def is_held(self) -> bool:
        """Whether a gesture is in progress."""

    def press(self, plot: CurvePlot, pointer: Pointer) -> None:
        """The left button went down."""

    def drag_to(self, plot: CurvePlot, pointer: Pointer) -> None:
        """The pointer moved with the button down."""

    def release(self, plot: CurvePlot, pointer: Pointer) -> None:
        """The left button went up."""

    def mouse_lost(self) -> None:
        """The release was lost."""

    def hover(self, plot: CurvePlot, pointer: Pointer) -> None:
        """The pointer moved without a button."""

    def leave(self, plot: CurvePlot) -> None:
        """The pointer left the plot."""

    def turn(self, plot: CurvePlot, pointer: Pointer, notches: float) -> None:
        """The wheel was turned during a gesture."""

    def cancel(self) -> None:
        """Esc, or the right button during a gesture."""


@dataclass(frozen=True)
class Handle:
    """The point that is dragged, or would be, with the numbers beside it."""

    time: float
    value: float
    held: bool = False
    text: tuple[str, ...] = ()


@dataclass(frozen=True)
class Marks:
    """Marks on the time axis, other than the playhead.

    Attributes:
        selection: with its falloffs, if any.
        edit: span of an edit, actual or possible, if it is to be shown.
        alpha: opacity of `edit`, 0..255.
    """

    selection: Span | None = None
    edit: Span | None = None
    alpha: int = style.HOVER


class CurvePlot(pg.GraphicsLayoutWidget, Mouse):
    """The plot of one control: a view box, and a value axis left of it.

    A `PlotItem` would bring three more axes, and 45 widgets of options that nobody sees.

    Signals:
        focus_changed(): the plot gained or lost the focus.
        menu_asked(seconds, place): a right click: its time, and its place on the screen.
        refused(why): a press on a curve that cannot be changed.
    """

    focus_changed = Signal()
    menu_asked = Signal(float, QPoint)
    refused = Signal(str)

    def __init__(self, control: Control, timeline: Timeline, mouse: CurveMouse) -> None:
        self.control, self._mouse, self._timeline = control, mouse, timeline
        super().__init__()
        self.setBackground(style.PLOT)
        self.view, self.axis = TimeView(timeline, self), ValueAxis()
        self.values_chosen = False  # by the user: nothing else then changes them
        self.close_up = False  # whether they fit even the smallest movements
        self.shows_focus = False
        self._marks, self._active = Marks(), False
        self._at = self._drawn_at = (0.0, 0.0)  # the playhead, and the face's value there
        self._lay_out()
        self._fill()
        self.setObjectName(f"plot_{control.id}")
        self.setAccessibleName(f"{control.label} curve")
        self.setAccessibleDescription(control.hint)
        self.setMinimumHeight(style.ROW_HEIGHT)
        self.setAcceptDrops(False)  # dropped files go to the window
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Ignored)
        self.view.setCursor(Qt.CursorShape.SizeVerCursor)
        self.view.values_chosen.connect(self._choose_values)
        self.view.menu_asked.connect(self._ask_menu)

    def _lay_out(self) -> None:
        self.ci.setContentsMargins(0, 0, 0, 0)
        self.ci.setSpacing(0)
        self.ci.setFlag(self.ci.GraphicsItemFlag.ItemHasNoContents)
        self.ci.addItem(self.axis, 0, 0)
        self.ci.addItem(self.view, 0, 1)
        self.axis.linkToView(self.view)
        self.axis.setStyle(tickFont=style.scaled_font(self, 0.82))

    def _fill(self) -> None:
        """Put in what is seen, from the back to the front."""
        color = self.control.color
        self._backdrop = Backdrop(self, self.view)
        self._spans = Spans(self.view, self._backdrop)
        self._gaps, self._lines = Gaps(_GAP_ALPHA), CurveLines(color)
        grid = GridLines(self.axis)
        self._pins, self._playhead = Pins(), Playhead()
        self._dot = dot(2.5, color, color)
        self._handle_dot = dot(5.0, style.PLOT, style.ASKED)
        self._numbers = Numbers(style.scaled_font(self, 0.9))
        self.handle: Handle | None = None
        self._handle_dot.hide()
        for item in (
            self._gaps,
            grid,
            self._pins,
            self._lines,
            self._playhead,
            self._dot,
            self._handle_dot,
            self._numbers,
        ):
            self.view.addItem(item, ignoreBounds=True)
        for item in (self._gaps, grid):
            item.move_behind(self._backdrop)

    # --- contents --------------------------------------------------------------------------

    @property
    def current_scale(self) -> Scale:
        """How the pixels of its view map to seconds and millimetres."""
        return self.view.scale_now

    @property
    def values(self) -> Interval:
        """Lowest and highest visible millimetre."""
        low, high = self.view.viewRange()[1]
        return low, high

    def show_values(self, values: Interval) -> None:
        """Make a range of millimetres visible."""
        if values != self.values:
            self.view.setYRange(*values, padding=0)

    def show_missing(self, why: str) -> None:
        """Disable and dim the curve, or enable it if `why` is empty."""
        self.setEnabled(not why)
        self.setToolTip(why)
        for item in (self._lines, self._dot):
            item.setOpacity(style.DIMMED if why else 1.0)
        if why:
            self.viewport().installEventFilter(self)
        else:
            self.viewport().removeEventFilter(self)

    @property
    def lines(self) -> Lines:
        """The curve's three lines."""
        return self._lines.lines

    def show_lines(self, lines: Lines) -> None:
        """Set the lines to draw."""
        self._lines.show_lines(lines)

    def show_gaps(self, gaps: Sequence[Interval]) -> None:
        """Mark the gaps."""
        self._gaps.show_gaps(gaps)

    def show_pins(self, times: tuple[float, ...]) -> None:
        """Mark the pins of the chosen retime, seconds."""
        self._pins.show_pins(times)

    @property
    def columns(self) -> int:
        """Width in screen dots."""
        dots: int = round(self.view.width() * self.devicePixelRatioF())
        return dots

    def show_marks(self, marks: Marks, playhead: float, handle: Handle | None, dot: float) -> None:
        """Draw spans, playhead (seconds) and handle; `dot` is the face's value at the playhead."""
        if marks != self._marks:
            self._marks = marks
            self._spans.show(marks.selection, marks.edit, marks.alpha)
        self._at = playhead, dot
        drawn, height = self._drawn_at
        if playhead != drawn:
            self._playhead.setValue(playhead)
        if playhead != drawn or abs(dot - height) > self._lines.unseen:
            self._show_dot()
        if handle != self.handle:
            self._show_handle(handle)

    def _show_dot(self) -> None:
        self._drawn_at = self._at
        self._dot.setPos(*self._at)

    def _show_handle(self, handle: Handle | None) -> None:
        self.handle = handle
        self._handle_dot.setVisible(handle is not None)
        if handle is not None:
            color = self.control.color
            self._handle_dot.setBrush(style.color(color if handle.held else style.PLOT))
            at = QPointF(handle.time, handle.value)
            self._handle_dot.setPos(at)
            self._numbers.show_beside(at, self.current_scale, handle.text)
        else:
            self._numbers.hide()
        self._show_active()

    def _show_active(self) -> None:
        active = self.shows_focus or self.handle is not None
        if active != self._active:
            self._active = active
            self.setBackground(style.PLOT_ACTIVE if active else style.PLOT)

    def _choose_values(self) -> None:
        self.values_chosen = True
        self._show_dot()  # closer up, a place that could not be told from its own perhaps can be

    def drawBackground(self, painter: QPainter, rect: QRectF) -> None:
        """Draw what lies behind the curves; Qt keeps it as a picture."""
        super().drawBackground(painter, rect)
        self._backdrop.paint(painter)

    # --- events ----------------------------------------------------------------------------

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Say why a press does nothing; a disabled widget gets no events itself."""
        if event.type() == QEvent.Type.MouseButtonPress and not self.isEnabled():
            self.refused.emit(self.toolTip())
        return bool(super().eventFilter(watched, event))

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Continue the gesture on the curve, else let pyqtgraph handle it."""
        if not self.view.drag_on(event):
            super().mouseMoveEvent(event)

    @property
    def takes_wheel(self) -> bool:
        """During a gesture, the wheel sets the falloff."""
        return self._mouse.is_held

    def pressed(self, pointer: Pointer) -> None:
        """The left button went down."""
        self._mouse.press(self, pointer)

    def dragged(self, pointer: Pointer) -> None:
        """The pointer moved with the button down."""
        self._mouse.drag_to(self, pointer)

    def released(self, pointer: Pointer) -> None:
        """The left button went up."""
        self._mouse.release(self, pointer)

    def mouse_lost(self) -> None:
        """The release of the left button was lost."""
        self._mouse.mouse_lost()

    def hovered(self, pointer: Pointer) -> None:
        """The pointer moved without a button."""
        self._mouse.hover(self, pointer)

    def left(self) -> None:
        """The pointer left the plot."""
        self._mouse.leave(self)

    def turned(self, pointer: Pointer, notches: float) -> None:
        """The wheel was turned during a gesture."""
        self._mouse.turn(self, pointer, notches)

    def cancel(self) -> None:
        """The right button went down during a gesture."""
        self._mouse.cancel()

    def _ask_menu(self, x: float, _y: float, place: QPoint) -> None:
        self.menu_asked.emit(self.current_scale.time_at(x), place)

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Ask for the menu at the playhead, for the menu key; the view handles right clicks."""
        event.accept()
        if event.reason() == QContextMenuEvent.Reason.Keyboard:
            seconds = self._timeline.time
            x = self.view.mapToScene(QPointF(self.current_scale.x_of(seconds), 0.0)).x()
            place = self.viewport().mapToGlobal(QPoint(round(x), self.height() // 2))
            self.menu_asked.emit(seconds, place)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Esc cancels the drag in progress; all other keys go to the window."""
        if event.key() == Qt.Key.Key_Escape:
            self._mouse.cancel()
        event.ignore()

    def focusInEvent(self, event: QFocusEvent) -> None:
        """Show the focus if it came by keyboard; after a click it is obvious."""
        reason = Qt.FocusReason
        keyboard = reason.TabFocusReason, reason.BacktabFocusReason, reason.ShortcutFocusReason
        self._show_focus(event.reason() in keyboard)
        event.accept()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Hide the focus."""
        self._show_focus(False)
        event.accept()

    def _show_focus(self, shown: bool) -> None:
        self.shows_focus = shown
        self.view.setBorder(style.FOCUS if shown else None)
        self._show_active()
        self.focus_changed.emit()

    def sizeHint(self) -> QSize:
        """A preferred size; the plots share the actual room."""
        return QSize(400, 3 * style.ROW_HEIGHT)
