"""Paints landmarks over a picture of a film."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF

from faceedit_app.core.arrays import Doubles
from faceedit_app.tracking.drawing import STROKES


def paint_landmarks(painter: QPainter, places: Doubles, room: QRectF) -> None:
    """Paint the landmarks (478, 2), shares of a picture's width and height, where it is shown."""
    corner, extent = np.array([room.x(), room.y()]), np.array([room.width(), room.height()])
    on_screen = corner + places * extent
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    for stroke in STROKES:
        points = on_screen[list(stroke.landmarks)]
        if not np.isfinite(points).all():
            continue
        corners = [QPointF(x, y) for x, y in points.tolist()]
        color = QColor(stroke.color)
        painter.setPen(QPen(color, 1.4))
        painter.drawPolyline(QPolygonF(corners))
        if stroke.is_control:
            painter.setBrush(color)
            for corner_ in corners:
                painter.drawEllipse(corner_, 2.2, 2.2)
            painter.setBrush(Qt.BrushStyle.NoBrush)
