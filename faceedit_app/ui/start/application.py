"""The one Qt application of a process, with the window's look; everything that starts uses it."""

from __future__ import annotations

import gc
import sys

from PySide6.QtWidgets import QApplication

from faceedit_app import __version__
from faceedit_app.ui.look.theme import apply_theme


def application() -> QApplication:
    """The Qt application of this process, made on the first call."""
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
