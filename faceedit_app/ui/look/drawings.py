"""What the icons show, as strokes and shapes on a 16 by 16 grid."""

from __future__ import annotations

import math
from collections.abc import Callable

from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QPainterPath

GRID = 16

# A drawing adds what is filled to the first path and what is stroked to the second.
Drawing = Callable[[QPainterPath, QPainterPath], None]


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


def _tool_move(filled: QPainterPath, stroked: QPainterPath) -> None:
    _lines(stroked, (8.0, 2.0), (8.0, 14.0))
    _lines(stroked, (5.2, 4.6), (8.0, 1.8), (10.8, 4.6))
    _lines(stroked, (5.2, 11.4), (8.0, 14.2), (10.8, 11.4))


def _tool_draw(filled: QPainterPath, stroked: QPainterPath) -> None:
    _lines(stroked, (2.4, 13.6), (3.3, 10.2), (10.9, 2.6), (13.4, 5.1), (5.8, 12.7), close=True)
    _lines(stroked, (9.2, 4.3), (11.7, 6.8))


def _tool_smooth(filled: QPainterPath, stroked: QPainterPath) -> None:
    _lines(stroked, (1.5, 5.5), (3.0, 2.5), (4.5, 6.0), (6.0, 2.2), (7.5, 5.0))
    stroked.moveTo(1.5, 12.5)
    stroked.cubicTo(5.0, 6.5, 9.5, 6.5, 14.5, 12.5)


def _tool_scale(filled: QPainterPath, stroked: QPainterPath) -> None:
    _lines(stroked, (2.0, 8.0), (14.0, 8.0))
    _lines(stroked, (8.0, 5.6), (8.0, 1.8))
    _lines(stroked, (5.8, 3.8), (8.0, 1.6), (10.2, 3.8))
    _lines(stroked, (8.0, 10.4), (8.0, 14.2))
    _lines(stroked, (5.8, 12.2), (8.0, 14.4), (10.2, 12.2))


def _tool_flatten(filled: QPainterPath, stroked: QPainterPath) -> None:
    stroked.moveTo(1.5, 11.5)
    stroked.cubicTo(3.0, 11.5, 3.2, 6.0, 5.0, 6.0)
    stroked.lineTo(11.0, 6.0)
    stroked.cubicTo(12.8, 6.0, 13.0, 11.5, 14.5, 11.5)


def _tool_restore(filled: QPainterPath, stroked: QPainterPath) -> None:
    """An eraser."""
    _lines(stroked, (2.0, 9.6), (8.6, 3.0), (13.2, 7.6), (8.6, 12.2), (4.6, 12.2), close=True)
    _lines(stroked, (5.2, 6.4), (9.8, 11.0))
    _lines(stroked, (8.6, 14.0), (14.0, 14.0))


def _link(filled: QPainterPath, stroked: QPainterPath) -> None:
    """A face with its line of symmetry."""
    stroked.addEllipse(QPointF(8, 8), 5.0, 6.2)
    _lines(stroked, (8.0, 3.6), (8.0, 5.2))
    _lines(stroked, (8.0, 7.2), (8.0, 8.8))
    _lines(stroked, (8.0, 10.8), (8.0, 12.4))


def _lips(filled: QPainterPath, stroked: QPainterPath) -> None:
    stroked.moveTo(1.5, 8.2)
    stroked.cubicTo(4.0, 5.6, 6.0, 3.6, 8.0, 5.4)
    stroked.cubicTo(10.0, 3.6, 12.0, 5.6, 14.5, 8.2)
    stroked.cubicTo(11.5, 13.4, 4.5, 13.4, 1.5, 8.2)
    _lines(stroked, (3.6, 8.2), (12.4, 8.2))


def _blink(filled: QPainterPath, stroked: QPainterPath) -> None:
    stroked.moveTo(1.5, 6.0)
    stroked.cubicTo(4.5, 10.8, 11.5, 10.8, 14.5, 6.0)
    for (x, y), (dx, dy) in (
        ((3.6, 8.6), (-1.2, 2.4)),
        ((8.0, 9.8), (0, 3)),
        ((12.4, 8.6), (1.2, 2.4)),
    ):
        _lines(stroked, (x, y), (x + dx, y + dy))


def _eye(filled: QPainterPath, stroked: QPainterPath) -> None:
    stroked.moveTo(1.5, 8.0)
    stroked.cubicTo(4.5, 2.8, 11.5, 2.8, 14.5, 8.0)
    stroked.cubicTo(11.5, 13.2, 4.5, 13.2, 1.5, 8.0)
    filled.addEllipse(QPointF(8, 8), 2.1, 2.1)


def _mouth(bend: float) -> Drawing:
    def draw(filled: QPainterPath, stroked: QPainterPath) -> None:
        stroked.addEllipse(QPointF(8, 8), 6.3, 6.3)
        for x in (5.8, 10.2):
            filled.addEllipse(QPointF(x, 6.2), 0.95, 0.95)
        stroked.moveTo(5.0, 10.2 - bend / 2)
        stroked.quadTo(8.0, 10.2 + 1.5 * bend, 11.0, 10.2 - bend / 2)

    return draw


def _calm(filled: QPainterPath, stroked: QPainterPath) -> None:
    _wave(stroked, 5.0, 4.0)
    _wave(stroked, 12.0, 1.2)


def _exaggerate(filled: QPainterPath, stroked: QPainterPath) -> None:
    _wave(stroked, 3.6, 1.2)
    _wave(stroked, 10.4, 4.0)


def _wave(path: QPainterPath, y: float, height: float) -> None:
    path.moveTo(1.5, y)
    path.cubicTo(4.0, y - height * 1.6, 5.5, y - height * 1.6, 8.0, y)
    path.cubicTo(10.5, y + height * 1.6, 12.0, y + height * 1.6, 14.5, y)


def _trash(filled: QPainterPath, stroked: QPainterPath) -> None:
    _lines(stroked, (2.5, 4.2), (13.5, 4.2))
    _lines(stroked, (6.0, 4.0), (6.0, 2.2), (10.0, 2.2), (10.0, 4.0))
    _lines(stroked, (3.8, 4.4), (4.6, 13.8), (11.4, 13.8), (12.2, 4.4))


def _split(filled: QPainterPath, stroked: QPainterPath) -> None:
    """Two faces side by side."""
    for x in (4.6, 11.4):
        stroked.addEllipse(QPointF(x, 8), 2.9, 4.4)


def _tick(filled: QPainterPath, stroked: QPainterPath) -> None:
    _lines(stroked, (2.8, 8.6), (6.4, 12.2), (13.2, 4.2))


def _save(filled: QPainterPath, stroked: QPainterPath) -> None:
    _lines(stroked, (2.4, 2.4), (11.4, 2.4), (13.6, 4.6), (13.6, 13.6), (2.4, 13.6), close=True)
    _lines(stroked, (5.0, 2.6), (5.0, 6.0), (10.4, 6.0), (10.4, 2.6))
    _lines(stroked, (4.6, 13.4), (4.6, 9.4), (11.4, 9.4), (11.4, 13.4))


def _sound(filled: QPainterPath, stroked: QPainterPath) -> None:
    _lines(filled, (1.5, 6.0), (4.2, 6.0), (8.0, 2.6), (8.0, 13.4), (4.2, 10.0), (1.5, 10.0))
    filled.closeSubpath()
    for radius in (2.6, 5.2):
        box = QRectF(8.4 - radius, 8.0 - radius, 2 * radius, 2 * radius)
        stroked.arcMoveTo(box, -42.0)
        stroked.arcTo(box, -42.0, 84.0)


def _muted(filled: QPainterPath, stroked: QPainterPath) -> None:
    _lines(filled, (1.5, 6.0), (4.2, 6.0), (8.0, 2.6), (8.0, 13.4), (4.2, 10.0), (1.5, 10.0))
    filled.closeSubpath()
    _lines(stroked, (10.4, 6.0), (14.4, 10.0))
    _lines(stroked, (14.4, 6.0), (10.4, 10.0))


def _zoom_out(filled: QPainterPath, stroked: QPainterPath) -> None:
    stroked.addEllipse(QPointF(6.8, 6.8), 4.6, 4.6)
    _lines(stroked, (10.3, 10.3), (14.0, 14.0))
    _lines(stroked, (4.8, 6.8), (8.8, 6.8))


def _zoom_in(filled: QPainterPath, stroked: QPainterPath) -> None:
    _zoom_out(filled, stroked)
    _lines(stroked, (6.8, 4.8), (6.8, 8.8))


def _down(filled: QPainterPath, stroked: QPainterPath) -> None:
    _lines(stroked, (3.5, 6.0), (8.0, 10.5), (12.5, 6.0))


def _up(filled: QPainterPath, stroked: QPainterPath) -> None:
    _lines(stroked, (3.5, 10.0), (8.0, 5.5), (12.5, 10.0))


def _mirrored(drawing: Drawing) -> Drawing:
    """The same, flipped left to right."""

    def draw(filled: QPainterPath, stroked: QPainterPath) -> None:
        drawing(filled, stroked)
        for path in (filled, stroked):
            for i in range(path.elementCount()):
                element = path.elementAt(i)
                path.setElementPositionAt(i, GRID - element.x, element.y)

    return draw


DRAWINGS: dict[str, Drawing] = {
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
    "tool_move": _tool_move,
    "tool_draw": _tool_draw,
    "tool_smooth": _tool_smooth,
    "tool_scale": _tool_scale,
    "tool_flatten": _tool_flatten,
    "tool_restore": _tool_restore,
    "link": _link,
    "lips": _lips,
    "blink": _blink,
    "eye": _eye,
    "smile": _mouth(1.6),
    "sad": _mouth(-1.6),
    "calm": _calm,
    "exaggerate": _exaggerate,
    "trash": _trash,
    "split": _split,
    "tick": _tick,
    "zoom_in": _zoom_in,
    "zoom_out": _zoom_out,
    "down": _down,
    "up": _up,
    "save": _save,
    "sound": _sound,
    "muted": _muted,
}
