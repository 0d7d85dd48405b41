"""The curves panel as a user meets it: a real mouse on real plots."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, QRect, Qt
from PySide6.QtGui import QFontMetricsF, QImage, QMouseEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLabel, QWidget
from pytestqt.qtbot import QtBot
from support.rigs import tiny_session

from faceedit_app.core.clip import Gap
from faceedit_app.core.controls import CONTROLS
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.session import EditSession
from faceedit_app.ui.curves import CurvesPanel, style
from faceedit_app.ui.curves.header import Layout
from faceedit_app.ui.curves.plot import CurvePlot
from faceedit_app.ui.state.timeline import Timeline
from faceedit_app.ui.state.tools import Tool

NONE, SHIFT, CTRL = (
    Qt.KeyboardModifier.NoModifier,
    Qt.KeyboardModifier.ShiftModifier,
    Qt.KeyboardModifier.ControlModifier,
)
LEFT, MIDDLE = Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton


def open_panel(qtbot: QtBot, session: EditSession) -> CurvesPanel:
    timeline = Timeline()
    panel = CurvesPanel(timeline)
    timeline.setParent(panel)
    qtbot.addWidget(panel)
    panel.resize(900, 700)
    panel.show()
    qtbot.waitExposed(panel)
    timeline.open(session.take.clip)
    panel.set_session(session)
    session.previewed.connect(panel.refresh)
    session.changed.connect(panel.refresh)
    QApplication.processEvents()
    return panel


@pytest.fixture
def panel(qtbot: QtBot) -> CurvesPanel:
    return open_panel(qtbot, tiny_session())


def session_of(panel: CurvesPanel) -> EditSession:
    assert panel.session is not None
    return panel.session


def place(plot: CurvePlot, seconds: float, y: int = 40) -> QPoint:
    return QPoint(round(plot.current_scale.x_of(seconds)), y)


def drag(
    widget: QWidget,
    start: QPoint,
    stop: QPoint,
    modifiers: Qt.KeyboardModifier = NONE,
    release: bool = True,
    button: Qt.MouseButton = LEFT,
    pause: int = 0,
) -> None:
    QTest.mouseMove(widget, start)
    QTest.mousePress(widget, button, modifiers, start)
    for i in range(1, 6):
        at = start + (stop - start) * i / 5
        QTest.mouseMove(widget, at) if modifiers == NONE else move_with(widget, at, modifiers)
        if pause:
            QTest.qWait(pause)
    if release:
        QTest.mouseRelease(widget, button, modifiers, stop)


def move_with(widget: QWidget, at: QPoint, modifiers: Qt.KeyboardModifier) -> None:
    """QTest moves the mouse without keys."""
    where = QPointF(widget.mapToGlobal(at))
    event = QMouseEvent(
        QEvent.Type.MouseMove, QPointF(at), where, Qt.MouseButton.NoButton, LEFT, modifiers
    )
    QApplication.sendEvent(widget, event)


def turn(
    widget: QWidget, at: QPoint, notches: float, modifiers: Qt.KeyboardModifier = NONE
) -> None:
    QApplication.sendEvent(
        widget,
        QWheelEvent(
            QPointF(at),
            QPointF(widget.mapToGlobal(at)),
            QPoint(),
            QPoint(0, round(120 * notches)),
            Qt.MouseButton.NoButton,
            modifiers,
            Qt.ScrollPhase.NoScrollPhase,
            False,
        ),
    )


# --- editing -------------------------------------------------------------------------------


@pytest.mark.parametrize("pause", [0, 20])
@pytest.mark.parametrize("index", [0, 2, 6])
def test_a_drag_is_one_edit_of_that_curve(panel: CurvesPanel, index: int, pause: int) -> None:
    panel.tooling.link(False)
    plot, session = panel.plots[index], session_of(panel)
    per_pixel = plot.current_scale.mm_per_pixel
    committed: list[int] = []
    session.changed.connect(lambda: committed.append(1))
    start = place(plot, 1.5)
    drag(plot, start, start + QPoint(4, -12), pause=pause)
    assert len(session.edits) == 1
    (edit,) = session.edits
    assert edit.controls == (CONTROLS[index].id,)
    assert edit.op is Op.OFFSET
    assert edit.value == pytest.approx(12 * per_pixel)
    assert edit.start == edit.end
    assert edit.start == pytest.approx(1.5, abs=0.02)
    assert edit.start in session.take.clip.times
    assert edit.falloff == panel.timeline.falloff
    assert committed == [1]
    assert panel.focused_control == CONTROLS[index].id
    assert not panel.is_dragging
    session.undo()
    assert session.edits == ()
    assert not session.can_undo


def test_the_curve_follows_while_it_is_dragged(panel: CurvesPanel, qtbot: QtBot) -> None:
    plot, session = panel.plots[0], session_of(panel)
    frame = session.take.clip.frame_at(2.1)
    before = float(session.asked[frame, 0])
    steps: list[float] = []
    session.previewed.connect(lambda: steps.append(float(session.asked[frame, 0])))
    start = place(plot, 2.1)
    drag(plot, start, start + QPoint(0, -20), release=False, pause=20)
    wanted = pytest.approx(before + 20 * plot.current_scale.mm_per_pixel, abs=0.01)
    qtbot.waitUntil(lambda: len(steps) >= 2 and steps[-1] == wanted)
    assert panel.is_dragging
    assert session.edits == ()
    assert steps == sorted(steps)
    # The playhead has gone where the face is changing.
    assert panel.timeline.frame == frame
    QTest.mouseRelease(plot, LEFT, NONE, start + QPoint(0, -20))


def test_many_moves_are_few_previews_and_the_last_counts(panel: CurvesPanel) -> None:
    plot, session = panel.plots[0], session_of(panel)
    steps: list[int] = []
    session.previewed.connect(lambda: steps.append(1))
    start = place(plot, 2.1)
    QTest.mousePress(plot, LEFT, NONE, start)
    for i in range(200):
        move_with(plot, start + QPoint(0, -(i % 30)), NONE)
    assert len(steps) == 0  # all in one turn of the event loop
    QTest.mouseRelease(plot, LEFT, NONE, start + QPoint(0, -25))
    assert session.edits[0].value == pytest.approx(25 * plot.current_scale.mm_per_pixel)


def test_shift_is_fine(panel: CurvesPanel) -> None:
    plot = panel.plots[0]
    start = place(plot, 1.5)
    drag(plot, start, start + QPoint(0, -20), SHIFT)
    (edit,) = session_of(panel).edits
    assert edit.value == pytest.approx(2 * plot.current_scale.mm_per_pixel)


def test_esc_drops_the_drag(panel: CurvesPanel) -> None:
    plot, session = panel.plots[0], session_of(panel)
    panel.timeline.go_to_frame(3)
    start = place(plot, 1.5)
    drag(plot, start, start + QPoint(0, -20), release=False, pause=20)
    assert panel.is_dragging
    QTest.keyClick(plot, Qt.Key.Key_Escape)
    assert not panel.is_dragging
    assert np.array_equal(session.asked, session.tracked)
    assert panel.timeline.frame == 3
    QTest.mouseRelease(plot, LEFT, NONE, start + QPoint(0, -20))
    assert session.edits == ()
    assert not session.can_undo


def test_the_wheel_sets_the_falloff_of_the_drag(panel: CurvesPanel, qtbot: QtBot) -> None:
    plot, session = panel.plots[0], session_of(panel)
    view = panel.timeline.view
    start = place(plot, 2.1)
    stop = start + QPoint(0, -20)
    drag(plot, start, stop, release=False, pause=20)
    beside = session.take.clip.frame_at(2.1 + 0.22)
    assert session.asked[beside, 0] == pytest.approx(session.tracked[beside, 0], abs=1e-4)
    turn(plot, stop, 2)
    qtbot.waitUntil(lambda: session.asked[beside, 0] > session.tracked[beside, 0] + 0.01)
    QTest.mouseRelease(plot, LEFT, NONE, stop)
    assert session.edits[0].falloff == panel.timeline.falloff == pytest.approx(0.288)
    assert panel.timeline.view == view


def test_inside_the_selection_a_drag_moves_all_of_it(panel: CurvesPanel) -> None:
    panel.timeline.select((1.0, 2.0))
    plot, session = panel.plots[7], session_of(panel)
    start = place(plot, 1.3)
    drag(plot, start, start + QPoint(0, 10))
    assert (session.edits[0].start, session.edits[0].end) == (1.0, 2.0)
    assert session.edits[0].value < 0
    start = place(plot, 3.0)
    drag(plot, start, start + QPoint(0, 10))
    assert session.edits[1].start == session.edits[1].end == pytest.approx(3.0, abs=0.02)


def test_the_value_axis_stretches_with_the_curve_and_gives_back(
    panel: CurvesPanel, qtbot: QtBot
) -> None:
    """The curve is never lost above the plot, and stays under a hand that is inside it."""
    plot, session = panel.plots[0], session_of(panel)
    span, per_pixel = plot.span, plot.current_scale.mm_per_pixel
    frame = int(session.tracked[:, 0].argmin())
    start = place(plot, float(session.take.clip.times[frame]))
    drag(plot, start, start + QPoint(0, -10), release=False, pause=20)
    assert plot.span == span

    def go_to(pixels: int) -> None:
        move_with(plot, start + QPoint(0, -pixels), NONE)
        wanted = float(session.tracked[frame, 0]) + pixels * per_pixel
        qtbot.waitUntil(lambda: session.asked[frame, 0] == pytest.approx(wanted))

    before = span[1]
    for pixels in range(40, 301, 20):
        go_to(pixels)
        asked = float(session.asked[frame, 0])
        assert 0 < plot.current_scale.y_of(asked) < plot.height()
        assert plot.span[1] >= before
        before = plot.span[1]
    assert before > span[1] + 10 * per_pixel
    go_to(10)
    assert plot.span == span
    go_to(300)
    stretched = plot.span
    QTest.mouseRelease(plot, LEFT, NONE, start + QPoint(0, -300))
    assert plot.span == pytest.approx(stretched, abs=2 * per_pixel)  # no jump at the end
    assert plot.span[1] > float(session.asked[:, 0].max())


def test_the_curves_that_move_along_take_their_axes_along(panel: CurvesPanel, qtbot: QtBot) -> None:
    left, right = panel.plots[2:4]
    still = panel.plots[6].span
    start = place(left, 1.5)
    drag(left, start, start + QPoint(0, -150), release=False, pause=20)
    session, frame = session_of(panel), panel.timeline.frame
    wanted = float(session.tracked[frame, 3]) + 150 * left.current_scale.mm_per_pixel * 0.2
    qtbot.waitUntil(lambda: session.asked[frame, 3] > wanted)
    assert 0 < right.current_scale.y_of(float(session.asked[frame, 3])) < right.height()
    assert panel.plots[6].span == still
    QTest.mouseRelease(left, LEFT, NONE, start + QPoint(0, -150))


def test_a_dropped_drag_leaves_the_value_axis_as_it_was(panel: CurvesPanel) -> None:
    plot = panel.plots[0]
    span = plot.span
    start = place(plot, 1.5)
    drag(plot, start, start + QPoint(0, -300), release=False, pause=20)
    assert plot.span[1] > span[1]
    QTest.keyClick(plot, Qt.Key.Key_Escape)
    assert plot.span == span
    QTest.mouseRelease(plot, LEFT, NONE, start + QPoint(0, -300))


def test_a_line_that_is_drawn_stays_under_the_pointer(panel: CurvesPanel) -> None:
    plot = panel.plots[0]
    span = plot.span
    panel.tooling.choose(Tool.DRAW)
    start = place(plot, 1.5)
    drag(plot, start, start + QPoint(20, -300), release=False, pause=20)
    assert panel.is_dragging
    assert plot.span == span
    QTest.mouseRelease(plot, LEFT, NONE, start + QPoint(20, -300))


@pytest.mark.parametrize("tool", [Tool.DRAW, Tool.SMOOTH, Tool.FLATTEN, Tool.RESTORE])
def test_the_face_follows_a_pen_and_a_brush(panel: CurvesPanel, qtbot: QtBot, tool: Tool) -> None:
    """And Esc puts the playhead back where it was."""
    plot, line = panel.plots[0], panel.timeline
    panel.tooling.choose(tool)
    line.go_to_frame(3)
    start, stop = place(plot, 1.5), place(plot, 2.5)
    drag(plot, start, stop, release=False, pause=20)
    qtbot.waitUntil(lambda: line.time == pytest.approx(2.5, abs=0.05))
    handle = plot._handle
    assert handle is not None
    assert handle.time == line.time
    QTest.keyClick(plot, Qt.Key.Key_Escape)
    assert line.frame == 3
    QTest.mouseRelease(plot, LEFT, NONE, stop)


def test_a_click_moves_the_playhead(panel: CurvesPanel) -> None:
    plot = panel.plots[3]
    QTest.mouseClick(plot, LEFT, NONE, place(plot, 2.5))
    assert panel.timeline.time == pytest.approx(2.5, abs=0.02)
    assert session_of(panel).edits == ()


def test_another_take_ends_the_drag(panel: CurvesPanel) -> None:
    plot, session = panel.plots[0], session_of(panel)
    start = place(plot, 1.5)
    drag(plot, start, start + QPoint(0, -20), release=False, pause=20)
    panel.set_session(None)
    assert not panel.is_dragging
    QTest.mouseRelease(plot, LEFT, NONE, start)
    assert session.edits == ()


# --- the time axis -------------------------------------------------------------------------


def test_the_ruler_scrubs_selects_and_clears(panel: CurvesPanel) -> None:
    ruler, timeline = panel.ruler, panel.timeline
    drag(ruler, QPoint(20, 10), QPoint(round(ruler.scale.x_of(3.0)), 10))
    assert timeline.time == pytest.approx(3.0, abs=0.02)
    start, stop = (QPoint(round(ruler.scale.x_of(t)), 10) for t in (2.0, 1.0))
    drag(ruler, start, stop, SHIFT)
    assert timeline.selection == pytest.approx((1.0, 2.0), abs=0.02)
    assert timeline.time == pytest.approx(3.0, abs=0.02)
    QTest.mouseDClick(ruler, LEFT, NONE, QPoint(30, 10))
    assert timeline.selection is None


def test_wheel_and_middle_button_move_about(panel: CurvesPanel) -> None:
    plot, timeline = panel.plots[1], panel.timeline
    at = place(plot, 1.0)
    turn(plot, at, 4)
    first, last = timeline.view
    assert last - first < 0.6 * timeline.duration
    assert plot.current_scale.time_at(at.x()) == pytest.approx(1.0, abs=0.02)
    turn(plot, at, -1, SHIFT)
    assert timeline.view[0] > first
    first = timeline.view[0]
    drag(plot, at, at + QPoint(50, 0), button=MIDDLE)
    assert timeline.view[0] < first
    assert session_of(panel).edits == ()
    for other in panel.plots:
        assert other.view == timeline.view


def test_ctrl_wheel_zooms_one_value_axis(panel: CurvesPanel) -> None:
    plot, other = panel.plots[1], panel.plots[2].span
    view, span = panel.timeline.view, plot.span
    turn(plot, place(plot, 1.0), 3, CTRL)
    assert plot.span[1] - plot.span[0] < 0.7 * (span[1] - span[0])
    assert panel.plots[2].span == other
    assert panel.timeline.view == view
    panel.refresh()
    assert plot.span[1] - plot.span[0] < 0.7 * (span[1] - span[0])  # the user's choice stays
    QTest.mouseDClick(panel.headers[1], LEFT)
    assert plot.span == span


def test_a_double_click_on_the_header_shows_small_movements_large(panel: CurvesPanel) -> None:
    plot = panel.plots[0]
    panel.timeline.show_range(0.9, 1.1)  # the mouth hardly moves here
    span = plot.span
    QTest.mouseDClick(panel.headers[0], LEFT)
    assert plot.span[1] - plot.span[0] < 0.8 * (span[1] - span[0])
    QTest.mouseDClick(panel.headers[0], LEFT)
    assert plot.span == span


def test_plots_and_ruler_stand_over_each_other(panel: CurvesPanel) -> None:
    left = panel.ruler.mapTo(panel, QPoint(0, 0)).x()
    for plot in panel.plots:
        assert plot.mapTo(panel, QPoint(0, 0)).x() == left
        assert plot.width() == panel.ruler.width()


# --- what it says and shows ----------------------------------------------------------------


def test_values_at_the_playhead(panel: CurvesPanel) -> None:
    session = session_of(panel)
    panel.timeline.go_to_frame(25)
    assert panel.headers[0].value == f"{session.achieved[25, 0]:.1f} mm"
    assert panel.headers[0].note == ""
    session.preview(Edit(("mouth_opening",), Op.OFFSET, 0.5, 0.5, 0.1, 500.0))
    panel.refresh()
    assert panel.headers[0].note.startswith("asked 5")  # no mouth opens half a metre


def test_names_do_not_hop_when_there_is_more_to_say(panel: CurvesPanel) -> None:
    """In playback through edits they would hop again and again."""
    header = panel.headers[1]
    header.resize(header.width(), 60)

    def name() -> QImage:
        return header.grab(QRect(0, 0, 120, 22)).toImage()

    header.show_value("44.2 mm")
    bare = name()
    header.show_value("44.2 mm", "tracked 45.6")
    assert name() == bare


def test_names_stand_alike_in_rows_that_differ_by_a_pixel(panel: CurvesPanel) -> None:
    """A height that eight rows share leaves some of them a pixel more."""
    header = panel.headers[1]
    tops = set()
    for height in range(style.ROW_HEIGHT - 4, style.ROW_HEIGHT + 6):  # with sound, they are lower
        header.setFixedHeight(height)
        layout = Layout.of(header, "Mouth width")
        assert layout.note is not None
        assert layout.note.top() + QFontMetricsF(layout.name_font).height() < height + 1
        tops.add(round(layout.name.top()))
    assert max(tops) - min(tops) <= 4


def test_what_reads_the_same_is_not_said_twice(panel: CurvesPanel) -> None:
    session = session_of(panel)
    panel.timeline.go_to_frame(25)
    asked = round(float(session.tracked[25, 0]) + 3.0, 1)
    session.asked[25, 0], session.achieved[25, 0] = asked - 0.04, asked + 0.04
    panel._show_state()
    assert panel.headers[0].note == ""
    session.achieved[25, 0] = asked + 0.06
    panel._show_state()
    assert panel.headers[0].note == f"asked {asked:.1f}"


def test_lines_that_coincide_are_drawn_once(panel: CurvesPanel) -> None:
    plot = panel.plots[0]
    assert plot.lines is not None
    assert len(plot.lines.face.x) > 100
    assert len(plot.lines.tracked.x) == 0
    assert len(plot.lines.asked.x) == 0
    start = place(plot, 1.5)
    drag(plot, start, start + QPoint(0, -20))
    assert 0 < len(plot.lines.asked.x) < 40
    assert 0 < len(plot.lines.tracked.x) < 40


def test_without_a_take_it_says_what_to_do(qtbot: QtBot) -> None:
    panel = CurvesPanel(Timeline())
    qtbot.addWidget(panel)
    panel.resize(600, 500)
    panel.show()
    labels = [label for label in panel.findChildren(QLabel) if label.isVisible()]
    assert [label.text() for label in labels] == ["Open a take (Ctrl+O) or drop a CSV here"]
    panel.refresh()
    panel.cancel_drag()


def test_the_keyboard_sees_where_it_is(panel: CurvesPanel) -> None:
    panel.activateWindow()
    panel.plots[2].setFocus(Qt.FocusReason.TabFocusReason)
    assert panel.focused_control == "left_corner"
    assert panel.plots[2].shows_focus
    panel.plots[4].setFocus(Qt.FocusReason.TabFocusReason)
    assert panel.focused_control == "upper_lip"
    assert not panel.plots[2].shows_focus
    panel.plots[5].setFocus(Qt.FocusReason.MouseFocusReason)
    assert not panel.plots[5].shows_focus


def test_names_for_screen_readers(panel: CurvesPanel) -> None:
    for control, plot, header in zip(CONTROLS, panel.plots, panel.headers, strict=True):
        assert plot.accessibleName() == f"{control.label} curve"
        assert plot.accessibleDescription() == control.hint
        assert header.accessibleName() == control.label
        assert control.hint in header.toolTip()
        assert header.accessibleDescription().startswith(header.value)
    assert "Dashed" in panel.legend.accessibleDescription()


def test_gaps_are_hatched(qtbot: QtBot) -> None:
    panel = open_panel(qtbot, tiny_session(gaps=(Gap(99, 40),)))
    plot = panel.plots[5]
    panel.timeline.go_to_frame(10)
    image = plot.grab().toImage()
    scale = plot.current_scale
    middle = 0.5 * (panel.session.take.clip.times[99] + panel.session.take.clip.times[100])
    x, y = round(scale.x_of(middle)), 8
    inside = {image.pixel(x + dx, y + dy) for dx in range(12) for dy in range(12)}
    beside = {image.pixel(round(scale.x_of(0.6)) + dx, y + dy) for dx in range(6) for dy in (0, 1)}
    assert len(inside) >= 2
    assert len(beside) == 1
    assert not beside & inside


def test_a_long_take_is_drawn_from_few_points(qtbot: QtBot) -> None:
    panel = open_panel(qtbot, tiny_session(frames=36_000))
    for plot in panel.plots:
        assert plot.lines is not None
        for line in (plot.lines.tracked, plot.lines.face, plot.lines.asked):
            assert len(line.x) <= 3 * plot.width() + 4
