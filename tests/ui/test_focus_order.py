"""Tab goes through the window in the order in which it is read, and shows where it is."""

from __future__ import annotations

from itertools import pairwise

import pytest
from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget
from support.waiting import run_events
from support.windows import Bench, add_edit, editor_of

from faceedit_app.ui.start.window import MainWindow

MOST = 200  # stops
AROUND = 6  # pixels beside a widget in which its focus may show


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    window = bench.editing()
    add_edit(window)
    editor_of(window).edits.select(0)
    window.activateWindow()
    window.setFocus()
    run_events()
    return window


def stops(window: MainWindow) -> list[QWidget]:
    """Where Tab stops, from the top of the window, until it is back."""
    found: list[QWidget] = []
    QTest.keyClick(window, Qt.Key.Key_Tab)
    while len(found) < MOST:
        focus = QApplication.focusWidget()
        assert focus is not None
        if focus in found:
            assert focus is found[0], "Tab goes round in a part of the window"
            top = min(range(len(found)), key=lambda i: place(found[i]).top())
            return found[top:] + found[:top]
        found.append(focus)
        QTest.keyClick(focus, Qt.Key.Key_Tab)
    raise AssertionError("Tab does not come back")


def place(widget: QWidget) -> QRect:
    return QRect(widget.mapTo(widget.window(), QPoint()), widget.size())


def test_tab_reaches_all_that_takes_the_focus_by_keys(window: MainWindow) -> None:
    reached = stops(window)
    for widget in window.findChildren(QWidget):
        if (
            widget.isVisible()
            and widget.isEnabled()
            and widget.window() is window
            and widget.focusPolicy() & Qt.FocusPolicy.TabFocus == Qt.FocusPolicy.TabFocus
            and widget.focusProxy() is None
        ):
            assert widget in reached, (widget, widget.accessibleName())


@pytest.mark.parametrize("unfolded", [False, True])
def test_tab_goes_from_top_to_bottom_in_each_part(window: MainWindow, unfolded: bool) -> None:
    editor = editor_of(window)
    editor.curves.shown.unfold(unfolded)
    run_events()
    parts: tuple[QWidget, ...] = (
        window.banner,
        editor.settings_bar,
        editor.tool_bar,
        editor.curves,
        editor.face,
        editor.lists,
        editor.transport,
    )
    part_of = [
        next(i for i, part in enumerate(parts) if part.isAncestorOf(stop) or part is stop)
        for stop in stops(window)
    ]
    assert part_of == sorted(part_of)
    for (part, one), (other, following) in pairwise(zip(part_of, stops(window), strict=True)):
        before, after = place(one), place(following)
        is_below = after.center().y() > before.center().y() - AROUND
        assert part != other or is_below or before.contains(after), (one, following)


def test_the_focus_is_seen(window: MainWindow) -> None:
    for stop in stops(window):
        around = place(stop).adjusted(-AROUND, -AROUND, AROUND, AROUND) & window.rect()
        pictures = []
        for focused in (stop, window):
            focused.setFocus(Qt.FocusReason.TabFocusReason)
            run_events()
            pictures.append(window.grab(around).toImage())
        assert pictures[0] != pictures[1], (stop, stop.accessibleName())
