"""Context menus of the curves: they open by a real right click and act on what was clicked."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from PySide6.QtCore import QPoint
from PySide6.QtGui import QContextMenuEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu, QWidget
from support.curves import CTRL, LEFT, RIGHT, drag, place, surface
from support.windows import Bench

from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX, LIDS, LIP_OPENING, MAIN_CONTROLS
from faceedit_app.ui.curves import CurvesPanel
from faceedit_app.ui.curves.range_bar import RangeBar
from faceedit_app.ui.curves.ruler import Ruler
from faceedit_app.ui.page import curve_menus
from faceedit_app.ui.page.editor import Editor
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.time_display import Unit


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    return bench.editing()


@pytest.fixture
def page(window: MainWindow) -> Editor:
    assert window.editor is not None
    return window.editor


@pytest.fixture
def panel(page: Editor) -> CurvesPanel:
    return page.curves


def opened(owner: QWidget) -> QMenu:
    menus = [menu for menu in owner.findChildren(QMenu) if menu.isVisible()]
    assert len(menus) == 1
    return menus[0]


def right_click(panel: CurvesPanel, widget: QWidget, at: QPoint) -> QMenu:
    QTest.mouseMove(surface(widget), at)
    QTest.mouseClick(surface(widget), RIGHT, pos=at)
    return opened(panel)


def on_name(panel: CurvesPanel, row: int) -> QMenu:
    header = panel.headers[row]
    at = header.rect().center()
    event = QContextMenuEvent(QContextMenuEvent.Reason.Mouse, at, header.mapToGlobal(at))
    QApplication.sendEvent(header, event)
    return opened(panel)


def choose(menu: QMenu, command: str) -> None:
    (action,) = (action for action in menu.actions() if action.objectName() == command)
    assert action.isEnabled()
    action.trigger()
    menu.close()


def commands(menu: QMenu) -> list[str]:
    return [action.objectName() for action in menu.actions() if not action.isSeparator()]


def flat(groups: curve_menus.Groups) -> list[str]:
    return [name for group in groups for name in group]


# --- a curve -----------------------------------------------------------------------------------


def test_a_curve_offers_the_fixes_that_change_it(panel: CurvesPanel) -> None:
    found: dict[str, list[str]] = {}
    for control in (LIP_OPENING, LIDS[0]):
        plot = panel.plots[CONTROL_INDEX[control]]
        menu = right_click(panel, plot, place(plot, 1.0))
        assert panel.focused_control == control
        found[control] = commands(menu)
        assert found[control] == flat(curve_menus.curve_groups(control))
        menu.close()
    assert "fix_close_lips" in found[LIP_OPENING]
    assert "fix_blink" not in found[LIP_OPENING]
    assert "fix_blink" in found[LIDS[0]]
    assert "fix_close_lips" not in found[LIDS[0]]


def test_a_right_click_acts_where_it_was(window: MainWindow, panel: CurvesPanel) -> None:
    session = panel.session
    assert session is not None
    plot = panel.plots[CONTROL_INDEX[LIP_OPENING]]
    choose(right_click(panel, plot, place(plot, 1.5)), "fix_close_lips")
    assert any(LIP_OPENING in edit.controls for edit in session.edits)
    choose(right_click(panel, plot, place(plot, 2.0)), "select_around")
    assert window.timeline.selection == pytest.approx((1.5, 2.5), abs=0.03)
    before = window.timeline.frame
    menu = right_click(panel, plot, place(plot, 1.8))
    assert window.timeline.frame == before, "inside the selection the playhead stays"
    choose(menu, "reset_curve")
    assert session.edits[-1].controls == (LIP_OPENING,)
    assert (session.edits[-1].start, session.edits[-1].end) == window.timeline.selection


def test_the_menu_key_opens_it_too(panel: CurvesPanel) -> None:
    plot = panel.plots[2]
    at = plot.rect().center()
    event = QContextMenuEvent(QContextMenuEvent.Reason.Keyboard, at, plot.mapToGlobal(at))
    QApplication.sendEvent(plot, event)
    menu = opened(panel)
    assert panel.focused_control == plot.control.id
    menu.close()


def test_the_right_button_drops_a_drag_and_opens_nothing(panel: CurvesPanel) -> None:
    plot = panel.plots[0]
    start = place(plot, 1.5)
    drag(plot, start, start - QPoint(0, 15), release=False)
    QTest.mouseClick(surface(plot), RIGHT, pos=start - QPoint(0, 15))
    assert not panel.is_dragging
    assert not [menu for menu in panel.findChildren(QMenu) if menu.isVisible()]
    QTest.mouseRelease(surface(plot), LEFT, pos=start)
    assert panel.session is not None
    assert panel.session.edits == ()


# --- its name ----------------------------------------------------------------------------------


def test_a_name_gives_its_curve_the_keyboard(panel: CurvesPanel) -> None:
    row = CONTROL_INDEX[LIP_OPENING] + 1
    menu = on_name(panel, row)
    assert commands(menu) == flat(curve_menus.NAME)
    menu.close()
    panel.nudge(1.0)
    assert panel.session is not None
    (edit,) = panel.session.edits
    assert panel.plots[row].control.id in edit.controls


def test_curves_are_chosen_by_the_menu_as_by_ctrl(panel: CurvesPanel) -> None:
    choose(on_name(panel, 1), "choose_curve")
    QTest.mouseClick(panel.headers[4], LEFT, CTRL)
    assert panel.chosen_controls == (CONTROL_IDS[1], CONTROL_IDS[4])
    choose(on_name(panel, 1), "choose_curve")
    assert panel.chosen_controls == (CONTROL_IDS[4],)


def test_curves_are_hidden_and_shown(bench: Bench, window: MainWindow, panel: CurvesPanel) -> None:
    def shown() -> list[int]:
        rows = zip(panel.headers, panel.plots, strict=True)
        return [i for i, row in enumerate(rows) if all(part.isVisible() for part in row)]

    everything = shown()
    choose(on_name(panel, 1), "hide_curve")
    assert shown() == [i for i in everything if i != 1]
    choose(on_name(panel, 2), "show_only_curve")
    assert shown() == [2, 3], "left and right are edited together"
    window.actions_["link"].trigger()
    choose(on_name(panel, 3), "show_only_curve")
    assert shown() == [3]
    menu = on_name(panel, 3)
    assert not window.actions_["hide_curve"].isEnabled()
    choose(menu, "show_all_curves")
    assert shown() == everything
    choose(on_name(panel, 0), "hide_curve")
    window.actions_["curve_1"].trigger()
    assert shown() == everything, "the keyboard goes to no curve that is not seen"


def test_the_curves_that_are_left_share_the_height(panel: CurvesPanel) -> None:
    height = panel.plots[len(MAIN_CONTROLS) - 1].geometry().bottom() - panel.plots[0].y()
    choose(on_name(panel, 2), "show_only_curve")
    QApplication.processEvents()
    first, last = panel.plots[2:4]
    assert first.height() == pytest.approx(last.height(), abs=1)
    assert last.geometry().bottom() - first.y() == pytest.approx(height, abs=1)
    assert last.y() - first.geometry().bottom() < 10


def test_hidden_curves_keep_up_and_are_not_edited(window: MainWindow, panel: CurvesPanel) -> None:
    choose(on_name(panel, 0), "choose_curve")
    choose(on_name(panel, 1), "choose_curve")
    choose(on_name(panel, 0), "hide_curve")
    assert panel.chosen_controls == (CONTROL_IDS[1],)
    window.timeline.show_range(1.0, 2.0)
    window.resize(window.width() + 40, window.height())
    window.actions_["show_all_curves"].trigger()
    QApplication.processEvents()
    first, second = panel.plots[:2]
    assert first.current_scale.view == second.current_scale.view == (1.0, 2.0)
    assert place(first, 1.7).x() == place(second, 1.7).x()


def test_small_movements_are_enlarged_by_the_menu(window: MainWindow, panel: CurvesPanel) -> None:
    window.timeline.show_range(0.0, 0.2)
    before = panel.plots[1].values
    choose(on_name(panel, 1), "enlarge_curve")
    assert window.actions_["enlarge_curve"].isChecked()
    after = panel.plots[1].values
    assert after[1] - after[0] <= before[1] - before[0]
    choose(on_name(panel, 1), "enlarge_curve")
    assert panel.plots[1].values == pytest.approx(before)


# --- the ruler ---------------------------------------------------------------------------------


@pytest.mark.parametrize("bar", [lambda panel: panel.ruler, lambda panel: panel.range_bar])
def test_ruler_and_range_bar(
    window: MainWindow, panel: CurvesPanel, bar: Callable[[CurvesPanel], Ruler | RangeBar]
) -> None:
    strip, line = bar(panel), window.timeline
    line.select((1.0, 2.0))
    menu = right_click(panel, strip, QPoint(30, 8))
    assert commands(menu) == flat(curve_menus.RULER)
    choose(menu, "fit")
    assert line.view == pytest.approx((0.9, 2.1))
    choose(right_click(panel, strip, QPoint(30, 8)), "deselect")
    assert line.selection is None
    choose(right_click(panel, strip, place(strip, 1.2, 8)), "mark_start")
    choose(right_click(panel, strip, place(strip, 1.9, 8)), "mark_end")
    assert line.selection == pytest.approx((1.2, 1.9), abs=0.02), "here is where it was clicked"
    choose(right_click(panel, strip, QPoint(30, 8)), "unit_frames")
    assert line.display.unit is Unit.FRAMES


def test_view_all_shows_the_whole_take_and_its_values(
    window: MainWindow, panel: CurvesPanel
) -> None:
    line, plot = window.timeline, panel.plots[0]
    values = plot.values
    line.show_range(0.5, 1.0)
    plot.show_values((0.0, 100.0))
    plot.values_chosen = True
    choose(right_click(panel, panel.ruler, QPoint(30, 8)), "view_all")
    assert line.view == pytest.approx((0.0, line.duration))
    assert plot.values == pytest.approx(values)
