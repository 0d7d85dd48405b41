"""Projects in the window: saved, opened, with a take that moved; and recovery after kill -9."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.character_files import write_glb
from support.waiting import run_events, wait_for_background
from support.windows import Bench, drop, session_of, trigger

from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.files import journal
from faceedit_app.editing.files.fingerprint import fingerprint
from faceedit_app.editing.files.pending import Pending, pending_journals
from faceedit_app.editing.files.project import (
    CharacterFile,
    Project,
    ViewState,
    read_project,
    write_project,
)
from faceedit_app.editing.steps import EditState
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.commands.dialogs import Recover, Unsaved
from faceedit_app.ui.commands.unsaved import question_about
from faceedit_app.ui.start.window import MainWindow


def add_edit(window: MainWindow) -> None:
    edit = Edit(("mouth_opening",), Op.OFFSET, 1.0, 1.4, 0.2, 6.0, name="wider")
    window.document.act(lambda session: session.add(edit))


def saved_project(bench: Bench) -> Path:
    """A project of the usual take, saved by a window that is closed."""
    window = bench.editing()
    add_edit(window)
    window.timeline.select((1.0, 2.0))
    window.timeline.set_falloffs(0.1, 0.4)
    window.timeline.go_to_time(1.5)
    window.timeline.show_range(0.5, 2.5)
    path = bench.folder / "scene.faceedit"
    bench.answers["save_project"] = path
    window.actions_["save"].trigger()
    assert window.windowTitle() == "scene.faceedit[*] – FaceEdit"
    assert not window.isWindowModified()
    assert window.close()
    return path


def open_again(bench: Bench, path: Path) -> MainWindow:
    window = bench.window()
    window.commands.file.open_if_saved(path)
    bench.qtbot.waitUntil(lambda: window.document.session is not None)
    return window


def test_a_head_on_the_command_line_is_shown_instead_of_the_projects(
    bench: Bench, tmp_path: Path
) -> None:
    path = saved_project(bench)
    saved, given = (write_glb(tmp_path / name) for name in ("saved.glb", "given.glb"))
    write_project(path, replace(read_project(path), character=CharacterFile(saved)))
    window = bench.window(start=False)
    window.start(path, character=given)
    bench.qtbot.waitUntil(lambda: window.document.session is not None)
    wait_for_background(window.workspace.background)
    assert _shown(window) == given
    assert not window.isWindowModified()
    window.commands.file.open_if_saved(path)
    bench.qtbot.waitUntil(lambda: _shown(window) == saved)
    assert window.close(), "there is nothing to save"


def _shown(window: MainWindow) -> Path | None:
    character = window.document.character
    return None if character is None else character.character.path


def test_a_project_comes_back_as_it_was(bench: Bench) -> None:
    window = open_again(bench, saved_project(bench))
    assert [edit.name for edit in session_of(window).edits] == ["wider"]
    line = window.timeline
    assert line.selection == pytest.approx((1.0, 2.0))
    assert (line.falloff, line.falloff_out) == (0.1, 0.4)
    assert line.time == pytest.approx(1.5, abs=0.02)
    assert line.view == pytest.approx((0.5, 2.5), abs=0.02)
    assert not window.isWindowModified()
    bench.qtbot.waitUntil(lambda: window.windowTitle() == "scene.faceedit[*] – FaceEdit")
    assert [path.name for path in bench.preferences().recent()] == ["scene.faceedit", "take.csv"]


@pytest.mark.parametrize("way", ["dialog", "drop", "command line"])
def test_a_kept_copy_of_a_project_opens_and_nothing_is_saved_over_it(
    bench: Bench, way: str
) -> None:
    kept = bench.folder / f"scene.faceedit.bak{'2' if way == 'drop' else ''}"
    wider = Edit(("mouth_opening",), Op.OFFSET, 1.0, 1.4, 0.2, 6.0, name="wider")
    view = ViewState(selection=(1.0, 2.0))
    write_project(kept, Project(bench.take, fingerprint(bench.take), EditState((wider,)), view))
    before = kept.read_bytes()
    said: list[str] = []
    window = bench.window(start=False) if way == "command line" else bench.editing()
    window.workspace.message.connect(said.append)
    if way == "command line":
        window.start(kept)
    elif way == "drop":
        drop(window, kept)
    else:
        bench.answers["open"] = kept
        trigger(window, "open")
    bench.qtbot.waitUntil(lambda: window.timeline.selection is not None, timeout=15_000)
    assert [edit.name for edit in session_of(window).edits] == ["wider"]
    assert window.timeline.selection == pytest.approx((1.0, 2.0))
    assert f"{kept.name} is open as a copy: Save asks for its name" in said
    document = window.document
    assert not document.loses_by_closing, "the copy holds it"
    assert not window.isWindowModified()
    away = kept.rename(kept.with_name("away"))
    assert document.loses_by_closing
    assert question_about(document)[0] == "Your edits to take.csv are not saved in a project."
    away.rename(kept)
    add_edit(window)
    assert window.isWindowModified()
    assert question_about(document)[0] == "Your edits to take.csv are not saved in a project."
    again = bench.answers["save_project"] = bench.folder / "again.faceedit"
    trigger(window, "save")
    assert not bench.answers, "it asks for a name"
    assert document.project == again
    assert not window.isWindowModified()
    assert kept.read_bytes() == before
    assert kept not in bench.preferences().recent()


def test_save_again_does_not_ask(bench: Bench) -> None:
    path = saved_project(bench)
    window = open_again(bench, path)
    add_edit(window)
    assert window.isWindowModified()
    window.actions_["save"].trigger()
    assert not window.isWindowModified()
    other = bench.folder / "other.faceedit"
    bench.answers["save_project"] = other
    window.actions_["save_as"].trigger()
    assert other.read_bytes() == path.read_bytes()


def test_closing_asks_to_save_the_project(bench: Bench) -> None:
    path = saved_project(bench)
    before = path.read_bytes()
    window = open_again(bench, path)
    add_edit(window)
    bench.answers["unsaved"] = Unsaved.SAVE
    assert window.close()
    assert path.read_bytes() != before


def test_a_moved_take_is_found_and_reported(bench: Bench) -> None:
    path = saved_project(bench)
    (bench.folder / "renamed").mkdir()
    bench.take.rename(bench.folder / "renamed" / "take.csv")
    window = open_again(bench, path)
    assert session_of(window).edits
    assert window.document.path == bench.folder / "renamed" / "take.csv"
    assert not window.isWindowModified()
    assert window.close(), "opening is no edit to ask about"


def test_a_changed_take_is_asked_about(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    path = saved_project(bench)
    bench.take.write_bytes(bench.take.read_bytes().replace(b"12:00:", b"13:00:"))
    asked: list[str] = []

    def answer(_parent: object, message: str, choices: list[Path], _folder: Path) -> Path | None:
        asked.append(message)
        return choices[0] if len(asked) > 1 else None

    monkeypatch.setattr(dialogs, "ask_take_of_project", answer)
    window = bench.window()
    window.commands.file.open(path)
    bench.qtbot.waitUntil(lambda: len(asked) == 1)
    wait_for_background(window.workspace.background)
    assert window.document.session is None
    window.commands.file.open(path)
    bench.qtbot.waitUntil(lambda: window.document.session is not None)
    assert "\n" not in asked[0]
    assert session_of(window).edits
    assert window.isWindowModified()


def test_a_damaged_project_is_one_line(bench: Bench) -> None:
    path = bench.folder / "bad.faceedit"
    path.write_text("{")
    window = bench.window()
    window.commands.file.open(path)
    bench.qtbot.waitUntil(lambda: bool(bench.errors))
    assert "bad.faceedit" in bench.errors[0]
    assert "\n" not in bench.errors[0]


def test_a_folder_that_cannot_be_written_loses_nothing(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window)
    bench.answers["save_project"] = bench.folder / "missing" / "scene.faceedit"
    window.actions_["save"].trigger()
    assert len(bench.errors) == 1
    assert window.isWindowModified()
    assert session_of(window).edits


KILLED = """
import sys
from dataclasses import replace
from pathlib import Path
from PySide6.QtCore import QPoint, QPointF, QEvent, Qt, QTimer
from PySide6.QtTest import QTest
from faceedit_app.ui.start import app
from faceedit_app.ui.state import loading
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.core.errors import FileError
loading.prepare_renderer = lambda: None
def no_engine(_rig):
    raise FileError("x", "is missing", "train")
loading.load_engine = no_engine
start = MainWindow.start
def started(window, take, demo, character):
    start(window, take, demo, character)
    look.timeout.connect(lambda: begin(window))
    look.start(20)
def begin(window):
    if window.document.session is None:
        return
    look.stop()
    plot = window.editor.curves.plots[0].viewport()
    for x, release in ((80, True), (140, True), (200, False)):
        at = QPoint(x, 20)
        QTest.mouseMove(plot, at)
        QTest.mousePress(plot, Qt.MouseButton.LeftButton, pos=at)
        for step in (4, 8, 12):
            QTest.mouseMove(plot, at - QPoint(0, step))
        if release:
            QTest.mouseRelease(plot, Qt.MouseButton.LeftButton, pos=at - QPoint(0, 12))
    print(len(window.document.session.edits), window.editor.curves.is_dragging, flush=True)
MainWindow.start = started
look = QTimer()
sys.exit(app.run(Path(sys.argv[1])))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no kill -9")
def test_kill_9_in_the_middle_of_a_drag_loses_that_drag_only(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    homes = {name: str(tmp_path) for name in ("HOME", "XDG_STATE_HOME", "XDG_CONFIG_HOME")}
    victim = subprocess.Popen(
        [sys.executable, "-c", KILLED, str(bench.take)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="utf-8",
        env=os.environ | homes,
    )
    assert victim.stdout is not None
    try:
        assert victim.stdout.readline().strip() == "2 True"
    finally:
        os.kill(victim.pid, signal.SIGKILL)
        victim.communicate()
    folder = next(tmp_path.rglob("*.jsonl")).parent
    monkeypatch.setattr(journal, "journal_folder", lambda: folder)
    asked: list[int] = []

    def recover(_parent: object, pending: Pending) -> Recover:
        asked.append(pending.gestures)
        return Recover.RECOVER

    monkeypatch.setattr(dialogs, "ask_recover", recover)
    window = bench.window()
    bench.qtbot.waitUntil(lambda: window.document.session is not None)
    assert asked == [2]
    assert len(session_of(window).edits) == 2
    assert window.isWindowModified()
    assert not np.array_equal(session_of(window).asked, session_of(window).tracked)
    run_events()
    bench.answers["unsaved"] = Unsaved.DISCARD
    assert window.close()
    assert pending_journals() == []
    shutil.rmtree(folder)


def test_recovery_says_that_its_take_has_changed_and_that_another_waits(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    folder = tmp_path / "journals"
    crashed = journal.Journal(bench.take, folder=folder)
    crashed.record(EditState((Edit(("mouth_opening",), Op.OFFSET, 1.0, 1.4, 0.2, 6.0),)))
    content = crashed.path.read_bytes()
    crashed.close()
    crashed.path.write_bytes(content)
    bench.take.write_bytes(bench.take.read_bytes().replace(b"12:00:", b"13:00:"))
    monkeypatch.setattr(journal, "journal_folder", lambda: folder)
    monkeypatch.setattr(dialogs, "ask_recover", lambda *_: Recover.RECOVER)
    asked: list[str] = []

    def use_it(_parent: object, message: str, likely: list[Path], _folder: Path) -> Path:
        asked.append(message)
        return likely[0]

    monkeypatch.setattr(dialogs, "ask_take_of_project", use_it)
    other = tmp_path / "other.csv"
    other.write_bytes(bench.take.read_bytes())
    window = bench.window(other)
    bench.qtbot.waitUntil(lambda: window.document.session is not None)
    assert "has changed since" in asked[0]
    bench.qtbot.waitUntil(lambda: "is not the take" in window.banner.text.text())
    assert "other.csv is not open yet" in window.banner.text.text()
    assert bench.preferences().recent() == [bench.take, other]
    assert len(session_of(window).edits) == 1
    bench.answers["unsaved"] = Unsaved.DISCARD
    assert window.close()
