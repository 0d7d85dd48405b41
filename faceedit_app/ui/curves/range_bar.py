"""The bar under the ruler that holds the time selection, with a handle on each of its edges."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QPointF, QRectF, Qt
from PySide6.QtGui import (
    QContextMenuEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPen,
    QPolygonF,
    QWheelEvent,
)
from PySide6.QtWidgets import QWidget

from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.axes import Scale, Span
from faceedit_app.ui.curves.band import BandMouse
from faceedit_app.ui.curves.edges import Edge
from faceedit_app.ui.curves.gestures import Brush, RulerDrag, stepped_falloff
from faceedit_app.ui.state.timeline import Timeline

HEIGHT = 17
_TIP = (
    "Drag here to select a range of time; drag its middle to move it, a handle to change it.\n"
    "The outer handles are the falloffs: how softly an edit fades in and out (also: wheel).\n"
    "Shift: fine. Ctrl: snap to frames. Esc: as it was. Double click: select nothing."
)
_HINT = "drag here to select time"


class RangeBar(QWidget):
    """Selects a range by dragging, and shows its hold and falloffs as a shape."""

    def __init__(self, timeline: Timeline, band: BandMouse, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._timeline, self._band = timeline, band
        self._selecting: RulerDrag | None = None
        self._before: Span | None = None  # what was selected until then
        self._hovered: Edge | None = None
        self.setFixedHeight(HEIGHT)
        self.setMouseTracking(True)
        self.setObjectName("range_bar")
        self.setAccessibleName("Time selection")
        self.setAccessibleDescription(_TIP)
        self.setToolTip(_TIP)
        timeline.selection_changed.connect(self.update)
        timeline.falloff_changed.connect(self.update)
        timeline.view_changed.connect(self.update)
        band.taken.connect(self.update)
        band.ended.connect(self.update)

    @property
    def scale(self) -> Scale:
        """How its pixels map to seconds."""
        return Scale(self.width(), self.height(), self._timeline.view, (0.0, 1.0))

    @property
    def is_selecting(self) -> bool:
        """Whether a selection is being dragged out."""
        return self._selecting is not None

    # --- mouse -----------------------------------------------------------------------------

    def _part_at(self, x: float) -> Edge | None:
        edge = self._band.edge_under(self.scale, x)
        band = self._band.band
        if edge is None and band is not None and band.start < self.scale.time_at(x) < band.end:
            return Edge.BODY
        return edge

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Grab what is there, else begin a new selection."""
        if event.button() != Qt.MouseButton.LeftButton:
            self.cancel()
            return
        seconds = self.scale.time_at(event.position().x())
        part = self._part_at(event.position().x())
        if part is not None:
            self._band.grab(part, seconds)
        else:
            self._before = self._timeline.selection
            self._selecting = RulerDrag(self._timeline.snap(seconds), selecting=True)
        self.update()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Go on with it, or show what a press would grab."""
        if not event.buttons():
            self.let_go()
        x = min(max(event.position().x(), 0.0), float(self.width()))
        if self._selecting is not None:
            seconds = self._timeline.snap(self.scale.time_at(x))
            self._timeline.select(self._selecting.selection(seconds))
        elif self._band.is_dragging:
            self._band.move(self.scale, event)
        else:
            self._hovered = self._part_at(x)
            self.setCursor(
                Qt.CursorShape.IBeamCursor
                if self._hovered is None
                else Qt.CursorShape.OpenHandCursor
                if self._hovered is Edge.BODY
                else Qt.CursorShape.SizeHorCursor
            )
        self.update()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """The end of it."""
        self.let_go()

    def let_go(self) -> None:
        """Keep what was dragged; a click on nothing selects nothing."""
        if self._selecting is not None:
            selection = self._timeline.selection
            if selection is not None and selection[0] == selection[1]:
                self._timeline.select(None)
        self._selecting = None
        self._band.release()
        self.update()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Select nothing."""
        if event.button() == Qt.MouseButton.LeftButton:
            self._timeline.select(None)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """The falloffs."""
        notches = (event.angleDelta().y() or event.angleDelta().x()) / 120.0
        line = self._timeline
        fades = (stepped_falloff(f, notches) for f in (line.falloff, line.falloff_out))
        line.set_falloffs(*fades)
        event.accept()

    def leaveEvent(self, event: QEvent) -> None:
        """Nothing is about to be grabbed."""
        self._hovered = None
        self.update()

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """The right button drops a drag."""
        event.accept()

    def cancel(self) -> None:
        """Drop the drag in progress."""
        if self._selecting is not None:
            self._selecting = None
            self._timeline.select(self._before)
        self._band.cancel()
        self.update()

    # --- painting --------------------------------------------------------------------------

    def paintEvent(self, _event: QPaintEvent) -> None:
        """The shape of the selection, and its handles."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, True)
        painter.fillRect(self.rect(), style.color(style.PLOT))
        band, scale = self._band.band, self.scale
        if band is None:
            painter.setFont(style.scaled_font(self, 0.82))
            painter.setPen(style.color(style.FAINT))
            painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter, _HINT)
            return
        self._paint_shape(painter, scale, band)
        held = self._band.held or self._hovered
        first, last = band.reach
        for edge, seconds, tall in (
            (Edge.FADE_IN, first, False),
            (Edge.FADE_OUT, last, False),
            (Edge.START, band.start, True),
            (Edge.END, band.end, True),
        ):
            self._paint_handle(painter, scale.x_of(seconds), tall, edge is held)

    def _paint_shape(self, painter: QPainter, scale: Scale, band: Brush) -> None:
        low, high = self.height() - 2.0, 3.0
        corners = [
            QPointF(scale.x_of(band.reach[0]), low),
            QPointF(scale.x_of(band.start), high),
            QPointF(scale.x_of(band.end), high),
            QPointF(scale.x_of(band.reach[1]), low),
        ]
        lit = self._hovered is Edge.BODY or self._band.held is Edge.BODY
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(style.color(style.SELECTION, 130 if lit else 90))
        painter.drawPolygon(QPolygonF(corners))

    def _paint_handle(self, painter: QPainter, x: float, tall: bool, lit: bool) -> None:
        """The hold's edges are bars, the falloffs' are diamonds at the foot."""
        painter.setPen(QPen(style.color(style.BACKGROUND), 1.0))
        painter.setBrush(style.color(style.TEXT if lit else style.SELECTION))
        if tall:
            painter.drawRoundedRect(QRectF(x - 3, 1.5, 6, self.height() - 3), 2, 2)
            return
        middle = self.height() - 6.0
        size = 5.5 if lit else 4.5
        around = [(-size, 0.0), (0.0, -size), (size, 0.0), (0.0, size)]
        painter.drawPolygon(QPolygonF([QPointF(x + dx, middle + dy) for dx, dy in around]))
