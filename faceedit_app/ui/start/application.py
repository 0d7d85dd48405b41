"""The process's single Qt application, with the window's theme."""

from __future__ import annotations

import gc
import sys
from importlib import import_module
from typing import Any

from PySide6.QtCore import QObject, QTimer
from PySide6.QtWidgets import QApplication

from faceedit_app import __version__
from faceedit_app.ui.look.theme import apply_theme

_USUAL = gc.get_threshold()
_RARELY = 200_000  # new objects between two collections
_EVERY = 1000  # milliseconds
_ALL = 20  # collections of new objects until all are looked through


def application() -> QApplication:
    """The Qt application of this process, created on the first call."""
    existing = QApplication.instance()
    app = existing if isinstance(existing, QApplication) else QApplication(sys.argv[:1])
    app.setApplicationName("FaceEdit")
    app.setApplicationVersion(__version__)
    app.setDesktopFileName("faceedit")
    apply_theme(app)
    return app


def rarely_collect() -> None:
    """Collect garbage rarely while starting, until `keep_for_good`.

    Imports make hundreds of thousands of objects and no garbage: searching them again and again
    takes a tenth of the start.
    """
    gc.set_threshold(_RARELY)


def keep_for_good() -> None:
    """Exclude everything created during start-up from garbage collection: it lives to the end.

    A full collection blocks the window for 40 ms; without these objects, for 10 ms.
    """
    gc.freeze()
    gc.set_threshold(*_USUAL)


class Collector(QTimer):
    """Collects garbage in the GUI thread, and in no other, from `begin` to `end`.

    Python collects in the thread that happens to make the next object. If that is not the GUI's,
    and the garbage holds a plot or a timer, Qt crashes: they must be deleted in their own thread.
    """

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent, interval=_EVERY)
        self._collected = 0
        self.timeout.connect(self.collect)

    def begin(self) -> None:
        """Collect from now on; Python itself no longer does."""
        gc.disable()
        self.start()

    def end(self) -> None:
        """Leave it to Python again."""
        self.stop()
        gc.enable()

    def collect(self) -> None:
        """Collect if there are as many new objects as would make Python do so."""
        if gc.get_count()[0] > _USUAL[0]:
            self._collected += 1
            gc.collect(2 if self._collected % _ALL == 0 else 1)


def _read_no_sources() -> None:
    """Keep PySide6 from reading the source of every module that is imported from now on.

    It searches them for its own name, as they may switch on features of PySide6 (`from __feature__
    import …`), which no module of FaceEdit does. The sources would also stay in memory.
    """
    try:
        features: Any = import_module("shibokensupport.feature")
    except ImportError:  # another version of PySide6, which starts more slowly
        return
    if hasattr(features, "_mod_uses_pyside"):
        features._mod_uses_pyside = lambda _module: False


_read_no_sources()  # now, because importing the window is most of what it speeds up
