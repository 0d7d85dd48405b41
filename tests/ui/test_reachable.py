"""Everything by keyboard and for screen readers: names, focus, tips, and room at 1280 by 720."""

from __future__ import annotations

import pytest
from PySide6.QtWidgets import QAbstractButton, QLabel, QWidget
from support.waiting import run_events
from support.windows import Bench

from faceedit_app.ui.commands.menus import MENUS
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.actions import shown_keys

# What every application has, and menus within menus.
SELF_EXPLANATORY = {
    "recent",
    "history",
    "recent_characters",
    "quit",
    "presets",
    "shortcuts",
    "about",
}


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    return bench.editing()


def shown(window: MainWindow, kind: type[QWidget]) -> list[QWidget]:
    return [w for w in window.findChildren(kind) if w.isVisible() and w.window() is window]


def test_every_button_says_what_it_does(window: MainWindow) -> None:
    buttons = shown(window, QAbstractButton)
    assert len(buttons) > 20
    for button in buttons:
        assert isinstance(button, QAbstractButton)
        assert button.toolTip() or button.text(), button
        assert button.accessibleName() or button.text(), button


def test_every_command_says_what_it_does(window: MainWindow) -> None:
    commands = [command for menu in MENUS for command in menu.commands]
    assert {command.id for command in commands if not command.tip} == SELF_EXPLANATORY
    for command in commands:
        action = window.actions_[command.id]
        assert action.text().replace("&", "").strip(), command.id
        if command.tip:
            assert action.statusTip() == (action.data() or command.tip), command.id
            assert len(action.toolTip()) >= len(command.tip), command.id
            for keys in command.keys[:1]:
                assert f"({shown_keys(keys)})" in action.toolTip(), command.id


@pytest.mark.parametrize("size", [(1280, 720), (1000, 600)])
def test_nothing_is_cut_off_in_a_small_window(
    bench: Bench, window: MainWindow, size: tuple[int, int]
) -> None:
    window.resize(*size)
    run_events()
    assert (window.width(), window.height()) == size
    assert window.editor is not None
    for plot in window.editor.curves.plots:
        assert plot.height() >= 24
    right = window.editor.transport.width()
    for part in (window.editor.settings_bar, window.editor.tool_bar, window.editor.transport):
        children = [
            child
            for child in part.findChildren(QWidget)
            if child.isVisible() and child.parent() is part and not isinstance(child, QLabel)
        ]
        assert children, part
        for child in children:
            assert child.geometry().right() <= right, (child, child.objectName())
