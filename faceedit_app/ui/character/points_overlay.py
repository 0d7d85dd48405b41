"""The control points of the user's character, shown on the face and dragged to correct them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np
from PySide6.QtCore import QPoint, QPointF, QRect, QRectF, Signal, SignalInstance
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPaintEvent, QPen, QRegion
from PySide6.QtWidgets import QToolTip, QWidget

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.controls import CONTROLS
from faceedit_app.ui.look.guard import guarded
from faceedit_app.ui.look.palette import BACKGROUND, TEXT

_RADIUS = 5.0
_GRAB = 9  # pixels from a point's middle
_REACH = 30.0  # pixels from the pointer to a vertex that it can choose
_DEEPER = 4.0  # pixels that a millimetre of depth counts


class Pictured(Protocol):
    """A widget with a picture of vertices, such as the viewport."""

    drawn: SignalInstance

    def project(self, vertices: Sequence[int] | None) -> Doubles | None:
        """Where vertices are in the picture; see `Viewport.project`."""


class PointsOverlay(QWidget):
    """Draws points on a picture of a head; only the points take the mouse.

    Signals:
        moved(str, int): a point, and the vertex of the rig it was dragged to.
    """

    moved = Signal(str, int)

    def __init__(self, picture: Pictured) -> None:
        assert isinstance(picture, QWidget)
        super().__init__(picture)
        self._picture: Pictured = picture
        self._around: QWidget = picture
        picture.drawn.connect(self.refresh)
        self._points: dict[str, int] = {}
        self._places: dict[str, QPointF] = {}
        self._dragged: str | None = None
        self.setMouseTracking(True)
        self.setAccessibleName("Control points")

    def show_points(self, points: Mapping[str, int]) -> None:
        """Show points: vertices of the rig by name."""
        self._points = dict(points)
        self._dragged = None
        self.show()
        self.refresh()

    def place(self, name: str) -> QPointF:
        """Where a point is shown, in pixels."""
        return self._places[name]

    def refresh(self) -> None:
        """Follow the face and the camera."""
        if not self._points or self._dragged is not None or self.isHidden():
            return
        self.setGeometry(self._around.rect())
        seen = self._picture.project(list(self._points.values()))
        if seen is None:
            self._places = {}
        else:
            self._places = {
                name: QPointF(float(x), float(y))
                for name, (x, y, _) in zip(self._points, seen, strict=True)
            }
        self._cover()
        self.update()

    def _cover(self) -> None:
        """Take the mouse on the points only."""
        region = QRegion()
        for place in self._places.values():
            middle = place.toPoint()
            region += QRect(middle - QPoint(_GRAB, _GRAB), middle + QPoint(_GRAB, _GRAB))
        self.setMask(region if not region.isEmpty() else QRegion(-2, -2, 1, 1))

    @guarded
    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint a dot in its curve's colour for each point."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for name, place in self._places.items():
            painter.setPen(QPen(QColor(TEXT if name == self._dragged else BACKGROUND), 1.5))
            painter.setBrush(QColor(_color(name)))
            painter.drawEllipse(QRectF(place.x() - _RADIUS, place.y() - _RADIUS, 10.0, 10.0))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take the nearest point."""
        self._dragged = self._at(event.position())

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Move the point that is held; else name the one under the pointer."""
        if self._dragged is None:
            name = self._at(event.position())
            text = name.replace("_", " ").capitalize() if name is not None else ""
            QToolTip.showText(event.globalPosition().toPoint(), text, self)
            return
        self._places[self._dragged] = event.position()
        self._cover()
        self.update()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Put the point on the nearest vertex in front."""
        name, self._dragged = self._dragged, None
        if name is None:
            return
        vertex = self._vertex_at(name, event.position())
        if vertex is not None and vertex != self._points[name]:
            self._points[name] = vertex
            self.moved.emit(name, vertex)
        self.refresh()

    def _at(self, place: QPointF) -> str | None:
        """The point under the pointer."""
        near = {name: (at - place).manhattanLength() for name, at in self._places.items()}
        return min(near, key=lambda name: near[name]) if near else None

    def _vertex_at(self, name: str, place: QPointF) -> int | None:
        """The vertex nearest to a place; those much deeper than the point's own do not count."""
        seen = self._picture.project(None)
        if seen is None:
            return None
        away = np.hypot(seen[:, 0] - place.x(), seen[:, 1] - place.y())
        deeper = 1000.0 * np.abs(seen[:, 2] - seen[self._points[name], 2])
        costs = np.where(away <= _REACH, away + _DEEPER * deeper, np.inf)
        best = int(costs.argmin())
        return best if np.isfinite(costs[best]) else None


def _color(point: str) -> str:
    """The colour of the first curve that a point belongs to."""
    return next(c.color for c in CONTROLS if c.between is not None and point in c.between)
