"""Drags on the curves: what they edit, and what follows them."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot
from support.curves import (
    ALT,
    CTRL,
    LEFT,
    NONE,
    SHIFT,
    drag,
    let_go,
    move_with,
    place,
    session_of,
    surface,
    turn,
)

from faceedit_app.core.controls import CONTROLS
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.ui.curves import CurvesPanel
from faceedit_app.ui.state.tools import Tool

# --- editing -------------------------------------------------------------------------------


@pytest.mark.parametrize("previews", [False, True])
@pytest.mark.parametrize("index", [0, 2, 6])
def test_a_drag_is_one_edit_of_that_curve(panel: CurvesPanel, index: int, previews: bool) -> None:
    panel.tools.link(False)
    plot, session = panel.plots[index], session_of(panel)
    per_pixel = plot.current_scale.mm_per_pixel
    committed: list[int] = []
    session.changed.connect(lambda: committed.append(1))
    start = place(plot, 1.5)
    drag(plot, start, start + QPoint(4, -12), previews=previews)
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
    drag(plot, start, start + QPoint(0, -20), release=False, previews=True)
    wanted = pytest.approx(before + 20 * plot.current_scale.mm_per_pixel, abs=0.01)
    qtbot.waitUntil(lambda: len(steps) >= 2 and steps[-1] == wanted)
    assert panel.is_dragging
    assert session.edits == ()
    assert steps == sorted(steps)
    # The playhead has gone where the face is changing.
    assert panel.timeline.frame == frame
    let_go(plot, start + QPoint(0, -20))


def test_many_moves_are_few_previews_and_the_last_counts(panel: CurvesPanel) -> None:
    plot, session = panel.plots[0], session_of(panel)
    steps: list[int] = []
    session.previewed.connect(lambda: steps.append(1))
    start, per_pixel = place(plot, 2.1), plot.current_scale.mm_per_pixel
    QTest.mousePress(surface(plot), LEFT, NONE, start)
    for i in range(200):
        move_with(plot, start + QPoint(0, -(i % 30)), NONE)
    assert len(steps) == 0  # all in one turn of the event loop
    let_go(plot, start + QPoint(0, -25))
    assert session.edits[0].value == pytest.approx(25 * per_pixel)


@pytest.mark.parametrize(("below", "index"), [(0, 1), (1, 2)])
def test_a_press_between_two_plots_is_one_on_the_nearer(
    panel: CurvesPanel, below: int, index: int
) -> None:
    panel.tools.link(False)
    plot, per_pixel = panel.plots[1], panel.plots[index].current_scale.mm_per_pixel
    content = plot.parentWidget()
    at = plot.mapToParent(QPoint(place(plot, 1.5).x(), plot.height() + below))
    assert content.childAt(at) is None, "a line is between the two"
    QTest.mousePress(content, LEFT, NONE, at)
    move_with(content, at - QPoint(0, 5), NONE)
    QTest.mouseRelease(content, LEFT, NONE, at - QPoint(0, 12))
    (edit,) = session_of(panel).edits
    assert edit.controls == (CONTROLS[index].id,)
    assert edit.value == pytest.approx(12 * per_pixel)


def test_shift_is_fine(panel: CurvesPanel) -> None:
    plot = panel.plots[0]
    start, per_pixel = place(plot, 1.5), plot.current_scale.mm_per_pixel
    drag(plot, start, start + QPoint(0, -20), SHIFT)
    (edit,) = session_of(panel).edits
    assert edit.value == pytest.approx(2 * per_pixel)


def test_esc_drops_the_drag(panel: CurvesPanel) -> None:
    plot, session = panel.plots[0], session_of(panel)
    panel.timeline.go_to_frame(3)
    start = place(plot, 1.5)
    drag(plot, start, start + QPoint(0, -20), release=False, previews=True)
    assert panel.is_dragging
    QTest.keyClick(plot, Qt.Key.Key_Escape)
    assert not panel.is_dragging
    assert np.array_equal(session.asked, session.tracked)
    assert panel.timeline.frame == 3
    let_go(plot, start + QPoint(0, -20))
    assert session.edits == ()
    assert not session.can_undo


def test_the_wheel_sets_the_falloff_of_the_drag(panel: CurvesPanel, qtbot: QtBot) -> None:
    plot, session = panel.plots[0], session_of(panel)
    view = panel.timeline.view
    start = place(plot, 2.1)
    stop = start + QPoint(0, -20)
    drag(plot, start, stop, release=False, previews=True)
    beside = session.take.clip.frame_at(2.1 + 0.22)
    assert session.asked[beside, 0] == pytest.approx(session.tracked[beside, 0], abs=1e-4)
    turn(plot, stop, 2)
    qtbot.waitUntil(lambda: session.asked[beside, 0] > session.tracked[beside, 0] + 0.01)
    let_go(plot, stop)
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
    values, per_pixel = plot.values, plot.current_scale.mm_per_pixel
    frame = int(session.tracked[:, 0].argmin())
    start = place(plot, float(session.take.clip.times[frame]))
    drag(plot, start, start + QPoint(0, -10), release=False, previews=True)
    assert plot.values == values

    def go_to(pixels: int) -> None:
        move_with(plot, start + QPoint(0, -pixels))
        wanted = float(session.tracked[frame, 0]) + pixels * per_pixel
        qtbot.waitUntil(lambda: session.asked[frame, 0] == pytest.approx(wanted))

    before = values[1]
    for pixels in range(40, 161, 20):
        go_to(pixels)
        asked = float(session.asked[frame, 0])
        assert 0 < plot.current_scale.y_of(asked) < plot.height()
        assert plot.values[1] >= before
        before = plot.values[1]
    assert before > values[1] + 10 * per_pixel
    go_to(10)
    assert plot.values == values
    let_go(plot, start + QPoint(0, -160))
    assert plot.values[1] > float(session.asked[:, 0].max())


def test_the_axis_fits_again_after_each_gesture(panel: CurvesPanel) -> None:
    """So that the same drag is the same number of millimetres, however often it is tried."""
    plot, session = panel.plots[0], session_of(panel)
    values, done = plot.values, []
    for _ in range(4):
        start = place(plot, 1.5)
        drag(plot, start, start + QPoint(0, -60))
        done.append((session.edits[0].value, plot.values))
        assert plot.values[1] > values[1]
        session.undo()
        panel.refresh()
        assert plot.values == values
    assert len(set(done)) == 1


@pytest.mark.parametrize("ends", ["undo", "Esc"])
def test_twenty_drags_taken_back_leave_the_axis_as_it_was(panel: CurvesPanel, ends: str) -> None:
    session, values = session_of(panel), [plot.values for plot in panel.plots]
    for number in range(20):
        plot = panel.plots[number % 3]
        start = place(plot, 1.5)
        drag(plot, start, start + QPoint(0, -175), release=ends == "undo")
        if ends == "Esc":
            QTest.keyClick(plot, Qt.Key.Key_Escape)
            let_go(plot, start + QPoint(0, -175))
        else:
            session.undo()
    assert [plot.values for plot in panel.plots] == values


def test_no_axis_goes_beyond_what_a_face_can_do(panel: CurvesPanel) -> None:
    """However much an edit asks for, as one of a file may."""
    session = session_of(panel)
    low, high = session.limits[0]
    session.add(Edit(("mouth_opening",), Op.OFFSET, 1.0, 2.0, 0.1, 5_000.0))
    first, last = panel.plots[0].values
    assert last - first < 2 * (high - low)
    assert first < float(session.tracked[:, 0].min())
    assert last > float(session.tracked[:, 0].max())


@pytest.mark.parametrize("way", [-5_000, 5_000])
@pytest.mark.parametrize("index", [0, 6])
def test_a_hand_asks_for_no_more_than_a_face_can_do(
    panel: CurvesPanel, qtbot: QtBot, index: int, way: int
) -> None:
    """And comes back as it went: the curve is under it again once it is inside."""
    panel.tools.link(False)
    plot, session = panel.plots[index], session_of(panel)
    low, high = session.limits[index]
    frame = session.take.clip.frame_at(1.5)
    start, per_pixel = place(plot, 1.5), plot.current_scale.mm_per_pixel
    drag(plot, start, start + QPoint(0, way), release=False, previews=True)
    qtbot.waitUntil(lambda: session.is_previewing)
    assert session.asked[frame, index] == pytest.approx(high if way < 0 else low, abs=1e-3)
    move_with(plot, start + QPoint(0, way // 1000))
    wanted = session.tracked[frame, index] - way // 1000 * per_pixel
    qtbot.waitUntil(lambda: session.asked[frame, index] == pytest.approx(wanted, abs=0.01))
    panel.cancel_drag()
    let_go(plot, start)
    assert session.edits == ()


@pytest.mark.parametrize("tool", list(Tool))
def test_no_drag_however_wild_raises(panel: CurvesPanel, tool: Tool) -> None:
    panel.tools.choose(tool)
    plot, session = panel.plots[0], session_of(panel)
    low, high = session.limits[0]
    for way in (QPoint(40, -100_000), QPoint(-90, 100_000), QPoint(30, -100_000)):
        start = place(plot, 1.5)
        drag(plot, start, start + way)
    assert session.asked[:, 0].min() >= low - 1.5 * (high - low)
    assert session.asked[:, 0].max() <= high + 1.5 * (high - low)


def test_the_curves_that_move_along_take_their_axes_along(panel: CurvesPanel, qtbot: QtBot) -> None:
    left, right = panel.plots[2:4]
    still = panel.plots[6].values
    start = place(left, 1.5)
    per_pixel = left.current_scale.mm_per_pixel
    drag(left, start, start + QPoint(0, -150), release=False, previews=True)
    session, frame = session_of(panel), panel.timeline.frame
    wanted = float(session.tracked[frame, 3]) + 150 * per_pixel * 0.2
    qtbot.waitUntil(lambda: session.asked[frame, 3] > wanted)
    assert 0 < right.current_scale.y_of(float(session.asked[frame, 3])) < right.height()
    assert panel.plots[6].values == still
    let_go(left, start + QPoint(0, -150))


def test_a_dropped_drag_leaves_the_value_axis_as_it_was(panel: CurvesPanel) -> None:
    plot = panel.plots[0]
    span = plot.values
    start = place(plot, 1.5)
    drag(plot, start, start + QPoint(0, -300), release=False, previews=True)
    assert plot.values[1] > span[1]
    QTest.keyClick(plot, Qt.Key.Key_Escape)
    assert plot.values == span
    let_go(plot, start + QPoint(0, -300))


def test_a_line_that_is_drawn_stays_under_the_pointer(panel: CurvesPanel) -> None:
    plot = panel.plots[0]
    span = plot.values
    panel.tools.choose(Tool.DRAW)
    start = place(plot, 1.5)
    drag(plot, start, start + QPoint(20, -300), release=False, previews=True)
    assert panel.is_dragging
    assert plot.values == span
    let_go(plot, start + QPoint(20, -300))


@pytest.mark.parametrize("tool", [Tool.DRAW, Tool.SMOOTH, Tool.FLATTEN, Tool.RESTORE])
def test_the_face_follows_a_pen_and_a_brush(panel: CurvesPanel, qtbot: QtBot, tool: Tool) -> None:
    """And Esc puts the playhead back where it was."""
    plot, line = panel.plots[0], panel.timeline
    panel.tools.choose(tool)
    line.go_to_frame(3)
    start, stop = place(plot, 1.5), place(plot, 2.5)
    drag(plot, start, stop, release=False, previews=True)
    qtbot.waitUntil(lambda: line.time == pytest.approx(2.5, abs=0.05))
    handle = plot.handle
    assert handle is not None
    assert handle.time == line.time
    QTest.keyClick(plot, Qt.Key.Key_Escape)
    assert line.frame == 3
    let_go(plot, stop)


@pytest.mark.parametrize("way", [-1, 1])
@pytest.mark.parametrize("tool", list(Tool))
def test_a_drag_past_the_edge_of_a_plot_leaves_the_view_where_it_is(
    panel: CurvesPanel, tool: Tool, way: int
) -> None:
    """Also where the nearest frame lies just beyond the edge."""
    line = panel.timeline
    line.show_range(1.009, 2.011)  # 50 frames a second
    view, plot = line.view, panel.plots[0]
    first, last = view
    assert line.snap(first) < first
    assert line.snap(last) > last
    panel.tools.choose(tool)
    start = place(plot, 1.5)
    beyond = QPoint(place(plot, last if way > 0 else first).x() + 60 * way, start.y() - 12)
    drag(plot, start, beyond, release=False, previews=True)
    move_with(plot, beyond + QPoint(40 * way, 0))
    let_go(plot, beyond + QPoint(40 * way, 0))
    assert line.view == view
    (edit,) = session_of(panel).edits
    if edit.op is not Op.RETIME:
        assert first - 1e-9 <= edit.start <= edit.end <= last + 1e-9
    QTest.mouseClick(surface(plot), LEFT, NONE, place(plot, last) - QPoint(1, 0))
    QTest.mouseClick(surface(panel.ruler), LEFT, NONE, place(panel.ruler, last, 5.0))
    assert line.view == view


def test_a_click_moves_the_playhead(panel: CurvesPanel) -> None:
    plot = panel.plots[3]
    QTest.mouseClick(surface(plot), LEFT, NONE, place(plot, 2.5))
    assert panel.timeline.time == pytest.approx(2.5, abs=0.02)
    assert session_of(panel).edits == ()


def test_keys_take_the_hover_away_until_the_pointer_moves(panel: CurvesPanel) -> None:
    plot = panel.plots[0]
    at = place(plot, 1.5)
    move_with(plot, at, NONE, Qt.MouseButton.NoButton)
    assert plot.handle is not None
    panel.timeline.go_to_frame(panel.timeline.frame + 1)
    assert plot.handle is None
    move_with(plot, at + QPoint(1, 0), NONE, Qt.MouseButton.NoButton)
    assert plot.handle is not None
    QTest.mouseClick(surface(plot), LEFT, NONE, at)
    assert plot.handle is not None, "a click moves the playhead, but the pointer is there"


@pytest.mark.parametrize("keys", [ALT, CTRL | SHIFT])
def test_a_key_limits_a_drag_to_one_side(panel: CurvesPanel, keys: Qt.KeyboardModifier) -> None:
    plot, per_pixel = panel.plots[2], panel.plots[2].current_scale.mm_per_pixel
    start = place(plot, 1.5)
    drag(plot, start, start + QPoint(0, -20), keys)
    (edit,) = session_of(panel).edits
    assert edit.controls == ("left_corner",)
    assert edit.value == pytest.approx(20 * per_pixel), "neither fine nor snapped"


def test_a_value_is_also_a_share_of_what_the_face_does(panel: CurvesPanel) -> None:
    session = session_of(panel)
    low, high = session.limits[0]
    panel.timeline.go_to_frame(10)
    value = float(session.achieved[10, 0])
    assert panel.headers[0].share == f"{100 * (value - low) / (high - low):.0f} %"


def test_another_take_ends_the_drag(panel: CurvesPanel) -> None:
    plot, session = panel.plots[0], session_of(panel)
    start = place(plot, 1.5)
    drag(plot, start, start + QPoint(0, -20), release=False, previews=True)
    panel.set_session(None)
    assert not panel.is_dragging
    let_go(plot, start)
    assert session.edits == ()
