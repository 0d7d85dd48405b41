"""Writes a large file in the background, with progress and Cancel."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TypeVar

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtWidgets import QProgressDialog, QWidget

from faceedit_app.core.texts import plain_line
from faceedit_app.media.container import Abandoned
from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.look.texts import plain_label

Result = TypeVar("Result")
Advance = Callable[[int, int], None]  # is given how much is done, and of how much
IsStopped = Callable[[], bool]  # says whether to give up

_AFTER_MS = 300  # what takes no longer shows no progress
_LONGEST = 80  # characters of what is being written


class Writing(QObject):
    """Writes one file at a time in a thread.

    Args:
        title: of the window with the progress.
    """

    _advanced = Signal(int, int)  # from the thread

    def __init__(self, workspace: Workspace, title: str) -> None:
        super().__init__(workspace)
        self._workspace, self._title = workspace, title
        self._stop: threading.Event | None = None
        self._dialog: QProgressDialog | None = None
        self._written: Callable[[], None] = lambda: None
        self._advanced.connect(self._show, Qt.ConnectionType.QueuedConnection)

    @property
    def is_busy(self) -> bool:
        """Whether a file is being written."""
        return self._stop is not None

    def start(
        self,
        name: str,
        doing: str,
        work: Callable[[Advance, IsStopped], Result],
        done: Callable[[Result], None],
        failed: Callable[[Exception], None],
    ) -> None:
        """Begin to write.

        Args:
            name: of the file.
            doing: what happens to it, such as “Writing”.
            work: writes it, in a thread.
            done: is given its result.
            failed: is given its error, unless it is `Abandoned`.
        """
        stop = self._stop = threading.Event()
        self._dialog = self._open(f"{doing} {name}…", stop)
        self._written = self._workspace.unfinished.begin(name, self.stop)

        def succeed(result: Result) -> None:
            self._finish()
            done(result)

        def fail(error: Exception) -> None:
            self._finish()
            if isinstance(error, Abandoned):
                self._workspace.message.emit("Cancelled; nothing was written")
            else:
                failed(error)

        advance = self._advanced.emit
        self._workspace.background.run(lambda: work(advance, stop.is_set), succeed, fail)

    def stop(self) -> None:
        """Give up."""
        if self._stop is not None:
            self._stop.set()
            self._finish()

    def _open(self, text: str, stop: threading.Event) -> QProgressDialog:
        dialog = progress_dialog(self._workspace.window, self._title, text)
        dialog.canceled.connect(stop.set)
        return dialog

    def _show(self, done: int, of: int) -> None:
        if self._dialog is not None and not self._dialog.wasCanceled():
            self._dialog.setMaximum(of)
            self._dialog.setValue(done)

    def _finish(self) -> None:
        if self._dialog is not None:
            self._dialog.canceled.disconnect()  # closing cancels
            self._dialog.close()
            self._dialog.deleteLater()
        self._dialog = self._stop = None
        self._written()  # commands may now be enabled again


def progress_dialog(parent: QWidget, title: str, text: str) -> QProgressDialog:
    """A window that says what is being written, and how much of it is done."""
    dialog = QProgressDialog("", "Cancel", 0, 0, parent)
    # A name may look like a tag, and is as long as it likes.
    dialog.setLabel(plain_label(plain_line(text, _LONGEST)))
    dialog.setWindowTitle(title)
    dialog.setMinimumDuration(_AFTER_MS)
    dialog.setWindowModality(Qt.WindowModality.NonModal)
    dialog.setAutoClose(False)
    dialog.setAutoReset(False)
    return dialog
