"""What ruler and plots draw alike: bands, gaps, the playhead."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QFont, QFontMetricsF, QLinearGradient, QPainter, QPen

from faceedit_app.editing.edits.edit import Op
from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.axes import Scale, Span
from faceedit_app.ui.curves.gestures import Brush

LEAST_GAP = 3.0  # pixels: a lost frame must not vanish when the whole take is in view


@dataclass(frozen=True)
class Marks:
    """What stands on the time axis besides curves and playhead. Times are seconds.

    Attributes:
        selection: the selected range with its falloffs, if any.
        gaps: from the last frame before to the first after each gap.
        brush: where an edit would act or acts, if it is to be shown.
        alpha: how strongly the brush is drawn, 0..255.
    """

    selection: Brush | None = None
    gaps: tuple[Span, ...] = ()
    brush: Brush | None = None
    alpha: int = style.HOVER


def draw_brush(painter: QPainter, scale: Scale, brush: Brush, alpha: int) -> None:
    """The reach of an edit as a band that fades as the edit itself does."""
    first, last = (scale.x_of(t) for t in brush.reach)
    first, last = first - 0.5, last + 0.5
    rect = QRectF(first, 0.0, last - first, scale.height)
    if brush.falloff <= 0 and brush.fade_out <= 0:
        painter.fillRect(rect, style.color(style.BAND, alpha))
        return
    fade = QLinearGradient(first, 0, last, 0)
    for stop, strength in _stops(brush):
        fade.setColorAt(stop, style.color(style.BAND, round(alpha * (0.12 + 0.88 * strength))))
    painter.fillRect(rect, QBrush(fade))
    painter.setPen(style.hairline(style.BAND, min(2 * alpha, 140)))
    for x in (scale.x_of(brush.reach[0]), scale.x_of(brush.reach[1])):
        painter.drawLine(QPointF(x, 0), QPointF(x, scale.height))


@lru_cache(maxsize=16)
def _stops(brush: Brush) -> list[tuple[float, float]]:
    """(position 0..1, strength 0..1) along the reach of a brush."""
    # The edit's own mask, so that the picture cannot tell another story than the result.
    mask = brush.edit(("mouth_opening",), Op.OFFSET)
    first, last = brush.reach
    ramp = np.linspace(0.0, 1.0, 7)
    times = np.concatenate([first + ramp * brush.falloff, brush.end + ramp * brush.fade_out])
    places = (times - first) / (last - first)
    return [(float(p), float(s)) for p, s in zip(places, mask.mask(times), strict=True)]


def draw_selection(painter: QPainter, scale: Scale, band: Brush) -> None:
    """The selected range, with edges that can be seen on any curve, and its falloffs."""
    first, last = (scale.x_of(t) for t in (band.start, band.end))
    painter.fillRect(
        QRectF(first, 0.0, max(last - first, 1.0), scale.height), style.color(style.SELECTION, 34)
    )
    for inner, outer in ((first, scale.x_of(band.reach[0])), (last, scale.x_of(band.reach[1]))):
        fade = QLinearGradient(inner, 0, outer, 0)
        fade.setColorAt(0.0, style.color(style.SELECTION, 26))
        fade.setColorAt(1.0, style.color(style.SELECTION, 6))
        rect = QRectF(min(inner, outer), 0.0, abs(outer - inner), scale.height)
        painter.fillRect(rect, QBrush(fade))
        painter.setPen(style.hairline(style.SELECTION, 190))
        painter.drawLine(QPointF(inner, 0), QPointF(inner, scale.height))
        painter.setPen(QPen(style.color(style.SELECTION, 90), 0, Qt.PenStyle.DashLine))
        painter.drawLine(QPointF(outer, 0), QPointF(outer, scale.height))


def draw_gaps(painter: QPainter, scale: Scale, gaps: tuple[Span, ...], alpha: int = 150) -> None:
    """Hatch what the recording lost."""
    hatch = QBrush(style.color(style.GAP, alpha), Qt.BrushStyle.BDiagPattern)
    for first, last in gaps:
        if last < scale.view[0] or first > scale.view[1]:
            continue
        left, right = scale.x_of(first), scale.x_of(last)
        middle, width = 0.5 * (left + right), max(right - left, LEAST_GAP)
        rect = QRectF(middle - 0.5 * width, 0.0, width, scale.height)
        painter.fillRect(rect, style.color(style.GAP, alpha // 6))
        painter.fillRect(rect, hatch)


def draw_playhead(painter: QPainter, scale: Scale, seconds: float) -> None:
    """The line of the frame on screen, on whole pixels so that it is crisp."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
    painter.setPen(style.hairline(style.PLAYHEAD, 215))
    x = round(scale.x_of(seconds))
    painter.drawLine(QPointF(x, 0), QPointF(x, scale.height))


def draw_dot(painter: QPainter, at: QPointF, radius: float, fill: str, edge: str) -> None:
    """A round handle or marker."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, True)
    painter.setPen(QPen(style.color(edge), 1.5))
    painter.setBrush(style.color(fill))
    painter.drawEllipse(at, radius, radius)


def draw_tag(
    painter: QPainter, scale: Scale, beside: QPointF, lines: tuple[str, ...], font: QFont
) -> None:
    """Numbers beside the pointer, kept inside the plot."""
    metrics = QFontMetricsF(font)
    width = max(metrics.horizontalAdvance(line) for line in lines) + 12
    height = metrics.height() * len(lines) + 6
    left = beside.x() + 14
    if left + width > scale.width:
        left = beside.x() - 14 - width
    top = min(max(beside.y() - height / 2, 2.0), max(scale.height - height - 2, 2.0))
    rect = QRectF(left, top, width, height)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, True)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(style.color(style.TAG, 225))
    painter.drawRoundedRect(rect, 4, 4)
    painter.setPen(style.color(style.TEXT))
    painter.setFont(font)
    text = "\n".join(lines)
    painter.drawText(rect, Qt.AlignmentFlag.AlignCenter, text)
