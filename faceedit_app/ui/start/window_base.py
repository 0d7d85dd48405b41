"""The main window's base: accepts dropped files and detects the first paint.

What a drop starts may ask a question, and a question must not open inside the drop: it would keep
the program that the files came from waiting, and the window system in the middle of a drag, where a
second drop ends the process. Files are therefore handled once the drop is over, and refused while a
question is open.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QEvent, QPoint, QRect, Qt, QTimer, Signal
from PySide6.QtGui import (
    QDragEnterEvent,
    QDragLeaveEvent,
    QDragMoveEvent,
    QDropEvent,
    QEnterEvent,
)
from PySide6.QtWidgets import QApplication, QMainWindow, QWidget


class WindowBase(QMainWindow):
    """Leaves it to a subclass what to do with the files.

    Signals:
        dropped(object): files, as a list of paths; received once the drop is over.
    """

    dropped = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self.dropped.connect(self.take_files, Qt.ConnectionType.QueuedConnection)
        self._on_paint: Callable[[], None] | None = None
        self._title, self._holds_title = "", False
        self.setAcceptDrops(True)

    def after_first_paint(self, work: Callable[[], None]) -> None:
        """Call `work` once the window has been painted."""
        self._on_paint = work

    def entitle(self, file: Path | None) -> None:
        """Name a file in the title, now or once its content has been painted; None is none yet."""
        if file is not None:
            self._title = f"{file.name}[*] – FaceEdit"
        if self._title and not self._holds_title:
            self.setWindowTitle(self._title)

    def hold_title(self) -> None:
        """Other content is about to be shown; its title would be on the screen before it."""
        if not self._holds_title:
            self._holds_title = True
            # After the face is painted, then after the curves: their scenes pass changes on later.
            QTimer.singleShot(0, self, lambda: QTimer.singleShot(0, self, self._release_title))

    def _release_title(self) -> None:
        self._holds_title = False
        self.entitle(None)

    def keep_frame_on_screen(self) -> None:
        """Once the window system has added its frame: keep that on the screen, too."""
        if not self.isMaximized() and not self.isFullScreen():
            room = self.screen().availableGeometry()
            fitted = framed_within(self.geometry(), self.frameGeometry(), room)
            if fitted != self.geometry():
                self.setGeometry(fitted)

    def event(self, event: QEvent) -> bool:
        """Detect the first paint, the loss of the mouse to another window, and its return."""
        if event.type() in (QEvent.Type.WindowDeactivate, QEvent.Type.WindowBlocked):
            self.mouse_lost()
        elif isinstance(event, QEnterEvent):
            self._unlight(event.globalPosition().toPoint())
        if event.type() == QEvent.Type.Paint and self._on_paint is not None:
            QTimer.singleShot(0, self._on_paint)
            self._on_paint = None
        return super().event(event)

    def _unlight(self, pointer: QPoint) -> None:
        """Tell the widgets that the pointer has left, if they have not noticed.

        A menu may cover a button when it is clicked, and the dialog that it opens may be closed
        with a key. Qt then tells the button that the pointer is on it, but later that it left the
        menu: the button would stay lit.

        Args:
            pointer: on the screen.
        """
        for child in self.findChildren(QWidget):
            if child.underMouse() and not child.rect().contains(child.mapFromGlobal(pointer)):
                QApplication.sendEvent(child, QEvent(QEvent.Type.Leave))
                child.update()

    def mouse_lost(self) -> None:
        """The release of a held button will not reach this window."""
        raise NotImplementedError

    def show_drop(self, active: bool) -> None:
        """Show whether a file hovers over the window."""
        raise NotImplementedError

    def take_files(self, paths: list[Path]) -> None:
        """Handle dropped files."""
        raise NotImplementedError

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Accept files, unless a question is open."""
        if _dropped(event) and not _asks():
            event.acceptProposedAction()
            self.show_drop(True)
        else:
            event.ignore()

    def dragMoveEvent(self, event: QDragMoveEvent) -> None:
        """Refuse files again if a question has opened meanwhile."""
        if _asks():
            event.ignore()
        else:
            event.acceptProposedAction()

    def dragLeaveEvent(self, event: QDragLeaveEvent) -> None:
        """The file was dragged away again."""
        self.show_drop(False)

    def dropEvent(self, event: QDropEvent) -> None:
        """Accept the files at once, and handle them when the drop is over."""
        self.show_drop(False)
        paths = _dropped(event)
        if paths and not _asks():
            event.acceptProposedAction()
            self.dropped.emit(paths)
        else:
            event.ignore()


def framed_within(inner: QRect, frame: QRect, room: QRect) -> QRect:
    """Where a window has to be for its frame to stay in a room.

    A window that leaves the room by more than its frame was put there by the user, and stays.

    Args:
        inner: the window without its frame.
        frame: with it.
        room: what the screen has for windows.
    """
    added = frame.size() - inner.size()
    left, width = _fitted(frame.x(), frame.width(), room.x(), room.width(), added.width())
    top, height = _fitted(frame.y(), frame.height(), room.y(), room.height(), added.height())
    fitted = QRect(left, top, width, height)
    return QRect(fitted.topLeft() + inner.topLeft() - frame.topLeft(), fitted.size() - added)


def _fitted(at: int, long: int, room_at: int, room: int, added: int) -> tuple[int, int]:
    """`framed_within` in one direction: where the frame begins, and its length."""
    if 0 < long - room <= added:
        long = room
    beyond = at + long - (room_at + room)
    return at - beyond if 0 < beyond <= added else at, long


def _asks() -> bool:
    """Whether a dialog holds the window until it is answered or done."""
    return QApplication.activeModalWidget() is not None


def _dropped(event: QDropEvent) -> list[Path]:
    """The local files in a drop."""
    return [Path(url.toLocalFile()) for url in event.mimeData().urls() if url.isLocalFile()]
