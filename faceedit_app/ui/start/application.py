"""The process's single Qt application, with the window's theme."""

from __future__ import annotations

import contextlib
import gc
import sys
from collections.abc import Iterator
from importlib import import_module
from typing import Any

from PySide6.QtCore import QObject, QTimer
from PySide6.QtWidgets import QApplication

from faceedit_app import __version__
from faceedit_app.ui.look.theme import apply_theme

_MANY = gc.get_threshold()[0]  # new objects that make Python collect
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


def collect_nothing() -> None:
    """Collect no garbage while starting, until a `Collector` begins.

    Imports make hundreds of thousands of objects and no garbage: searching them again and again
    takes a tenth of the start.
    """
    gc.disable()


def keep_for_good() -> None:
    """Exclude everything created during start-up from garbage collection: it lives to the end.

    A full collection blocks the window for 40 ms; without these objects, for 10 ms.
    """
    gc.freeze()


class Garbage:
    """Collects garbage when it is asked to, as often as Python would by itself."""

    def __init__(self) -> None:
        self._collected = 0

    def collect(self) -> None:
        """Collect if there are as many new objects as would make Python do so."""
        if gc.get_count()[0] > _MANY:
            self._collected += 1
            gc.collect(2 if self._collected % _ALL == 0 else 1)


class Collector(QTimer):
    """Collects garbage in the GUI thread, and in no other, from `begin` to `end`.

    Python collects in the thread that happens to make the next object. If that is not the GUI's,
    and the garbage holds a plot or a timer, Qt crashes or hangs: they must be deleted in their own
    thread. So Python never collects again by itself: threads may outlive the window that they
    worked for, which is garbage by then.
    """

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent, interval=_EVERY)
        self._garbage = Garbage()
        self.timeout.connect(self._garbage.collect)

    def begin(self) -> None:
        """Collect from now on; Python itself no longer does."""
        gc.disable()
        self.start()

    def end(self) -> None:
        """Collect no more."""
        self.stop()


@contextlib.contextmanager
def collecting(parent: QObject | None = None) -> Iterator[None]:
    """Let a `Collector` collect meanwhile."""
    collector = Collector(parent)
    collector.begin()
    try:
        yield
    finally:
        collector.end()


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
