"""Paints landmarks over a picture of a film."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF

from faceedit_app.core.arrays import Doubles
from faceedit_app.tracking.drawing import STROKES

_EYES = 33, 263  # the outer corners
# Of the distance between them: how thick lines are, and how large the points of a control. On a
# small face they would hide what they show; these are the least and the most, pixels.
_LINE, _LINES = 0.012, (0.6, 1.4)
_POINT, _POINTS = 0.018, (0.7, 2.2)


def paint_landmarks(painter: QPainter, places: Doubles, room: QRectF) -> None:
    """Paint the landmarks (478, 2), shares of a picture's width and height, where it is shown."""
    corner, extent = np.array([room.x(), room.y()]), np.array([room.width(), room.height()])
    on_screen = corner + places * extent
    first, second = on_screen[list(_EYES)]
    apart = float(np.linalg.norm(first - second))
    line, point = np.clip(_LINE * apart, *_LINES), np.clip(_POINT * apart, *_POINTS)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    for stroke in STROKES:
        points = on_screen[list(stroke.landmarks)]
        if not np.isfinite(points).all():
            continue
        corners = [QPointF(x, y) for x, y in points.tolist()]
        color = QColor(stroke.color)
        painter.setPen(QPen(color, float(line)))
        painter.drawPolyline(QPolygonF(corners))
        if stroke.is_control:
            painter.setBrush(color)
            for corner_ in corners:
                painter.drawEllipse(corner_, float(point), float(point))
            painter.setBrush(Qt.BrushStyle.NoBrush)
