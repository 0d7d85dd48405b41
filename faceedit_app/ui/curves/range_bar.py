"""The bar under the ruler that shows the selection, with a handle on each edge."""

from __future__ import annotations

import pyqtgraph as pg
from PySide6.QtCore import QPoint, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QPainter, QPen, QPolygonF
from PySide6.QtWidgets import QStyleOptionGraphicsItem, QWidget

from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.edges import Edge, edge_times, part_at
from faceedit_app.ui.curves.gestures import Pointer, RulerDrag, Span, clamped, stepped_falloff
from faceedit_app.ui.curves.marks import SpanRegion
from faceedit_app.ui.curves.scale import Interval, Scale
from faceedit_app.ui.curves.selection_mouse import SelectionMouse
from faceedit_app.ui.curves.time_view import Mouse, TimeView
from faceedit_app.ui.look.guard import guarded
from faceedit_app.ui.state.timeline import Timeline

HEIGHT = 17
_TIP = (
    "Drag to select a time range; drag its middle to move it, or a handle to change it.\n"
    "The outer handles set the falloffs, over which an edit fades in and out; so does the wheel.\n"
    "Shift: fine. Ctrl: snap to frames. Esc: cancel. Double-click: clear the selection."
)
_HINT = "Drag here to select a time range"
_HANDLE = 7.0  # greatest pixels from an edge to the side of its handle
_HOLD = (Edge.START, Edge.END)


class SelectionHandles(SpanRegion):
    """The selection as a shape whose height is the edit's strength, with four handles."""

    def __init__(self) -> None:
        super().__init__(style.SELECTION)
        self._lit: Edge | None = None

    def light(self, edge: Edge | None) -> None:
        """Highlight the edge that is held, or would be."""
        if edge is not self._lit:
            self._lit = edge
            self.update()

    def boundingRect(self) -> QRectF:
        """The shape, with room for the handles."""
        rect: QRectF = super().boundingRect()
        room = _HANDLE * self.getViewBox().viewPixelSize()[0]
        return rect.adjusted(-room, 0.0, room, 0.0)

    @guarded
    def paint(
        self, painter: QPainter, _option: QStyleOptionGraphicsItem, widget: QWidget | None = None
    ) -> None:
        """Draw shape and handles."""
        place = painter.transform()
        painter.resetTransform()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, True)
        at = {edge: place.map(QPointF(t, 0.0)).x() for edge, t in edge_times(self.span).items()}
        low, high = HEIGHT - 2.0, 3.0
        corners = [
            QPointF(at[Edge.FADE_IN], low),
            QPointF(at[Edge.START], high),
            QPointF(at[Edge.END], high),
            QPointF(at[Edge.FADE_OUT], low),
        ]
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(style.color(style.SELECTION, 130 if self._lit is Edge.BODY else 90))
        painter.drawPolygon(QPolygonF(corners))
        for edge in (Edge.FADE_IN, Edge.FADE_OUT, *_HOLD):
            is_hold = edge in _HOLD
            lit = edge is self._lit or (is_hold and self._lit is Edge.BODY)
            _paint_handle(painter, at[edge], is_hold, lit)


def _paint_handle(painter: QPainter, x: float, is_hold: bool, lit: bool) -> None:
    """Draw a handle: a bar for the hold, a diamond at the foot for a falloff."""
    painter.setPen(QPen(style.color(style.BACKGROUND), 1.0))
    painter.setBrush(style.color(style.TEXT if lit else style.SELECTION))
    if is_hold:
        painter.drawRoundedRect(QRectF(x - 3, 1.5, 6, HEIGHT - 3), 2, 2)
        return
    middle, size = HEIGHT - 6.0, 5.5 if lit else 4.5
    around = [(-size, 0.0), (0.0, -size), (size, 0.0), (0.0, size)]
    painter.drawPolygon(QPolygonF([QPointF(x + dx, middle + dy) for dx, dy in around]))


class RangeBar(pg.GraphicsView, Mouse):
    """Selects a range by dragging, and shows its hold and falloffs as a shape.

    Signals:
        menu_asked(place): a right click, and its place on the screen.
    """

    menu_asked = Signal(QPoint)

    def __init__(self, timeline: Timeline, edges: SelectionMouse) -> None:
        super().__init__(background=style.PLOT)
        self._timeline, self._edges = timeline, edges
        self._selecting: RulerDrag | None = None
        self._before: Interval | None = None  # selection before the drag
        self._hovered: Edge | None = None
        self.view = TimeView(timeline, self, has_values=False)
        self.setCentralItem(self.view)
        self._handles = SelectionHandles()
        self.view.addItem(self._handles, ignoreBounds=True)
        self._hint = pg.TextItem(_HINT, style.MUTED, anchor=(0.5, 0.5))
        self._hint.setFont(style.scaled_font(self, 0.82))
        self._hint.setParentItem(self.view)
        self.view.sigResized.connect(lambda: self._hint.setPos(self.view.rect().center()))
        self.view.menu_asked.connect(self._ask_menu)
        self.setFixedHeight(HEIGHT)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setAcceptDrops(False)
        self.setObjectName("range_bar")
        self.setAccessibleName("Time selection")
        self.setAccessibleDescription(_TIP)
        self.setToolTip(_TIP)
        timeline.selection_changed.connect(self._show)
        timeline.falloff_changed.connect(self._show)
        edges.taken.connect(self._show)
        edges.ended.connect(self._show)
        self._show()

    @property
    def current_scale(self) -> Scale:
        """How its pixels map to seconds."""
        return self.view.scale_now

    def _ask_menu(self, x: float, _y: float, place: QPoint) -> None:
        """Make the menu act where it was asked for: “here” is the playhead."""
        self._timeline.go_to_time(self.current_scale.time_at(x))
        self.menu_asked.emit(place)

    @property
    def is_selecting(self) -> bool:
        """Whether a selection is being dragged out."""
        return self._selecting is not None

    def _show(self) -> None:
        span: Span | None = self._edges.span
        self._hint.setVisible(span is None)
        self._handles.show_span(span, style.SELECTED)
        self._handles.light(self._edges.held or self._hovered)

    # --- mouse -----------------------------------------------------------------------------

    @property
    def takes_wheel(self) -> bool:
        """The wheel sets the falloffs."""
        return True

    def _part_at(self, x: float) -> Edge | None:
        span = self._edges.span
        return part_at(x, self.current_scale, span) if span is not None else None

    def pressed(self, pointer: Pointer) -> None:
        """Grab an edge, or begin a new selection if there is none."""
        seconds = self.current_scale.time_at(pointer.x)
        part = self._part_at(pointer.x)
        if part is not None:
            self._edges.grab(part, seconds)
        else:
            self._before = self._timeline.selection
            self._selecting = RulerDrag(self._timeline.snap_edge(seconds), selecting=True)

    def dragged(self, pointer: Pointer) -> None:
        """Continue the gesture."""
        scale = self.current_scale
        if self._selecting is not None:
            seconds = scale.time_at(clamped(pointer.x, (0.0, scale.width)))
            self._timeline.select(self._selecting.selection(self._timeline.snap_edge(seconds)))
        elif self._edges.is_dragging:
            self._edges.move(scale, pointer)

    def released(self, _pointer: Pointer) -> None:
        """End the gesture."""
        self.mouse_lost()

    def mouse_lost(self) -> None:
        """End the gesture and keep its result; a click outside clears the selection."""
        if self._selecting is not None:
            selection = self._timeline.selection
            if selection is not None and selection[0] == selection[1]:
                self._timeline.select(None)
        self._selecting = None
        self._edges.release()

    def double_clicked(self, _pointer: Pointer) -> None:
        """Clear the selection."""
        self._timeline.select(None)

    def hovered(self, pointer: Pointer) -> None:
        """Show what a press would grab."""
        self._hovered = self._part_at(pointer.x)
        self.view.setCursor(
            Qt.CursorShape.IBeamCursor
            if self._hovered is None
            else Qt.CursorShape.OpenHandCursor
            if self._hovered is Edge.BODY
            else Qt.CursorShape.SizeHorCursor
        )
        self._show()

    def left(self) -> None:
        """Remove the highlight."""
        self._hovered = None
        self._show()

    def turned(self, _pointer: Pointer, notches: float) -> None:
        """Change both falloffs."""
        line, span = self._timeline, self._edges.span
        fade_in, fade_out = (stepped_falloff(f, notches) for f in (line.falloff, line.falloff_out))
        if span is not None:
            self._edges.place(Span(span.start, span.end, fade_in, fade_out))
        else:
            line.set_falloffs(fade_in, fade_out)

    def cancel(self) -> None:
        """Cancel the drag in progress."""
        if self._selecting is not None:
            self._selecting = None
            self._timeline.select(self._before)
        self._edges.cancel()
