"""Full disks, read-only folders and vanished drives, met in the window: nothing is lost."""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import QSettings
from support.windows import Bench, add_edit, drag_curve, trigger

from faceedit_app.editing.files import journal
from faceedit_app.editing.files.pending import pending_journals
from faceedit_app.editing.files.project import read_project
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.preferences import Preferences

Trouble = Callable[[], None]


def mounted(folder: Path) -> bool:
    """Whether a disk of a few kilobytes could be put there; only the superuser can."""
    command = ["mount", "-t", "tmpfs", "-o", "size=64k", "none", str(folder)]
    try:
        return subprocess.run(command, capture_output=True, check=False).returncode == 0
    except OSError:
        return False


@pytest.fixture
def drive() -> Iterator[Path]:
    """A folder on a drive that trouble can come to.

    It is not in pytest's own: what a test that was killed leaves mounted there ends later runs.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "drive"
        folder.mkdir()
        is_mount = mounted(folder)
        yield folder
        if is_mount and folder.is_mount():
            subprocess.run(["umount", "-l", str(folder)], check=True)
        elif folder.exists():
            folder.chmod(0o755)


def refuse(monkeypatch: pytest.MonkeyPatch, drive: Path, code: int) -> None:
    """Have the system refuse to write on a drive, as for users who cannot mount one."""
    real_make, real_open, real_write = tempfile.mkstemp, os.open, os.write

    def is_there(path: object) -> bool:
        return Path(str(path)).is_relative_to(drive)

    def make(*args: object, **kinds: object) -> tuple[int, str]:
        if is_there(kinds["dir"]):
            raise OSError(code, os.strerror(code))
        return real_make(*args, **kinds)  # type: ignore[call-overload, no-any-return]

    def open_(path: object, flags: int, *rest: object, **kinds: object) -> int:
        if is_there(path) and flags & (os.O_WRONLY | os.O_RDWR):
            raise OSError(code, os.strerror(code))
        return real_open(path, flags, *rest, **kinds)  # type: ignore[arg-type]

    def write(file: int, data: bytes) -> int:
        if any(os.path.samestat(os.fstat(file), path.stat()) for path in drive.rglob("*")):
            raise OSError(code, os.strerror(code))
        return real_write(file, data)

    monkeypatch.setattr(tempfile, "mkstemp", make)
    monkeypatch.setattr(os, "open", open_)
    monkeypatch.setattr(os, "write", write)


@pytest.fixture(params=["full", "read-only", "gone"])
def trouble(
    request: pytest.FixtureRequest, drive: Path, monkeypatch: pytest.MonkeyPatch
) -> tuple[Trouble, str]:
    """What brings the trouble about, and what the system calls it."""

    def full() -> None:
        if not drive.is_mount():
            refuse(monkeypatch, drive, errno.ENOSPC)
            return
        with contextlib.suppress(OSError), (drive / "filler").open("wb", 0) as file:
            while True:
                file.write(bytes(512))

    def read_only() -> None:
        command = ["mount", "-o", "remount,ro", str(drive)]  # not while a file is open there
        if not drive.is_mount() or subprocess.run(command, check=False).returncode:
            refuse(monkeypatch, drive, errno.EROFS)

    def gone() -> None:
        if drive.is_mount():
            subprocess.run(["umount", "-l", str(drive)], check=True)
        shutil.rmtree(drive)

    return {
        "full": (full, "no space left on device"),
        "read-only": (read_only, "read-only file system"),
        "gone": (gone, "its folder does not exist"),
    }[request.param]


def reported(bench: Bench, path: Path, reason: str) -> None:
    """One line that names the file, what is wrong, and what to do."""
    (line,) = bench.errors
    bench.errors.clear()
    assert line.startswith(f"{path}: cannot be written ({reason}")
    other = "make the folder, or choose another one"
    remedy = other if "folder" in reason else "choose another folder or free some space"
    assert line.endswith(f"; {remedy}")
    assert "\n" not in line


def ready(bench: Bench, folder: Path) -> MainWindow:
    """A window on a take of that folder, with an edit."""
    take = folder / "take.csv"
    if take != bench.take:
        shutil.copy(bench.take, take)
    window = bench.window(take)
    window.banner.dismiss()  # there are no networks
    add_edit(window)
    return window


@pytest.mark.parametrize(("command", "name"), [("export", "out.csv"), ("save", "p.faceedit")])
def test_a_file_that_cannot_be_written_is_reported_and_can_go_elsewhere(
    bench: Bench, drive: Path, trouble: tuple[Trouble, str], command: str, name: str
) -> None:
    bring, reason = trouble
    window = ready(bench, bench.folder)
    old = drive / name
    old.write_bytes(b"what was there before")
    question = {"export": "export", "save": "save_project"}[command]
    bring()
    before = {path: path.read_bytes() for path in drive.glob("*")}
    bench.answers[question] = old
    trigger(window, command)
    reported(bench, old, reason)
    assert {path: path.read_bytes() for path in drive.glob("*")} == before
    assert window.isWindowModified()
    bench.answers[question] = bench.folder / name
    trigger(window, command)
    assert window.isWindowModified() == (command == "export")
    assert (bench.folder / name).is_file()
    assert not bench.errors


def test_a_project_whose_drive_fails_can_be_saved_elsewhere(
    bench: Bench, drive: Path, trouble: tuple[Trouble, str]
) -> None:
    """Take and project lie on the drive; the window goes on without it."""
    bring, reason = trouble
    small = bench.folder / "small.csv"
    small.write_bytes(b"".join(bench.take.read_bytes().splitlines(keepends=True)[:30]))
    bench.take = small
    window = ready(bench, drive)
    bench.answers["save_project"] = drive / "p.faceedit"
    trigger(window, "save")
    assert not window.isWindowModified()
    drag_curve(window, 0, 0.2, 30)
    bring()
    trigger(window, "save")
    reported(bench, drive / "p.faceedit", reason)
    bench.answers["unsaved"] = dialogs.Unsaved.SAVE
    assert not window.close(), "closing cannot save either, so the window stays"
    reported(bench, drive / "p.faceedit", reason)
    bench.answers["save_project"] = bench.folder / "p.faceedit"
    trigger(window, "save_as")
    assert not window.isWindowModified()
    assert window.document.session is not None
    assert read_project(bench.folder / "p.faceedit").state.edits == window.document.session.edits
    bench.answers["export"] = bench.folder / "out.csv"
    trigger(window, "export")
    assert (bench.folder / "out.csv").is_file()


def test_a_journal_that_cannot_be_written_is_reported_until_it_can(
    bench: Bench, drive: Path, trouble: tuple[Trouble, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    bring, reason = trouble
    journals = drive / "journals"
    monkeypatch.setattr(journal, "journal_folder", lambda: journals)
    window = ready(bench, bench.folder)
    assert not window.banner.isVisible()
    bring()
    if "folder" in reason:
        drive.write_text("a drive that is gone: nothing can be made there")
        reason = "not a directory"
    drag_curve(window, 0, 1.0, 20)
    assert window.document.session is not None
    assert len(window.document.session.edits) == 2, "the gesture is not disturbed"
    for drag in range(60):  # a full disk has room in the file's last block
        if not window.banner.isVisible():
            drag_curve(window, 0, 1.0, -20 if drag % 2 else 20)
    text = window.banner.text.text()
    assert text.startswith("Edits are not being backed up (")
    assert text.endswith(f": {journals}); save often")
    window.banner.dismiss()
    drag_curve(window, 0, 1.0, 20)
    assert not window.banner.isVisible(), "reported once"


def test_a_journal_whose_folder_vanishes_begins_again(bench: Bench) -> None:
    window = ready(bench, bench.folder)
    journals = bench.folder / "journals"
    shutil.rmtree(journals)
    drag_curve(window, 0, 1.0, 20)
    assert not window.banner.isVisible()
    (path,) = journals.glob("*.jsonl")
    content = path.read_bytes()
    session = window.document.session
    assert session is not None
    state = session.state
    window.leave()
    path.write_bytes(content)
    assert pending_journals(journals)[0].state == state


def test_a_journal_that_can_be_written_again_says_nothing_more(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    window = ready(bench, bench.folder)
    with monkeypatch.context() as patch:
        refuse(patch, bench.folder / "journals", errno.ENOSPC)
        drag_curve(window, 0, 1.0, 20)
        assert "no space left on device" in window.banner.text.text()
        assert window.banner.isVisible()
    drag_curve(window, 0, 2.0, 20)
    assert not window.banner.isVisible()
    session = window.document.session
    assert session is not None
    (path,) = (bench.folder / "journals").glob("*.jsonl")
    content, state = path.read_bytes(), session.state
    window.leave()
    path.write_bytes(content)
    assert pending_journals(path.parent)[0].state == state


def test_settings_that_cannot_be_kept_are_reported(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    in_the_way = bench.folder / "config"
    in_the_way.write_text("a file where the folder of the settings should be")
    settings = in_the_way / "FaceEdit.ini"
    preferences = Preferences(QSettings(str(settings), QSettings.Format.IniFormat))
    monkeypatch.setattr(bench, "preferences", lambda: preferences)
    window = bench.editing()
    assert window.banner.isVisible()
    (line,) = (n for n in window.banner.text.text().splitlines() if n.startswith(str(settings)))
    assert "cannot be saved; check the folder's permissions" in line
    add_edit(window)
    assert window.document.session is not None
    assert len(window.document.session.edits) == 1


def test_settings_that_are_kept_are_not_spoken_of(bench: Bench) -> None:
    assert "cannot be saved" not in bench.editing().banner.text.text()
