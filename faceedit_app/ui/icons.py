"""Our own icons: strokes and shapes on a 16 by 16 grid, drawn sharp at any scale."""

from __future__ import annotations

import math
from collections.abc import Callable

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QIcon, QPainter, QPainterPath, QPen, QPixmap

from faceedit_app.ui.palette import ACCENT, BACKGROUND, FAINT, ORANGE, TEXT

GRID = 16
_SCALES = (1.0, 1.25, 1.5, 2.0, 3.0)
_STROKE = 1.5

# A drawing adds what is filled to the first path and what is stroked to the second.
Drawing = Callable[[QPainterPath, QPainterPath], None]


def icon(name: str, color: str = TEXT) -> QIcon:
    """The icon of that name, with a paler one for disabled controls."""
    out = QIcon()
    for mode, ink in ((QIcon.Mode.Normal, color), (QIcon.Mode.Disabled, FAINT)):
        for scale in _SCALES:
            out.addPixmap(_pixmap(_DRAWINGS[name], ink, scale), mode)
    return out


def picture(name: str, color: str, size: int, ratio: float) -> QPixmap:
    """The icon at another size than the usual, for a screen with `ratio` pixels per unit."""
    pixmap = _pixmap(_DRAWINGS[name], color, size * ratio / GRID)
    pixmap.setDevicePixelRatio(ratio)
    return pixmap


def app_icon() -> QIcon:
    """FaceEdit's own icon: a curve, its edit, and the point that is dragged."""
    out = QIcon()
    for size in (16, 24, 32, 48, 64, 128, 256):
        pixmap = QPixmap(size, size)
        pixmap.fill(Qt.GlobalColor.transparent)
        painter = QPainter(pixmap)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.scale(size / 64, size / 64)
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
        painter.end()
        out.addPixmap(pixmap)
    return out


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


def _lines(path: QPainterPath, *points: tuple[float, float], close: bool = False) -> None:
    path.moveTo(*points[0])
    for point in points[1:]:
        path.lineTo(*point)
    if close:
        path.closeSubpath()


def _play(filled: QPainterPath, stroked: QPainterPath) -> None:
    _lines(filled, (4.0, 2.5), (13.5, 8.0), (4.0, 13.5), close=True)


def _pause(filled: QPainterPath, stroked: QPainterPath) -> None:
    filled.addRoundedRect(QRectF(3.5, 2.5, 3.2, 11), 0.8, 0.8)
    filled.addRoundedRect(QRectF(9.3, 2.5, 3.2, 11), 0.8, 0.8)


def _forward(filled: QPainterPath, stroked: QPainterPath) -> None:
    _lines(filled, (6.0, 3.5), (12.5, 8.0), (6.0, 12.5), close=True)
    filled.addRoundedRect(QRectF(2.6, 3.5, 1.7, 9), 0.6, 0.6)


def _end(filled: QPainterPath, stroked: QPainterPath) -> None:
    _lines(filled, (3.0, 3.0), (10.6, 8.0), (3.0, 13.0), close=True)
    filled.addRoundedRect(QRectF(11.3, 3.0, 1.9, 10), 0.6, 0.6)


def _loop(filled: QPainterPath, stroked: QPainterPath) -> None:
    _lines(stroked, (2.5, 7.5), (2.5, 6.5))
    stroked.cubicTo(2.5, 5.0, 3.5, 4.5, 5.0, 4.5)
    stroked.lineTo(12.0, 4.5)
    _lines(stroked, (10.0, 2.2), (12.4, 4.5), (10.0, 6.8))
    _lines(stroked, (13.5, 8.5), (13.5, 9.5))
    stroked.cubicTo(13.5, 11.0, 12.5, 11.5, 11.0, 11.5)
    stroked.lineTo(4.0, 11.5)
    _lines(stroked, (6.0, 9.2), (3.6, 11.5), (6.0, 13.8))


def _undo(filled: QPainterPath, stroked: QPainterPath) -> None:
    _lines(stroked, (5.5, 2.5), (2.5, 5.5), (5.5, 8.5))
    stroked.moveTo(2.8, 5.5)
    stroked.lineTo(9.0, 5.5)
    stroked.cubicTo(15.0, 5.5, 15.0, 13.2, 9.0, 13.2)
    stroked.lineTo(6.0, 13.2)


def _reset(filled: QPainterPath, stroked: QPainterPath) -> None:
    """A raised curve that goes back to its base line."""
    _lines(stroked, (1.5, 13.5), (14.5, 13.5))
    stroked.moveTo(2.0, 9.5)
    stroked.cubicTo(5.0, 9.5, 5.0, 2.5, 8.0, 2.5)
    stroked.cubicTo(11.0, 2.5, 11.0, 9.5, 14.0, 9.5)
    _lines(stroked, (8.0, 5.5), (8.0, 10.8))
    _lines(stroked, (6.2, 9.2), (8.0, 11.0), (9.8, 9.2))


def _open(filled: QPainterPath, stroked: QPainterPath) -> None:
    _lines(
        stroked,
        *((2.0, 12.8), (2.0, 3.2), (6.2, 3.2), (7.8, 5.2), (12.6, 5.2), (12.6, 7.4)),
    )
    _lines(stroked, (2.0, 12.8), (4.6, 7.4), (14.8, 7.4), (12.4, 12.8), close=True)


def _export(filled: QPainterPath, stroked: QPainterPath) -> None:
    _lines(stroked, (2.5, 9.5), (2.5, 13.2), (13.5, 13.2), (13.5, 9.5))
    _lines(stroked, (8.0, 10.0), (8.0, 2.5))
    _lines(stroked, (4.8, 5.5), (8.0, 2.3), (11.2, 5.5))


def _camera(filled: QPainterPath, stroked: QPainterPath) -> None:
    """Four corners around a head: the view that fits."""
    for x, inwards in ((2.0, 3.5), (14.0, -3.5)):
        for y, down in ((2.0, 3.5), (14.0, -3.5)):
            _lines(stroked, (x + inwards, y), (x, y), (x, y + down))
    stroked.addEllipse(QPointF(8, 8), 2.6, 3.2)


def _fit(filled: QPainterPath, stroked: QPainterPath) -> None:
    _lines(stroked, (1.8, 3.0), (1.8, 13.0))
    _lines(stroked, (14.2, 3.0), (14.2, 13.0))
    _lines(stroked, (4.5, 8.0), (11.5, 8.0))
    _lines(stroked, (6.5, 5.8), (4.3, 8.0), (6.5, 10.2))
    _lines(stroked, (9.5, 5.8), (11.7, 8.0), (9.5, 10.2))


def _close(filled: QPainterPath, stroked: QPainterPath) -> None:
    _lines(stroked, (4.0, 4.0), (12.0, 12.0))
    _lines(stroked, (12.0, 4.0), (4.0, 12.0))


def _warning(filled: QPainterPath, stroked: QPainterPath) -> None:
    _lines(stroked, (8.0, 2.2), (14.6, 13.6), (1.4, 13.6), close=True)
    _lines(stroked, (8.0, 6.6), (8.0, 9.6))
    filled.addEllipse(QPointF(8.0, 11.6), 0.9, 0.9)


def _drop(filled: QPainterPath, stroked: QPainterPath) -> None:
    """Sound-like curve over a tray: drop a take here."""
    stroked.moveTo(1.5, 7.0)
    for i in range(1, 53):
        x = i / 4
        stroked.lineTo(1.5 + x, 7.0 - 4.0 * math.sin(x * 1.45) * math.exp(-(((x - 6.5) / 4) ** 2)))
    _lines(stroked, (2.0, 12.0), (2.0, 14.0), (14.0, 14.0), (14.0, 12.0))


def _mirrored(drawing: Drawing) -> Drawing:
    """The same, flipped left to right."""

    def draw(filled: QPainterPath, stroked: QPainterPath) -> None:
        drawing(filled, stroked)
        for path in (filled, stroked):
            for i in range(path.elementCount()):
                element = path.elementAt(i)
                path.setElementPositionAt(i, GRID - element.x, element.y)

    return draw


_DRAWINGS: dict[str, Drawing] = {
    "play": _play,
    "pause": _pause,
    "forward": _forward,
    "back": _mirrored(_forward),
    "end": _end,
    "start": _mirrored(_end),
    "loop": _loop,
    "undo": _undo,
    "redo": _mirrored(_undo),
    "reset": _reset,
    "open": _open,
    "export": _export,
    "camera": _camera,
    "fit": _fit,
    "close": _close,
    "warning": _warning,
    "drop": _drop,
}
