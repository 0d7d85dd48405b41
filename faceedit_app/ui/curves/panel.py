"""The curves panel: legend, ruler and plots, in sync with timeline and session."""

from __future__ import annotations

from collections.abc import Callable

import pyqtgraph as pg
from PySide6.QtCore import QPoint, Qt, Signal
from PySide6.QtGui import QPalette
from PySide6.QtWidgets import QGridLayout, QLabel, QStackedWidget, QVBoxLayout, QWidget

from faceedit_app.core.controls import CONTROL_INDEX, CONTROLS
from faceedit_app.editing.edits.edit import Edit
from faceedit_app.editing.session import EditSession
from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.chosen_curves import ChosenCurves
from faceedit_app.ui.curves.gestures import CurveDrag
from faceedit_app.ui.curves.group_head import GroupHead
from faceedit_app.ui.curves.hand import FaceHand
from faceedit_app.ui.curves.header import Header
from faceedit_app.ui.curves.interaction import Interaction
from faceedit_app.ui.curves.legend import Legend
from faceedit_app.ui.curves.one_painting import OnePainting
from faceedit_app.ui.curves.plot import CurvePlot
from faceedit_app.ui.curves.range_bar import RangeBar
from faceedit_app.ui.curves.range_fields import RangeFields
from faceedit_app.ui.curves.readout import Readout
from faceedit_app.ui.curves.rows import CurveRows
from faceedit_app.ui.curves.ruler import Ruler
from faceedit_app.ui.curves.selection_mouse import SelectionMouse
from faceedit_app.ui.curves.shown import ShownCurves
from faceedit_app.ui.curves.tools import ScaleDrag
from faceedit_app.ui.curves.value_axes import ValueAxes
from faceedit_app.ui.curves.visible_curves import Lines, VisibleCurves
from faceedit_app.ui.state.gap_frames import edited_at
from faceedit_app.ui.state.timeline import Timeline
from faceedit_app.ui.state.tools import Tools

_EMPTY = "Open a take (Ctrl+O) or drop one here"


class CurvesPanel(QWidget):
    """The controls' curves on one time axis; dragging them edits the session.

    The page opens the clip on the timeline and sets the session; the panel shows both. Call
    `refresh` whenever the session changes, also during a drag.

    Signals:
        reshaped(): an edge of the selection is being dragged.
        reshape_ended(): it was released.
        edit_began(new): a drag began; whether it makes a new edit.
        edit_made(): it, or a key, made one.
        curve_menu_asked(place): a right click on a curve, which now has the focus.
        name_menu_asked(place): on its name.
        time_menu_asked(place): on the ruler, or on the bar under it.
    """

    reshaped = Signal()
    reshape_ended = Signal()
    edit_began = Signal(bool)
    edit_made = Signal()
    curve_menu_asked = Signal(QPoint)
    name_menu_asked = Signal(QPoint)
    time_menu_asked = Signal(QPoint)

    def __init__(
        self, timeline: Timeline, tools: Tools | None = None, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.timeline = timeline
        self.tools = tools or Tools(self)
        self.session: EditSession | None = None
        self._impossible: dict[str, str] | None = None  # why, by control; None: not shown yet
        self._width = 0.0  # seconds in view
        self._curves: VisibleCurves | None = None
        self._columns_read: list[int] = []  # of the curves that are not folded away
        self._columns = 0  # screen dots across a plot
        self._edges = SelectionMouse(timeline, self)
        self._mouse = Interaction(timeline, self.tools, self._edges, self)
        self.legend, self.ruler = Legend(), Ruler(timeline)
        self.range_bar = RangeBar(timeline, self._edges)
        self.fields = RangeFields(timeline, self._edges)
        self._pages = QStackedWidget(self)
        self._grid = self._build()
        self.plots = [CurvePlot(control, timeline, self._mouse) for control in CONTROLS]
        self.headers = [Header(control) for control in CONTROLS]
        self._chosen = ChosenCurves(self.headers, self._mouse, self._show_state)
        self.group_head = GroupHead()
        self._rows = CurveRows(self.headers, self.plots, self.group_head, self._grid.parentWidget())
        self._grid.addWidget(self._rows, 3, 0, 1, 3)
        self.shown = ShownCurves(self._rows, self.group_head, self)
        self.hand = FaceHand(self.plots, self._mouse, self.shown.reveal)
        self._axes = ValueAxes(self.plots)
        self._readout = Readout(
            self.headers,
            self.plots,
            self.ruler,
            self.legend,
            self._mouse,
            self._edges,
            timeline,
            self.tools,
        )
        strips: tuple[pg.GraphicsView, ...] = (self.ruler, self.range_bar, *self.plots)
        OnePainting(self, [strip.scene() for strip in strips])
        self._connect()
        self.set_session(None)

    def _build(self) -> QGridLayout:
        """Lay out all but the rows, from the outside in: what has a place is not moved again."""
        self.setObjectName("curves")
        self.setAccessibleName("Curves")
        self.setAutoFillBackground(True)
        colors = self.palette()
        colors.setColor(QPalette.ColorRole.Window, style.color(style.BACKGROUND))
        self.setPalette(colors)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._pages)
        empty = QLabel(_EMPTY, alignment=Qt.AlignmentFlag.AlignCenter, wordWrap=True)
        empty.setStyleSheet(f"color: {style.MUTED}; font-size: 15px;")
        content = QWidget()
        for page in (empty, content):
            self._pages.addWidget(page)
        grid = QGridLayout(content)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setHorizontalSpacing(0)
        grid.setVerticalSpacing(style.ROW_GAP)
        grid.addWidget(self.legend, 0, 0, 1, 3)
        grid.addWidget(self.fields, 1, 0, 2, 1)
        grid.addWidget(self.ruler, 1, 1)
        grid.addWidget(self.range_bar, 2, 1)
        grid.setRowStretch(3, 1)
        grid.setColumnStretch(1, 1)
        grid.setColumnMinimumWidth(2, style.RIGHT_MARGIN)
        return grid

    def _connect(self) -> None:
        for header, plot in zip(self.headers, self.plots, strict=True):
            plot.focus_changed.connect(lambda p=plot: self._focus_moved(p))
            plot.menu_asked.connect(lambda at, place, p=plot: self._ask_curve_menu(p, at, place))
            header.picked.connect(lambda add, p=plot: self._pick(p, add))
            header.close_up_asked.connect(lambda p=plot: self._axes.toggle_close_up(p))
            header.menu_asked.connect(lambda place, p=plot: self._ask_name_menu(p, place))
        for strip in (self.ruler, self.range_bar):
            strip.menu_asked.connect(self.time_menu_asked)
        self.shown.changed.connect(self._show_shown)
        self.plots[0].view.sigResized.connect(self._show_columns)
        self.timeline.view_changed.connect(self._show_view)
        self.timeline.playhead_moved.connect(self._mouse.forget_pointer)
        self.timeline.playhead_moved.connect(self._show_state)
        self.timeline.selection_changed.connect(self._show_state)
        self.timeline.falloff_changed.connect(self._show_state)
        self.tools.changed.connect(self._show_state)
        self._edges.moved.connect(self.reshaped)
        self._edges.ended.connect(self.reshape_ended)
        self._mouse.changed.connect(self._show_state)
        self._mouse.began.connect(self.edit_began)
        self._mouse.made.connect(self.edit_made)

    # --- for the page ----------------------------------------------------------------------

    @property
    def is_dragging(self) -> bool:
        """Whether an edit, or an edge of the selection, is being dragged."""
        return self._mouse.is_dragging or self._edges.is_dragging or self.range_bar.is_selecting

    @property
    def chosen_controls(self) -> tuple[str, ...]:
        """Ids of the curves chosen to be edited together; empty if none."""
        return self._chosen.controls

    @property
    def focused_control(self) -> str | None:
        """Id of the control whose curve was last hovered, clicked or reached with Tab."""
        return self._mouse.focused

    def focus_curve(self, index: int) -> None:
        """Focus a curve; if it is hidden, show it."""
        self.shown.reveal(self.plots[index].control.id)
        self._rows.ensureWidgetVisible(self.plots[index])
        self.plots[index].setFocus(Qt.FocusReason.ShortcutFocusReason)

    @property
    def _focused(self) -> CurvePlot:
        """The plot that commands act on: the first one if none had the focus yet."""
        return self.plots[CONTROL_INDEX.get(self._mouse.focused or "", 0)]

    def nudge(self, millimetres: float) -> None:
        """Move the focused curve, at the playhead or in the selection around it."""
        self._mouse.nudge(self._focused, millimetres)

    @property
    def is_focused_chosen(self) -> bool:
        """Whether the focused curve is chosen, to be edited together with others."""
        return self._focused.control.id in self._mouse.chosen

    def choose_focused(self) -> None:
        """Choose the focused curve, or remove it from the chosen ones."""
        self._chosen.toggle(self._focused.control.id)

    # --- which curves are shown --------------------------------------------------------------

    def show_only_focused(self) -> None:
        """Hide all curves but the focused one and those edited with it."""
        self.shown.show(self._mouse.edited_from(self._focused.control.id))

    def hide_focused(self) -> None:
        """Hide the focused curve, unless it is the last one."""
        shown = self.shown.controls
        self.shown.show(shown - {self._focused.control.id} or shown)

    def _show_shown(self) -> None:
        """Other rows are shown; hidden curves are no longer chosen, and folded ones not read."""
        if self._curves is not None and self._columns_read != self.shown.columns:
            self._read_curves()
            self._look()
            self._fit_axes()
        self._chosen.keep(self.shown.controls)

    def _read_curves(self) -> None:
        assert self.session is not None
        columns = self._columns_read = self.shown.columns
        self._curves = self._axes.curves = VisibleCurves(self.session, columns, self.timeline)

    @property
    def is_reshaping(self) -> bool:
        """Whether an edge of the selection is being moved."""
        return self._edges.is_changing

    def follow_chosen(self, chosen_edit: Callable[[], tuple[int, Edit] | None]) -> None:
        """Let drags change the chosen edit: row and edit, or None."""
        self._mouse.chosen_edit = chosen_edit

    def cover_legend(self, bar: QWidget) -> None:
        """Put a bar over the legend, where a second click does nothing once the bar is gone."""
        bar.setFixedHeight(style.LEGEND_HEIGHT)
        self._grid.addWidget(bar, 0, 0, 1, 3)

    def add_row(self, head: QWidget, strip: QWidget) -> None:
        """Add a strip on the time axis, under the curves."""
        row = self._grid.rowCount()
        self._grid.addWidget(head, row, 0)
        self._grid.addWidget(strip, row, 1)

    def show_character(self, shown: bool) -> None:
        """Explain the line of the user's character, or not."""
        self.legend.show_character(shown)

    def cancel_drag(self) -> None:
        """Cancel the drag in progress, if any."""
        self.range_bar.cancel()
        self._mouse.cancel()

    def set_session(self, session: EditSession | None) -> None:
        """Show another take, or none."""
        self._mouse.cancel()
        self._chosen.forget_click()
        self.session = self._mouse.session = session
        self._curves = self._axes.curves = None
        clip = session.take.clip if session is not None else None
        gaps = clip.gap_times if clip is not None else []
        self.ruler.show_clip(clip, gaps)
        self._pages.setCurrentIndex(0 if session is None else 1)
        for plot in self.plots:
            plot.show_gaps(gaps)
            plot.values_chosen = plot.close_up = False
        self._show_impossible_curves()
        if session is not None:
            self._read_curves()
            self.shown.note_edits(session.edits)
        self._width = 0.0
        self._show_view()

    def _show_impossible_curves(self) -> None:
        """Disable curves that the character or the take lacks, and show why."""
        why: dict[str, str] = {}
        if self.session is not None:
            why = {control: str(lack) for control, lack in self.session.lacks.items()}
            why |= dict.fromkeys(self.session.rig.missing_controls, self.session.rig.missing_note)
        if why == self._impossible:
            return
        self._impossible = why
        rig = self.session.rig if self.session is not None else None
        if rig is not None:
            self.shown.allow(rig.missing_controls, rig.missing_note)
        for plot, header in zip(self.plots, self.headers, strict=True):
            reason = why.get(plot.control.id, "")
            plot.show_missing(reason)
            header.show_missing(reason)

    def refresh(self) -> None:
        """Draw the session again; axes fit once no gesture is in progress."""
        if self._curves is not None and self.session is not None:
            self._curves.refresh()
            self.shown.note_edits(self.session.edits)
        self._show_impossible_curves()  # the engine, once loaded, knows what the take lacks
        self._show_lines()
        self._fit_axes()
        self._show_state()

    def fit_values(self) -> None:
        """Fit all value axes to what is in view, also those that the user set."""
        self._axes.release(self.plots)

    @property
    def is_focused_enlarged(self) -> bool:
        """Whether small movements of the focused curve are enlarged."""
        return self._focused.close_up

    def enlarge_focused(self) -> None:
        """Enlarge small movements of the focused curve, or stop doing so."""
        self._axes.toggle_close_up(self._focused)

    def mouse_lost(self) -> None:
        """The mouse is lost to another window: end drags and keep their result."""
        for part in (self._mouse, self.range_bar, self.ruler):
            part.mouse_lost()

    # --- keeping in step -------------------------------------------------------------------

    def _focus_moved(self, plot: CurvePlot) -> None:
        if plot.shows_focus:
            self._mouse.focused = plot.control.id
        if not plot.hasFocus():
            self._chosen.leave(plot.control.id)
        self._show_state()

    def _pick(self, plot: CurvePlot, add: bool) -> None:
        """A click on a name focuses its curve; with Ctrl it chooses the curve, or removes it."""
        self._chosen.pick(plot.control.id, add)
        self._take_focus(plot)

    def _ask_curve_menu(self, plot: CurvePlot, seconds: float, place: QPoint) -> None:
        """Make the menu act on this curve at this time, or on the selection around it."""
        self._take_focus(plot)
        selection = self._edges.span
        if selection is None or not selection.start <= seconds <= selection.end:
            self.timeline.go_to_time(seconds)
        self.curve_menu_asked.emit(place)

    def _ask_name_menu(self, plot: CurvePlot, place: QPoint) -> None:
        self._take_focus(plot)
        self.name_menu_asked.emit(place)

    def _take_focus(self, plot: CurvePlot) -> None:
        plot.setFocus(Qt.FocusReason.MouseFocusReason)
        self._mouse.focused = plot.control.id

    def _show_view(self) -> None:
        """Fit value axes after a zoom; a pan only extends them, so that curves do not shake."""
        first, last = self.timeline.view
        zoomed = abs((last - first) - self._width) > 1e-6
        self._width = last - first
        self._look()
        if self.is_dragging or not zoomed:
            self._axes.make_room()
        else:
            self._axes.fit()
        self._show_state()

    def _show_columns(self) -> None:
        """Show as many points as there are screen dots."""
        if self.plots[0].columns != self._columns:
            self._look()

    def _look(self) -> None:
        self._columns = self.plots[0].columns
        if self._curves is not None:
            self._curves.look(self.timeline.view, self._columns)
        self._show_lines()

    def _show_lines(self) -> None:
        curves = self._curves
        for i in self._columns_read:
            self.plots[i].show_lines(curves.lines(i) if curves is not None else Lines())

    def _fit_axes(self) -> None:
        """Fit the axes; during a preview or computation, only extend them."""
        session = self.session
        if session is None:
            return
        if self.is_dragging:
            self._follow_hand(session)
        elif session.is_previewing or not session.live.is_complete:
            self._axes.make_room()
        else:
            self._axes.fit()

    def _follow_hand(self, session: EditSession) -> None:
        """Keep a moved curve in sight; under a painting tool, the axis never changes."""
        drag = self._mouse.drag
        if isinstance(drag, CurveDrag | ScaleDrag):
            stop = self.timeline.stop_at(drag.time)
            both = (mm.tolist() for mm in edited_at(session, self.timeline, stop))
            self._axes.follow(zip(*both, strict=True), self._mouse.plot)

    def _show_state(self) -> None:
        if self.session is not None:
            self._readout.show(self.session, self._columns_read)
