"""The random gestures do what they are named after, on real widgets."""

from __future__ import annotations

import random
from collections.abc import Callable
from types import SimpleNamespace
from typing import cast

import pytest
from PySide6.QtCore import QCoreApplication
from support.windows import Bench, bench, session_of

from faceedit_app.core.controls import LIP_OPENING
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.lab.attacks import gestures, list_gestures
from faceedit_app.lab.attacks.hands import Hands, dialogs_cancelled
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.actions import Command, Menu

__all__ = ["bench"]

TRIES = 25
EDITS = tuple(
    Edit((LIP_OPENING,), Op.OFFSET, start, start + 0.4, 0.1, 3.0) for start in (0.5, 1.5, 2.5)
)


def edits(window: MainWindow) -> object:
    return session_of(window).edits


def range_of_first(window: MainWindow) -> object:
    edit = session_of(window).edits[0]
    return edit.start, edit.end, edit.falloff, edit.fade_out


def channels(window: MainWindow) -> object:
    return [edit.channels for edit in session_of(window).edits if edit.channels]


def steps(window: MainWindow) -> object:
    done, undone = session_of(window).history
    return len(done), len(undone)


def sizes(window: MainWindow) -> object:
    assert window.editor is not None
    return window.width(), window.height(), window.editor.panes.sizes()


class Entry:
    """An entry of a menu."""

    def __init__(self, is_enabled: bool) -> None:
        self.is_enabled, self.uses = is_enabled, 0

    def isEnabled(self) -> bool:
        return self.is_enabled

    def trigger(self) -> None:
        self.uses += 1


def test_every_enabled_command_is_used_once_before_others_are_again() -> None:
    entries = {name: Entry(name != "redo") for name in ("undo", "redo", "smile", "blink")}
    commands: tuple[Command[object], ...] = tuple(
        Command(name, name, lambda _: None) for name in entries
    )
    menus = [(Menu("Edit", commands), None)]
    window = SimpleNamespace(
        editor=object(),
        document=SimpleNamespace(character=None),
        commands=SimpleNamespace(menus=lambda: menus),
        actions_=entries,
    )
    hands = Hands(cast(MainWindow, window), random.Random(5))
    for _ in range(3):
        hands.run_unused_command()
    assert {name: entry.uses for name, entry in entries.items()} == {
        **dict.fromkeys(entries, 1),
        "redo": 0,
    }
    assert hands.unused == {"redo"}
    entries["redo"].is_enabled = True
    hands.run_unused_command()
    assert entries["redo"].uses == 1
    assert not hands.unused


@pytest.mark.parametrize(
    ("gesture", "changes"),
    [
        (gestures.drag_curve, edits),
        (gestures.lose_mouse, edits),
        (gestures.move_selection, range_of_first),
        (gestures.travel, steps),
        (gestures.play, lambda window: window.timeline.time),
        (gestures.turn_wheel, lambda window: window.timeline.view),
        (gestures.resize, sizes),
        (gestures.set_exactness, lambda window: session_of(window).settings),
        (list_gestures.type_in_list, edits),
        (list_gestures.drag_row, edits),
        (list_gestures.click_in_list, edits),
        (list_gestures.edit_channels, channels),
    ],
)
def test_gesture_changes_what_it_is_for(
    bench: Bench, gesture: Callable[[Hands], object], changes: Callable[[MainWindow], object]
) -> None:
    window = bench.editing()
    assert window.editor is not None
    session_of(window).add(*EDITS)
    window.editor.edits.select(0)
    hands, before = Hands(window, random.Random(5)), changes(window)
    with dialogs_cancelled() as errors:
        for _ in range(TRIES):
            gesture(hands)
            QCoreApplication.processEvents()
            if changes(window) != before:
                break
    window.workspace.end_gestures()
    assert not errors
    assert changes(window) != before
    assert not session_of(window).is_previewing
