"""A wide, smooth line that is cheap to draw."""

from __future__ import annotations

import math

import pyqtgraph as pg
from PySide6.QtGui import QPainter, QPen, QTransform

from faceedit_app.ui.curves.axes import Span
from faceedit_app.ui.curves.polyline import EMPTY, Polyline


class WideLine(pg.PlotCurveItem):  # type: ignore[misc]  # pyqtgraph has no types
    """Draws a hairline several times, fractions of a pixel apart.

    Qt has a fast path for antialiased lines up to one pixel wide. Any wider, it computes the
    outline with all its joints, which takes 20 times as long for 200 points and 200 times for
    2,000; drawn as single segments instead, the joints show as beads.

    Args:
        pen: colour, dashes, and the width in pixels of a screen with 96 dots per inch.
    """

    def __init__(self, pen: QPen) -> None:
        super().__init__(skipFiniteCheck=True)
        self._wanted = pen
        self._line = EMPTY
        self._hair: tuple[float, QPen] = (0.0, pen)

    def show_line(self, line: Polyline) -> Span | None:
        """Draw other points; tell between which seconds that is to be seen, None for nowhere."""
        changed, self._line = line.changed_from(self._line), line
        if changed is not None and self._wanted.dashPattern() and len(line.x):
            changed = changed[0], max(changed[1], float(line.x[-1]))  # dashes follow each other
        # pyqtgraph's own way in asks for the bounds of everything, twice; they are not wanted.
        self.xData, self.yData = line.x, line.y
        self.opts["connect"] = "all" if line.joined is None else line.joined
        self.path = None
        return changed

    def paint(self, painter: QPainter, *_: object) -> None:
        """Draw it, in its full width unless it fills its pixel columns anyway."""
        if len(self._line.x) < 2:
            return
        ratio = painter.device().devicePixelRatioF()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, True)
        if self._hair[0] != ratio:
            self._hair = ratio, _hairline(self._wanted, ratio)
        painter.setPen(self._hair[1])
        path, place = self.getPath(), painter.transform()
        for dx, dy in offsets(1.0 if self._line.thinned else ratio * self._wanted.widthF()):
            painter.setTransform(place * QTransform.fromTranslate(dx / ratio, dy / ratio))
            painter.drawPath(path)
        painter.setTransform(place)


def _hairline(pen: QPen, ratio: float) -> QPen:
    """The pen, one dot of the screen wide, with dashes that look as long as on any other."""
    hair = QPen(pen.color(), 1.0)
    hair.setCosmetic(True)
    if pen.dashPattern():
        hair.setDashPattern([ratio * length for length in pen.dashPattern()])
    return hair


def offsets(width: float) -> list[tuple[float, float]]:
    """Where to draw a line of 1 pixel so that it looks `width` pixels wide in any direction."""
    if width <= 1:
        return [(0.0, 0.0)]
    radius = 0.5 * (width - 1)
    count = 3 if radius <= 0.5 else 6
    around = [2 * math.pi * (i + 0.25) / count for i in range(count)]
    ring = [(radius * math.cos(a), radius * math.sin(a)) for a in around]
    return ring if count == 3 else [(0.0, 0.0), *ring]
