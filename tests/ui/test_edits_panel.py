"""The list of edits: chosen, weakened, switched, renamed, moved, deleted; one step a gesture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QApplication,
    QLineEdit,
    QToolButton,
)
from support.curves import drag, turn
from support.windows import Bench, drag_curve, editor_of, session_of

from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.editing.edits.describe import describe_controls
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.ui.edits.model import COLUMNS
from faceedit_app.ui.edits.panel import EditsPanel
from faceedit_app.ui.start.window import MainWindow

LEFT = Qt.MouseButton.LeftButton
NAMES = ("first", "second", "third")


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    window = bench.editing()
    session = session_of(window)
    for number, name in enumerate(NAMES):
        start = 0.5 + 0.5 * number
        session.add(
            Edit(("mouth_opening",), Op.OFFSET, start, start + 0.3, 0.1, 4.0, 0.2, name=name)
        )
    return window


def panel_of(window: MainWindow) -> EditsPanel:
    assert window.editor is not None
    return window.editor.edits


def click(panel: EditsPanel, row: int, x: int = 60) -> None:
    rect = panel.list.visualRect(panel.model.index(row))
    QTest.mouseClick(panel.list.viewport(), LEFT, pos=QPoint(x, rect.center().y()))


def names(window: MainWindow) -> list[str]:
    return [edit.name for edit in session_of(window).edits]


def test_a_menu_may_count_the_selection_before_the_list_knows_of_a_change(
    window: MainWindow,
) -> None:
    panel, session = panel_of(window), session_of(window)
    lips = ("upper_lip", "lower_lip", "mouth_width")
    session.add(*(Edit((lip,), Op.OFFSET, 2.0, 2.5, 0.1, 1.0, 0.1, name="Pasted") for lip in lips))
    panel.select(len(NAMES))
    assert (panel.rows, panel.model.counted(panel.rows)) == ([3, 4, 5], "edit")
    with session.changed.blocked():
        session.undo()
        session.add(replace(session.edits[0], start=2.0, end=2.5))
        assert panel.model.counted(panel.rows) == "edit"
    session.changed.emit()
    assert panel.model.rowCount() == len(NAMES) + 1


def test_without_edits_it_says_what_belongs_here(bench: Bench) -> None:
    window = bench.editing()
    assert not panel_of(window).list.isVisible()
    assert not window.actions_["delete_edit"].isEnabled()
    drag_curve(window, 0, 1.0, 20)
    assert panel_of(window).list.isVisible()
    assert window.editor is not None
    assert window.editor.lists.tabText(0) == "Edits  1"


def test_choosing_an_edit_shows_its_range(window: MainWindow) -> None:
    panel = panel_of(window)
    click(panel, 1)
    assert panel.current == 1
    assert window.timeline.selection == pytest.approx((1.0, 1.3))
    assert (window.timeline.falloff, window.timeline.falloff_out) == (0.1, 0.2)
    window.actions_["select_all"].trigger()
    assert panel.current is None


def test_the_switch_of_a_row(window: MainWindow) -> None:
    panel, session = panel_of(window), session_of(window)
    click(panel, 0, x=16)
    assert not session.edits[0].enabled
    window.actions_["undo"].trigger()
    assert session.edits[0].enabled
    click(panel, 2)
    window.actions_["toggle_edit"].trigger()
    assert not session.edits[2].enabled
    click(panel, 2, x=16)
    assert session.edits[2].enabled
    assert panel.rows == [2] == [panel.current], "it stays chosen: Strength and Del act on it"


def test_an_edit_is_chosen_by_the_user_and_not_by_the_focus(window: MainWindow) -> None:
    panel, line = panel_of(window), window.timeline
    line.show_range(2.2, 2.9)
    assert window.editor is not None
    window.editor.lists.setCurrentIndex(1)
    window.editor.lists.setCurrentIndex(0)
    panel.list.setFocus(Qt.FocusReason.TabFocusReason)
    assert panel.current is None
    assert panel.rows == []
    assert line.selection is None
    assert line.view == pytest.approx((2.2, 2.9))
    QTest.keyClick(panel.list, Qt.Key.Key_Down)
    assert panel.rows == [0] == [panel.current]


def test_strength_is_live_and_one_step(bench: Bench, window: MainWindow) -> None:
    panel, session = panel_of(window), session_of(window)
    click(panel, 0)
    frame = session.take.clip.frame_at(0.65)
    full = float(session.asked[frame, 0])
    slider = panel.strength
    slider.setSliderDown(True)
    for value in (80, 60, 50):
        slider.setSliderPosition(value)
    assert float(session.asked[frame, 0]) == pytest.approx(full - 2.0, abs=0.01)
    assert session.edits[0].strength == 1.0
    slider.setSliderDown(False)
    assert session.edits[0].strength == 0.5
    assert panel.percent.text() == "50 %"
    window.actions_["undo"].trigger()
    assert session.edits[0].strength == 1.0
    assert slider.value() == 100
    slider.setFocus()
    QTest.keyClick(slider, Qt.Key.Key_Right)
    QTest.keyClick(slider, Qt.Key.Key_Right)
    bench.qtbot.waitUntil(lambda: session.edits[0].strength == 1.02, timeout=3000)
    window.actions_["undo"].trigger()
    assert session.edits[0].strength == 1.0


def test_rename(bench: Bench, window: MainWindow) -> None:
    panel = panel_of(window)
    click(panel, 1)
    window.actions_["rename_edit"].trigger()
    editor = panel.list.findChild(QLineEdit)
    assert editor is not None
    editor.selectAll()
    QTest.keyClicks(editor, "open wide")
    QTest.keyClick(editor, Qt.Key.Key_Return)
    bench.qtbot.waitUntil(lambda: names(window) == ["first", "open wide", "third"])


def test_a_paste_is_one_row_that_opens(bench: Bench) -> None:
    window = bench.editing()
    panel, session, line = panel_of(window), session_of(window), window.timeline
    session.add(Edit(("mouth_width",), Op.OFFSET, 0.2, 0.3, 0.1, 1.0, name="before"))
    line.select((0.5, 1.0))
    window.actions_["copy"].trigger()
    line.select(None)
    line.go_to_time(1.5)
    window.actions_["paste"].trigger()
    count = len(session.edits) - 1
    assert count > 4, "an edit for each curve that differs"
    pasted = list(range(1, count + 1))
    shown = [row for row in range(count + 1) if not panel.list.isRowHidden(row)]
    assert shown == [0, 1]
    assert panel.rows == pasted
    as_shown = panel.list.size()
    for number in range(4):
        panel.list.resize(300, 90)
        session.add(replace(session.edits[0], name=f"after {number}"))
        panel.select_new()
        place = panel.list.visualRect(panel.model.index(len(session.edits) - 1))
        assert 0 <= place.top() < place.bottom() < panel.list.viewport().height()
    panel.list.resize(as_shown)
    for _ in range(4):
        session.undo()
    panel.select_new(count)
    assert editor_of(window).settings_bar.edits.short == "2 edits", "as many as rows"
    assert editor_of(window).lists.tabText(0) == "Edits  2"
    window.actions_["undo"].trigger()
    assert window.status.currentMessage() == "Undid: Paste"
    window.actions_["redo"].trigger()
    assert window.status.currentMessage() == "Redid: Paste"
    session.add(session.edits[0])
    assert window.status.currentMessage() == "", "another step was made"
    session.undo()
    panel.select_new(count)
    together = {control for edit in session.edits[1:] for control in edit.controls}
    what = panel.model.data(panel.model.index(1), COLUMNS)[1]
    assert what == describe_controls([c for c in CONTROL_IDS if c in together])
    click(panel, 1, x=16)
    assert [edit.enabled for edit in session.edits] == [True] + count * [False]
    window.actions_["undo"].trigger()
    assert all(edit.enabled for edit in session.edits)
    click(panel, 1, x=120)
    panel.strength.setValue(40)
    assert {edit.strength for edit in session.edits[1:]} == {0.4}
    window.actions_["edit_up"].trigger()
    assert session.edits[-1].name == "before"
    window.actions_["edit_down"].trigger()
    assert session.edits[0].name == "before"
    assert panel.rows == pasted
    click(panel, 1, x=36)
    assert not any(panel.list.isRowHidden(row) for row in [0, *pasted])
    click(panel, 3)
    assert panel.rows == [3]
    QTest.keyClick(panel.list, Qt.Key.Key_Delete)
    assert len(session.edits) == count
    click(panel, 1, x=36)
    click(panel, 1, x=120)
    QTest.keyClick(panel.list, Qt.Key.Key_Delete)
    assert names(window) == ["before"]
    assert session.undo_name == "Delete edit", "as many as rows"
    session.undo()
    assert window.actions_["delete_edit"].text() == "&Delete edit"
    panel.list.selectAll()
    assert window.actions_["delete_edit"].text() == "&Delete 2 edits"
    QTest.keyClick(panel.list, Qt.Key.Key_Delete)
    assert (session.edits, session.undo_name) == ((), "Delete 2 edits")


def test_after_renaming_the_list_has_the_keyboard_again(bench: Bench, window: MainWindow) -> None:
    """It went on to the speed of playback, where arrows then changed something else."""
    panel = panel_of(window)
    window.activateWindow()
    click(panel, 1)
    QTest.keyClick(window, Qt.Key.Key_F2)
    field = panel.list.findChild(QLineEdit)
    assert field is not None
    QTest.keyClicks(field, "open wide")
    QTest.keyClick(field, Qt.Key.Key_Return)
    bench.qtbot.waitUntil(lambda: names(window)[1] == "open wide")
    bench.qtbot.waitUntil(lambda: QApplication.focusWidget() is panel.list)
    QTest.keyClick(panel.list, Qt.Key.Key_Down)
    assert panel.current == 2


def test_the_falloff_of_a_chosen_edit_is_not_that_of_the_next_drag(window: MainWindow) -> None:
    panel, line, session = panel_of(window), window.timeline, session_of(window)
    line.set_falloffs(0.35, 0.4)
    click(panel, 0)
    click(panel, 1)
    assert (line.falloff, line.falloff_out) == (0.1, 0.2)
    QTest.keyClick(window, Qt.Key.Key_Escape)
    assert panel.current is None
    assert (line.falloff, line.falloff_out) == (0.35, 0.4)
    # So it is with an edit of the whole take, which has handles at its ends.
    session.add(Edit(("mouth_width",), Op.OFFSET, 0.0, line.duration, 0.0, 1.0, name="all"))
    click(panel, 3)
    assert panel.current == 3
    assert line.selection == (0.0, line.duration)
    assert line.own_falloffs == (0.35, 0.4)
    click(panel, 0)
    QTest.keyClick(panel.list, Qt.Key.Key_Delete)
    assert (line.falloff, line.falloff_out) == (0.1, 0.2), "of the next edit, which is chosen"
    assert line.own_falloffs == (0.35, 0.4)
    QTest.keyClick(window, Qt.Key.Key_Escape)
    assert (line.falloff, line.falloff_out) == (0.35, 0.4)


def test_new_edits_are_scrolled_to(window: MainWindow) -> None:
    panel, session = panel_of(window), session_of(window)
    for number in range(20):
        session.add(Edit(("mouth_width",), Op.OFFSET, 0.5, 0.6, 0.1, 1.0, name=str(number)))
    panel.select_new(2)
    shown = panel.list.viewport().rect()
    assert shown.contains(panel.list.visualRect(panel.model.index(21)))
    assert shown.contains(panel.list.visualRect(panel.model.index(22)))


def test_order_by_keys_and_by_dropping(window: MainWindow) -> None:
    panel, model = panel_of(window), panel_of(window).model
    click(panel, 0)
    window.actions_["edit_down"].trigger()
    assert names(window) == ["second", "first", "third"]
    assert panel.current == 1
    window.actions_["edit_up"].trigger()
    assert names(window) == list(NAMES)
    data = model.mimeData([model.index(0)])
    model.dropMimeData(data, Qt.DropAction.MoveAction, 3, 0, model.index(-1))
    assert names(window) == ["second", "third", "first"]
    assert panel.rows == [2]  # what was moved is what comes next in hand
    assert window.timeline.selection == pytest.approx((0.5, 0.8))
    window.actions_["undo"].trigger()
    assert names(window) == list(NAMES)


def test_delete(window: MainWindow) -> None:
    panel = panel_of(window)
    click(panel, 1)
    QTest.keyClick(panel.list, Qt.Key.Key_Delete)
    assert names(window) == ["first", "third"]
    assert panel.current == 1
    window.actions_["undo"].trigger()
    assert names(window) == list(NAMES)


def test_deleting_leaves_the_view_where_it_is(window: MainWindow) -> None:
    """The next edit of the list may lie anywhere in the take."""
    panel, session = panel_of(window), window.document.session
    assert session is not None
    here, far = (Edit(("mouth_width",), Op.OFFSET, at, at + 0.1, 0.1, 1.0) for at in (0.2, 2.7))
    window.document.act(lambda session: session.put((here, far)))
    window.timeline.show_range(0.0, 0.8)
    click(panel, 0)
    panel.delete()
    assert session.edits == (far,)
    assert panel.chosen_edit == (0, far), "with its range and handles"
    assert window.timeline.selection == pytest.approx((2.7, 2.8))
    assert window.timeline.view == pytest.approx((0.0, 0.8))
    window.actions_["undo"].trigger()
    assert panel.chosen_edit == (0, here)
    window.actions_["redo"].trigger()
    QTest.keyClick(panel.list, Qt.Key.Key_Delete)
    assert session.edits == ()


def test_switching_is_one_step_and_computed_once(
    window: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    panel, session = panel_of(window), window.document.session
    assert session is not None
    click(panel, 0)
    shown: list[object] = []
    show = session.live.show
    monkeypatch.setattr(session.live, "show", lambda pieces: (shown.append(pieces), show(pieces)))
    window.actions_["toggle_edit"].trigger()
    assert not session.edits[0].enabled
    assert len(shown) == 1
    panel.strength.setSliderDown(True)
    panel.strength.setSliderPosition(40)
    assert len(shown) == 2
    panel.strength.setSliderDown(False)
    assert len(shown) == 2, "letting go keeps what is shown"
    assert session.edits[0].strength == pytest.approx(0.4)


def test_arrows_walk_the_list(window: MainWindow) -> None:
    panel = panel_of(window)
    click(panel, 0)
    panel.list.setFocus()
    QTest.keyClick(panel.list, Qt.Key.Key_Down)
    assert panel.current == 1


def test_the_edges_of_the_chosen_edit_reshape_it(window: MainWindow) -> None:
    panel, session = panel_of(window), session_of(window)
    assert window.editor is not None
    bar = window.editor.curves.range_bar
    scale = bar.current_scale
    click(panel, 2)
    start, stop = (QPoint(round(scale.x_of(t)), 8) for t in (1.8, 2.4))
    drag(bar, start, stop)
    assert panel.current == 2
    assert (session.edits[2].start, session.edits[2].end) == pytest.approx((1.5, 2.4), abs=0.02)
    assert names(window) == list(NAMES)
    fields = window.editor.curves.fields
    fields.start.setValue(1.4)
    assert session.edits[2].start == pytest.approx(1.4)
    assert panel.current == 2
    window.actions_["undo"].trigger()
    window.actions_["undo"].trigger()
    assert (session.edits[2].start, session.edits[2].end) == pytest.approx((1.5, 1.8))
    before = session.weights.copy()
    drag(bar, start, stop, release=False)
    window.actions_["deselect"].trigger()
    assert (session.edits[2].start, session.edits[2].end) == pytest.approx((1.5, 1.8))
    np.testing.assert_array_equal(session.weights, before)
    turn(bar, start, 1)


def test_a_double_click_on_the_bin_deletes_one_edit(window: MainWindow) -> None:
    """The next row is chosen by then."""
    panel = panel_of(window)
    click(panel, 1)
    deleted = window.actions_["delete_edit"]
    (bin_,) = (b for b in panel.findChildren(QToolButton) if b.defaultAction() is deleted)
    for press in (QTest.mouseClick, QTest.mouseDClick):
        press(bin_, LEFT)
    assert names(window) == ["first", "third"]
