"""What the curves panel says about the frame on screen and the pointer: values, marks and hint."""

from __future__ import annotations

from collections.abc import Sequence

from faceedit_app.editing.edits.describe import one_decimal
from faceedit_app.editing.session import EditSession
from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.gestures import span_at
from faceedit_app.ui.curves.header import Header
from faceedit_app.ui.curves.interaction import Interaction
from faceedit_app.ui.curves.legend import Legend
from faceedit_app.ui.curves.plot import CurvePlot, Handle, Marks
from faceedit_app.ui.curves.retime_drag import RetimeDrag
from faceedit_app.ui.curves.ruler import Ruler
from faceedit_app.ui.curves.selection_mouse import SelectionMouse
from faceedit_app.ui.curves.tools import Gesture
from faceedit_app.ui.curves.words import CHOSEN_HINT, IDLE_HINTS, length, note_on
from faceedit_app.ui.state.gap_frames import edited_at, values_at
from faceedit_app.ui.state.timeline import Timeline
from faceedit_app.ui.state.tools import Tools

_MOST_PINS = 4


class Readout:
    """Shows playhead, spans, handle, values and hint.

    Args:
        headers, plots: of the curves, in order.
        ruler, legend: of the panel.
        mouse, edges: what drags, and the selection's edges.
        timeline, tools: what all views share.
    """

    def __init__(
        self,
        headers: Sequence[Header],
        plots: Sequence[CurvePlot],
        ruler: Ruler,
        legend: Legend,
        mouse: Interaction,
        edges: SelectionMouse,
        timeline: Timeline,
        tools: Tools,
    ) -> None:
        self._headers, self._plots = headers, plots
        self._ruler, self._legend = ruler, legend
        self._mouse, self._edges = mouse, edges
        self._timeline, self._tools = timeline, tools

    def show(self, session: EditSession, columns: Sequence[int]) -> None:
        """Follow the session, the timeline and the pointer.

        Args:
            session: whose curves.
            columns: of the curves that are not folded away.
        """
        mouse, timeline = self._mouse, self._timeline
        # When another take opens, timeline and panel are updated one after the other.
        values = values_at(session.tracked, timeline), *edited_at(session, timeline)
        limits = session.limits
        dragging, span, selection = mouse.is_dragging, mouse.span, self._edges.span
        plain = Marks(selection, span if dragging else None, style.WEAK)
        lit = Marks(selection, span, style.STRONG if dragging else style.HOVER)
        edited = mouse.drag.controls if mouse.drag is not None and mouse.drag.moving else ()
        pins = self._pins()
        curves = zip(*(each.tolist() for each in values), strict=True)
        rows = list(zip(self._headers, self._plots, curves, strict=True))
        for i in columns:
            header, plot, (tracked, asked, face) = rows[i]
            here = plot is mouse.plot
            marks = lit if (plot.control.id in edited if dragging else here) else plain
            handle = self._handle(session, i) if here else None
            plot.show_marks(marks, timeline.time, handle, face)
            plot.show_pins(pins)
            low, high = limits[i]
            share = f"{100 * (face - low) / (high - low):.0f} %" if high > low else ""
            header.show_value(f"{one_decimal(face)} mm", note_on(tracked, asked, face), share)
            header.show_active(here or plot.shows_focus)
        fades = timeline.own_falloffs
        span = span or span_at(timeline.time, timeline.own_selection, *fades)
        self._ruler.show_marks(Marks(selection, span, style.STRONG), timeline.time)
        self._legend.show_hint(self._hint())

    def _pins(self) -> tuple[float, ...]:
        """Where the retime that is dragged or chosen shows what it was pinned at, seconds."""
        drag, chosen = self._mouse.drag, self._mouse.chosen_edit()
        if isinstance(drag, RetimeDrag) and drag.moving:
            return drag.goal
        pins = chosen[1].pins if chosen is not None else ()
        # Those of whole sentences would hide the curves.
        return tuple(now for _, now in pins) if len(pins) <= _MOST_PINS else ()

    def _handle(self, session: EditSession, control: int) -> Handle | None:
        """The dot under the pointer, on the curve as asked for, since a drag moves that."""
        time, drag = self._mouse.hover_time, self._mouse.drag
        if time is None:
            return None
        line = self._timeline
        asked, face = (float(mm[control]) for mm in edited_at(session, line, line.stop_at(time)))
        if drag is None or not drag.moving:
            return Handle(time, asked, held=drag is not None)
        words = self._amount(drag), f"asked {one_decimal(asked)} · face {one_decimal(face)}"
        return Handle(time, asked, True, words)

    def _amount(self, drag: Gesture) -> str:
        """How far a drag has gone, in the unit in which times are shown."""
        if not isinstance(drag, RetimeDrag):
            return drag.words
        amount = drag.words if drag.later is None else length(self._timeline, drag.later, "+")
        return f"{amount} · no more room" if drag.is_blocked else amount

    def _hint(self) -> str:
        mouse = self._mouse
        if mouse.is_dragging:
            falloff = length(self._timeline, self._timeline.falloff)
            return f"Falloff {falloff} (wheel) · Shift: fine · Ctrl: snap · Esc: cancel"
        if mouse.plot is not None:
            return mouse.plot.control.hint
        return CHOSEN_HINT if self._timeline.shows_edit else IDLE_HINTS[self._tools.tool]
