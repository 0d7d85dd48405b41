"""Windows and panels that tests use again: as new, or noticed to be not."""

from __future__ import annotations

from collections.abc import Callable
from threading import Event

from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot
from support import renewal
from support.curves import drag, place
from support.facts import differences, facts_of
from support.panels import PanelShelf
from support.waiting import run_events, wait_for_background
from support.windows import Bench, drag_curve, editor_of, press_key, trigger

from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.tools import Tool


def hide_a_curve(window: MainWindow) -> None:
    editor_of(window).curves.focus_curve(2)
    trigger(window, "hide_curve")


CHANGES: tuple[Callable[[MainWindow], object], ...] = (
    lambda window: window.timeline.zoom(0.5, 1.0),
    lambda window: window.timeline.go_to_frame(9),
    lambda window: window.timeline.select((0.5, 1.0)),
    lambda window: drag_curve(window, 0, 1.0, 12),
    lambda window: trigger(window, "tool_draw"),
    lambda window: trigger(window, "loop"),
    lambda window: trigger(window, "show_difference"),
    lambda window: trigger(window, "unit_frames"),
    hide_a_curve,
    lambda window: editor_of(window).lists.setCurrentIndex(2),
    lambda window: editor_of(window).panes.setSizes([500, 780]),
    lambda window: editor_of(window).transport.speed.setCurrentIndex(0),
    lambda window: editor_of(window).settings_bar.exactness.setFocus(),
    lambda window: window.banner.show_message("Something"),
    lambda window: window.resize(1200, 700),
)


def test_what_a_user_changes_tells_a_window_from_a_new_one(bench: Bench) -> None:
    window = bench.window(bench.take)
    facts = facts_of(window)
    assert facts_of(window) == facts
    for number, change in enumerate(CHANGES):
        change(window)
        run_events()
        changed = facts_of(window)
        assert changed != facts, f"change {number} is not seen"
        facts = changed


def test_a_window_that_was_used_is_as_new(bench: Bench) -> None:
    window = bench.window(bench.take)
    wanted = facts_of(window)
    drag_curve(window, 0, 1.0, 12)
    trigger(window, "fix_smile")
    press_key(editor_of(window).settings_bar.exactness, Qt.Key.Key_Left)
    for command in ("undo", "tool_draw", "zoom_in", "loop", "show_both", "unit_frames"):
        trigger(window, command)
    hide_a_curve(window)
    trigger(window, "unfold_curves")
    QTest.mousePress(editor_of(window).curves.plots[0].viewport(), Qt.MouseButton.LeftButton)
    for _ in range(6):  # more than there are threads
        window.workspace.background.run(int, lambda _: None, lambda _: None)
    wait_for_background(window.workspace.background)
    shelf = renewal.Shelf()
    assert shelf.put(window)
    assert not shelf.put(window), "there is one"
    bench.forget_preferences()
    assert shelf.take() is window
    bench.renew(window, bench.take)
    assert differences(wanted, facts_of(window)) == []


def test_a_window_at_work_is_not_kept(bench: Bench) -> None:
    window, go_on = bench.window(bench.take), Event()
    window.workspace.background.run(go_on.wait, lambda _: None, lambda _: None)
    assert not renewal.Shelf().put(window)
    go_on.set()
    window.close()
    assert not renewal.Shelf().put(window), "it is closed"


def test_a_panel_that_was_used_is_as_new(qtbot: QtBot) -> None:
    shelf = PanelShelf()
    panel = shelf.take(qtbot)
    start = place(panel.plots[0], 1.0)
    drag(panel.plots[0], start, start - QPoint(0, 12))
    panel.timeline.select((0.5, 1.0))
    panel.timeline.set_falloffs(0.5, 0.4)
    panel.timeline.zoom(0.5, 1.0)
    panel.tools.choose(Tool.DRAW)
    panel.tools.link(False)
    panel.shown.show({"mouth_opening"})
    panel.plots[1].setFocus()
    shelf.put(panel)
    assert shelf.take(qtbot) is panel
    assert panel.session is not None
    assert panel.session.edits == ()
    shelf.put(panel)
    shelf.close()


def test_a_panel_that_is_not_as_new_is_not_used_again(qtbot: QtBot) -> None:
    shelf = PanelShelf()
    panel = shelf.take(qtbot)
    panel.fields.setToolTip("Something")
    shelf.put(panel)
    other = shelf.take(qtbot)
    assert other is not panel
    shelf.put(other)
    shelf.close()
