"""A window with everything loaded, whose settings are not the user's."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path

from PySide6.QtCore import QCoreApplication, QEvent, QSettings

from faceedit_app.core.errors import FaceEditError
from faceedit_app.editing.session import EditSession
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.preferences import Preferences

_PATIENCE = 600.0  # seconds, on a busy machine


def open_window(
    take: Path, folder: Path, character: Path | None = None, refused: Sequence[str] = ()
) -> MainWindow:
    """Open a take, or what can be recovered, and wait until face and networks are loaded.

    Args:
        folder: for the settings.
        character: the user's, to be shown.
        refused: the errors that the window has shown, see `hands.dialogs_cancelled`.

    Raises:
        FaceEditError: one of the files cannot be read.
        TimeoutError: that takes too long.
    """
    settings = QSettings(str(folder / "settings.ini"), QSettings.Format.IniFormat)
    preferences = Preferences(settings)
    preferences.set_hints_seen()
    window = MainWindow(preferences)
    settled: list[bool] = []
    window.settled.connect(lambda: settled.append(True))
    window.resize(1280, 720)
    window.show()
    window.start(take, character=character)
    document, until = window.document, time.monotonic() + _PATIENCE
    while not (settled and document.session is not None and _shows(window, character)):
        QCoreApplication.processEvents()
        if refused:
            window.leave()
            raise FaceEditError(refused[0])
        if time.monotonic() > until:
            raise TimeoutError(f"{take} was not opened in {_PATIENCE:.0f} s")
    return window


def close_window(window: MainWindow) -> None:
    """Close a window and delete all of it, in this thread and while Qt is there.

    What is left when Python ends is deleted in any order, which may crash.
    """
    window.leave()
    window.hide()
    window.deleteLater()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
    QCoreApplication.processEvents()


def _shows(window: MainWindow, character: Path | None) -> bool:
    """Whether the user's character is shown, if there is one."""
    return character is None or window.document.character is not None


def session_of(window: MainWindow) -> EditSession:
    """The session of the open take."""
    assert window.document.session is not None
    return window.document.session
