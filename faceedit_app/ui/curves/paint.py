"""Painting for strips on the time axis that are not pyqtgraph plots, to match the plots."""

from __future__ import annotations

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QFont, QFontMetricsF, QLinearGradient, QPainter, QPen, QWheelEvent

from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.gestures import PAN_STEP, Span, WheelAction, wheel_action, zoom_factor
from faceedit_app.ui.curves.scale import Scale
from faceedit_app.ui.state.timeline import Timeline

_APART = 14.0  # pixels between a point and its numbers
_AROUND = 6.0  # pixels above and below numbers, together


def draw_selection(painter: QPainter, scale: Scale, span: Span) -> None:
    """Draw the selection, with its edges and falloffs."""
    first, last = (scale.x_of(t) for t in (span.start, span.end))
    painter.fillRect(
        QRectF(first, 0.0, max(last - first, 1.0), scale.height), style.color(style.SELECTION, 34)
    )
    for inner, outer in ((first, scale.x_of(span.ends[0])), (last, scale.x_of(span.ends[1]))):
        fade = QLinearGradient(inner, 0, outer, 0)
        fade.setColorAt(0.0, style.color(style.SELECTION, 26))
        fade.setColorAt(1.0, style.color(style.SELECTION, 6))
        rect = QRectF(min(inner, outer), 0.0, abs(outer - inner), scale.height)
        painter.fillRect(rect, QBrush(fade))
        painter.setPen(style.hairline(style.SELECTION, 190))
        painter.drawLine(QPointF(inner, 0), QPointF(inner, scale.height))
        painter.setPen(QPen(style.color(style.SELECTION, 90), 0, Qt.PenStyle.DashLine))
        painter.drawLine(QPointF(outer, 0), QPointF(outer, scale.height))


def draw_playhead(painter: QPainter, scale: Scale, seconds: float) -> None:
    """Draw the playhead, on whole pixels so that it is crisp."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
    painter.setPen(style.hairline(style.PLAYHEAD, 215))
    x = round(scale.x_of(seconds))
    painter.drawLine(QPointF(x, 0), QPointF(x, scale.height))


def fitting(lines: tuple[str, ...], scale: Scale, font: QFont) -> tuple[str, ...]:
    """Lines of numbers, in one line if the strip is too low for all of them."""
    height = QFontMetricsF(font).height() * len(lines) + _AROUND
    return (" · ".join(lines),) if height > scale.height else lines


def tag_box(at: QPointF, scale: Scale, lines: tuple[str, ...], font: QFont) -> QRectF:
    """The box for lines of numbers: right of a pixel, or left of it if there is no room."""
    metrics = QFontMetricsF(font)
    width = max(metrics.horizontalAdvance(line) for line in lines) + 12.0
    height = metrics.height() * len(lines) + _AROUND
    left = at.x() + _APART
    if left + width > scale.width:
        left = max(at.x() - _APART - width, 0.0)
    top = min(max(at.y() - height / 2, 2.0), max(scale.height - height - 2.0, 2.0))
    return QRectF(left, top, width, height)


def draw_tag(painter: QPainter, box: QRectF, lines: tuple[str, ...], font: QFont) -> None:
    """Draw lines of numbers on their own background."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, True)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(style.color(style.TAG, 225))
    painter.drawRoundedRect(box, 4.0, 4.0)
    painter.setPen(style.color(style.TEXT))
    painter.setFont(font)
    painter.drawText(box, Qt.AlignmentFlag.AlignCenter, "\n".join(lines))


def turn_wheel(timeline: Timeline, seconds: float, event: QWheelEvent) -> WheelAction:
    """Zoom or pan the time axis for a wheel event over `seconds`; returns which it was."""
    modifiers = event.modifiers()
    across, notches = event.angleDelta().x() / 120.0, event.angleDelta().y() / 120.0
    shift = bool(modifiers & Qt.KeyboardModifier.ShiftModifier)
    ctrl = bool(modifiers & Qt.KeyboardModifier.ControlModifier)
    means = wheel_action(dragging=False, shift=shift or abs(across) > abs(notches), ctrl=ctrl)
    if means is WheelAction.PAN:
        # macOS and some mice turn the wheel sideways with Shift; both directions pan.
        turn = notches if abs(notches) > abs(across) else across
        first, last = timeline.view
        timeline.pan(-turn * PAN_STEP * (last - first))
    elif means is WheelAction.ZOOM_TIME:
        timeline.zoom(zoom_factor(notches), seconds)
    return means
