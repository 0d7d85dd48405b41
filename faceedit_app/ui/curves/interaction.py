"""Turns gestures on the plots into edits of the session and changes of the timeline."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from time import monotonic

from PySide6.QtCore import QObject, Qt, QTimer, Signal

from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.editing.edits.describe import describe
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.session import EditSession
from faceedit_app.ui.curves.chosen_change import ChosenChange, change_by
from faceedit_app.ui.curves.edges import GRASP
from faceedit_app.ui.curves.gestures import (
    CurveDrag,
    Pointer,
    Span,
    clamped,
    moved_together,
    stepped_falloff,
)
from faceedit_app.ui.curves.plot import CurvePlot
from faceedit_app.ui.curves.retime_drag import held_retime
from faceedit_app.ui.curves.selection_mouse import SelectionMouse
from faceedit_app.ui.curves.tools import Gesture, Press, begin, move
from faceedit_app.ui.state.gap_frames import edited_at, values_at
from faceedit_app.ui.state.timeline import Timeline
from faceedit_app.ui.state.tools import Tool, Tools

# Seconds between two previews: a mouse may report 1000 moves a second, a screen shows 60.
PREVIEW_INTERVAL = 0.016
_HAND = 0.01  # mm per unit of the hand's moves, in place of pixels
_NOTHING = 1e-9  # mm: nudges up and down that cancel out
CURSORS = {
    Tool.MOVE: Qt.CursorShape.SizeVerCursor,
    Tool.SCALE: Qt.CursorShape.SizeVerCursor,
    Tool.DRAW: Qt.CursorShape.CrossCursor,
    Tool.SMOOTH: Qt.CursorShape.CrossCursor,
    Tool.FLATTEN: Qt.CursorShape.CrossCursor,
    Tool.RESTORE: Qt.CursorShape.CrossCursor,
    Tool.RETIME: Qt.CursorShape.SizeHorCursor,
}


class Interaction(QObject):
    """Handles the left button on the plots.

    Attributes:
        chosen_edit: gives row and edit of the chosen edit, which a drag at its place changes.

    Signals:
        changed(): the pointer or the drag moved; the session did not change.
        began(new): a drag began; whether it makes a new edit.
        made(): it made one.
    """

    changed = Signal()
    began = Signal(bool)
    made = Signal()

    def __init__(
        self,
        timeline: Timeline,
        tools: Tools,
        edges: SelectionMouse,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._timeline, self._tools, self._edges = timeline, tools, edges
        self.session: EditSession | None = None
        self.drag: Gesture | None = None
        self.plot: CurvePlot | None = None  # under the pointer, or being dragged
        self.focused: str | None = None
        self.chosen: frozenset[str] = frozenset()  # ids of curves to edit together
        self.chosen_edit: Callable[[], tuple[int, Edit] | None] = lambda: None
        self._change: ChosenChange | None = None  # if the drag changes the chosen edit
        self._clicks = False  # a click is moving the playhead
        self._x = 0.0  # pixels of the pointer, in its plot
        self._came_from = 0.0  # seconds of the playhead before the drag
        self._shown = 0.0  # seconds to which the drag moved the playhead
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
        """Seconds of the frame under the pointer, or of the one being dragged."""
        if self.drag is not None:
            return self._timeline.snap(self.drag.time)
        if self.plot is None or self.session is None or self._edges.is_dragging:
            return None
        return self._timeline.snap(self.plot.current_scale.time_at(self._x))

    @property
    def span(self) -> Span | None:
        """The span of the drag, or of a press now."""
        line = self._timeline
        if self.drag is not None:
            return self.drag.span(line.falloff, line.falloff_out)
        time = self.hover_time
        return self._edges.span_at(time, self._grasp) if time is not None else None

    @property
    def _grasp(self) -> float:
        """Seconds by which the pointer may miss."""
        return GRASP * self.plot.current_scale.seconds_per_pixel if self.plot is not None else 0.0

    def edited_from(self, control: str, one_side: bool = False) -> tuple[str, ...]:
        """The curves that a gesture on one of them edits."""
        linked = self._tools.linked and not one_side
        return moved_together(control, self.chosen, linked)

    # --- the mouse (see plot.CurveMouse) ----------------------------------------------------

    @property
    def is_held(self) -> bool:
        """Whether a gesture is in progress."""
        return self.drag is not None or self._edges.is_dragging

    def press(self, plot: CurvePlot, pointer: Pointer) -> None:
        """Grab an edge of the selection, else begin an edit or a click."""
        if self.session is None or self.is_held:
            return
        self._enter(plot, pointer)
        edge = self._edges.edge_on_plot(plot.current_scale, pointer.x)
        if edge is not None and self._tools.tool is not Tool.RETIME:
            self._edges.grab(edge, plot.current_scale.time_at(pointer.x))
        else:
            self._begin(plot, pointer)

    def drag_to(self, plot: CurvePlot, pointer: Pointer) -> None:
        """Continue the gesture."""
        if self._edges.is_dragging:
            self._edges.move(plot.current_scale, pointer)
            self.changed.emit()
        elif self.drag is not None:
            self._drag_to(pointer)
            if self.is_dragging:
                self._preview_soon()  # and marks with it, so that plots are painted once, not twice
            else:
                self.changed.emit()

    def release(self, plot: CurvePlot, pointer: Pointer) -> None:
        """Commit the edit, or treat a press that never moved as a click."""
        if self._edges.is_dragging:
            self._edges.release()
        elif self.drag is not None:
            self._drag_to(pointer)
            self._finish()
        if not plot.view.rect().contains(pointer.x, pointer.y):
            self.leave(plot)
        self.changed.emit()

    def hover(self, plot: CurvePlot, pointer: Pointer) -> None:
        """Show what a press here would do."""
        if self.session is None:
            return
        self._enter(plot, pointer)
        edge = self._edges.edge_on_plot(plot.current_scale, pointer.x)
        plot.view.setCursor(
            Qt.CursorShape.SizeHorCursor if edge is not None else CURSORS[self._tools.tool]
        )
        self.changed.emit()

    def mouse_lost(self) -> None:
        """The release was lost: end the gesture and keep its result."""
        self._edges.release()
        if self.drag is None:
            return
        if self.drag.moving:
            self._finish()
        else:
            self.cancel()

    def turn(self, plot: CurvePlot, pointer: Pointer, notches: float) -> None:
        """Change both falloffs; with Alt (sideways on some systems) only the pointer's side."""
        line, span = self._timeline, self.span
        fade_in = stepped_falloff(line.falloff, notches)
        fade_out = stepped_falloff(line.falloff_out, notches)
        if pointer.one_side and span is not None:
            left = plot.current_scale.time_at(pointer.x) < (span.start + span.end) / 2
            fade_in = fade_in if left else line.falloff
            fade_out = line.falloff_out if left else fade_out
        line.set_falloffs(fade_in, fade_out)

    def forget_pointer(self) -> None:
        """Keys or playback moved the playhead: show no hover until the pointer moves again."""
        if not (self.is_held or self._clicks):
            self.plot = None

    def leave(self, plot: CurvePlot) -> None:
        """The pointer left the plot."""
        if not self.is_held and self.plot is plot:
            self.plot = None
            self.changed.emit()

    def cancel(self) -> None:
        """Cancel the drag in progress, and restore curves, edges and playhead."""
        drag, self.drag, self._change = self.drag, None, None
        self._timer.stop()
        self._edges.cancel()
        if drag is not None and drag.moving and self.session is not None:
            self.session.cancel()
            self._timeline.point_at(self._came_from)
        self.changed.emit()

    # --- the edit --------------------------------------------------------------------------

    def _enter(self, plot: CurvePlot, pointer: Pointer) -> None:
        self.plot, self._x = plot, pointer.x
        self.focused = plot.control.id

    def _begin(self, plot: CurvePlot, pointer: Pointer) -> None:
        time = self._timeline.snap(plot.current_scale.time_at(pointer.x))
        at = pointer.x, pointer.y
        press = self._press(plot, time, at, self._grasp, pointer.one_side)
        self.drag = begin(self._tools.tool, press, self._tools.smooth)
        self._change = self._change_by(press)
        if self.drag.moving:
            self._begins()
            self._preview_soon()
        self.changed.emit()

    def _press(
        self,
        plot: CurvePlot,
        time: float,
        at: tuple[float, float],
        slack: float,
        one_side: bool = False,
    ) -> Press:
        """What a gesture needs to know about the curve at a time."""
        session, control = self.session, plot.control.id
        assert session is not None
        line, column = self._timeline, CONTROL_INDEX[control]
        stop = line.stop_at(time)
        return Press(
            control,
            self.edited_from(control, one_side),
            at,
            time,
            plot.current_scale,
            self._edges.span_at(time, slack),
            float(edited_at(session, line, stop)[0][column]),
            float(values_at(session.tracked, line, stop)[column]),
            session.limits[column],
            session.take.clip,
            held_retime(self.chosen_edit(), time, slack),
        )

    # --- a hand on the face ------------------------------------------------------------------

    def grab(self, plot: CurvePlot, one_side: bool) -> bool:
        """Take a curve at the frame on screen; False if that is not possible now."""
        if self.session is None or self.is_held or not plot.isEnabled():
            return False
        line = self._timeline
        self.plot, self.focused = plot, plot.control.id
        self._x = plot.current_scale.x_of(line.time)
        press = self._press(plot, line.time, (self._x, 0.0), self._grasp, one_side)
        # With the Retime tool, a press on a curve would go on with the chosen retime.
        self._change = None if self._tools.tool is Tool.RETIME else self._change_by(press)
        self.drag = replace(move(press), mm_per_pixel=_HAND)
        self.changed.emit()
        return True

    def probe(self, millimetres: float) -> None:
        """Show what a pull would do, without beginning it."""
        if self.session is not None and isinstance(self.drag, CurveDrag):
            line = self._timeline
            span = Span(*self.drag.hold, *line.own_falloffs)
            self.session.preview(span.edit(self.drag.controls, Op.OFFSET, millimetres))

    def pull(self, millimetres: float, snap: bool) -> None:
        """Move the grabbed curve by this much since the grab."""
        if self.plot is not None and self.drag is not None:
            pointer = Pointer(self._x, -millimetres / _HAND, snap=snap)
            self.drag_to(self.plot, pointer)

    def let_go(self) -> None:
        """Keep the edit."""
        if self.drag is not None:
            self._finish()
            self.plot = None
            self.changed.emit()

    # --- the keyboard ----------------------------------------------------------------------

    def nudge(self, plot: CurvePlot, millimetres: float) -> None:
        """Move a curve at the playhead, or in the selection around it; a run is one step."""
        session, line = self.session, self._timeline
        if session is None or self.is_held:
            return
        self.plot, self._x = plot, plot.current_scale.x_of(line.time)
        press = self._press(plot, line.time, (0.0, 0.0), slack=0.0)
        millimetres = clamped(millimetres, move(press).limits)
        edit = press.span.edit(press.controls, Op.OFFSET, millimetres)
        edits, key = session.edits, ("nudge", replace(edit, value=0.0))
        if session.extends(key):
            edits, edit = edits[:-1], replace(edit, value=edits[-1].value + millimetres)
        is_nothing = abs(edit.value) < _NOTHING
        session.put(edits if is_nothing else (*edits, edit), merge=key)
        if not is_nothing:
            self.made.emit()

    def _drag_to(self, pointer: Pointer) -> None:
        assert self.drag is not None
        was_moving = self.drag.moving
        self._x = pointer.x
        self.drag = self.drag.moved(pointer.x, pointer.y, pointer.fine, pointer.snap)
        if self.drag.moving and not was_moving:
            self._begins()

    def _begins(self) -> None:
        """The press has become an edit."""
        self.began.emit(self._change is None)
        self._show_edited_frame()

    def _change_by(self, press: Press) -> ChosenChange | None:
        selection = self._timeline.selection
        return change_by(self._tools.tool, press, self.chosen_edit(), selection)

    def _preview_edit(self, edit: Edit | None) -> None:
        """Show a new edit, or the chosen one with what the drag adds to it."""
        session = self.session
        assert session is not None
        if self._change is None:
            session.preview(edit)
        else:
            falloffs = self._timeline.falloff, self._timeline.falloff_out
            session.preview_replace(self._change.row, self._change.edit(edit, falloffs))

    def _show_edited_frame(self) -> None:
        """Make the viewport show the frame being changed."""
        assert self.drag is not None
        self._came_from = self._timeline.time
        self._shown = self.drag.time
        self._timeline.point_at(self._shown)

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
            self._preview_edit(edit)
            self._commit()
        elif drag.moving:
            self.cancel()
        else:
            self.drag = None
            if drag.is_click:
                self._clicks = True
                self._timeline.point_at(drag.time)
                self._clicks = False

    def _commit(self) -> None:
        """Keep what the drag did, as one step."""
        session, change = self.session, self._change
        assert session is not None
        self._change = None
        if change is None:
            session.commit()
            self.made.emit()
        else:
            session.commit(f"Change {describe(change.old)}")

    def _falloff_changed(self, _seconds: float) -> None:
        if self.is_dragging:
            self._preview_soon()

    def _preview_soon(self) -> None:
        """Preview at most once per screen refresh; the timer delivers the last one."""
        if not self._timer.isActive():
            wait = self._last_preview + PREVIEW_INTERVAL - monotonic()
            self._timer.start(max(0, round(1000 * wait)))

    def _preview(self) -> None:
        if self.drag is not None and self.session is not None:
            if self.drag.time != self._shown:  # a pen or brush has moved on
                self._shown = self.drag.time
                self._timeline.point_at(self._shown)
            self._preview_edit(self._edit())
            self._last_preview = monotonic()
