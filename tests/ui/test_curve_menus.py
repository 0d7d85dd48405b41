"""Context menus of the curves: they open where they are asked for and act on that curve."""

from __future__ import annotations

import pytest
from PySide6.QtCore import QPoint
from PySide6.QtGui import QContextMenuEvent
from PySide6.QtWidgets import QApplication, QMenu, QWidget
from support.windows import Bench

from faceedit_app.core.controls import CONTROL_INDEX, LIP_OPENING
from faceedit_app.ui.page import curve_menus
from faceedit_app.ui.page.editor import Editor


@pytest.fixture
def page(bench: Bench) -> Editor:
    editor = bench.editing().editor
    assert editor is not None
    return editor


def opened(owner: QWidget) -> QMenu:
    menus = [menu for menu in owner.findChildren(QMenu) if menu.isVisible()]
    assert len(menus) == 1
    return menus[0]


@pytest.mark.parametrize(
    ("signal", "groups"),
    [
        ("curve_menu_asked", curve_menus.CURVE),
        ("name_menu_asked", curve_menus.NAME),
        ("time_menu_asked", curve_menus.RULER),
    ],
)
def test_each_place_offers_its_commands(
    page: Editor, signal: str, groups: curve_menus.Groups
) -> None:
    getattr(page.curves, signal).emit(QPoint(40, 40))
    menu = opened(page.curves)
    texts = [action.text() for action in menu.actions() if not action.isSeparator()]
    assert len(texts) == sum(map(len, groups))
    assert all(texts)
    menu.close()


def test_a_right_click_on_a_name_gives_its_curve_the_keyboard(page: Editor) -> None:
    row = CONTROL_INDEX[LIP_OPENING] + 1
    header = page.curves.headers[row]
    at = header.rect().center()
    event = QContextMenuEvent(QContextMenuEvent.Reason.Mouse, at, header.mapToGlobal(at))
    QApplication.sendEvent(header, event)
    opened(page.curves).close()
    before = page.curves.session.edits if page.curves.session else ()
    page.curves.nudge(1.0)
    assert page.curves.session is not None
    (edit,) = page.curves.session.edits[len(before) :]
    assert page.curves.plots[row].control.id in edit.controls
