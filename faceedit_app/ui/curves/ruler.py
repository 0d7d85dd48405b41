"""The time ruler: seconds, frames at deep zoom, gaps, selection, playhead; scrubs and selects."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QEvent, QPointF, QRectF, Qt
from PySide6.QtGui import (
    QFontMetricsF,
    QHelpEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPolygonF,
    QWheelEvent,
)
from PySide6.QtWidgets import QToolTip, QWidget

from faceedit_app.core.clip import Clip
from faceedit_app.ui.curves import paint, style
from faceedit_app.ui.curves.axes import Scale, Tick, frame_ticks, time_ticks
from faceedit_app.ui.curves.gestures import (
    PAN_STEP,
    Pan,
    RulerDrag,
    WheelMeans,
    wheel_means,
    zoom_factor,
)
from faceedit_app.ui.state.clock import Unit, label
from faceedit_app.ui.state.timeline import Timeline

_FRAME_SPACING = 34.0  # pixels between two frame numbers
_FRAME_CLOSEST = 9.0  # pixels between two frames, below which they are not marked


class Ruler(QWidget):
    """Time axis over the plots, as wide as they are."""

    def __init__(self, timeline: Timeline, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._timeline = timeline
        self._clip: Clip | None = None
        self._marks, self._playhead = paint.Marks(), 0.0
        self._drag: RulerDrag | Pan | None = None
        timeline.clock.changed.connect(self.update)
        self.setFixedHeight(style.RULER_HEIGHT)
        self.setMouseTracking(True)  # a release that was lost shows by the next move
        self.setObjectName("ruler")
        self.setAccessibleName("Time ruler")
        self.setAccessibleDescription("Drag to scrub; Shift and drag to select a time range.")
        self.setToolTip("Drag to scrub. Shift+drag selects, double click clears the selection.")

    @property
    def scale(self) -> Scale:
        """How its pixels map to seconds."""
        return Scale(self.width(), self.height(), self._timeline.view, (0.0, 1.0))

    @property
    def is_selecting(self) -> bool:
        """Whether a selection is being dragged out."""
        return isinstance(self._drag, RulerDrag) and self._drag.selecting

    def show_clip(self, clip: Clip | None) -> None:
        """Show the frames of a clip."""
        self._clip, self._drag = clip, None
        self.update()

    def show_marks(self, marks: paint.Marks, playhead: float) -> None:
        """Show selection, gaps and brush, and the playhead (seconds)."""
        if (marks, playhead) != (self._marks, self._playhead):
            self._marks, self._playhead = marks, playhead
            self.update()

    # --- mouse -----------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Left scrubs or selects, middle pans."""
        x = event.position().x()
        seconds = self._timeline.snap(self.scale.time_at(x))
        if event.button() == Qt.MouseButton.MiddleButton:
            self._drag = Pan(x, self._timeline.view, self.scale.seconds_per_pixel)
        elif event.button() == Qt.MouseButton.LeftButton:
            shift = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
            self._drag = RulerDrag(seconds, shift)
            if not shift:
                self._timeline.go_to_time(seconds)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Go on with what the press began."""
        if not event.buttons() and event.type() == QEvent.Type.MouseMove:
            self.let_go()
        x = event.position().x()
        if isinstance(self._drag, Pan):
            self._timeline.show_range(*self._drag.moved(x))
        elif self._drag is not None:
            # Beyond the edges it stays in view, so that scrubbing does not turn pages.
            seconds = self._timeline.snap(self.scale.time_at(min(max(x, 0), self.width())))
            if self._drag.selecting:
                self._timeline.select(self._drag.selection(seconds))
            else:
                self._timeline.go_to_time(seconds)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """The end of it."""
        self.mouseMoveEvent(event)
        self.let_go()

    def let_go(self) -> None:
        """Keep what was dragged."""
        drag, self._drag = self._drag, None
        if isinstance(drag, RulerDrag) and drag.selecting:
            selection = self._timeline.selection
            if selection is not None and selection[0] == selection[1]:
                self._timeline.select(None)  # one frame is what the brush is for

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Select nothing."""
        if event.button() == Qt.MouseButton.LeftButton:
            self._timeline.select(None)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom about the pointer; Shift pans."""
        turn_wheel(self._timeline, self.scale.time_at(event.position().x()), event)
        event.accept()

    def event(self, event: QEvent) -> bool:
        """Over a gap the tooltip says what is missing."""
        if isinstance(event, QHelpEvent) and self._clip is not None:
            for gap, (first, last) in zip(self._clip.gaps, self._marks.gaps, strict=False):
                left, right = self.scale.x_of(first), self.scale.x_of(last)
                if left - 4 <= event.pos().x() <= right + 4:
                    plural = "s" if gap.missing > 1 else ""
                    text = f"{gap.missing} frame{plural} missing at {first:.2f} s"
                    QToolTip.showText(event.globalPos(), text, self)
                    return True
        return super().event(event)

    # --- painting --------------------------------------------------------------------------

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Bands, ticks, playhead."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), style.color(style.BACKGROUND))
        if self._clip is None:
            return
        scale = self.scale
        if self._marks.selection is not None:
            paint.draw_selection(painter, scale, self._marks.selection)
        if self._marks.brush is not None:
            paint.draw_brush(painter, scale, self._marks.brush, self._marks.alpha)
        paint.draw_gaps(painter, scale, self._marks.gaps)
        times = np.asarray(self._clip.times)
        frames = frame_ticks(times, scale.view, scale.width, _FRAME_SPACING, _FRAME_CLOSEST)
        self._paint_times(painter, scale, bool(frames))
        self._paint_frames(painter, scale, frames)
        self._paint_head(painter, scale)

    def _paint_times(self, painter: QPainter, scale: Scale, has_frames: bool) -> None:
        """Seconds; where frames are marked, those take the place of the ticks."""
        unit = self._timeline.clock.unit
        room = style.TIMECODE_SPACING if unit is Unit.TIMECODE else style.TIME_SPACING
        labelled, between = time_ticks(scale.view, scale.width, room)
        if not has_frames:
            painter.setPen(style.hairline(style.TICK))
            self._paint_ticks(painter, scale, between, 4)
            self._paint_ticks(painter, scale, [tick.at for tick in labelled], 9)
        if unit is not Unit.SECONDS and self._clip is not None:
            clip = self._clip
            labelled = [Tick(tick.at, label(clip, tick.at, unit)) for tick in labelled]
        self._paint_labels(painter, scale, labelled, 3.0, 0.88, style.LABEL)

    def _paint_frames(self, painter: QPainter, scale: Scale, ticks: list[Tick]) -> None:
        numbered = [tick for tick in ticks if tick.label]
        self._paint_labels(painter, scale, numbered, 0.5 * scale.height - 1, 0.74, style.MUTED)
        painter.setPen(style.hairline(style.TICK))
        self._paint_ticks(painter, scale, [tick.at for tick in ticks], 2)
        self._paint_ticks(painter, scale, [tick.at for tick in numbered], 4)

    def _paint_ticks(self, painter: QPainter, scale: Scale, at: list[float], length: int) -> None:
        for seconds in at:
            x = round(scale.x_of(seconds))
            painter.drawLine(QPointF(x, scale.height - length), QPointF(x, scale.height))

    def _paint_labels(
        self,
        painter: QPainter,
        scale: Scale,
        ticks: list[Tick],
        top: float,
        size: float,
        color: str,
    ) -> None:
        font = style.scaled_font(self, size)
        metrics = QFontMetricsF(font)
        painter.setFont(font)
        painter.setPen(style.color(color))
        for tick in ticks:
            width = metrics.horizontalAdvance(tick.label) + 2
            left = scale.x_of(tick.at) - 0.5 * width
            left = min(max(left, 0.0), scale.width - width)
            box = QRectF(left, top, width, metrics.height())
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, tick.label)

    def _paint_head(self, painter: QPainter, scale: Scale) -> None:
        """The playhead's handle: what one grabs to scrub."""
        paint.draw_playhead(painter, scale, self._playhead)
        x, bottom = round(scale.x_of(self._playhead)) + 0.5, scale.height
        head = QPolygonF([QPointF(x - 5, bottom - 10), QPointF(x + 5, bottom - 10)])
        head.append(QPointF(x + 5, bottom - 5))
        head.append(QPointF(x, bottom))
        head.append(QPointF(x - 5, bottom - 5))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, True)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(style.color(style.PLAYHEAD))
        painter.drawPolygon(head)


def turn_wheel(timeline: Timeline, seconds: float, event: QWheelEvent) -> WheelMeans:
    """Zoom or pan the time axis as a wheel event over `seconds` says; returns what it meant."""
    modifiers = event.modifiers()
    across, notches = event.angleDelta().x() / 120.0, event.angleDelta().y() / 120.0
    shift = bool(modifiers & Qt.KeyboardModifier.ShiftModifier)
    ctrl = bool(modifiers & Qt.KeyboardModifier.ControlModifier)
    means = wheel_means(dragging=False, shift=shift or abs(across) > abs(notches), ctrl=ctrl)
    if means is WheelMeans.PAN:
        # macOS and some mice turn the wheel sideways with Shift; both directions pan.
        turn = notches if abs(notches) > abs(across) else across
        first, last = timeline.view
        timeline.pan(-turn * PAN_STEP * (last - first))
    elif means is WheelMeans.ZOOM_TIME:
        timeline.zoom(zoom_factor(notches), seconds)
    return means
