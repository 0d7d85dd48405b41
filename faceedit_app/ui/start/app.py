"""Opens the window."""

from __future__ import annotations

import gc
import os
import signal
import sys
from pathlib import Path

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication

from faceedit_app import __version__
from faceedit_app.ui.look.theme import apply_theme
from faceedit_app.ui.start import crash
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.preferences import Preferences


def application() -> QApplication:
    """The one Qt application of this process, dressed."""
    existing = QApplication.instance()
    app = existing if isinstance(existing, QApplication) else QApplication(sys.argv[:1])
    app.setApplicationName("FaceEdit")
    app.setApplicationVersion(__version__)
    app.setDesktopFileName("faceedit")
    apply_theme(app)
    return app


def keep_for_good() -> None:
    """Take what the start has made out of Python's search for garbage: it lives to the end.

    The search stops the window, for 40 ms where all modules are looked through, else for 10.
    """
    gc.freeze()


def run(take: Path | None, demo: bool = False) -> int:
    """Show the window and stay until it is closed.

    Args:
        take: a take to open.
        demo: open the demo take instead.

    Returns:
        The process's exit code.
    """
    app = application()
    crash.install()
    _quit_on_interrupt(app)
    window = MainWindow(Preferences())
    window.settled.connect(keep_for_good)
    window.after_first_paint(lambda: window.start(take, demo))
    if folder := os.environ.get("FACEEDIT_SMOKE"):  # a test of an installed FaceEdit
        from faceedit_app.ui.start import smoke

        smoke.play(window, Path(folder))
    window.show()
    return app.exec()


def _quit_on_interrupt(app: QApplication) -> None:
    """Let Ctrl+C in the terminal end the application, as in any other program."""
    signal.signal(signal.SIGINT, lambda *_: app.quit())
    # Python sees signals between its own instructions only, so have it run some now and then.
    heartbeat = QTimer(app, interval=250)
    heartbeat.timeout.connect(lambda: None)
    heartbeat.start()
