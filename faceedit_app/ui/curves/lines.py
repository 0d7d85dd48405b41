"""The three lines of a curve, as one item of a plot."""

from __future__ import annotations

import math
from functools import lru_cache

from pyqtgraph.functions import arrayToQPath, create_qpolygonf, ndarray_from_qpolygonf
from PySide6.QtGui import QPainter, QPainterPath, QPen, QPolygonF, QTransform
from PySide6.QtWidgets import QStyleOptionGraphicsItem, QWidget

from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.scale import Interval
from faceedit_app.ui.curves.view_item import ViewItem
from faceedit_app.ui.curves.visible_curves import EMPTY, Lines, Polyline
from faceedit_app.ui.look.guard import guarded

_EDGE = 5.0  # greatest pixels from the centre of a line to its edge
# Pixels that a line may move and not be drawn again: its pixels would differ by two steps of 255.
_UNSEEN = 0.01


class CurveLines(ViewItem):
    """Draws the tracked, face and asked-for lines; repaints only between the times that changed.

    A mouth that opens moves the lids by a tenth of a micrometre. That is not drawn again.

    pyqtgraph's own curve items take three times as long: one per line, and wide pens (`Stroke`).
    """

    def __init__(self, color: str) -> None:
        # Edge, left, right, top and height of the view.
        self._room: tuple[float, float, float, float, float] | None = None
        self._unseen: float | None = None
        self.lines = Lines()
        self._tracked = Stroke(style.tracked_pen())
        self._face = Stroke(style.face_pen(color))
        self._asked = Stroke(style.asked_pen())
        self._character = Stroke(style.character_pen())
        super().__init__()

    def show_lines(self, lines: Lines) -> None:
        """Set the lines to draw."""
        self.lines = lines
        spans = self._set_lines(self.unseen)
        if spans:
            self._update_between(min(span[0] for span in spans), max(span[1] for span in spans))

    def _set_lines(self, unseen: float) -> list[Interval]:
        """Where the lines have changed visibly."""
        lines = self.lines
        changed = (
            self._tracked.show_line(lines.tracked, unseen),
            self._face.show_line(lines.face, unseen),
            self._asked.show_line(lines.asked, unseen),
            self._character.show_line(lines.character, unseen),
        )
        return [span for span in changed if span is not None]

    @property
    def unseen(self) -> float:
        """How far a value may move without being seen to, in millimetres."""
        if self._unseen is None:
            view = self.getViewBox()
            self._unseen = _UNSEEN * self.boundingRect().height() / max(view.height(), 1.0)
        return self._unseen

    def forget(self) -> None:
        """The scale changed: forget what was measured, and draw what could not be seen in it."""
        self._room = self._unseen = None
        self._set_lines(0.0)
        super().forget()

    def _update_between(self, first: float, last: float) -> None:
        if self._room is None:
            rect = self.boundingRect()
            edge = _EDGE * self.getViewBox().pixel
            self._room = edge, rect.left(), rect.right(), rect.top(), rect.height()
        edge, left, right, top, height = self._room
        left, right = max(first - edge, left), min(last + edge, right)
        if left < right:
            self.update(left, top, right - left, height)

    @guarded
    def paint(
        self, painter: QPainter, _option: QStyleOptionGraphicsItem, widget: QWidget | None = None
    ) -> None:
        """Draw the lines, from back to front: tracked, the user's character, face, asked for."""
        ratio = painter.device().devicePixelRatioF()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, True)
        for stroke in (self._tracked, self._character, self._face, self._asked):
            stroke.draw(painter, ratio)


class Stroke:
    """Draws a wide line as several hairlines, fractions of a pixel apart.

    Qt draws antialiased lines up to one pixel wide on a fast path. For wider ones it computes the
    outline with all its joints, which takes 20 times as long for 200 points and 200 times as
    long for 2,000. Drawn as single segments, the joints would show as beads.

    Args:
        pen: colour, dashes, and the width in pixels of a screen with 96 dots per inch.
    """

    def __init__(self, pen: QPen) -> None:
        self._wanted, self._dashed = pen, bool(pen.dashPattern())
        self._line, self._points, self._path = EMPTY, QPolygonF(), QPainterPath()
        self._hair: tuple[float, QPen] = (0.0, pen)

    def show_line(self, line: Polyline, unseen: float = 0.0) -> Interval | None:
        """Set the points; returns first and last second of the visible change, None if none.

        Args:
            unseen: how far values may move without being seen to; they then keep their place.
        """
        changed = line.changed_from(self._line, unseen)
        if changed is not None:
            self._line = line
            if line.joined is None:
                self._points = _polygon(line)
            else:
                self._path = arrayToQPath(line.x, line.y, line.joined, finiteCheck=False)
            if self._dashed and len(line.x):
                changed = changed[0], max(changed[1], float(line.x[-1]))  # all dashes move
        return changed

    def draw(self, painter: QPainter, ratio: float) -> None:
        """Draw the line, in full width unless it fills its pixel columns anyway.

        Args:
            ratio: screen dots per pixel.
        """
        if len(self._line.x) < 2:
            return
        if self._hair[0] != ratio:
            self._hair = ratio, _hairline(self._wanted, ratio)
        painter.setPen(self._hair[1])
        aside = offsets(ratio * (1.0 if self._line.thinned else self._wanted.widthF()))
        place = painter.transform() if len(aside) > 1 else None
        for dx, dy in aside:
            if place is not None:
                painter.setTransform(place * QTransform.fromTranslate(dx / ratio, dy / ratio))
            if self._line.joined is None:
                painter.drawPolyline(self._points)
            else:
                painter.drawPath(self._path)
        if place is not None:
            painter.setTransform(place)


def _polygon(line: Polyline) -> QPolygonF:
    """The points of a line, for Qt."""
    polygon: QPolygonF = create_qpolygonf(len(line.x))
    if len(line.x):
        points = ndarray_from_qpolygonf(polygon)
        points[:, 0], points[:, 1] = line.x, line.y
    return polygon


def _hairline(pen: QPen, ratio: float) -> QPen:
    """The pen, one screen dot wide, with dashes of the same length on every screen."""
    hair = QPen(pen.color(), 1.0)
    hair.setCosmetic(True)
    if pen.dashPattern():
        hair.setDashPattern([ratio * length for length in pen.dashPattern()])
    return hair


@lru_cache(maxsize=8)
def offsets(width: float) -> list[tuple[float, float]]:
    """Offsets of 1-pixel lines that together look `width` pixels wide in any direction."""
    if width <= 1:
        return [(0.0, 0.0)]
    radius = 0.5 * (width - 1)
    count = 3 if radius <= 0.5 else 6
    around = [2 * math.pi * (i + 0.25) / count for i in range(count)]
    ring = [(radius * math.cos(a), radius * math.sin(a)) for a in around]
    return ring if count == 3 else [(0.0, 0.0), *ring]
