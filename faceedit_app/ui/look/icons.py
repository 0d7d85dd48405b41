"""Our own icons: strokes and shapes on a 16 by 16 grid, drawn sharp at any scale."""

from __future__ import annotations

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QIcon, QPainter, QPainterPath, QPen, QPixmap

from faceedit_app.ui.look.drawings import DRAWINGS, GRID, Drawing
from faceedit_app.ui.look.palette import ACCENT, BACKGROUND, FAINT, ORANGE, TEXT

_SCALES = (1.0, 1.25, 1.5, 2.0, 3.0)
_STROKE = 1.5
APP_GRID = 64


def icon(name: str, color: str = TEXT) -> QIcon:
    """The icon of that name, with a paler one for disabled controls."""
    out = QIcon()
    for mode, ink in ((QIcon.Mode.Normal, color), (QIcon.Mode.Disabled, FAINT)):
        for scale in _SCALES:
            out.addPixmap(_pixmap(DRAWINGS[name], ink, scale), mode)
    return out


def picture(name: str, color: str, size: int, ratio: float) -> QPixmap:
    """The icon at another size than the usual, for a screen with `ratio` pixels per unit."""
    pixmap = _pixmap(DRAWINGS[name], color, size * ratio / GRID)
    pixmap.setDevicePixelRatio(ratio)
    return pixmap


def app_icon() -> QIcon:
    """FaceEdit's own icon."""
    out = QIcon()
    for size in (16, 24, 32, 48, 64, 128, 256):
        pixmap = QPixmap(size, size)
        pixmap.fill(Qt.GlobalColor.transparent)
        painter = QPainter(pixmap)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.scale(size / APP_GRID, size / APP_GRID)
        paint_app_icon(painter)
        painter.end()
        out.addPixmap(pixmap)
    return out


def paint_app_icon(painter: QPainter) -> None:
    """A curve, its edit, and the point that is dragged, on a grid of `APP_GRID` units."""
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(BACKGROUND))
    painter.drawRoundedRect(QRectF(2, 2, 60, 60), 14, 14)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    for color, lift in ((FAINT, 0.0), (ACCENT, 20.0)):
        path = QPainterPath(QPointF(8, 44))
        path.cubicTo(24, 44, 22, 36 - lift, 32, 36 - lift)
        path.cubicTo(42, 36 - lift, 40, 44, 56, 44)
        pen = QPen(QColor(color), 5)
        pen.setCapStyle(Qt.PenCapStyle.RoundCap)
        painter.setPen(pen)
        painter.drawPath(path)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(ORANGE))
    painter.drawEllipse(QPointF(32, 16), 6.5, 6.5)


def _pixmap(drawing: Drawing, color: str, scale: float) -> QPixmap:
    pixmap = QPixmap(round(GRID * scale), round(GRID * scale))
    pixmap.fill(Qt.GlobalColor.transparent)
    filled, stroked = QPainterPath(), QPainterPath()
    drawing(filled, stroked)
    painter = QPainter(pixmap)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.scale(scale, scale)
    painter.fillPath(filled, QColor(color))
    pen = QPen(QColor(color), _STROKE)
    pen.setCapStyle(Qt.PenCapStyle.RoundCap)
    pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
    painter.strokePath(stroked, pen)
    painter.end()
    pixmap.setDevicePixelRatio(scale)
    return pixmap
