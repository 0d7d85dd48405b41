"""A wide, smooth line that is cheap to draw."""

from __future__ import annotations

import math

from pyqtgraph.functions import arrayToQPath
from PySide6.QtGui import QPainter, QPainterPath, QPen, QTransform

from faceedit_app.ui.curves.axes import Span
from faceedit_app.ui.curves.polyline import EMPTY, Polyline


class WideLine:
    """Draws a hairline several times, fractions of a pixel apart.

    Qt has a fast path for antialiased lines up to one pixel wide. Any wider, it computes the
    outline with all its joints, which takes 20 times as long for 200 points and 200 times for
    2,000; drawn as single segments instead, the joints show as beads.

    Args:
        pen: colour, dashes, and the width in pixels of a screen with 96 dots per inch.
    """

    def __init__(self, pen: QPen) -> None:
        self._wanted, self._dashed = pen, bool(pen.dashPattern())
        self._line, self._path = EMPTY, QPainterPath()
        self._hair: tuple[float, QPen] = (0.0, pen)

    def show_line(self, line: Polyline) -> Span | None:
        """Draw other points; tell between which seconds that is to be seen, None for nowhere."""
        changed = line.changed_from(self._line)
        if changed is not None:
            self._line = line
            joined = "all" if line.joined is None else line.joined
            self._path = arrayToQPath(line.x, line.y, joined, finiteCheck=False)
            if self._dashed and len(line.x):
                changed = changed[0], max(changed[1], float(line.x[-1]))  # all dashes move
        return changed

    def paint(self, painter: QPainter) -> None:
        """Draw it, in its full width unless it fills its pixel columns anyway."""
        if len(self._line.x) < 2:
            return
        ratio = painter.device().devicePixelRatioF()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, True)
        if self._hair[0] != ratio:
            self._hair = ratio, _hairline(self._wanted, ratio)
        painter.setPen(self._hair[1])
        place = painter.transform()
        for dx, dy in offsets(1.0 if self._line.thinned else ratio * self._wanted.widthF()):
            painter.setTransform(place * QTransform.fromTranslate(dx / ratio, dy / ratio))
            painter.drawPath(self._path)
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
