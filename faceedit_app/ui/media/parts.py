"""Widgets that sound and film share: name, offset, placing and removing."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QSignalBlocker, QSize, Qt
from PySide6.QtGui import QPainter, QPaintEvent
from PySide6.QtWidgets import QLabel, QMenu, QSizePolicy, QToolButton

from faceedit_app.ui.look.guard import guarded
from faceedit_app.ui.look.icons import SIZE, icon
from faceedit_app.ui.look.number import NumberBox
from faceedit_app.ui.look.palette import MUTED
from faceedit_app.ui.look.texts import plain_tip
from faceedit_app.ui.media.take_media import TakeMedia
from faceedit_app.ui.state.timeline import Timeline

_LEAST = 48  # pixels; with less room, no name is painted


class OffsetBox(NumberBox):
    """The time in the take at which sound or film begins, in seconds."""

    def __init__(self, what: str) -> None:
        super().__init__()
        self.setDecimals(3)
        self.setSingleStep(0.01)
        self.setSuffix(" s")
        self.setRange(-86_400.0, 86_400.0)
        self.setKeyboardTracking(False)
        self.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.setAccessibleName(f"Offset of the {what}")
        self.setToolTip(
            f"Second of the take at which the {what} begins; arrow keys move it by 10 ms.\n"
            "A film and its own sound move together."
        )
        self.lineEdit().setAcceptDrops(False)  # dropped files go to the window

    def textFromValue(self, value: float) -> str:
        """The number with its sign."""
        return f"{value + 0.0:+.3f}"

    def show_offset(self, seconds: float) -> None:
        """Show a value without emitting it."""
        with QSignalBlocker(self):
            self.setValue(seconds)


class Name(QLabel):
    """A file's name, shortened in the middle if there is no room."""

    def __init__(self) -> None:
        super().__init__()
        self._name = ""
        self.setTextFormat(Qt.TextFormat.PlainText)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)

    def show_name(self, name: str, path: str) -> None:
        """Show a name, and the whole path in its tooltip."""
        self._name = name
        self.setToolTip(plain_tip(path))
        self.setText(name)

    @guarded
    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint as much of the name as fits."""
        if self.width() < _LEAST:
            return  # too short to read; the tooltip shows it
        painter = QPainter(self)
        mode = Qt.TextElideMode.ElideMiddle
        text = self.fontMetrics().elidedText(self._name, mode, self.width())
        flags = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
        painter.setPen(self.palette().windowText().color())
        painter.drawText(self.rect(), flags, text)


def placing_actions(
    menu: QMenu, media: TakeMedia, move: Callable[[float], None], timeline: Timeline
) -> None:
    """Add menu entries that place sound or film with one click."""

    def put(seconds: float) -> None:
        move(seconds)
        media.acted.emit()

    menu.addAction("Begin at the playhead").triggered.connect(lambda: put(timeline.time))
    menu.addAction("Begin with the take").triggered.connect(lambda: put(0.0))


def remove_button(what: str) -> QToolButton:
    """A small cross."""
    button = QToolButton()
    button.setObjectName("icon")
    button.setIcon(icon("close", MUTED))
    button.setToolTip(f"Remove {what}")
    button.setAccessibleName(f"Remove {what}")
    button.setFocusPolicy(Qt.FocusPolicy.NoFocus)
    button.setIconSize(QSize(SIZE, SIZE))
    button.setFixedSize(26, 26)
    return button
