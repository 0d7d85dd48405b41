"""From gestures on the plots to edits of the session and moves of the timeline."""

from __future__ import annotations

from time import monotonic

from PySide6.QtCore import QObject, QPointF, Qt, QTimer, Signal
from PySide6.QtGui import QMouseEvent, QWheelEvent

from faceedit_app.editing.session import EditSession
from faceedit_app.ui.curves.axes import zoomed_span
from faceedit_app.ui.curves.gestures import (
    Brush,
    CurveDrag,
    Pan,
    brush_at,
    press_curve,
    stepped_falloff,
    zoom_factor,
)
from faceedit_app.ui.curves.plot import CurvePlot
from faceedit_app.ui.curves.ruler import turn_wheel
from faceedit_app.ui.timeline import Timeline

# Seconds between two previews: a mouse can report a thousand moves a second, a screen shows 60.
PREVIEW_INTERVAL = 0.016
LEFT, MIDDLE, RIGHT = (
    Qt.MouseButton.LeftButton,
    Qt.MouseButton.MiddleButton,
    Qt.MouseButton.RightButton,
)


class Interaction(QObject):
    """What the mouse does on the eight plots.

    Signals:
        previewed(): the session shows another floating edit, or none any more.
        committed(): a gesture ended in one more undo step.
        changed(): the pointer or the drag are elsewhere; nothing in the session changed.
    """

    previewed = Signal()
    committed = Signal()
    changed = Signal()

    def __init__(self, timeline: Timeline, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._timeline = timeline
        self.session: EditSession | None = None
        self.drag: CurveDrag | None = None
        self.plot: CurvePlot | None = None  # that the pointer is on, or that is dragged
        self.focused: str | None = None
        self._pan: Pan | None = None
        self._pointer = QPointF()
        self._came_from = 0  # the playhead's frame before the drag
        self._last_preview = 0.0
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.timeout.connect(self._preview)
        timeline.falloff_changed.connect(self._falloff_changed)

    @property
    def is_dragging(self) -> bool:
        """Whether an edit is being dragged."""
        return self.drag is not None and self.drag.moving

    @property
    def hover_time(self) -> float | None:
        """Seconds of the frame under the pointer, or of the one that is dragged."""
        if self.drag is not None:
            return self.drag.time
        if self.plot is None or self.session is None or self._pan is not None:
            return None
        return self._timeline.snap(self.plot.current_scale.time_at(self._pointer.x()))

    @property
    def brush(self) -> Brush | None:
        """Where the drag acts, or a press now would."""
        if self.drag is not None:
            return self.drag.brush(self._timeline.falloff)
        if (time := self.hover_time) is None:
            return None
        return brush_at(time, self._timeline.selection, self._timeline.falloff)

    # --- the mouse (see plot.Mouse) --------------------------------------------------------

    def press(self, plot: CurvePlot, event: QMouseEvent) -> None:
        """Left begins an edit or a click, middle a pan; right drops a drag as Esc does."""
        if self.session is None or (self.drag is not None and event.button() != RIGHT):
            return
        self._enter(plot, event.position())
        if event.button() == LEFT:
            self._begin(plot, event.position())
        elif event.button() == MIDDLE:
            scale = plot.current_scale
            self._pan = Pan(event.position().x(), scale.view, scale.seconds_per_pixel)
            plot.viewport().setCursor(Qt.CursorShape.ClosedHandCursor)
        elif event.button() == RIGHT:
            self.cancel()

    def move(self, plot: CurvePlot, event: QMouseEvent) -> None:
        """Go on with the gesture, or only hover."""
        if self.session is None:
            return
        if self.drag is not None:
            self._drag_to(event)
            if self.is_dragging:
                self._preview_soon()
        elif self._pan is not None:
            self._timeline.show_range(*self._pan.moved(event.position().x()))
        else:
            self._enter(plot, event.position())
        self.changed.emit()

    def release(self, plot: CurvePlot, event: QMouseEvent) -> None:
        """Keep the edit, or take a press that never moved for a click."""
        if event.button() == MIDDLE and self._pan is not None:
            self._pan = None
            plot.viewport().setCursor(Qt.CursorShape.SizeVerCursor)
        elif event.button() == LEFT and self.drag is not None:
            self._drag_to(event)
            self._finish()
        if not plot.viewport().rect().contains(event.position().toPoint()):
            self.leave(plot)
        self.changed.emit()

    def wheel(self, plot: CurvePlot, event: QWheelEvent) -> None:
        """During a drag the falloff, else zoom and pan."""
        if self.session is None:
            return
        if self.drag is not None:
            notches = (event.angleDelta().y() or event.angleDelta().x()) / 120.0
            self._timeline.set_falloff(stepped_falloff(self._timeline.falloff, notches))
            return
        self._pointer = event.position()
        zooms_values = bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier)
        if not zooms_values:
            turn_wheel(self._timeline, plot.current_scale.time_at(self._pointer.x()), event)
        else:
            factor = zoom_factor(event.angleDelta().y() / 120.0)
            around = plot.current_scale.value_at(self._pointer.y())
            plot.show_span(zoomed_span(plot.span, factor, around))
            plot.span_chosen = True
        self.changed.emit()

    def leave(self, plot: CurvePlot) -> None:
        """The pointer went elsewhere."""
        if self.drag is None and self._pan is None and self.plot is plot:
            self.plot = None
            self.changed.emit()

    def cancel(self) -> None:
        """Drop the drag in progress: curves and playhead go back to where they were."""
        drag, self.drag = self.drag, None
        self._timer.stop()
        if drag is not None and drag.moving and self.session is not None:
            self.session.cancel()
            self._timeline.go_to_frame(self._came_from)
            self.previewed.emit()
        self.changed.emit()

    # --- the edit --------------------------------------------------------------------------

    def _enter(self, plot: CurvePlot, at: QPointF) -> None:
        self.plot, self._pointer = plot, at
        self.focused = plot.control.id

    def _begin(self, plot: CurvePlot, at: QPointF) -> None:
        scale = plot.current_scale
        time = self._timeline.snap(scale.time_at(at.x()))
        brush = brush_at(time, self._timeline.selection, self._timeline.falloff)
        self.drag = press_curve(plot.control.id, at.x(), at.y(), scale, time, brush)
        self.changed.emit()

    def _drag_to(self, event: QMouseEvent) -> None:
        assert self.drag is not None
        was_moving = self.drag.moving
        fine = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
        self._pointer = event.position()
        self.drag = self.drag.moved(self._pointer.x(), self._pointer.y(), fine)
        if self.drag.moving and not was_moving:
            self._came_from = self._timeline.frame
            # The face beside the curves must show the frame that is being changed.
            self._timeline.go_to_time(self.drag.time)

    def _finish(self) -> None:
        drag, session = self.drag, self.session
        assert drag is not None
        assert session is not None
        self._timer.stop()
        edit = drag.edit(self._timeline.falloff)
        if edit is not None:
            session.preview(edit)
            session.commit()
            self.drag = None
            self.committed.emit()
        elif drag.moving:
            self.cancel()
        else:
            self.drag = None
            if drag.is_click:
                self._timeline.go_to_time(drag.time)

    def _falloff_changed(self, _seconds: float) -> None:
        if self.is_dragging:
            self._preview_soon()

    def _preview_soon(self) -> None:
        """At most one preview per frame of the screen; the timer brings the last one."""
        if not self._timer.isActive():
            wait = self._last_preview + PREVIEW_INTERVAL - monotonic()
            self._timer.start(max(0, round(1000 * wait)))

    def _preview(self) -> None:
        if self.drag is not None and self.session is not None:
            self.session.preview(self.drag.edit(self._timeline.falloff))
            self._last_preview = monotonic()
            self.previewed.emit()
