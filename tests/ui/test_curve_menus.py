"""What a right click offers on curves, their names and the time."""

from __future__ import annotations

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QContextMenuEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu, QWidget
from support.curves import place, surface
from support.windows import Bench, drag_curve, trigger

from faceedit_app.ui.page.editor import CURVE_MENU, NAME_MENU, TIME_MENU, Editor
from faceedit_app.ui.start.window import MainWindow

RIGHT = Qt.MouseButton.RightButton


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    return bench.editing()


def editor_of(window: MainWindow) -> Editor:
    assert window.editor is not None
    return window.editor


def the_menu(window: MainWindow) -> QMenu:
    """The context menu that is open."""
    menus = editor_of(window).curves.findChildren(QMenu)
    (menu,) = [menu for menu in menus if menu.isVisible()]
    return menu


def offers(window: MainWindow, menu: QMenu, ids: tuple[tuple[str, ...], ...]) -> bool:
    """Whether a menu holds exactly these commands, in this order."""
    wanted = [window.actions_[name] for group in ids for name in group]
    return [action for action in menu.actions() if not action.isSeparator()] == wanted


def test_a_curves_menu_acts_on_it_at_that_moment(window: MainWindow) -> None:
    plot = editor_of(window).curves.plots[3]
    drag_curve(window, 3, 1.0, 12)
    QTest.mouseClick(surface(plot), RIGHT, pos=place(plot, 2.0, plot.height() / 2))
    menu = the_menu(window)
    assert offers(window, menu, CURVE_MENU)
    assert window.timeline.time == pytest.approx(2.0, abs=0.02)
    menu.close()
    trigger(window, "reset_curve")
    session = window.document.session
    assert session is not None
    assert session.edits[-1].controls == (plot.control.id,)


def ask_menu(widget: QWidget) -> None:
    at = widget.rect().center()
    event = QContextMenuEvent(QContextMenuEvent.Reason.Mouse, at, widget.mapToGlobal(at))
    QApplication.sendEvent(widget, event)


def test_a_names_menu_is_about_its_curve(window: MainWindow) -> None:
    curves = editor_of(window).curves
    ask_menu(curves.headers[5])
    menu = the_menu(window)
    assert offers(window, menu, NAME_MENU)
    assert curves.focused_control == curves.plots[5].control.id
    menu.close()


def test_the_rulers_menu_is_about_time(window: MainWindow) -> None:
    ruler = editor_of(window).curves.ruler
    QTest.mouseClick(surface(ruler), RIGHT, pos=surface(ruler).rect().center())
    menu = the_menu(window)
    assert offers(window, menu, TIME_MENU)
    menu.close()


def test_scales_that_were_chosen_fit_again(window: MainWindow) -> None:
    plots = editor_of(window).curves.plots
    for plot in plots:
        plot.values_chosen = True
    plots[2].setFocus(Qt.FocusReason.MouseFocusReason)
    trigger(window, "fit_curve")
    assert [plot.values_chosen for plot in plots].count(False) == 1
    assert not plots[2].values_chosen
    trigger(window, "fit_curves")
    assert not any(plot.values_chosen for plot in plots)
