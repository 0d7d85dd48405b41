"""What stands on the time axis besides curves: selection, gaps, playhead, handles."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QFont, QLinearGradient, QPainter, QPen
from PySide6.QtWidgets import QStyleOptionGraphicsItem, QWidget

from faceedit_app.core.controls import LIP_OPENING
from faceedit_app.editing.edits.edit import Op
from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.gestures import Span, clamped
from faceedit_app.ui.curves.scale import Interval

LEAST_GAP = 3.0  # pixels: a lost frame must not vanish when the whole take is in view
_NONE = QPen(Qt.PenStyle.NoPen)
_APART = 14.0  # pixels between a point and its numbers
_FAINTEST = 0.12  # of a span's strength, at the ends of its falloffs


class SpanRegion(pg.LinearRegionItem):
    """A span of time with four edges: its hold, and the falloffs on either side.

    Its fill fades as an edit there fades.

    Args:
        color: of the fill.
        hold, falloff: pens of the edges.
    """

    def __init__(self, color: str, hold: QPen = _NONE, falloff: QPen = _NONE) -> None:
        super().__init__(pen=hold, movable=False, swapMode=None)
        self._color = color
        self._shown: tuple[Span | None, int] = (None, 0)
        self.span = Span(0.0, 0.0, 0.0)
        self.outer = [pg.InfiniteLine(0.0, 90, pen=falloff) for _ in range(2)]
        for line in self.outer:
            line.setParentItem(self)
        for line in (*self.lines, *self.outer):
            line.setVisible(line.pen.style() != Qt.PenStyle.NoPen)
        self.hide()

    def show_span(self, span: Span | None, alpha: int) -> None:
        """Show it, or nothing; the fill's strength is 0..255."""
        if (span, alpha) == self._shown:
            return
        self._shown = span, alpha
        self.setVisible(span is not None)
        if span is None:
            return
        self.span = span
        self.prepareGeometryChange()
        self.setRegion((span.start, span.end))
        for line, seconds in zip(self.outer, span.ends, strict=True):
            line.setValue(seconds)
        self.setBrush(self._fill(span, alpha))
        self.update()

    def _fill(self, span: Span, alpha: int) -> QBrush:
        first, last = span.ends
        if first == last:
            return QBrush(style.color(self._color, alpha))
        fade = QLinearGradient(first, 0.0, last, 0.0)
        for place, strength in _stops(span):
            seen = alpha * (_FAINTEST + (1 - _FAINTEST) * strength)
            fade.setColorAt(place, style.color(self._color, round(seen)))
        return QBrush(fade)

    def viewRangeChanged(self) -> None:
        """It is as tall as the view, and never thinner than a pixel."""
        self.prepareGeometryChange()

    def boundingRect(self) -> QRectF:
        """From the first to the last second that an edit changes."""
        view = self.viewRect()
        if view is None:
            return QRectF()
        first, last = self.span.ends
        pixel = self.getViewBox().viewPixelSize()[0]
        first, last = first - 0.5 * pixel, last + 0.5 * pixel
        return QRectF(first, view.top(), last - first, view.height())


@lru_cache(maxsize=16)
def _stops(span: Span) -> list[tuple[float, float]]:
    """(position 0..1, strength 0..1) along a span."""
    # The edit's own mask, so that the picture cannot tell another story than the result.
    mask = span.edit((LIP_OPENING,), Op.OFFSET)
    first, last = span.ends
    ramp = np.linspace(0.0, 1.0, 7)
    times = np.concatenate([first + ramp * span.falloff, span.end + ramp * span.fade_out])
    places = (times - first) / (last - first)
    return [(float(p), float(s)) for p, s in zip(places, mask.mask(times), strict=True)]


def selection_region() -> SpanRegion:
    """The selection: edges that can be seen on any curve."""
    falloff = QPen(style.color(style.SELECTION, 90), 0, Qt.PenStyle.DashLine)
    return SpanRegion(style.SELECTION, style.hairline(style.SELECTION, 190), falloff)


def edit_region() -> SpanRegion:
    """Where an edit acts, or would act."""
    return SpanRegion(style.EDITED, falloff=style.hairline(style.EDITED, 100))


class Gaps(pg.UIGraphicsItem):
    """Hatches what the recording lost."""

    def __init__(self, alpha: int) -> None:
        super().__init__()
        self._gaps: Sequence[Interval] = ()
        self._hatch = QBrush(style.color(style.GAP, alpha), Qt.BrushStyle.BDiagPattern)
        self._fill = style.color(style.GAP, alpha // 6)

    def show_gaps(self, gaps: Sequence[Interval]) -> None:
        """From the last second before each gap to the first after it."""
        self._gaps = gaps
        self.setVisible(bool(gaps))
        self.update()

    def paint(
        self, painter: QPainter, _option: QStyleOptionGraphicsItem, widget: QWidget | None = None
    ) -> None:
        """Hatch in pixels: a pattern would be stretched with the seconds."""
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


class Playhead(pg.InfiniteLine):
    """The line of the frame on screen, one dot wide so that it is crisp."""

    def __init__(self) -> None:
        super().__init__(0.0, 90, pen=style.hairline(style.PLAYHEAD, 215))


class Dot(pg.GraphicsObject):
    """A round handle or marker, as large at any scale."""

    def __init__(self, radius: float, fill: str, edge: str) -> None:
        super().__init__()
        self._radius, self._fill = radius, style.color(fill)
        self._pen = QPen(style.color(edge), 1.5)
        self.setFlag(self.GraphicsItemFlag.ItemIgnoresTransformations)

    def fill(self, color: str) -> None:
        """Have another colour inside."""
        if (wanted := style.color(color)) != self._fill:
            self._fill = wanted
            self.update()

    def boundingRect(self) -> QRectF:
        """With room for its edge."""
        size = self._radius + 2.0
        return QRectF(-size, -size, 2.0 * size, 2.0 * size)

    def paint(
        self, painter: QPainter, _option: QStyleOptionGraphicsItem, widget: QWidget | None = None
    ) -> None:
        """Draw it."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, True)
        painter.setPen(self._pen)
        painter.setBrush(self._fill)
        painter.drawEllipse(QPointF(), self._radius, self._radius)


class Numbers(pg.TextItem):
    """Lines of numbers beside a point, kept inside the plot."""

    def __init__(self, font: QFont) -> None:
        super().__init__(color=style.TEXT, fill=style.color(style.TAG, 225))
        self.setFont(font)
        self.setVisible(False)

    def show_beside(self, seconds: float, value: float, lines: Sequence[str]) -> None:
        """Show them right of the point, or left of it if there is no room; none: nothing."""
        self.setVisible(bool(lines))
        if not lines:
            return
        self.setText("\n".join(lines))
        view = self.getViewBox()
        place = view.mapFromView(QPointF(seconds, value))
        size = self.textItem.boundingRect()
        fits = place.x() + _APART + size.width() <= view.width()
        left = -_APART / size.width() if fits else 1.0 + _APART / size.width()
        top = clamped(
            place.y() - 0.5 * size.height(), (0.0, max(view.height() - size.height(), 0.0))
        )
        self.setAnchor((left, (place.y() - top) / size.height()))
        self.setPos(seconds, value)

    def paint(
        self, painter: QPainter, _option: QStyleOptionGraphicsItem, widget: QWidget | None = None
    ) -> None:
        """Draw the box behind them."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, True)
        painter.setPen(_NONE)
        painter.setBrush(self.fill)
        painter.drawRoundedRect(self.boundingRect(), 4.0, 4.0)
