"""What any main window does: take files that are dropped on it, and notice its first paint."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QEvent, QTimer
from PySide6.QtGui import QDragEnterEvent, QDragLeaveEvent, QDropEvent
from PySide6.QtWidgets import QMainWindow


class WindowBase(QMainWindow):
    """A subclass knows what to do with the files."""

    def __init__(self) -> None:
        super().__init__()
        self._on_paint: Callable[[], None] | None = None
        self.setAcceptDrops(True)

    def after_first_paint(self, work: Callable[[], None]) -> None:
        """Call `work` once the window has been painted."""
        self._on_paint = work

    def event(self, event: QEvent) -> bool:
        """Notice the first paint, and the loss of the mouse to another window or a dialog."""
        if event.type() in (QEvent.Type.WindowDeactivate, QEvent.Type.WindowBlocked):
            self.let_go()
        if event.type() == QEvent.Type.Paint and self._on_paint is not None:
            QTimer.singleShot(0, self._on_paint)
            self._on_paint = None
        return super().event(event)

    def let_go(self) -> None:
        """A button that is held will go up where we do not see it."""
        raise NotImplementedError

    def show_drop(self, active: bool) -> None:
        """A file hovers over the window, or no longer."""
        raise NotImplementedError

    def take_files(self, paths: list[Path]) -> None:
        """These files were dropped."""
        raise NotImplementedError

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Welcome a file."""
        if _dropped(event):
            event.acceptProposedAction()
            self.show_drop(True)

    def dragLeaveEvent(self, event: QDragLeaveEvent) -> None:
        """Forget a file that was not dropped."""
        self.show_drop(False)

    def dropEvent(self, event: QDropEvent) -> None:
        """Take the files."""
        self.show_drop(False)
        paths = _dropped(event)
        if paths:
            event.acceptProposedAction()
            self.take_files(paths)


def _dropped(event: QDropEvent) -> list[Path]:
    """The local files that are dropped."""
    return [Path(url.toLocalFile()) for url in event.mimeData().urls() if url.isLocalFile()]
