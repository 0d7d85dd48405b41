"""Fixes, problems, presets and the clipboard in the real window."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QMenu, QPushButton, QToolButton
from support.windows import (
    Bench,
    add_edit,
    double_click,
    editor_of,
    session_of,
    trigger_enabled,
    with_problems,
)

from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.help.presets import shipped_presets
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.edits.model import columns
from faceedit_app.ui.edits.slider_dialog import SliderDialog
from faceedit_app.ui.start.window import MainWindow

LEFT_EYE, OPENING = CONTROL_INDEX["left_eyelid"], CONTROL_INDEX["mouth_opening"]


@pytest.fixture
def window(bench: Bench, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> MainWindow:
    return with_problems(bench, monkeypatch, tmp_path)


def test_every_fix_is_one_step_and_ready_to_be_weakened(window: MainWindow) -> None:
    session = session_of(window)
    window.timeline.go_to_time(4.8)
    for fix in shipped_presets():
        trigger_enabled(window, f"fix_{fix.id}")
        assert session.edits, fix
        assert editor_of(window).edits.rows == list(range(len(session.edits)))
        assert editor_of(window).edits.strength.isEnabled()
        trigger_enabled(window, "undo")
        assert session.edits == ()


def test_a_blink_at_the_playhead_closes_the_eyes(window: MainWindow) -> None:
    session = session_of(window)
    window.timeline.go_to_time(3.0)
    QTest.keyClick(window, Qt.Key.Key_2, Qt.KeyboardModifier.ControlModifier)
    assert session.edits[0].controls == ("left_eyelid", "right_eyelid")
    near = np.abs(session.take.clip.times - 3.0) < 0.2
    assert session.asked[near, LEFT_EYE].min() < 0.5
    assert window.timeline.own_selection is None


def test_smile_acts_on_the_selection_or_on_the_whole_take(window: MainWindow) -> None:
    session = session_of(window)
    trigger_enabled(window, "fix_smile")
    assert session.edits[0].end - session.edits[0].start > 9
    trigger_enabled(window, "undo")
    window.timeline.select((2.0, 3.0))
    trigger_enabled(window, "fix_smile")
    assert (session.edits[0].start, session.edits[0].end) == pytest.approx((2.0, 3.0))


def test_a_chosen_edit_does_not_catch_fixes_made_elsewhere(window: MainWindow) -> None:
    session = session_of(window)
    window.timeline.select((2.0, 3.0))
    trigger_enabled(window, "fix_smile")
    window.timeline.select(None)
    editor_of(window).edits.select(0)
    assert window.timeline.selection == pytest.approx((2.0, 3.0))
    window.timeline.go_to_time(6.0)
    trigger_enabled(window, "fix_blink")
    assert abs(session.edits[1].start - 6.0) < 0.3


def test_the_range_of_a_chosen_edit_is_no_selection(window: MainWindow) -> None:
    """Under the handles of what was made last, a smile would last for a blink."""
    session, line = session_of(window), window.timeline
    trigger_enabled(window, "fix_close_lips", "fix_smile")
    assert session.edits[1].end - session.edits[1].start > 9
    editor_of(window).edits.select(0)
    editor_of(window).curves.fields.end.setValue(0.5)
    trigger_enabled(window, "fix_smile")
    assert session.edits[2].end - session.edits[2].start > 9
    line.select((3.0, 3.5))
    trigger_enabled(window, "fix_smile", "fix_exaggerate")
    assert {(edit.start, edit.end) for edit in session.edits[3:]} == {(3.0, 3.5)}


def test_the_expression_slider_is_tried_out_live(window: MainWindow) -> None:
    session = session_of(window)
    trigger_enabled(window, "expression")
    dialog = window.findChild(SliderDialog)
    assert dialog is not None
    dialog.slider.setValue(50)
    dialog.preview()
    column = CONTROL_INDEX["left_corner"]
    assert session.asked[100, column] > session.tracked[100, column]
    assert session.edits == ()
    dialog.slider.setValue(-80)
    dialog.accept()
    kept: tuple[Edit, ...] = session.edits
    assert {round(made.strength, 2) for made in kept} == {0.8}
    assert session.asked[100, column] != session.tracked[100, column]
    trigger_enabled(window, "undo", "expression")
    dialog = next(d for d in window.findChildren(SliderDialog) if d.isVisible())
    dialog.slider.setValue(90)
    dialog.preview()
    double_click(dialog.slider)
    assert dialog.slider.value() == 0
    dialog.slider.setValue(90)
    dialog.preview()
    dialog.reject()
    np.testing.assert_array_equal(session.asked, session.tracked)


# --- presets and the clipboard -----------------------------------------------------------------


def test_a_preset_is_saved_applied_and_deleted(
    window: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    session, menu = session_of(window), window.actions_.submenu("presets")
    monkeypatch.setattr(dialogs, "ask_preset_name", lambda _w: "My smile")
    trigger_enabled(window, "fix_smile", "save_preset")
    assert window.status.currentMessage().startswith("Select the range whose edits to save")
    trigger_enabled(window, "undo")
    window.timeline.select((2.0, 3.0))
    with monkeypatch.context() as patched:
        patched.setattr(dialogs, "ask_preset_name", lambda _w: pytest.fail("asked for a name"))
        trigger_enabled(window, "save_preset")
    assert window.status.currentMessage().startswith("There is no edit in the selection")
    trigger_enabled(window, "fix_smile")
    trigger_enabled(window, "save_preset")
    assert window.status.currentMessage() == "Saved the preset “My smile”: 1 edit"
    trigger_enabled(window, "undo")
    window.timeline.select((5.0, 6.0))
    menu.aboutToShow.emit()
    where = menu.actions()[0]
    assert (where.text(), where.isEnabled()) == ("In the selection, 5.000 to 6.000 s", False)
    mine = next(a for a in menu.actions() if a.text() == "My smile")
    mine.trigger()
    assert session.edits[0].name
    assert 4.5 < session.edits[0].start < 5.5
    monkeypatch.setattr(dialogs, "ask_preset_name", lambda _w, current: f"{current}, wide")
    sure, said = [False, True], list[str]()
    monkeypatch.setattr(dialogs, "ask_delete_preset", lambda _w, _name: sure.pop(0))
    # Rename, then Delete, twice.
    for entry, name in ((-2, "My smile"), (-1, "My smile, wide"), (-1, "My smile, wide")):
        menu.aboutToShow.emit()
        act = menu.actions()[entry].menu()
        assert isinstance(act, QMenu)
        assert [action.text() for action in act.actions()] == [name]
        act.actions()[0].trigger()
        said.append(window.status.currentMessage())
    renamed = "Renamed the preset “My smile” to “My smile, wide”"
    assert said == [renamed, renamed, "Deleted the preset “My smile, wide”"]
    menu.aboutToShow.emit()
    assert [a.text() for a in menu.actions()] == ["No presets of your own"]


def test_copy_and_paste_at_the_playhead(window: MainWindow) -> None:
    session, line = session_of(window), window.timeline
    line.select((5.0, 6.0))
    trigger_enabled(window, "copy")
    line.select(None)
    line.go_to_time(1.0)
    line.show_range(0.0, 1.2)
    trigger_enabled(window, "paste")
    assert line.view == pytest.approx((0.9, 2.1)), "all that was pasted is in view"
    clip = session.take.clip
    to, source = clip.frame_at(1.5), clip.frame_at(5.5)
    assert session.asked[to, OPENING] == pytest.approx(session.tracked[source, OPENING], abs=0.2)
    trigger_enabled(window, "undo")
    assert session.edits == ()
    line.go_to_time(9.5)
    trigger_enabled(window, "paste")
    assert "9.500 to 10.000 s" in window.status.currentMessage(), "not beyond the end of the take"
    (row,) = {columns(edit, line.rows)[0] for edit in session_of(window).edits}
    assert row == "9.500 – 10.000 s", "the list says the same"


def test_mirror_swaps_left_and_right(window: MainWindow) -> None:
    session = session_of(window)
    window.tools.link(False)
    window.timeline.select((2.0, 3.0))
    trigger_enabled(window, "mirror")
    frame = session.take.clip.frame_at(2.5)
    right = CONTROL_INDEX["right_eyelid"]
    assert session.asked[frame, LEFT_EYE] == pytest.approx(session.tracked[frame, right], abs=0.1)
    assert {edit.op for edit in session.edits} == {Op.DRAW}


def test_a_fix_at_the_first_frame_begins_at_the_first_frame(window: MainWindow) -> None:
    """Its message gives no time before the take."""
    said: list[str] = []
    window.workspace.message.connect(said.append)
    window.timeline.go_to_time(0.0)
    trigger_enabled(window, "fix_close_lips")
    assert said[-1].startswith("Close lips: 0.000 to ")


def clicked_twice(button: QAbstractButton) -> None:
    """As Qt sends a double click."""
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    QTest.mouseDClick(button, Qt.MouseButton.LeftButton)
    QTest.mouseRelease(button, Qt.MouseButton.LeftButton)


@pytest.mark.parametrize("command", ["fix_blink", "fix_smile"])
def test_a_double_click_on_a_fix_is_one_click(window: MainWindow, command: str) -> None:
    window.timeline.go_to_time(4.8)
    editor, action = editor_of(window), window.actions_[command]
    (button,) = [b for b in editor.tool_bar.fix_buttons if b.defaultAction() is action]
    clicked_twice(button)
    assert len(session_of(window).edits) == 1
    trigger_enabled(window, command, command)  # keys and menus may repeat it
    assert len(session_of(window).edits) == 3


def test_quick_clicks_on_undo_all_count(window: MainWindow) -> None:
    session, undo = session_of(window), window.actions_["undo"]
    window.timeline.go_to_time(4.8)
    trigger_enabled(window, "fix_smile", "fix_smile")
    buttons = editor_of(window).settings_bar.findChildren(QToolButton)
    (button,) = [b for b in buttons if b.defaultAction() is undo]
    clicked_twice(button)
    assert session.edits == ()


def test_a_double_click_on_a_button_of_the_channels_is_one_click(window: MainWindow) -> None:
    trigger_enabled(window, "all_channels")
    panel = editor_of(window).channels
    assert panel is not None
    (mute,) = [b for b in panel.findChildren(QPushButton) if b.text() == "Mute"]
    clicked_twice(mute)
    assert len(session_of(window).edits) == 1


@pytest.mark.parametrize(
    ("command", "name"),
    [("export", "out.csv"), ("save", "out.faceedit"), ("save_edits", "out.json")],
)
def test_what_is_written_while_a_fix_is_previewed_says_that_it_is_not_in_it(
    bench: Bench, window: MainWindow, command: str, name: str
) -> None:
    question = {"save": "save_project"}.get(command, command)
    said = "; without the proposal, which was not accepted"
    trigger_enabled(window, "next_problem", "fix_problem")
    bench.answers[question] = None
    trigger_enabled(window, command)
    assert "The proposal was discarded" in window.status.currentMessage()
    trigger_enabled(window, "fix_problem")
    bench.answers[question] = bench.folder / name
    trigger_enabled(window, command)
    assert window.status.currentMessage().endswith(f"{name}{said}")
    assert session_of(window).edits == ()
    bench.answers[question] = bench.folder / name
    trigger_enabled(window, command)
    assert said not in window.status.currentMessage(), "nothing was proposed this time"


def test_nothing_is_said_of_a_problem_elsewhere(window: MainWindow) -> None:
    trigger_enabled(window, "next_problem")
    assert window.commands.fix.problem is not None
    assert window.status.currentMessage() == window.commands.fix.problem.message
    window.timeline.visit(9.0)
    assert window.status.currentMessage() == ""


def test_closing_says_that_the_previewed_fix_is_not_among_the_edits(
    bench: Bench, window: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[str] = []

    def ask(_parent: object, _message: str, more: str, **_buttons: bool) -> dialogs.Unsaved:
        asked.append(more)
        return dialogs.Unsaved.CANCEL

    monkeypatch.setattr(dialogs, "ask_unsaved", ask)
    add_edit(window)
    trigger_enabled(window, "next_problem", "fix_problem")
    assert not window.close()
    assert "The proposal was discarded" in window.status.currentMessage()
    assert not window.close()
    assert ["proposal" in more for more in asked] == [True, False]
