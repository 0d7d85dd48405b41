"""From the start of the window to an open take, and what may be missing on the way."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import cast

import pytest
from PySide6.QtCore import QObject, Qt
from PySide6.QtWidgets import QPushButton, QWidget
from pytestqt.qtbot import QtBot
from support.faces import random_engine, random_rig, shipped_rig
from support.takes import make_livelink_csv
from support.waiting import wait_for_background
from support.windows import Bench, FakeRenderer, drag_curve, drop, open_path, trigger

from faceedit_app import render
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.core.errors import FileError
from faceedit_app.core.resources import shipped
from faceedit_app.core.rig import Rig
from faceedit_app.ui.start.application import Collector, collect_nothing, collecting
from faceedit_app.ui.state import loading
from faceedit_app.ui.state.background import Background
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.take_opener import TakeOpener

OPENING = CONTROL_INDEX["mouth_opening"]


def run_python(code: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run code in a process of its own, offscreen."""
    return subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        encoding="utf-8",
        env=os.environ | {"PYTHONUTF8": "1"} | environment,
        check=True,
        timeout=60,
    )


# --- start -----------------------------------------------------------------------------------


def test_the_window_is_painted_before_anything_heavy_is_imported() -> None:
    code = """
import sys, tempfile
from PySide6.QtCore import QSettings, QTimer
from faceedit_app.ui.start.application import application
from faceedit_app.ui.state.preferences import Preferences
from faceedit_app.ui.start.window import MainWindow
app = application()
window = MainWindow(Preferences(QSettings(tempfile.mktemp(), QSettings.Format.IniFormat)))
window.after_first_paint(app.quit)
window.show()
app.exec()
heavy = {"torch", "scipy", "OpenGL", "pyqtgraph", "pygltflib"}
print(sorted(heavy & set(sys.modules)))
"""
    assert run_python(code).stdout.strip() == "[]"


def test_no_sources_are_read_while_modules_are_imported() -> None:
    """PySide6 would read them all: a fifth of the time until the face is there."""
    code = """
import linecache
from faceedit_app.ui.start import app
import scipy.sparse, faceedit_app.editing.session
large = ("scipy", "editing", "commands")
print([path for path in linecache.cache if any(name in path for name in large)])
"""
    assert run_python(code).stdout.strip() == "[]"


def test_the_whole_application_starts_on_the_demo_and_ends_in_silence(tmp_path: Path) -> None:
    code = """
import sys
from faceedit_app.ui.start import app
from faceedit_app.ui.start.window import MainWindow
from PySide6.QtCore import QTimer
start = MainWindow.start
def start_and_close(window, take, demo, character):
    window.settled.connect(lambda: QTimer.singleShot(300, finish))
    def finish():
        print(window.windowTitle(), window.document.session is not None)
        window.close()
    start(window, take, demo, character)
MainWindow.start = start_and_close
sys.exit(app.run(None, demo=True))
"""
    homes = {"XDG_CONFIG_HOME": tmp_path, "XDG_STATE_HOME": tmp_path, "HOME": tmp_path}
    out = run_python(code, **{name: str(path) for name, path in homes.items()})
    assert out.stdout.strip() == "demo_take.csv[*] – FaceEdit True"
    assert out.stderr == ""


def test_without_a_take_the_window_says_what_to_do(bench: Bench) -> None:
    window = bench.window()
    texts = [button.text() for button in window.start_page.findChildren(QPushButton)]
    assert any(text.startswith("Open…") for text in texts)
    assert {"Track a film…", "Open the demo take"} <= set(texts)
    assert not window.actions_["export"].isEnabled()
    assert not window.actions_["play"].isEnabled()
    assert window.actions_["open"].isEnabled()
    assert window.windowTitle() == "FaceEdit[*]"


def test_missing_networks_are_reported_without_being_in_the_way(bench: Bench) -> None:
    window = bench.editing()
    assert window.banner.isVisible()
    assert "face model could not be loaded" in window.banner.text.text()
    assert "No face model" in window.status.networks.text()
    assert bench.errors == []
    drag_curve(window, OPENING, 1.0, 20)
    assert window.document.session is not None
    assert len(window.document.session.edits) == 1


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_a_missing_character_is_reported_once_whichever_ends_first(
    order: tuple[int, int], qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Both its own loading and that of the take end in it; another take is reported again."""
    jobs: list[Callable[[], None]] = []

    class InTurn:
        def run(self, work: Callable[[], Rig], _done: object, failed: Callable[..., None]) -> None:
            def end() -> None:
                with pytest.raises(FileError) as raised:
                    work()
                failed(raised.value)

            jobs.append(end)

    def missing() -> None:
        raise FileError("character.glb", "is missing", "install FaceEdit again")

    monkeypatch.setattr(loading, "load_character", missing)
    owner, errors = QObject(), list[Exception]()
    opener = TakeOpener(Document(owner), cast(Background, InTurn()), owner)
    opener.failed.connect(errors.append)
    opener.load_character()
    opener.open(Path("take.csv"))
    for job in order:
        jobs[job]()
    assert [str(error) for error in errors] == ["character.glb: is missing; install FaceEdit again"]
    opener.open(Path("take.csv"))
    jobs[2]()
    assert len(errors) == 2


def test_networks_answer_once_they_are_loaded(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(loading, "load_engine", lambda rig: random_engine())
    window = bench.editing()
    assert window.document.session is not None
    assert window.document.session.has_engine
    assert window.status.networks.text() == "", "nothing to say"
    assert not window.banner.isVisible()


def test_the_renderer_that_was_opened_meanwhile_draws_the_face(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    rig = shipped_rig()
    ahead = FakeRenderer(rig, 1, 1)
    monkeypatch.setattr(loading, "load_character", lambda: rig)
    monkeypatch.setattr(loading, "prepare_renderer", lambda: ahead)
    window = bench.editing()
    assert window.editor is not None
    viewport = window.editor.face.viewport
    bench.qtbot.waitUntil(lambda: viewport.draws > 0)
    assert ahead.calls
    assert not bench.renderers, "opened a second one"


def test_threads_that_load_the_character_share_it() -> None:
    with ThreadPoolExecutor(2) as threads:
        first, second = threads.map(lambda _: loading.load_character(), range(2))
    assert first is second, "the renderer that was opened meanwhile would draw another one"


def test_a_renderer_of_another_character_is_not_used(bench: Bench) -> None:
    window = bench.editing()
    assert window.editor is not None
    other = FakeRenderer(shipped_rig(), 1, 1)
    window.editor.face.viewport.open(rig := random_rig(1), cast(render.FaceRenderer, other))
    assert not other.open
    assert bench.renderers[-1].rig is rig


def test_a_renderer_that_no_take_has_used_is_closed_with_the_window(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    ahead = FakeRenderer(None, 1, 1)
    monkeypatch.setattr(loading, "prepare_renderer", lambda: ahead)
    window = bench.window()
    assert ahead.open
    window.close()
    assert not ahead.open


def test_while_a_take_is_read_the_window_says_so(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    gate = threading.Event()
    real = loading.open_session
    monkeypatch.setattr(
        loading, "open_session", lambda path, rig, fps: (gate.wait(10), real(path, rig, fps))[1]
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
    bench.qtbot.waitUntil(lambda: window.windowTitle() == "take.csv[*] – FaceEdit")
    assert "Live Link Face CSV" in window.status.facts.text()
    assert "60 fps" in window.status.facts.text()
    assert "180 frames" in window.status.facts.text()
    assert window.status.gaps.isHidden(), "what is not there leaves no space behind"
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
    viewports: tuple[QWidget, ...] = (window.editor.curves.plots[0], window.editor.face.viewport)
    for number, part in enumerate(viewports):
        other = make_livelink_csv(bench.folder / f"other{number}.csv")
        drop(part, other)
        bench.qtbot.waitUntil(partial(lambda path: open_path(window) == path, other))


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
    bench.preferences().add_recent(bench.take)
    window = bench.window()
    recent = [b for b in window.start_page.findChildren(QPushButton) if b.text() == "take.csv"]
    bench.qtbot.mouseClick(recent[0], Qt.MouseButton.LeftButton)
    bench.qtbot.waitUntil(lambda: window.document.session is not None)
    menu = window.actions_.submenu("recent")
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
    assert bench.preferences().recent() == []


def test_a_bad_file_is_one_line_and_the_old_take_stays(bench: Bench) -> None:
    window = bench.editing()
    empty, picture, folder, missing = (bench.folder / f"bad.{n}.csv" for n in range(4))
    empty.touch()
    picture.write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(range(256)))
    folder.mkdir()
    for bad in (empty, picture, folder, missing):
        bench.errors.clear()
        drop(window, bad)
        bench.qtbot.waitUntil(lambda: bool(bench.errors))
        assert len(bench.errors) == 1
        assert "\n" not in bench.errors[0]
        assert bad.name in bench.errors[0]
        assert open_path(window) == bench.take
        assert window.status.currentMessage() == ""


def test_the_take_that_was_asked_for_last_wins(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    gate = threading.Event()
    real = loading.open_session
    slow = make_livelink_csv(bench.folder / "slow.csv")

    def read(path: Path, rig: object, fps: float | None) -> object:
        if path == slow:
            gate.wait(10)
        return real(path, rig, fps)  # type: ignore[arg-type]

    monkeypatch.setattr(loading, "open_session", read)
    window = bench.window()
    window.commands.file.open(slow)
    window.commands.file.open(bench.take)
    bench.qtbot.waitUntil(lambda: window.document.session is not None)
    gate.set()
    wait_for_background(window.workspace.background)
    assert open_path(window) == bench.take


def test_garbage_is_collected_in_the_gui_thread_only(qtbot: QtBot) -> None:
    class Cycle:
        def __init__(self) -> None:
            self.itself = self

        def __del__(self) -> None:
            collected.append(threading.current_thread())

    def busy() -> None:
        Cycle()
        kept.extend([] for _ in range(50_000))

    collected: list[threading.Thread] = []
    kept: list[list[object]] = []
    collect_nothing()
    busy()
    collector = Collector()
    collector.begin()
    try:
        thread = threading.Thread(target=busy)
        thread.start()
        thread.join()
        assert not collected
        qtbot.waitUntil(lambda: len(collected) == 2)
        assert set(collected) == {threading.main_thread()}
    finally:
        collector.end()


def test_no_thread_that_outlives_the_window_collects_it() -> None:
    before = gc.isenabled()
    gc.enable()
    try:
        with collecting():
            assert not gc.isenabled()
        assert not gc.isenabled()
    finally:
        (gc.enable if before else gc.disable)()
