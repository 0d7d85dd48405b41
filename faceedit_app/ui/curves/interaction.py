"""From gestures on the plots to edits of the session and moves of the timeline."""

from __future__ import annotations

from dataclasses import replace
from time import monotonic

from PySide6.QtCore import QObject, QPointF, Qt, QTimer, Signal
from PySide6.QtGui import QMouseEvent, QWheelEvent

from faceedit_app.core.regions import CONTROL_INDEX
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.session import EditSession
from faceedit_app.ui.curves.axes import zoomed_span
from faceedit_app.ui.curves.band import BandMouse
from faceedit_app.ui.curves.gestures import (
    Brush,
    Pan,
    brush_at,
    moved_together,
    stepped_falloff,
    zoom_factor,
)
from faceedit_app.ui.curves.plot import CurvePlot
from faceedit_app.ui.curves.ruler import turn_wheel
from faceedit_app.ui.curves.tools import Gesture, Press, begin
from faceedit_app.ui.state.timeline import Timeline
from faceedit_app.ui.state.tools import Tool, Tooling

# Seconds between two previews: a mouse can report a thousand moves a second, a screen shows 60.
PREVIEW_INTERVAL = 0.016
_NOTHING = 1e-9  # mm: nudges up and down that lead back
LEFT, MIDDLE, RIGHT = (
    Qt.MouseButton.LeftButton,
    Qt.MouseButton.MiddleButton,
    Qt.MouseButton.RightButton,
)
CURSORS = {
    Tool.MOVE: Qt.CursorShape.SizeVerCursor,
    Tool.SCALE: Qt.CursorShape.SizeVerCursor,
    Tool.DRAW: Qt.CursorShape.CrossCursor,
    Tool.SMOOTH: Qt.CursorShape.CrossCursor,
    Tool.FLATTEN: Qt.CursorShape.CrossCursor,
    Tool.RESTORE: Qt.CursorShape.CrossCursor,
}


class Interaction(QObject):
    """What the mouse does on the eight plots.

    Signals:
        changed(): the pointer or the drag are elsewhere; nothing in the session changed.
    """

    changed = Signal()

    def __init__(
        self, timeline: Timeline, tooling: Tooling, band: BandMouse, parent: QObject | None = None
    ) -> None:
        super().__init__(parent)
        self._timeline, self._tooling, self._band = timeline, tooling, band
        self.session: EditSession | None = None
        self.drag: Gesture | None = None
        self.plot: CurvePlot | None = None  # that the pointer is on, or that is dragged
        self.focused: str | None = None
        self.chosen: frozenset[str] = frozenset()  # curves that are edited together
        self._pan: Pan | None = None
        self._pointer = QPointF()
        self._came_from = 0  # the playhead's frame before the drag
        self._shown = 0.0  # seconds where the drag has put it
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
            return self._timeline.snap(self.drag.time)
        if self.plot is None or self.session is None or self._pan or self._band.is_dragging:
            return None
        return self._timeline.snap(self.plot.current_scale.time_at(self._pointer.x()))

    @property
    def brush(self) -> Brush | None:
        """Where the drag acts, or a press now would."""
        line = self._timeline
        if self.drag is not None:
            return self.drag.brush(line.falloff, line.falloff_out)
        if (time := self.hover_time) is None:
            return None
        return brush_at(time, line.selection, line.falloff, line.falloff_out)

    def edited_from(self, control: str, one_side: bool = False) -> tuple[str, ...]:
        """The curves that a gesture on one of them edits."""
        linked = self._tooling.linked and not one_side
        return moved_together(control, self.chosen, linked)

    # --- the mouse (see plot.Mouse) --------------------------------------------------------

    def press(self, plot: CurvePlot, event: QMouseEvent) -> None:
        """Left begins an edit or a click, middle a pan; right drops a drag as Esc does."""
        if self.session is None or (self._is_held and event.button() != RIGHT):
            return
        self._enter(plot, event.position())
        if event.button() == LEFT:
            if not self._band.press(plot.current_scale, event):
                self._begin(plot, event)
        elif event.button() == MIDDLE:
            scale = plot.current_scale
            self._pan = Pan(event.position().x(), scale.view, scale.seconds_per_pixel)
            plot.setCursor(Qt.CursorShape.ClosedHandCursor)
        elif event.button() == RIGHT:
            self.cancel()

    @property
    def _is_held(self) -> bool:
        return self.drag is not None or self._band.is_dragging

    def move(self, plot: CurvePlot, event: QMouseEvent) -> None:
        """Go on with the gesture, or only hover."""
        if self.session is None:
            return
        if not event.buttons():
            self.let_go()
        if self._band.is_dragging:
            self._band.move(plot.current_scale, event)
        elif self.drag is not None:
            self._drag_to(event)
            if self.is_dragging:
                self._preview_soon()  # and marks with it: all plots are painted once, not twice
                return
        elif self._pan is not None:
            self._timeline.show_range(*self._pan.moved(event.position().x()))
        else:
            self._enter(plot, event.position())
            self._show_cursor(plot)
        self.changed.emit()

    def release(self, plot: CurvePlot, event: QMouseEvent) -> None:
        """Keep the edit, or take a press that never moved for a click."""
        if event.button() == MIDDLE and self._pan is not None:
            self._pan = None
            self._show_cursor(plot)
        elif event.button() == LEFT and self._band.is_dragging:
            self._band.release()
        elif event.button() == LEFT and self.drag is not None:
            self._drag_to(event)
            self._finish()
        if not plot.rect().contains(event.position().toPoint()):
            self.leave(plot)
        self.changed.emit()

    def let_go(self) -> None:
        """The button went up where nobody saw it: keep what was dragged until then."""
        self._pan = None
        self._band.release()
        if self.drag is None:
            return
        if self.drag.moving:
            self._finish()
        else:
            self.cancel()

    def wheel(self, plot: CurvePlot, event: QWheelEvent) -> None:
        """During a drag the falloff, else zoom and pan."""
        if self.session is None:
            return
        if self._is_held:
            self._turn_falloff(plot, event)
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

    def _turn_falloff(self, plot: CurvePlot, event: QWheelEvent) -> None:
        """Both falloffs; with Alt (which some systems turn sideways) the pointer's side only."""
        notches = (event.angleDelta().y() or event.angleDelta().x()) / 120.0
        line, brush = self._timeline, self.brush
        fade_in = stepped_falloff(line.falloff, notches)
        fade_out = stepped_falloff(line.falloff_out, notches)
        if event.modifiers() & Qt.KeyboardModifier.AltModifier and brush is not None:
            left = plot.current_scale.time_at(event.position().x()) < (brush.start + brush.end) / 2
            fade_in = fade_in if left else line.falloff
            fade_out = line.falloff_out if left else fade_out
        line.set_falloffs(fade_in, fade_out)

    def leave(self, plot: CurvePlot) -> None:
        """The pointer went elsewhere."""
        if not self._is_held and self._pan is None and self.plot is plot:
            self.plot = None
            self.changed.emit()

    def cancel(self) -> None:
        """Drop the drag in progress: curves, band and playhead go back to where they were."""
        drag, self.drag = self.drag, None
        self._timer.stop()
        self._band.cancel()
        if drag is not None and drag.moving and self.session is not None:
            self.session.cancel()
            self._timeline.go_to_frame(self._came_from)
        self.changed.emit()

    # --- the edit --------------------------------------------------------------------------

    def _enter(self, plot: CurvePlot, at: QPointF) -> None:
        self.plot, self._pointer = plot, at
        self.focused = plot.control.id

    def _show_cursor(self, plot: CurvePlot) -> None:
        edge = self._band.edge_under(plot.current_scale, self._pointer.x())
        plot.setCursor(
            Qt.CursorShape.SizeHorCursor if edge is not None else CURSORS[self._tooling.tool]
        )

    def _begin(self, plot: CurvePlot, event: QMouseEvent) -> None:
        scale, at, line = plot.current_scale, event.position(), self._timeline
        time = line.snap(scale.time_at(at.x()))
        brush = brush_at(time, line.selection, line.falloff, line.falloff_out)
        one_side = bool(event.modifiers() & Qt.KeyboardModifier.AltModifier)
        controls = self.edited_from(plot.control.id, one_side)
        assert self.session is not None
        frame, column = self.session.take.clip.frame_at(time), CONTROL_INDEX[plot.control.id]
        press = Press(
            plot.control.id,
            controls,
            (at.x(), at.y()),
            time,
            scale,
            brush,
            float(self.session.asked[frame, column]),
            float(self.session.tracked[frame, column]),
        )
        self.drag = begin(self._tooling.tool, press, self._tooling.smooth)
        if self.drag.moving:
            self._show_edited_frame()
            self._preview_soon()
        self.changed.emit()

    # --- the keyboard ----------------------------------------------------------------------

    def nudge(self, plot: CurvePlot, millimetres: float) -> None:
        """Move a curve at the playhead, or the selection it stands in; nudges in a row are one."""
        session, line = self.session, self._timeline
        if session is None or self._is_held:
            return
        self.plot = plot
        self._pointer = QPointF(plot.current_scale.x_of(line.time), 0.0)
        brush = brush_at(line.time, line.selection, line.falloff, line.falloff_out)
        edit = brush.edit(self.edited_from(plot.control.id), Op.OFFSET, millimetres)
        edits, key = session.edits, ("nudge", replace(edit, value=0.0))
        if session.extends(key):
            edits, edit = edits[:-1], replace(edit, value=edits[-1].value + millimetres)
        session.put(edits if abs(edit.value) < _NOTHING else (*edits, edit), merge=key)

    def _drag_to(self, event: QMouseEvent) -> None:
        assert self.drag is not None
        was_moving = self.drag.moving
        fine = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
        snap = bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier)
        self._pointer = event.position()
        self.drag = self.drag.moved(self._pointer.x(), self._pointer.y(), fine, snap)
        if self.drag.moving and not was_moving:
            self._show_edited_frame()

    def _show_edited_frame(self) -> None:
        """The face beside the curves must show the frame that is being changed."""
        assert self.drag is not None
        self._came_from = self._timeline.frame
        self._shown = self.drag.time
        self._timeline.go_to_time(self._shown)

    def _edit(self) -> Edit | None:
        assert self.drag is not None
        return self.drag.edit(self._timeline.falloff, self._timeline.falloff_out)

    def _finish(self) -> None:
        drag, session = self.drag, self.session
        assert drag is not None
        assert session is not None
        self._timer.stop()
        edit = self._edit()
        if edit is not None:
            self.drag = None
            session.preview(edit)
            session.commit()
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
            if self.drag.time != self._shown:  # a pen or brush went on
                self._shown = self.drag.time
                self._timeline.go_to_time(self._shown)
            self.session.preview(self._edit())
            self._last_preview = monotonic()
