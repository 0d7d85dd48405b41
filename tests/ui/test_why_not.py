"""A command that is not possible says why, in its tooltip and in the status bar."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QWidget
from support.character_files import write_glb
from support.films import make_film
from support.media import FakeOutput, settle
from support.waiting import run_events
from support.windows import Bench, add_edit, editor_of, session_of, trigger

from faceedit_app.characters.fitted import fit
from faceedit_app.characters.registry import read_character
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.actions import NO_TAKE

ON_A_RANGE = {"copy", "copy_changes", "mirror", "stretch_time", "move_time", "cut_time", "fill"}
TWO_LINES = {"preserve", "resynthesize"}  # their buttons explain them


def explained(window: MainWindow) -> set[str]:
    """The commands that are not possible; each of them, and no other, says why."""
    grey = set()
    window.actions_.refresh()
    for command, _ in window.actions_._commands:
        if command.fills is not None:
            continue  # a menu, whose entries say it
        action = window.actions_[command.id]
        reason = action.data() or ""
        assert action.isEnabled() is not bool(reason), command.id
        assert action.statusTip() == (reason or command.tip), command.id
        if reason != NO_TAKE:  # then there are no buttons with tooltips
            assert action.toolTip().partition("\n")[2] == reason or command.id in TWO_LINES
        if reason:
            grey.add(command.id)
    return grey


def test_each_command_says_why_it_is_not_possible(
    bench: Bench, devices: list[FakeOutput], tmp_path: Path
) -> None:
    window = bench.window()
    nothing_open = explained(window)
    assert {"export", "undo", "fix_smile", "fix_problem"} <= nothing_open
    assert window.actions_["export"].data() == NO_TAKE
    assert not {"open", "quit", "open_character"} & nothing_open

    window = bench.editing()
    editor = editor_of(window)
    for widget in window.findChildren(QWidget):
        assert NO_TAKE not in widget.toolTip(), widget
    states: list[tuple[Callable[[], object], set[str]]] = [
        (
            lambda: None,
            {"undo", "redo", "delete_edit", "edit_up", "remove_film", "remove_sound", *ON_A_RANGE},
        ),
        (lambda: window.timeline.select((1.0, 2.0)), {"undo", "delete_edit", "paste"}),
        (lambda: (add_edit(window), editor.edits.select(0)), {"redo", "edit_up", "edit_down"}),
        (lambda: add_edit(window, 3.0), {"edit_up"}),
        (lambda: editor.edits.select(1), {"edit_down"}),
        (lambda: trigger(window, "undo"), {"edit_down"}),
        (lambda: use_character(window, tmp_path), {"mirror_film"}),
        (lambda: add_film(bench, window), {"film_landmarks"}),
    ]
    possible = {
        1: ON_A_RANGE,
        2: {"undo", "delete_edit", "reset_range"},
        3: {"edit_down"},
        4: {"edit_up"},
        5: {"redo"},
        6: {"own_character", "character_checklist"},
        7: {"mirror_film", "remove_film", "film_above"},
    }
    for number, (go, grey) in enumerate(states):
        go()
        found = explained(window)
        assert grey <= found, number
        wanted = possible.get(number, set()) & {
            command.id for command, _ in window.actions_._commands
        }
        assert not wanted & found, number
    assert session_of(window).edits


def use_character(window: MainWindow, folder: Path) -> None:
    window.document.use_character(fit(read_character(write_glb(folder / "head.glb"))))


def add_film(bench: Bench, window: MainWindow) -> None:
    window.media.add(make_film(bench.folder / "a.mp4", sound=1.0))
    settle(bench, window)


def test_a_key_whose_command_is_not_possible_says_why(bench: Bench) -> None:
    window = bench.editing()
    keys, modifier = Qt.Key, Qt.KeyboardModifier
    window.setFocus()
    for key, held, command in (
        (keys.Key_V, modifier.ControlModifier, "paste"),
        (keys.Key_W, modifier.ShiftModifier, "stretch_time"),
        (keys.Key_Z, modifier.ControlModifier, "undo"),
    ):
        reason = window.actions_[command].data()
        assert reason
        QTest.keyClick(editor_of(window).curves.plots[0], key, held)
        assert window.status.currentMessage() == reason, command
    window.timeline.select((1.0, 2.0))
    QTest.keyClick(window, keys.Key_C, modifier.ControlModifier)
    assert window.status.currentMessage().startswith("Copied 1.00 s")
    QTest.keyClick(window, keys.Key_V, modifier.ControlModifier)
    assert session_of(window).edits, "as soon as there is something to paste"
    QTest.keyClick(window, keys.Key_Return)
    assert "proposal" not in window.status.currentMessage(), "Enter only ends what is typed"


@pytest.mark.parametrize("command", ["reset_curve"])
def test_what_does_nothing_says_what_to_do(bench: Bench, command: str) -> None:
    window = bench.editing()
    add_edit(window)
    editor_of(window).curves._mouse.focused = None
    trigger(window, command)
    assert window.status.currentMessage()


def test_a_key_says_why_its_command_is_not_possible_wherever_the_focus_is(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window)
    add_edit(window, 3.0)
    window.activateWindow()
    run_events()
    editor = editor_of(window)
    reason = window.actions_["fix_problem"].data()
    assert reason
    edits = editor.edits.list
    for focus in (editor.curves, edits, editor.transport.speed, editor.settings_bar.exactness):
        focus.setFocus()
        window.status.clearMessage()
        before = edits.currentIndex().row()
        QTest.keyClick(focus, Qt.Key.Key_P)
        assert focus.hasFocus()
        assert window.status.currentMessage() == reason, focus
        assert edits.currentIndex().row() == before, "the list looks for nothing"
    trigger(window, "all_channels")
    assert editor.channels is not None
    search = editor.channels.search
    search.setFocus()
    window.status.clearMessage()
    QTest.keyClick(search, Qt.Key.Key_P)
    assert search.text() == "p", "what is typed belongs to a field"
    assert not window.status.currentMessage()
