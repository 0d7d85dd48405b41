"""Everything by keyboard and for screen readers: names, focus, tips, and room at 1280 by 720."""

from __future__ import annotations

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QAbstractButton, QLabel, QWidget
from support.waiting import run_events
from support.windows import Bench

from faceedit_app.ui.commands.menus import MENUS
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.actions import shown_keys


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    return bench.editing()


def shown(window: MainWindow, kind: type[QWidget]) -> list[QWidget]:
    return [w for w in window.findChildren(kind) if w.isVisible() and w.window() is window]


def test_whatever_has_the_focus_has_a_name(window: MainWindow) -> None:
    for widget in shown(window, QWidget):
        if widget.focusPolicy() & Qt.FocusPolicy.TabFocus and widget.isEnabled():
            if widget.focusProxy() is not None:
                continue
            words = widget.accessibleName() or getattr(widget, "text", str)()
            assert words, (widget, widget.objectName(), widget.parent())


def test_every_button_says_what_it_does(window: MainWindow) -> None:
    for button in shown(window, QAbstractButton):
        assert isinstance(button, QAbstractButton)
        assert button.toolTip() or button.text(), button
        assert button.accessibleName() or button.text(), button


def test_every_command_says_what_it_does(window: MainWindow) -> None:
    for command in (command for menu in MENUS for command in menu.commands):
        action = window.actions_[command.id]
        assert action.text(), command.id
        if command.keys:
            assert shown_keys(command.keys[0]) in action.toolTip() or not command.tip, command.id


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
        for child in part.findChildren(QWidget):
            if child.isVisible() and child.parent() is part and not isinstance(child, QLabel):
                assert child.geometry().right() <= right, (child, child.objectName())
