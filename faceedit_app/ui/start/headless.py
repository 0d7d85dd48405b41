"""Runs without a display: the same widgets, drawn into pictures."""

from __future__ import annotations

import os
import tempfile
import time
from pathlib import Path

from PySide6.QtCore import QSettings
from PySide6.QtWidgets import QApplication

from faceedit_app.core.errors import FileError, Unavailable, reason_of
from faceedit_app.editing.session import EditSession
from faceedit_app.render.snapshot import snapshot, write_png
from faceedit_app.ui.start.application import application
from faceedit_app.ui.start.sample_edit import sample_edit
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.preferences import Preferences

SIZE = (1440, 900)
FACE_SIZE = (800, 900)
_SHOWN = 2.0  # seconds on either side of the sample edit
_IDLE = 0.4  # seconds until the face is drawn smoothly


def run_headless(output: Path) -> list[Path]:
    """Open the demo take, edit it, and write the result and pictures before and after.

    Args:
        output: the folder to write to; created if it does not exist.

    Returns:
        The files: the edited take, its edits, the window and the face before and after. There are
        no pictures of the face if it cannot be drawn.

    Raises:
        FileError: something cannot be read or written.
    """
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    try:
        output.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = reason_of(error)
        raise FileError(output, f"cannot be created ({reason})", "choose another folder") from error
    app = application()
    with tempfile.TemporaryDirectory() as folder:
        window = _open_window(Path(folder) / "settings.ini")
        try:
            return _work(app, window, output)
        finally:
            window.leave()


def _open_window(settings: Path) -> MainWindow:
    window = MainWindow(Preferences(QSettings(str(settings), QSettings.Format.IniFormat)))
    window.resize(*SIZE)
    window.show()
    window.open_demo_now()
    return window


def _work(app: QApplication, window: MainWindow, output: Path) -> list[Path]:
    session = window.document.session
    assert session is not None
    edit = sample_edit(session)
    middle = (edit.start + edit.end) / 2
    window.timeline.go_to_time(middle)
    window.timeline.show_range(middle - _SHOWN, middle + _SHOWN)
    written = [_grab(app, window, output / "window_before.png")]
    written += _face(session, window.timeline.frame, output / "face_before.png")
    session.add(edit)
    written.append(_grab(app, window, output / "window_after.png"))
    written += _face(session, window.timeline.frame, output / "face_after.png")
    take, edits = output / "demo_take_edited.csv", output / "demo_take_edits.json"
    window.document.export(take)
    window.document.save_edits(edits)
    return [take, edits, *written]


def _grab(app: QApplication, window: MainWindow, path: Path) -> Path:
    until = time.monotonic() + _IDLE
    while time.monotonic() < until:
        app.processEvents()
        time.sleep(0.01)
    if not window.grab().save(str(path)):
        raise FileError(path, "cannot be written", "choose another folder or free some space")
    return path


def _face(session: EditSession, frame: int, path: Path) -> list[Path]:
    try:
        write_png(path, snapshot(session.rig, session.rig_weights(frame), *FACE_SIZE))
    except Unavailable:
        return []
    return [path]
