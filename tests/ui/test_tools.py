"""Tools, the link of left and right, snapping, several curves, and the keyboard on a curve."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, QRect, Qt
from PySide6.QtGui import QEnterEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QToolButton
from support.curves import (
    ALT,
    CTRL,
    LEFT,
    NONE,
    drag,
    let_go,
    move_with,
    place,
    session_of,
    surface,
)
from support.waiting import run_events
from support.windows import Bench, double_click

from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.ui.curves import CurvesPanel
from faceedit_app.ui.curves.gestures import moved_together
from faceedit_app.ui.state.tools import DEFAULT_SMOOTH, Tool

LEFT_EYE = CONTROL_INDEX["left_eyelid"]


def only_edit(panel: CurvesPanel) -> Edit:
    (edit,) = session_of(panel).edits
    return edit


# --- left and right ----------------------------------------------------------------------------


def test_what_moves_together() -> None:
    assert moved_together("left_corner", (), True) == ("left_corner", "right_corner")
    assert moved_together("left_corner", (), False) == ("left_corner",)
    assert moved_together("mouth_width", (), True) == ("mouth_width",)
    chosen = ("mouth_width", "left_eyelid")
    assert moved_together("left_eyelid", chosen, False) == chosen
    assert moved_together("upper_lip", chosen, False) == ("upper_lip",)


def test_both_sides_are_one_edit_unless_alt_or_unlinked(panel: CurvesPanel) -> None:
    plot, session = panel.plots[LEFT_EYE], session_of(panel)
    start = place(plot, 1.0)
    drag(plot, start, start + QPoint(0, 12))
    assert session.edits[0].controls == ("left_eyelid", "right_eyelid")
    drag(plot, start, start + QPoint(0, 12), ALT)
    assert session.edits[1].controls == ("left_eyelid",)
    panel.tools.link(False)
    drag(plot, start, start + QPoint(0, 12))
    assert session.edits[2].controls == ("left_eyelid",)


def test_several_curves_are_chosen_by_ctrl_click(panel: CurvesPanel) -> None:
    panel.tools.link(False)
    QTest.mouseClick(panel.headers[0], LEFT, CTRL)
    QTest.mouseClick(panel.headers[4], LEFT, CTRL)
    assert panel.chosen_controls == ("mouth_opening", "upper_lip")
    plot = panel.plots[4]
    start = place(plot, 1.0)
    drag(plot, start, start - QPoint(0, 12))
    assert only_edit(panel).controls == ("mouth_opening", "upper_lip")
    QTest.mouseClick(panel.headers[2], LEFT)
    assert panel.chosen_controls == ()
    assert panel.focused_control == "left_corner"


def test_the_curve_whose_name_was_clicked_is_the_first_that_ctrl_click_chooses(
    panel: CurvesPanel,
) -> None:
    QTest.mouseClick(panel.headers[0], LEFT)
    assert panel.chosen_controls == ()
    QTest.mouseClick(panel.headers[4], LEFT, CTRL)
    assert panel.chosen_controls == ("mouth_opening", "upper_lip")
    for index in (0, 4, 2):  # the click counts only once
        QTest.mouseClick(panel.headers[index], LEFT, CTRL)
    assert panel.chosen_controls == ("left_corner",)
    for between in ("focus", "take", "nothing"):
        panel.focus_curve(1)
        QTest.mouseClick(panel.headers[0], LEFT)
        if between == "focus":
            panel.focus_curve(1)
        elif between == "take":
            panel.set_session(panel.session)
        QTest.mouseClick(panel.headers[4], LEFT, CTRL)
        expected = ("mouth_opening",) if between == "nothing" else ()
        assert panel.chosen_controls == (*expected, "upper_lip"), between


# --- snapping ----------------------------------------------------------------------------------


def test_ctrl_snaps_to_zero_and_to_the_tracked_curve(panel: CurvesPanel) -> None:
    panel.tools.link(False)
    plot, session = panel.plots[0], session_of(panel)
    frame = session.take.clip.frame_at(1.5)
    asked, scale = float(session.asked[frame, 0]), plot.current_scale
    start = place(plot, 1.5)
    down = round(asked / scale.mm_per_pixel) + 4
    drag(plot, start, start + QPoint(0, down), CTRL)
    assert session.asked[frame, 0] == pytest.approx(0.0, abs=1e-4)
    drag(plot, start, start - QPoint(0, down - 8), CTRL)
    assert session.asked[frame, 0] == pytest.approx(session.tracked[frame, 0], abs=1e-4)


# --- tools -------------------------------------------------------------------------------------


def test_draw_goes_where_the_pointer_went(panel: CurvesPanel) -> None:
    panel.tools.choose(Tool.DRAW)
    plot, session = panel.plots[0], session_of(panel)
    panel.timeline.set_falloffs(0.05, 0.05)
    drag(plot, place(plot, 1.0, 50), place(plot, 2.0, 20))
    edit = only_edit(panel)
    assert edit.op is Op.DRAW
    assert (edit.start, edit.end) == pytest.approx((1.0, 2.0), abs=0.02)
    value = plot.current_scale.value_at(35)
    frame = session.take.clip.frame_at(1.5)
    assert session.asked[frame, 0] == pytest.approx(value, abs=0.5)
    session.undo()
    assert session.edits == ()


def test_drawing_back_draws_over(panel: CurvesPanel) -> None:
    panel.tools.choose(Tool.DRAW)
    plot = panel.plots[0]
    drag(plot, place(plot, 1.0, 50), place(plot, 2.0, 50), release=False)
    for seconds in (1.8, 1.6, 1.4):
        move_with(plot, place(plot, seconds, 20))
    let_go(plot, place(plot, 1.4, 20))
    points = np.array(only_edit(panel).points)
    assert np.all(np.diff(points[:, 0]) > 0)
    high = points[(points[:, 0] > 1.42) & (points[:, 0] < 1.78), 1]
    assert np.allclose(high, plot.current_scale.value_at(20), atol=0.3)


def test_smooth_paints_where_it_passes(panel: CurvesPanel) -> None:
    panel.tools.choose(Tool.SMOOTH)
    panel.tools.set_smooth(0.1)
    plot = panel.plots[0]
    drag(plot, place(plot, 1.0), place(plot, 1.6))
    edit = only_edit(panel)
    assert (edit.op, edit.value) == (Op.SMOOTH, 0.1)
    assert (edit.start, edit.end) == pytest.approx((1.0, 1.6), abs=0.02)


def test_in_the_selection_a_paint_tool_takes_all_of_it(panel: CurvesPanel) -> None:
    panel.tools.choose(Tool.FLATTEN)
    panel.timeline.select((1.0, 2.0))
    plot, session = panel.plots[0], session_of(panel)
    asked = float(session.asked[session.take.clip.frame_at(1.5), 0])
    QTest.mouseClick(surface(plot), LEFT, NONE, place(plot, 1.5))
    edit = only_edit(panel)
    assert (edit.op, edit.start, edit.end) == (Op.SET, 1.0, 2.0)
    assert edit.value == pytest.approx(asked)


def test_scale_about_the_median(panel: CurvesPanel) -> None:
    panel.tools.choose(Tool.SCALE)
    plot = panel.plots[1]
    start = place(plot, 1.0)
    drag(plot, start, start - QPoint(0, 30))
    assert only_edit(panel).op is Op.SCALE
    assert 1.2 < only_edit(panel).value < 1.3


def test_back_to_tracked_erases(panel: CurvesPanel) -> None:
    session, plot = session_of(panel), panel.plots[0]
    session.add(Edit(("mouth_opening",), Op.OFFSET, 0.5, 2.5, 0.0, 4.0))
    panel.refresh()
    panel.tools.choose(Tool.RESTORE)
    panel.timeline.set_falloffs(0.1, 0.1)
    drag(plot, place(plot, 1.0), place(plot, 2.0))
    frame = session.take.clip.frame_at(1.5)
    assert session.asked[frame, 0] == session.tracked[frame, 0]
    frame = session.take.clip.frame_at(0.7)
    assert session.asked[frame, 0] > session.tracked[frame, 0]


def test_esc_drops_a_paint(panel: CurvesPanel) -> None:
    panel.tools.choose(Tool.SMOOTH)
    plot, session = panel.plots[0], session_of(panel)
    drag(plot, place(plot, 1.0), place(plot, 1.6), release=False, previews=True)
    QTest.keyClick(plot, Qt.Key.Key_Escape)
    assert session.edits == ()
    np.testing.assert_array_equal(session.asked, session.tracked)


# --- in the window -----------------------------------------------------------------------------


def test_tools_by_their_keys_and_buttons(bench: Bench) -> None:
    window = bench.editing()
    for key, tool in (
        (Qt.Key.Key_D, Tool.DRAW),
        (Qt.Key.Key_S, Tool.SMOOTH),
        (Qt.Key.Key_X, Tool.SCALE),
        (Qt.Key.Key_M, Tool.MOVE),
    ):
        QTest.keyClick(window, key)
        assert window.tools.tool is tool
        assert window.actions_[f"tool_{tool}"].isChecked()
    assert window.editor is not None
    assert not window.editor.tool_bar.smooth.isVisible()
    window.actions_["tool_smooth"].trigger()
    assert window.editor.tool_bar.smooth.isVisible()
    window.tools.set_smooth(0.2)
    double_click(window.editor.tool_bar.smooth)
    assert window.tools.smooth == DEFAULT_SMOOTH
    window.actions_["link"].trigger()
    assert not window.tools.linked
    assert not window.actions_["link"].isChecked()


def test_more_is_not_left_lit_once_its_menu_is_closed(bench: Bench) -> None:
    window = bench.editing()
    assert window.editor is not None
    bar = window.editor.tool_bar
    (more,) = [b for b in bar.findChildren(QToolButton) if b.text().startswith("More")]
    menu = more.menu()
    assert menu is not None
    more.setAttribute(Qt.WidgetAttribute.WA_UnderMouse)  # as when it was clicked
    more.setDown(True)
    menu.popup(QPoint(0, 0))
    menu.close()
    bench.qtbot.waitUntil(lambda: not more.testAttribute(Qt.WidgetAttribute.WA_UnderMouse))
    assert not more.isDown()


def test_no_button_is_left_lit_that_the_pointer_has_left(bench: Bench) -> None:
    window = bench.editing()
    export, undo = (
        next(b for b in window.findChildren(QToolButton) if b.defaultAction() is action)
        for action in (window.actions_["export"], window.actions_["undo"])
    )
    for button in (export, undo):  # a dialog that a menu opened there was closed with a key
        button.setAttribute(Qt.WidgetAttribute.WA_UnderMouse)
    place = QPointF(undo.mapToGlobal(undo.rect().center()))
    QApplication.sendEvent(window, QEnterEvent(place, place, place))
    assert not export.underMouse()
    assert undo.underMouse()
    QApplication.sendEvent(undo, QEvent(QEvent.Type.Leave))


def test_the_slider_of_a_tool_pushes_no_button_about(bench: Bench) -> None:
    window = bench.editing()
    assert window.editor is not None
    bar = window.editor.tool_bar

    def places() -> list[QRect]:
        run_events()
        return [button.geometry() for button in bar.findChildren(QToolButton)]

    before = places()
    window.actions_["tool_smooth"].trigger()
    assert bar.smooth.isVisible()
    assert places() == before


def test_the_keyboard_moves_the_focused_curve_as_one_step(bench: Bench) -> None:
    window = bench.editing()
    session = window.document.session
    assert session is not None
    QTest.keyClick(window, Qt.Key.Key_7)
    assert window.editor is not None
    assert window.editor.curves.focused_control == "left_eyelid"
    assert window.editor.curves.plots[6].shows_focus
    window.timeline.go_to_time(1.0)
    for _ in range(3):
        window.actions_["lower"].trigger()
    window.actions_["raise_fine"].trigger()
    (edit,) = session.edits
    assert edit.value == pytest.approx(-1.45)
    assert edit.controls == ("left_eyelid", "right_eyelid")
    window.actions_["forward"].trigger()
    window.actions_["lower"].trigger()
    assert len(session.edits) == 2, "at another frame it is another edit"
    window.actions_["undo"].trigger()
    assert session.edits == (edit,)
    window.actions_["undo"].trigger()
    assert session.edits == ()
    window.actions_["raise"].trigger()
    window.actions_["lower"].trigger()
    assert session.edits == ()
    assert not session.can_undo
    assert session.can_redo, "up and down again is no step, and costs no redo"
