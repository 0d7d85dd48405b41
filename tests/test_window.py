"""The window as a user meets it: open, edit, undo, export, close."""

from __future__ import annotations

import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from faces import random_engine
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import QApplication, QPushButton, QWidget
from takes import make_livelink_csv
from windows import Bench, drag_curve

from faceedit_app import render
from faceedit_app.core.regions import CONTROL_INDEX
from faceedit_app.core.resources import shipped
from faceedit_app.editing.edit import Edit, Op, read_edits
from faceedit_app.formats.opening import open_take
from faceedit_app.ui import loading
from faceedit_app.ui.dialogs import Unsaved
from faceedit_app.ui.window import MainWindow

OPENING = CONTROL_INDEX["mouth_opening"]


def add_edit(window: MainWindow, value: float = 6.0) -> None:
    """An edit as a drag would leave it."""
    assert window.document.session is not None
    window.document.session.add(Edit(("mouth_opening",), Op.OFFSET, 1.0, 1.4, 0.2, value))
    window.document.changed.emit()


def trigger(window: MainWindow, command: str) -> None:
    window.actions_[command].trigger()


def drop(target: QWidget, path: Path) -> None:
    """Drop a file on a widget; what it does not want goes to the widgets around it."""
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(path))])
    buttons, keys = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
    enter = QDragEnterEvent(QPoint(9, 9), Qt.DropAction.CopyAction, data, buttons, keys)
    QApplication.sendEvent(target, enter)
    assert enter.isAccepted()
    event = QDropEvent(QPointF(9, 9), Qt.DropAction.CopyAction, data, buttons, keys)
    QApplication.sendEvent(target, event)


def open_path(window: MainWindow) -> Path:
    assert window.document.path is not None
    return window.document.path


# --- start -----------------------------------------------------------------------------------


def test_the_window_is_painted_before_anything_heavy_is_imported() -> None:
    code = """
import sys, tempfile
from PySide6.QtCore import QSettings, QTimer
from faceedit_app.ui.app import application
from faceedit_app.ui.store import Store
from faceedit_app.ui.window import MainWindow
app = application()
window = MainWindow(Store(QSettings(tempfile.mktemp(), QSettings.Format.IniFormat)))
window.after_first_paint(app.quit)
window.show()
app.exec()
heavy = {"torch", "scipy", "pyrender", "OpenGL", "pyqtgraph", "pygltflib"}
print(sorted(heavy & set(sys.modules)))
"""
    environment = {"QT_QPA_PLATFORM": "offscreen"} | dict(__import__("os").environ)
    out = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=True
    )
    assert out.stdout.strip() == "[]"


def test_without_a_take_the_window_says_what_to_do(bench: Bench) -> None:
    window = bench.window()
    texts = [button.text() for button in window.start_page.findChildren(QPushButton)]
    assert any(text.startswith("Open…") for text in texts)
    assert "Open the demo take" in texts
    assert not window.actions_["export"].isEnabled()
    assert not window.actions_["play"].isEnabled()
    assert window.actions_["open"].isEnabled()
    assert window.windowTitle() == "FaceEdit"


def test_missing_networks_are_told_without_being_in_the_way(bench: Bench) -> None:
    window = bench.editing()
    assert window.banner.isVisible()
    assert "rig alone" in window.banner.text.text()
    assert "rig alone" in window.status.networks.text()
    assert bench.errors == []
    drag_curve(window, OPENING, 1.0, 20)
    assert window.document.session is not None
    assert len(window.document.session.edits) == 1


def test_networks_answer_once_they_are_loaded(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(loading, "load_engine", random_engine)
    window = bench.editing()
    assert window.document.session is not None
    assert window.document.session.has_engine
    assert window.status.networks.text() == "Networks: ready"
    assert not window.banner.isVisible()


def test_while_a_take_is_read_the_window_says_so(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    gate = threading.Event()
    real = loading.open_session
    monkeypatch.setattr(
        loading, "open_session", lambda path, rig: (gate.wait(10), real(path, rig))[1]
    )
    window = bench.window(start=False)
    window.start(bench.take)
    assert window.start_page.loading.isVisible()
    assert window.start_page.loading.text() == "Opening take.csv…"
    gate.set()
    bench.qtbot.waitUntil(lambda: window.document.session is not None)
    assert window.status.currentMessage() == ""


def test_without_opengl_the_reason_is_shown_and_curves_still_work(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(render, "open_renderer", bench.no_gl)
    window = bench.editing()
    assert window.editor is not None
    assert "no OpenGL; install it" in window.editor.face.viewport.message
    window.grab()
    drag_curve(window, OPENING, 1.0, 20)
    assert window.document.session is not None
    assert len(window.document.session.edits) == 1
    assert bench.errors == []


# --- open ------------------------------------------------------------------------------------


def test_open_by_command(bench: Bench) -> None:
    window = bench.window()
    bench.answers["open"] = bench.take
    trigger(window, "open")
    bench.qtbot.waitUntil(lambda: window.document.session is not None)
    assert window.windowTitle() == "take.csv[*] – FaceEdit"
    assert "Live Link Face CSV" in window.status.facts.text()
    assert "60 fps" in window.status.facts.text()
    assert "180 frames" in window.status.facts.text()
    assert window.actions_["export"].isEnabled()
    assert not window.actions_["undo"].isEnabled()


def test_open_by_drop_with_gaps(bench: Bench) -> None:
    window = bench.window()
    drop(window, make_livelink_csv(bench.folder / "gaps.csv", dropped=(20, 50, 51, 52)))
    bench.qtbot.waitUntil(lambda: window.document.session is not None)
    assert open_path(window).name == "gaps.csv"
    assert "2 gaps, 4 frames missing" in window.status.gaps.text()
    assert "2 gaps" in window.status.gaps.toolTip()


def test_a_file_may_be_dropped_on_any_part_of_the_window(bench: Bench) -> None:
    window = bench.editing()
    assert window.editor is not None
    viewports = (window.editor.curves.plots[0].viewport(), window.editor.face.viewport)
    for number, part in enumerate(viewports):
        other = make_livelink_csv(bench.folder / f"other{number}.csv")
        drop(part, other)
        bench.qtbot.waitUntil(lambda path=other: open_path(window) == path)


def test_a_bad_first_file_leaves_a_window_that_works(bench: Bench) -> None:
    bad = bench.folder / "bad.csv"
    bad.touch()
    window = bench.window(start=False)
    with bench.qtbot.waitSignal(window.settled):
        window.start(bad)
    assert len(bench.errors) == 1
    assert window.start_page.isVisible()
    drop(window, bench.take)
    bench.qtbot.waitUntil(lambda: window.document.session is not None)


def test_open_a_recent_take(bench: Bench) -> None:
    bench.store().add_recent(bench.take)
    window = bench.window()
    recent = [b for b in window.start_page.findChildren(QPushButton) if b.text() == "take.csv"]
    bench.qtbot.mouseClick(recent[0], Qt.MouseButton.LeftButton)
    bench.qtbot.waitUntil(lambda: window.document.session is not None)
    menu = window.actions_.recent_menu
    menu.aboutToShow.emit()
    assert [a.text() for a in menu.actions()] == ["take.csv", "", "Clear"]
    menu.actions()[-1].trigger()
    menu.aboutToShow.emit()
    assert [a.text() for a in menu.actions()] == ["No recent takes"]


def test_open_the_demo(bench: Bench) -> None:
    window = bench.window()
    trigger(window, "open_demo")
    bench.qtbot.waitUntil(lambda: window.document.session is not None)
    assert open_path(window) == shipped("assets/demo_take.csv")
    assert bench.store().recent() == []


@pytest.mark.parametrize("kind", ["empty", "picture", "folder", "missing"])
def test_a_bad_file_is_one_line_and_the_old_take_stays(bench: Bench, kind: str) -> None:
    window = bench.editing()
    bad = bench.folder / "bad.csv"
    if kind == "empty":
        bad.touch()
    elif kind == "picture":
        bad.write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(range(256)))
    elif kind == "folder":
        bad.mkdir()
    drop(window, bad)
    bench.qtbot.waitUntil(lambda: bool(bench.errors))
    assert len(bench.errors) == 1
    assert "\n" not in bench.errors[0]
    assert "bad.csv" in bench.errors[0]
    assert open_path(window) == bench.take
    assert window.status.currentMessage() == ""


def test_the_take_that_was_asked_for_last_wins(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    gate = threading.Event()
    real = loading.open_session
    slow = make_livelink_csv(bench.folder / "slow.csv")

    def read(path: Path, rig: object) -> object:
        if path == slow:
            gate.wait(10)
        return real(path, rig)  # type: ignore[arg-type]

    monkeypatch.setattr(loading, "open_session", read)
    window = bench.window()
    window.files.open(slow)
    window.files.open(bench.take)
    bench.qtbot.waitUntil(lambda: window.document.session is not None)
    gate.set()
    bench.qtbot.wait(100)
    assert open_path(window) == bench.take


# --- edit ------------------------------------------------------------------------------------


def test_a_drag_with_the_mouse_changes_the_exported_file(bench: Bench) -> None:
    window = bench.editing()
    before = bench.take.read_bytes()
    drag_curve(window, OPENING, 1.5, 25)
    session = window.document.session
    assert session is not None
    assert len(session.edits) == 1
    assert window.isWindowModified()
    bench.answers["export"] = bench.folder / "out.csv"
    trigger(window, "export")
    after = (bench.folder / "out.csv").read_bytes()
    assert after != before
    assert len(after.splitlines()) == len(before.splitlines())
    assert not window.isWindowModified()
    assert "Exported" in window.status.currentMessage()


def test_what_is_exported_opens_as_what_was_on_screen(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window)
    session = window.document.session
    assert session is not None
    shown = session.clip_weights()
    bench.answers["export"] = bench.folder / "out.csv"
    trigger(window, "export")
    again = open_take(bench.folder / "out.csv")
    np.testing.assert_allclose(again.clip.weights, shown, atol=1e-6)
    assert again.clip.channels == session.take.clip.channels


def test_undo_redo_and_reset(bench: Bench) -> None:
    window = bench.editing()
    session = window.document.session
    assert session is not None
    tracked = session.weights.copy()
    add_edit(window)
    edited = session.weights.copy()
    assert not np.array_equal(edited, tracked)
    trigger(window, "undo")
    np.testing.assert_array_equal(session.weights, tracked)
    assert not window.isWindowModified()
    assert not window.actions_["undo"].isEnabled()
    trigger(window, "redo")
    np.testing.assert_array_equal(session.weights, edited)
    trigger(window, "select_all")
    trigger(window, "reset_range")
    np.testing.assert_array_equal(session.weights, tracked)
    trigger(window, "undo")
    np.testing.assert_array_equal(session.weights, edited)


def test_reset_without_a_selection_acts_around_the_playhead(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window)
    window.timeline.go_to_time(1.2)
    window.timeline.set_falloff(0.3)
    trigger(window, "reset_range")
    session = window.document.session
    assert session is not None
    reset = session.edits[-1]
    assert reset.op is Op.RESET
    assert (reset.start, reset.end) == pytest.approx((0.9, 1.5), abs=0.02)


def test_reset_of_one_curve(bench: Bench) -> None:
    window = bench.editing()
    drag_curve(window, OPENING, 1.0, 20)
    trigger(window, "reset_curve")
    session = window.document.session
    assert session is not None
    assert session.edits[-1].controls == ("mouth_opening",)
    assert session.edits[-1].op is Op.RESET


def test_naturalness_is_one_undo_step_per_gesture(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window)
    session, editor = window.document.session, window.editor
    assert session is not None
    assert editor is not None
    slider = editor.strip.natural
    slider.setSliderDown(True)
    for value in (80, 60, 40):
        slider.setSliderPosition(value)
        bench.qtbot.wait(60)
    slider.setSliderDown(False)
    assert session.settings.naturalness == pytest.approx(0.4)
    assert editor.strip.percent.text() == "40 %"
    trigger(window, "undo")
    assert session.settings.naturalness == 1.0
    assert slider.value() == 100
    assert len(session.edits) == 1


def test_mode_is_chosen_by_its_two_buttons(bench: Bench) -> None:
    window = bench.editing()
    trigger(window, "resynthesize")
    assert window.actions_["resynthesize"].isChecked()
    assert not window.actions_["preserve"].isChecked()
    trigger(window, "undo")
    assert window.actions_["preserve"].isChecked()
    trigger(window, "preserve")
    assert window.actions_["preserve"].isChecked()


def test_edits_are_saved_and_loaded(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window)
    session = window.document.session
    assert session is not None
    file = bench.folder / "edits.json"
    bench.answers["save_edits"] = file
    trigger(window, "save_edits")
    assert read_edits(file) == session.edits
    assert not window.isWindowModified()
    trigger(window, "undo")
    drop(window, file)
    assert session.edits == read_edits(file)


def test_a_failed_export_says_so_and_keeps_the_edits(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window)
    bench.answers["export"] = bench.folder / "nowhere" / "out.csv"
    trigger(window, "export")
    assert len(bench.errors) == 1
    assert window.isWindowModified()


# --- close -----------------------------------------------------------------------------------


def test_closing_asks_about_edits(bench: Bench) -> None:
    window = bench.editing()
    assert window.document.session is not None
    add_edit(window)
    bench.answers["unsaved"] = Unsaved.CANCEL
    assert not window.close()
    assert window.isVisible()
    bench.answers |= {"unsaved": Unsaved.EXPORT, "export": None}
    assert not window.close()
    bench.answers |= {"unsaved": Unsaved.SAVE, "save_edits": bench.folder / "edits.json"}
    assert window.close()
    assert (bench.folder / "edits.json").exists()


def test_opening_another_take_asks_about_edits(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window)
    other = make_livelink_csv(bench.folder / "other.csv")
    bench.answers["unsaved"] = Unsaved.CANCEL
    drop(window, other)
    assert open_path(window) == bench.take
    bench.answers["unsaved"] = Unsaved.DISCARD
    drop(window, other)
    bench.qtbot.waitUntil(lambda: open_path(window) == other)
    assert not window.isWindowModified()


def test_without_edits_nothing_is_asked(bench: Bench) -> None:
    window = bench.editing()
    assert window.close()


def test_the_layout_is_remembered(bench: Bench) -> None:
    window = bench.editing()
    assert window.editor is not None
    window.editor.panes.setSizes([400, 880])
    sizes = window.editor.panes.sizes()
    window.resize(1280, 700)
    assert window.close()
    again = bench.window(bench.take)
    assert again.editor is not None
    assert again.editor.panes.sizes()[0] == pytest.approx(sizes[0], abs=4)
