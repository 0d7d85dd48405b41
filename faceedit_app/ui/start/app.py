"""Opens the window and runs until it is closed."""

from __future__ import annotations

import os
import signal
from pathlib import Path

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication

from faceedit_app.ui.start.application import (
    Collector,
    application,
    collect_nothing,
    keep_for_good,
)

# The module above makes the imports below quicker.
# isort: split
from faceedit_app.ui.start import crash, smoke
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.preferences import Preferences


def run(take: Path | None, demo: bool = False, character: Path | None = None) -> int:
    """Show the window and return when it is closed.

    Args:
        take: a take to open.
        demo: open the demo take instead.
        character: the user's character to show.

    Returns:
        The process's exit code.
    """
    collect_nothing()
    app = application()
    crash.install()
    _quit_on_interrupt(app)
    window = MainWindow(Preferences())
    window.settled.connect(keep_for_good)
    window.settled.connect(Collector(app).begin)

    def begin() -> None:
        window.keep_frame_on_screen()
        window.start(take, demo, character)

    window.after_first_paint(begin)
    if folder := os.environ.get(smoke.VARIABLE):
        smoke.play(window, Path(folder))
    window.show()
    return app.exec()


def _quit_on_interrupt(app: QApplication) -> None:
    """Let Ctrl+C in the terminal end the application, as in any other program."""
    signal.signal(signal.SIGINT, lambda *_: app.quit())
    # Python handles signals only between its own instructions, so make it run some regularly.
    heartbeat = QTimer(app, interval=250)
    heartbeat.timeout.connect(lambda: None)
    heartbeat.start()
