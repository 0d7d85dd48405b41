"""A wide, smooth line that is cheap to draw."""

from __future__ import annotations

import math

import pyqtgraph as pg
from PySide6.QtGui import QPainter, QPen, QTransform
from PySide6.QtWidgets import QStyleOptionGraphicsItem, QWidget


class WideLine(pg.PlotCurveItem):  # type: ignore[misc]  # pyqtgraph has no types
    """Draws a hairline several times, fractions of a pixel apart.

    Qt has a fast path for antialiased lines up to one pixel wide. Any wider, it computes the
    outline with all its joints, which takes 20 times as long for 200 points and 200 times for
    2,000; drawn as single segments instead, the joints show as beads.
    """

    def __init__(self, color: str, width: float) -> None:
        super().__init__(antialias=True, skipFiniteCheck=True)
        self._pen = QPen(pg.mkColor(color), 1.0)
        self._pen.setCosmetic(True)
        self._width = width
        self.wide = True

    def paint(
        self, painter: QPainter, _option: QStyleOptionGraphicsItem, _widget: QWidget | None = None
    ) -> None:
        """Draw it, in its full width unless `wide` is off."""
        if self.xData is None or len(self.xData) < 2:
            return
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, True)
        painter.setPen(self._pen)
        path, place = self.getPath(), painter.transform()
        width = self._width * painter.device().devicePixelRatioF() if self.wide else 1.0
        for dx, dy in offsets(width):
            painter.setTransform(place * QTransform.fromTranslate(dx, dy))
            painter.drawPath(path)
        painter.setTransform(place)


def offsets(width: float) -> list[tuple[float, float]]:
    """Where to draw a line of 1 pixel so that it looks `width` pixels wide in any direction."""
    if width <= 1:
        return [(0.0, 0.0)]
    radius = 0.5 * (width - 1)
    count = 3 if radius <= 0.5 else 6
    around = [2 * math.pi * (i + 0.25) / count for i in range(count)]
    ring = [(radius * math.cos(a), radius * math.sin(a)) for a in around]
    return ring if count == 3 else [(0.0, 0.0), *ring]
