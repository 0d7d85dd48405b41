"""The main window's base: accepts dropped files and detects the first paint."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QEvent, QTimer
from PySide6.QtGui import QDragEnterEvent, QDragLeaveEvent, QDropEvent
from PySide6.QtWidgets import QMainWindow


class WindowBase(QMainWindow):
    """Leaves it to a subclass what to do with the files."""

    def __init__(self) -> None:
        super().__init__()
        self._on_paint: Callable[[], None] | None = None
        self.setAcceptDrops(True)

    def after_first_paint(self, work: Callable[[], None]) -> None:
        """Call `work` once the window has been painted."""
        self._on_paint = work

    def event(self, event: QEvent) -> bool:
        """Detect the first paint, and the loss of the mouse to another window or a dialog."""
        if event.type() in (QEvent.Type.WindowDeactivate, QEvent.Type.WindowBlocked):
            self.let_go()
        if event.type() == QEvent.Type.Paint and self._on_paint is not None:
            QTimer.singleShot(0, self._on_paint)
            self._on_paint = None
        return super().event(event)

    def let_go(self) -> None:
        """The release of a held button will not reach this window."""
        raise NotImplementedError

    def show_drop(self, active: bool) -> None:
        """Show whether a file hovers over the window."""
        raise NotImplementedError

    def take_files(self, paths: list[Path]) -> None:
        """Handle dropped files."""
        raise NotImplementedError

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Accept files."""
        if _dropped(event):
            event.acceptProposedAction()
            self.show_drop(True)

    def dragLeaveEvent(self, event: QDragLeaveEvent) -> None:
        """The file was dragged away again."""
        self.show_drop(False)

    def dropEvent(self, event: QDropEvent) -> None:
        """Handle the files."""
        self.show_drop(False)
        paths = _dropped(event)
        if paths:
            event.acceptProposedAction()
            self.take_files(paths)


def _dropped(event: QDropEvent) -> list[Path]:
    """The local files in a drop."""
    return [Path(url.toLocalFile()) for url in event.mimeData().urls() if url.isLocalFile()]
