"""What Undo, Redo and the history say, and who hears of a change."""

from __future__ import annotations

import pytest
from support.windows import (
    Bench,
    add_edit,
    editor_of,
    session_of,
    trigger,
    with_undone_slider,
)

from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.ui.commands.menus import help_rows
from faceedit_app.ui.start.window import MainWindow


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    return with_undone_slider(bench)


# --- what the menu says --------------------------------------------------------------------------


def test_undo_and_redo_name_the_step(window: MainWindow) -> None:
    undo, redo = window.actions_["undo"], window.actions_["redo"]
    assert (undo.text(), redo.text()) == ("&Undo Mouth opening +6.0 mm", "&Redo Natural to exact")
    window.timeline.select((0.5, 2.5))
    trigger(window, "fix_smile")
    assert (undo.text(), redo.text()) == ("&Undo Smile", "&Redo")
    assert not redo.isEnabled()
    for command, step in {
        "toggle_edit": "Switch edit off",
        "edit_up": "Move edit",
        "delete_edit": "Delete edit",
        "resynthesize": "Resynthesize",
        "reset_range": "Reset range",
        "mirror": "Mirror",
    }.items():
        trigger(window, command)
        assert undo.text() == f"&Undo {step}"
    while session_of(window).can_undo:
        trigger(window, "undo")
    assert undo.text() == "&Undo"
    assert not undo.isEnabled()


def test_the_history_goes_to_any_step(window: MainWindow) -> None:
    session, menu = session_of(window), window.actions_.submenu("history")
    session.travel(-100)
    for value in (1.0, 2.0, 3.0):
        edit = Edit(("mouth_opening",), Op.OFFSET, 1.0, 1.4, 0.2, value, name=f"Step & {value:.0f}")
        session.add(edit)
    computed: list[int] = []
    session.changed.connect(lambda: computed.append(1))

    def choose(name: str) -> None:
        menu.aboutToShow.emit()
        entry = next(a for a in menu.actions() if a.text().replace("&&", "&") == name)
        entry.trigger()

    menu.aboutToShow.emit()
    names = [action.text().replace("&&", "&") for action in menu.actions()]
    assert names == ["Step & 3", "Step & 2", "Step & 1", "As opened"]
    choose("Step & 1")
    assert [edit.value for edit in session.edits] == [1.0]
    assert len(computed) == 1
    menu.aboutToShow.emit()
    assert [action.isChecked() for action in menu.actions()] == [False, False, True, False]
    choose("As opened")
    assert session.edits == ()
    choose("Step & 3")
    edits: tuple[Edit, ...] = session.edits
    assert [edit.value for edit in edits] == [1.0, 2.0, 3.0]


def test_a_name_of_the_users_cannot_break_the_menu(window: MainWindow) -> None:
    session_of(window).add(name="R&D\ttab\nline " + "x" * 90)
    assert window.actions_["undo"].text() == "&Undo Mouth opening +6.0 mm", "nothing was added"
    (edit,) = session_of(window).edits
    session_of(window).add(edit, name="R&D\ttab\nline " + "x" * 90)
    text = window.actions_["undo"].text()
    assert text.startswith("&Undo R&&D tab line x")
    assert text.endswith("x…")
    assert len(text) < 60


def test_the_shortcuts_keep_the_plain_names(window: MainWindow) -> None:
    texts = {keys: text for _, keys, text in help_rows()}
    assert texts["Ctrl+Z"] == "Undo the last step"
    assert window.actions_["undo"].toolTip() == "Undo the last step  (Ctrl+Z)"


# --- the one way from the session to the views ---------------------------------------------------


def test_any_change_of_the_session_is_seen_everywhere(bench: Bench) -> None:
    window = bench.editing()
    session, editor = session_of(window), editor_of(window)
    add_edit(window)
    assert window.isWindowModified()
    assert len(editor.edits.model.edits) == 1
    assert editor.lists.tabText(0) == "Edits  1"
    assert editor.settings_bar.edits.text().startswith("1 edit")
    session.undo()
    assert not window.isWindowModified()
    assert editor.lists.tabText(0) == "Edits"


def test_the_session_of_the_last_take_is_heard_no_more(bench: Bench) -> None:
    window = bench.editing()
    old = session_of(window)
    heard: list[None] = []
    add_edit(window)
    (edit,) = old.edits
    old.mark_saved()
    window.commands.file.open(bench.take)
    bench.qtbot.waitUntil(lambda: window.document.session is not old)
    window.document.changed.connect(lambda: heard.append(None))
    window.document.previewed.connect(lambda: heard.append(None))
    old.undo()
    old.preview(edit)
    old.cancel()
    assert not heard
