"""A window with everything loaded, whose settings are not the user's."""

from __future__ import annotations

import time
from pathlib import Path

from PySide6.QtCore import QCoreApplication, QSettings

from faceedit_app.editing.session import EditSession
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.preferences import Preferences

_PATIENCE = 120.0  # seconds


def open_window(take: Path, folder: Path) -> MainWindow:
    """Open a take, or what can be recovered, and wait until face and networks are loaded.

    Args:
        folder: for the settings.

    Raises:
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
    window.start(take)
    until = time.monotonic() + _PATIENCE
    while not (settled and window.document.session is not None):
        QCoreApplication.processEvents()
        if time.monotonic() > until:
            raise TimeoutError(f"{take} was not opened in {_PATIENCE:.0f} s")
    return window


def session_of(window: MainWindow) -> EditSession:
    """The session of the open take."""
    assert window.document.session is not None
    return window.document.session
