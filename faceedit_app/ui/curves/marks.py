"""Items on the time axis other than curves: selection, gaps, playhead, handles."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import (
    QBrush,
    QFont,
    QLinearGradient,
    QPainter,
    QPainterPath,
    QPen,
    QPolygonF,
)
from PySide6.QtWidgets import (
    QGraphicsItem,
    QGraphicsPathItem,
    QStyleOptionGraphicsItem,
    QWidget,
)

from faceedit_app.core.controls import LIP_OPENING
from faceedit_app.editing.edits.edit import Op
from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.backdrop import Backdrop
from faceedit_app.ui.curves.gestures import Span
from faceedit_app.ui.curves.paint import draw_tag, fitting, tag_box
from faceedit_app.ui.curves.scale import Interval, Scale
from faceedit_app.ui.curves.view_item import MeasuredItem, ViewItem
from faceedit_app.ui.look.guard import guarded

LEAST_GAP = 3.0  # pixels: a lost frame must not vanish when the whole take is in view
_NONE = QPen(Qt.PenStyle.NoPen)
_FAINTEST = 0.12  # factor on a span's opacity at the ends of its falloffs


class SpanRegion(MeasuredItem, pg.LinearRegionItem):
    """A span of time with four edges: its hold, and the falloffs on either side.

    Its fill fades as the edit does. pyqtgraph's own two lines stay out of the plot: as separate
    items, four edges would take as long to paint as the curves.

    Args:
        color: of the fill.
        hold, falloff: pens of the edges.
    """

    def __init__(self, color: str, hold: QPen = _NONE, falloff: QPen = _NONE) -> None:
        super().__init__(pen=_NONE, hoverPen=_NONE, movable=False, swapMode=None)
        self.span = Span(0.0, 0.0, 0.0)
        self._color, self._hold, self._falloff = color, hold, falloff
        self._shown: tuple[Span | None, int] = (None, 0)
        self._fills: list[tuple[QRectF, QBrush]] = []
        self._edges: list[tuple[QPen, list[QLineF]]] = []
        for line in self.lines:
            line.setParentItem(None)
        self.hide()

    def show_span(self, span: Span | None, alpha: int) -> None:
        """Show a span, or None; `alpha` is the opacity of the fill, 0..255."""
        if (span, alpha) == self._shown:
            return
        self.redraw()
        self._shown = span, alpha
        self.setVisible(span is not None)
        if span is None:
            return
        self.span = span
        self.forget()
        self.setRegion((span.start, span.end))
        self.setBrush(style.color(self._color, alpha))
        self.redraw()

    def _measure(self, view: QRectF, pixel: float) -> QRectF:
        """The whole span, hold and falloffs; the hold of a single frame is one pixel wide."""
        span, top, height = self.span, view.top(), view.height()
        first, last = span.ends
        hold = max(span.end - span.start, pixel)
        self._fills = [(QRectF(span.start, top, hold, height), self.brush)]
        for start, end in ((first, span.start), (span.end, last)):
            if end > start:
                rect = QRectF(start, top, end - start, height)
                self._fills.append((rect, self._fade(start, end)))
        pens = (self._hold, (span.start, span.end)), (self._falloff, (first, last))
        self._edges = [
            (pen, [QLineF(x, top, x, top + height) for x in edges])
            for pen, edges in pens
            if pen is not _NONE
        ]
        return QRectF(first - pixel, top, last - first + 2.0 * pixel, height)

    def _fade(self, first: float, last: float) -> QBrush:
        fade = QLinearGradient(first, 0.0, last, 0.0)
        for place, strength in _stops(self.span, first, last):
            seen = self._shown[1] * (_FAINTEST + (1 - _FAINTEST) * strength)
            fade.setColorAt(place, style.color(self._color, round(seen)))
        return QBrush(fade)

    @guarded
    def paint(
        self, painter: QPainter, _option: QStyleOptionGraphicsItem, widget: QWidget | None = None
    ) -> None:
        """Fill hold and falloffs, then draw the edges."""
        for rect, brush in self._fills:
            painter.fillRect(rect, brush)
        for pen, edges in self._edges:
            painter.setPen(pen)
            painter.drawLines(edges)


@lru_cache(maxsize=16)
def _stops(span: Span, first: float, last: float) -> list[tuple[float, float]]:
    """(position 0..1, strength 0..1) along one of a span's falloffs."""
    # The edit's own mask, so that the picture always matches the result.
    ramp = np.linspace(0.0, 1.0, 7)
    mask = span.edit((LIP_OPENING,), Op.OFFSET).mask(first + ramp * (last - first))
    return [(float(p), float(s)) for p, s in zip(ramp, mask, strict=True)]


class Spans:
    """The selection and the span of an edit, behind all else in a view.

    They are made when there is one to show: their items in all plots would take a tenth of the
    time in which a window opens.

    Args:
        view: where they are shown.
        backdrop: what draws them; None = the scene of the view.
    """

    def __init__(self, view: pg.ViewBox, backdrop: Backdrop | None = None) -> None:
        self._view, self._backdrop = view, backdrop
        self._selection: SpanRegion | None = None
        self._edit: SpanRegion | None = None

    def show(self, selection: Span | None, edit: Span | None, alpha: int) -> None:
        """Show them, or None; `alpha` is the opacity of the edit's, 0..255."""
        if self._selection is None and selection is not None:
            self._selection = self._added(selection_region(), -2.0)
        if self._edit is None and edit is not None:
            self._edit = self._added(edit_region(), -1.0)
        if self._selection is not None:
            self._selection.show_span(selection, style.SELECTED)
        if self._edit is not None:
            self._edit.show_span(edit, alpha)

    def _added(self, region: SpanRegion, height: float) -> SpanRegion:
        region.setZValue(height)
        self._view.addItem(region, ignoreBounds=True)
        if self._backdrop is not None:
            region.move_behind(self._backdrop)
        return region


def selection_region() -> SpanRegion:
    """The selection: its edges are visible on any curve."""
    falloff = QPen(style.color(style.SELECTION, 90), 0, Qt.PenStyle.DashLine)
    return SpanRegion(style.SELECTION, style.hairline(style.SELECTION, 190), falloff)


def edit_region() -> SpanRegion:
    """The span of an edit, actual or possible."""
    return SpanRegion(style.EDITED, falloff=style.hairline(style.EDITED, 100))


class Gaps(ViewItem):
    """Hatches the gaps."""

    def __init__(self, alpha: int) -> None:
        super().__init__()
        self._gaps: Sequence[Interval] = ()
        self._hatch = QBrush(style.color(style.GAP, alpha), Qt.BrushStyle.BDiagPattern)
        self._fill = style.color(style.GAP, alpha // 6)

    def show_gaps(self, gaps: Sequence[Interval]) -> None:
        """Hatch from the last frame before each gap to the first after it."""
        self._gaps = gaps
        self.redraw()
        self.setVisible(bool(gaps))
        self.redraw()

    @guarded
    def paint(
        self, painter: QPainter, _option: QStyleOptionGraphicsItem, widget: QWidget | None = None
    ) -> None:
        """Hatch in pixels: a pattern in seconds would be stretched."""
        view, place = self.boundingRect(), painter.transform()
        painter.resetTransform()
        for first, last in self._gaps:
            if last < view.left() or first > view.right():
                continue
            rect = place.mapRect(QRectF(first, view.top(), last - first, view.height()))
            if (missing := LEAST_GAP - rect.width()) > 0:
                rect.adjust(-0.5 * missing, 0.0, 0.5 * missing, 0.0)
            painter.fillRect(rect, self._fill)
            painter.fillRect(rect, self._hatch)


class Pins(ViewItem):
    """Lines where a retime shows the moments that it was pinned at."""

    def __init__(self) -> None:
        super().__init__()
        self._times: tuple[float, ...] = ()
        self._pen = QPen(style.color(style.ASKED, 170), 0, Qt.PenStyle.DashDotLine)
        self.hide()

    def show_pins(self, times: tuple[float, ...]) -> None:
        """Show pins at some seconds."""
        if times != self._times:
            self._times = times
            self.setVisible(bool(times))
            self.update()

    @guarded
    def paint(
        self, painter: QPainter, _option: QStyleOptionGraphicsItem, widget: QWidget | None = None
    ) -> None:
        """Draw those that are in view."""
        view = self.boundingRect()
        painter.setPen(self._pen)
        for time in self._times:
            if view.left() <= time <= view.right():
                painter.drawLine(QLineF(time, view.top(), time, view.bottom()))


class Playhead(MeasuredItem, pg.InfiniteLine):
    """The line of the frame on screen, one dot wide so that it is crisp."""

    def __init__(self) -> None:
        super().__init__(0.0, 90, pen=style.hairline(style.PLAYHEAD, 215), hoverPen=_NONE)

    def _measure(self, view: QRectF, pixel: float) -> QRectF:
        """The box in the line's own coordinates, which are rotated by 90 degrees."""
        return QRectF(view.top(), -2.0 * pixel, view.height(), 4.0 * pixel)

    @guarded
    def paint(
        self, painter: QPainter, _option: QStyleOptionGraphicsItem, widget: QWidget | None = None
    ) -> None:
        """Draw it."""
        rect = self.boundingRect()
        painter.setPen(self.pen)
        painter.drawLine(QLineF(rect.left(), 0.0, rect.right(), 0.0))


class Marker(QGraphicsPathItem):
    """A small shape with the same size at any scale.

    Args:
        shape: around its position, in pixels.
        fill, edge: colours.
    """

    def __init__(self, shape: QPainterPath, fill: str, edge: str | None = None) -> None:
        super().__init__(shape)
        self.setBrush(style.color(fill))
        self.setPen(_NONE if edge is None else QPen(style.color(edge), 1.5))
        self.setFlag(self.GraphicsItemFlag.ItemIgnoresTransformations)

    @guarded
    def paint(
        self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None
    ) -> None:
        """Draw it smoothly."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, True)
        super().paint(painter, option, widget)


def dot(radius: float, fill: str, edge: str) -> Marker:
    """A round one."""
    shape = QPainterPath()
    shape.addEllipse(QPointF(), radius, radius)
    return Marker(shape, fill, edge)


def grip() -> Marker:
    """The handle for scrubbing, pointing at the playhead."""
    shape = QPainterPath()
    corners = [(0.5, 0.0), (-4.5, -5.0), (-4.5, -10.0), (5.5, -10.0), (5.5, -5.0)]
    shape.addPolygon(QPolygonF([QPointF(x, y) for x, y in corners]))
    shape.closeSubpath()
    return Marker(shape, style.PLAYHEAD)


class Numbers(QGraphicsItem):
    """Lines of numbers beside a point, kept inside the plot.

    pyqtgraph's text items lay out a document for each change, which is slower than the curves.
    """

    def __init__(self, font: QFont) -> None:
        super().__init__()
        self._font = font
        self._lines: tuple[str, ...] = ()
        self._box = QRectF()
        self.setFlag(self.GraphicsItemFlag.ItemIgnoresTransformations)
        self.hide()

    def show_beside(self, point: QPointF, scale: Scale, lines: tuple[str, ...]) -> None:
        """Show them right of a point (seconds, millimetres), or left of it if there is no room."""
        self.setVisible(bool(lines))
        if not lines:
            return
        self.prepareGeometryChange()
        place = QPointF(scale.x_of(point.x()), scale.y_of(point.y()))
        self._lines = fitting(lines, scale, self._font)
        self._box = tag_box(place, scale, self._lines, self._font)
        self._box.translate(-place)
        self.setPos(point)

    def boundingRect(self) -> QRectF:
        """Their box, relative to the point."""
        return self._box.adjusted(-1.0, -1.0, 1.0, 1.0)

    @guarded
    def paint(
        self, painter: QPainter, _option: QStyleOptionGraphicsItem, widget: QWidget | None = None
    ) -> None:
        """Draw them on their background."""
        draw_tag(painter, self._box, self._lines, self._font)
