"""The curves panel: legend, ruler and the eight plots, kept in step with timeline and session."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QPalette
from PySide6.QtWidgets import QGridLayout, QLabel, QSizePolicy, QStackedWidget, QVBoxLayout, QWidget

from faceedit_app.core.regions import CONTROL_IDS, CONTROL_INDEX, CONTROLS
from faceedit_app.editing.session import EditSession
from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.axes import (
    LEAST_SHARE,
    SMALLEST_SPAN,
    Span,
    fitted_span,
    grown_span,
    held_span,
)
from faceedit_app.ui.curves.band import BandMouse
from faceedit_app.ui.curves.gestures import CurveDrag, brush_at
from faceedit_app.ui.curves.header import Header
from faceedit_app.ui.curves.interaction import Interaction
from faceedit_app.ui.curves.legend import Legend
from faceedit_app.ui.curves.paint import Marks
from faceedit_app.ui.curves.plot import CurvePlot, Handle
from faceedit_app.ui.curves.range_bar import RangeBar
from faceedit_app.ui.curves.range_fields import RangeFields
from faceedit_app.ui.curves.ruler import Ruler
from faceedit_app.ui.curves.sight import Sight
from faceedit_app.ui.curves.tools import ScaleDrag
from faceedit_app.ui.state.timeline import Timeline
from faceedit_app.ui.state.tools import Tool, Tooling

_APART = 0.05  # mm between two lines from which on the header mentions it
_EMPTY = "Open a take (Ctrl+O) or drop a CSV here"
_IDLE_HINTS = {
    Tool.MOVE: "Drag a curve up or down to change the face",
    Tool.DRAW: "Draw a curve freehand",
    Tool.SMOOTH: "Paint over a curve to calm its shaking",
    Tool.SCALE: "Drag a curve up for larger movements, down for smaller ones",
    Tool.FLATTEN: "Paint over a curve to hold it where you pressed",
    Tool.RESTORE: "Paint over edits to go back to the take as tracked",
}


class CurvesPanel(QWidget):
    """Eight curves on one time axis; dragging them edits the session.

    The window opens the clip on the timeline and gives the session; the panel shows both. Call
    `refresh` when the session announces that it shows something else, in a drag as well.

    Signals:
        reshaped(): an edge of the selection is being dragged.
        reshape_ended(): it was let go of.
    """

    reshaped = Signal()
    reshape_ended = Signal()

    def __init__(
        self, timeline: Timeline, tooling: Tooling | None = None, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.timeline = timeline
        self.tooling = tooling or Tooling(self)
        self.session: EditSession | None = None
        self._gaps: tuple[tuple[float, float], ...] = ()
        self._width = 0.0  # seconds in view
        self._sight: Sight | None = None
        self._columns = 0  # of pixels
        self._resting: tuple[Span, ...] = ()  # value axes as they were before the drag
        self._band = BandMouse(timeline, self)
        self._mouse = Interaction(timeline, self.tooling, self._band, self)
        self.legend, self.ruler = Legend(), Ruler(timeline)
        self.range_bar, self.fields = (
            RangeBar(timeline, self._band),
            RangeFields(timeline, self._band),
        )
        self.plots = [CurvePlot(control, self._mouse) for control in CONTROLS]
        self.headers = [Header(control) for control in CONTROLS]
        self._pages = QStackedWidget()
        self._build()
        self._connect()
        self.set_session(None)

    def _build(self) -> None:
        self.setObjectName("curves")
        self.setAccessibleName("Curves")
        self.setAutoFillBackground(True)
        colors = self.palette()
        colors.setColor(QPalette.ColorRole.Window, style.color(style.BACKGROUND))
        self.setPalette(colors)
        empty = QLabel(_EMPTY)
        empty.setAlignment(Qt.AlignmentFlag.AlignCenter)
        empty.setWordWrap(True)
        empty.setStyleSheet(f"color: {style.MUTED}; font-size: 15px;")
        content = QWidget()
        grid = self._grid = QGridLayout(content)
        grid.setContentsMargins(0, 0, style.RIGHT_MARGIN, 0)
        grid.setHorizontalSpacing(0)
        grid.setVerticalSpacing(style.ROW_GAP)
        grid.addWidget(self.legend, 0, 0, 1, 2)
        grid.addWidget(self.fields, 1, 0, 2, 1)
        grid.addWidget(self.ruler, 1, 1)
        grid.addWidget(self.range_bar, 2, 1)
        for row, (header, plot) in enumerate(zip(self.headers, self.plots, strict=True), start=3):
            grid.addWidget(header, row, 0)
            grid.addWidget(plot, row, 1)
            grid.setRowStretch(row, 1)
            plot.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Ignored)
        grid.setColumnStretch(1, 1)
        for page in (empty, content):
            self._pages.addWidget(page)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._pages)

    def _connect(self) -> None:
        for header, plot in zip(self.headers, self.plots, strict=True):
            plot.focus_changed.connect(lambda p=plot: self._focus_moved(p))
            plot.scale_changed.connect(lambda h=header, p=plot: h.show_scale(p.current_scale))
            header.picked.connect(lambda add, p=plot: self._pick(p, add))
            header.close_up_asked.connect(lambda p=plot: self._toggle_close_up(p))
        self.plots[0].scale_changed.connect(self._show_columns)
        self.timeline.view_changed.connect(self._show_view)
        self.timeline.playhead_moved.connect(self._show_state)
        self.timeline.selection_changed.connect(self._show_state)
        self.timeline.falloff_changed.connect(self._show_state)
        self.tooling.changed.connect(self._show_state)
        self._band.moved.connect(self.reshaped)
        self._band.ended.connect(self.reshape_ended)
        self._mouse.changed.connect(self._show_state)

    # --- what the window uses --------------------------------------------------------------

    @property
    def is_dragging(self) -> bool:
        """Whether an edit, or an edge of the selection, is being dragged."""
        return self._mouse.is_dragging or self._band.is_dragging or self.range_bar.is_selecting

    @property
    def chosen_controls(self) -> tuple[str, ...]:
        """Ids of the curves that are edited together by name; empty for one at a time."""
        return tuple(c for c in CONTROL_IDS if c in self._mouse.chosen)

    @property
    def focused_control(self) -> str | None:
        """Id of the control whose curve was last hovered, clicked or reached by Tab."""
        return self._mouse.focused

    def focus_curve(self, index: int) -> None:
        """Give the keyboard to one of the eight curves."""
        self.plots[index].setFocus(Qt.FocusReason.ShortcutFocusReason)

    def nudge(self, millimetres: float) -> None:
        """Move the curve that has the focus, at the playhead or in the selection there."""
        index = CONTROL_INDEX.get(self._mouse.focused or "", 0)
        self._mouse.nudge(self.plots[index], millimetres)

    @property
    def is_reshaping(self) -> bool:
        """Whether an edge of the selection is being put elsewhere."""
        return self._band.is_changing

    def add_row(self, head: QWidget, strip: QWidget) -> None:
        """Put another strip on the time axis, under the curves."""
        row = self._grid.rowCount()
        self._grid.addWidget(head, row, 0)
        self._grid.addWidget(strip, row, 1)

    def cancel_drag(self) -> None:
        """Drop the drag in progress, if any."""
        self.range_bar.cancel()
        self._mouse.cancel()

    def set_session(self, session: EditSession | None) -> None:
        """Show another take, or none."""
        self._mouse.cancel()
        self.session = self._mouse.session = session
        self._sight = Sight(session) if session is not None else None
        clip = session.take.clip if session is not None else None
        self._gaps = ()
        if clip is not None:
            times = clip.times
            self._gaps = tuple(
                (float(times[gap.frame]), float(times[gap.frame + 1])) for gap in clip.gaps
            )
        self.ruler.show_clip(clip)
        self._pages.setCurrentIndex(0 if session is None else 1)
        for plot in self.plots:
            plot.span_chosen = plot.close_up = False
        self._width = 0.0
        self._show_view()

    def refresh(self) -> None:
        """The session's arrays changed: draw them, and make room for a curve that grew."""
        if self._sight is not None:
            self._sight.refresh()
        self._show_lines()
        self._make_room()
        self._show_state()

    def let_go(self) -> None:
        """The mouse is lost to another window: what was dragged until then is kept."""
        for part in (self._mouse, self.range_bar, self.ruler):
            part.let_go()

    # --- keeping in step -------------------------------------------------------------------

    def _focus_moved(self, plot: CurvePlot) -> None:
        if plot.shows_focus:
            self._mouse.focused = plot.control.id
        self._show_state()

    def _pick(self, plot: CurvePlot, add: bool) -> None:
        """A click on a name gives the focus; with Ctrl curves are chosen, or no longer."""
        plot.setFocus(Qt.FocusReason.MouseFocusReason)
        self._mouse.focused = plot.control.id
        self._mouse.chosen = self._mouse.chosen ^ {plot.control.id} if add else frozenset()
        for header in self.headers:
            header.show_chosen(header.control.id in self._mouse.chosen)
        self._show_state()

    def _show_view(self) -> None:
        """Value axes follow a zoom; a pan only makes them room, so that it does not shake."""
        first, last = self.timeline.view
        zoomed = abs((last - first) - self._width) > 1e-6
        self._width = last - first
        for plot in self.plots:
            plot.show_view(self.timeline.view)
        self._look()
        if zoomed:
            for index in range(len(self.plots)):
                self._fit(index)
        self._make_room()
        self.ruler.update()
        self._show_state()

    def _show_columns(self) -> None:
        """More or fewer pixels show more or fewer points."""
        if self.plots[0].columns != self._columns:
            self._look()

    def _look(self) -> None:
        self._columns = self.plots[0].columns
        if self._sight is not None:
            self._sight.look(self.timeline.view, self._columns)
        self._show_lines()

    def _show_lines(self) -> None:
        for i, plot in enumerate(self.plots):
            plot.show_lines(self._sight.lines(i) if self._sight is not None else None)

    def _fit(self, index: int) -> None:
        """Fit a value axis to what is in view, unless the user chose it."""
        plot, sight = self.plots[index], self._sight
        if sight is None or plot.span_chosen or self.is_dragging:
            return
        height = float(sight.high[index] - sight.low[index])
        least = SMALLEST_SPAN if plot.close_up else LEAST_SHARE * height
        plot.show_span(fitted_span(*sight.extent(index), least))

    def _toggle_close_up(self, plot: CurvePlot) -> None:
        """Fit a value axis as closely as it makes sense, or no longer."""
        plot.close_up = not (plot.close_up or plot.span_chosen)
        plot.span_chosen = False
        self._fit(self.plots.index(plot))

    def _make_room(self) -> None:
        """Extend value axes that a visible curve has left, unless the user chose them."""
        if self._sight is None:
            return
        if self.is_dragging:
            self._follow_hand()
            return
        resting, self._resting = self._resting, ()
        for index, plot in enumerate(self.plots):
            if plot.span_chosen:
                continue
            low, high = self._sight.extent(index)
            if resting and resting[index][0] <= low and high <= resting[index][1]:
                plot.show_span(resting[index])  # the drag was dropped
            plot.show_span(grown_span(plot.span, low, high))

    def _follow_hand(self) -> None:
        """Keep in sight what a drag moves up or down; while it is inside, axes stay as they are.

        Tools that paint stand where the pointer is: under them an axis never changes.
        """
        session, drag = self.session, self._mouse.drag
        if session is None or not isinstance(drag, CurveDrag | ScaleDrag):
            return
        self._resting = self._resting or tuple(plot.span for plot in self.plots)
        frame = session.take.clip.frame_at(drag.time)
        values = (array[frame].tolist() for array in (session.asked, session.achieved))
        for plot, span, asked, face in zip(self.plots, self._resting, *values, strict=True):
            if plot.span_chosen:
                continue
            span = held_span(span, asked)
            if plot is not self._mouse.plot:  # no hand is there that must not lose its curve
                span = held_span(span, face)
            plot.show_span(span)

    def _show_state(self) -> None:
        """Playhead, bands, handle, values and hint."""
        session, mouse, timeline = self.session, self._mouse, self.timeline
        if session is None:
            return
        # A window that changes take tells timeline and panel one after the other.
        frame = min(timeline.frame, len(session.tracked) - 1)
        arrays = session.tracked, session.asked, session.achieved
        values = zip(*(array[frame].tolist() for array in arrays), strict=True)
        dragging, brush, band = mouse.is_dragging, mouse.brush, self._band.band
        plain = Marks(band, self._gaps, brush if dragging else None, style.WEAK)
        lit = Marks(band, self._gaps, brush, style.STRONG if dragging else style.HOVER)
        edited = mouse.drag.controls if mouse.drag is not None and mouse.drag.moving else ()
        rows = zip(self.headers, self.plots, values, strict=True)
        for i, (header, plot, (tracked, asked, face)) in enumerate(rows):
            here = plot is mouse.plot
            marks = lit if (plot.control.id in edited if dragging else here) else plain
            handle = self._handle(session, i) if here else None
            plot.show_marks(marks, timeline.time, handle, face)
            header.show_value(f"{face:.1f} mm", _note(tracked, asked, face))
            header.show_active(here or plot.shows_focus)
        fades = timeline.falloff, timeline.falloff_out
        brush = brush or brush_at(timeline.time, timeline.selection, *fades)
        marks = Marks(band, self._gaps, brush, style.STRONG)
        self.ruler.show_marks(marks, timeline.time)
        self.legend.show_hint(self._hint())

    def _handle(self, session: EditSession, control: int) -> Handle | None:
        """The dot under the pointer: on what was asked for, since that is what a drag moves."""
        time, drag = self._mouse.hover_time, self._mouse.drag
        if time is None:
            return None
        frame = session.take.clip.frame_at(time)
        asked = float(session.asked[frame, control])
        if drag is None or not drag.moving:
            return Handle(time, asked, held=drag is not None)
        face = float(session.achieved[frame, control])
        words = drag.words, f"asked {asked:.1f} · face {face:.1f}"
        return Handle(time, asked, True, words)

    def _hint(self) -> str:
        mouse = self._mouse
        if mouse.is_dragging:
            seconds = self.timeline.falloff
            return f"Falloff {seconds:.2f} s (wheel) · Shift fine · Ctrl snap · Esc cancel"
        if mouse.plot is not None:
            return mouse.plot.control.hint
        return _IDLE_HINTS[self.tooling.tool]


def _note(tracked: float, asked: float, face: float) -> str:
    """What else to know about a value: that the face fell short, or moved along unasked."""
    if abs(asked - tracked) > _APART:
        return f"asked {asked:.1f}" if _read_apart(asked, face) else ""
    return f"tracked {tracked:.1f}" if _read_apart(tracked, face) else ""


def _read_apart(one: float, other: float) -> bool:
    """Whether two values differ, and can be seen to in one decimal."""
    return abs(one - other) > _APART and f"{one:.1f}" != f"{other:.1f}"
