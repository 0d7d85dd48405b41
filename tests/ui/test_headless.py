"""The window's job on a machine without a display, and when FaceEdit itself is wrong."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest
from PIL import Image
from PySide6.QtCore import QSettings
from pytestqt.qtbot import QtBot

from faceedit_app.core.errors import FileError
from faceedit_app.core.resources import shipped
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.start import crash
from faceedit_app.ui.start.headless import run_headless
from faceedit_app.ui.state.preferences import RECENT, Preferences


def test_headless_writes_the_edited_take_and_pictures(qtbot: QtBot, tmp_path: Path) -> None:
    files = {path.name: path for path in run_headless(tmp_path / "out")}
    demo = shipped("assets/demo_take.csv").read_bytes().splitlines()
    edited = files["demo_take_edited.csv"].read_bytes().splitlines()
    changed = sum(a != b for a, b in zip(demo, edited, strict=True))
    assert 10 < changed < 120
    assert len(json.loads(files["demo_take_edits.json"].read_text())["edits"]) == 1
    before, after = (Image.open(files[f"window_{when}.png"]) for when in ("before", "after"))
    assert before.size == after.size == (1440, 900)
    assert before.tobytes() != after.tobytes()
    if "face_before.png" in files:  # where the face can be drawn
        faces = [Image.open(files[f"face_{when}.png"]) for when in ("before", "after")]
        assert faces[0].tobytes() != faces[1].tobytes()


def test_headless_says_where_it_cannot_write(qtbot: QtBot, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(FileError, match="cannot be created"):
        run_headless(tmp_path / "file")


def test_an_unexpected_error_is_reported_and_written_down(
    qtbot: QtBot,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    told: list[str] = []
    monkeypatch.setattr(crash, "log_path", lambda: tmp_path / "logs" / "faceedit.log")
    monkeypatch.setattr(dialogs, "show_error", lambda _w, text: told.append(str(text)))
    monkeypatch.setattr(sys, "excepthook", sys.excepthook)
    crash.install()
    try:
        raise ZeroDivisionError("a test's own")
    except ZeroDivisionError:
        sys.excepthook(*sys.exc_info())
    assert len(told) == 1
    assert "edits are still here" in told[0]
    assert "a test's own" in (tmp_path / "logs" / "faceedit.log").read_text()
    assert "a test's own" in capsys.readouterr().err
    for handler in list(crash._log.handlers):
        crash._log.removeHandler(handler)
        handler.close()


def test_recent_takes_are_few_newest_first_and_existing(tmp_path: Path) -> None:
    preferences = Preferences(QSettings(str(tmp_path / "s.ini"), QSettings.Format.IniFormat))
    paths = [tmp_path / f"{i}.csv" for i in range(RECENT + 3)]
    for path in paths:
        path.touch()
        preferences.add_recent(path)
    preferences.add_recent(paths[-2])
    assert preferences.recent()[:2] == [paths[-2], paths[-1]]
    assert len(preferences.recent()) == RECENT
    paths[-2].unlink()
    assert preferences.recent()[0] == paths[-1]
    preferences.clear_recent()
    assert preferences.recent() == []
    assert preferences.folder("take").is_dir()
