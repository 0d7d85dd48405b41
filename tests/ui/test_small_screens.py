"""Dialogs on a screen with less room than they would like."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import pytest
from PySide6.QtCore import QSize
from PySide6.QtGui import QScreen
from PySide6.QtWidgets import QMenu, QWidget
from pytestqt.qtbot import QtBot
from support.windows import Bench, editor_of, trigger

from faceedit_app.ui.character.checklist import CharacterChecklist
from faceedit_app.ui.commands.help import about_dialog
from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.rows import CurveRows
from faceedit_app.ui.look.widgets import Elided


@pytest.mark.parametrize("kind", ["checklist", "about"])
def test_a_dialog_is_no_larger_than_the_screen(
    kind: str, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(QScreen, "availableSize", lambda _: QSize(500, 480))
    parent = QWidget()
    qtbot.addWidget(parent)
    dialog = CharacterChecklist(parent) if kind == "checklist" else about_dialog(parent, "")
    assert dialog.width() <= 500
    assert dialog.height() < 480


def test_every_menu_is_one_column_on_a_small_laptop(bench: Bench) -> None:
    """1920 x 1080 at twice the size are 540 pixels; a menu that is higher becomes two columns."""
    window = bench.window()
    menus = window.menuBar().findChildren(QMenu)
    assert len(menus) > 8
    for menu in menus:
        assert menu.sizeHint().height() <= 540, menu.title()


def test_the_window_fits_1080_lines_at_twice_the_size(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(QScreen, "availableSize", lambda _: QSize(960, 540))
    window = bench.editing()
    window.resize(960, 510)
    bench.qtbot.waitUntil(lambda: window.width() <= 960)
    assert window.height() <= 540
    assert window.editor is not None
    bottom = window.editor.transport.mapTo(window, window.editor.transport.rect().bottomLeft())
    assert bottom.y() < window.height()
    lists = window.editor.lists
    assert lists.height() == lists.minimumSizeHint().height(), "the face gets all the rest"


def test_a_low_window_keeps_a_whole_curve_in_view_beside_all_channels(bench: Bench) -> None:
    window = bench.editing()
    editor = editor_of(window)
    editor.sound.want(True)
    editor.words.want(True)
    trigger(window, "all_channels")
    (rows,) = editor.curves.findChildren(CurveRows)

    def shown() -> tuple[bool, bool]:
        return editor.sound.isVisible(), editor.words.isVisible()

    for height, wanted in ((900, (True, True)), (640, (False, True)), (900, (True, True))):
        window.resize(1000, height)
        bench.qtbot.waitUntil(partial(_is_settled, rows, shown, wanted))
    editor.words.want(False)
    window.resize(1000, 600)
    bench.qtbot.waitUntil(partial(_is_settled, rows, shown, (False, False)))


def _is_settled(
    rows: CurveRows, shown: Callable[[], tuple[bool, bool]], wanted: tuple[bool, bool]
) -> bool:
    return shown() == wanted and rows.viewport().height() >= style.ROW_HEIGHT


def test_a_line_without_room_is_shown_in_short(qtbot: QtBot) -> None:
    line = Elided()
    qtbot.addWidget(line)
    line.setText("3 edits · 3356 frames changed")
    line.short = "3 edits"
    line.resize(400, 20)
    assert line.shown == "3 edits · 3356 frames changed"
    line.resize(100, 20)
    assert line.shown == "3 edits"
    line.resize(20, 20)
    assert line.shown.endswith("…")
