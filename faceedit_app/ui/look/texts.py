"""Show texts from files as they are, never as rich text that could load pictures or hold links."""

from __future__ import annotations

import html

from PySide6.QtGui import QResizeEvent, Qt
from PySide6.QtWidgets import QLabel

from faceedit_app.core.arkit import ARKIT_CHANNELS

_LONGEST_NAME = 60  # letters: a file name may be longer than the screen is wide


def plain_label(text: str = "") -> QLabel:
    """A label that shows any text as it is."""
    label = QLabel(text)
    label.setTextFormat(Qt.TextFormat.PlainText)
    return label


class Message(QLabel):
    """A plain text of as many lines as it needs.

    A window grows if a longer text has no room in it. Qt measures that only when it opens.
    """

    def __init__(self, text: str = "") -> None:
        super().__init__(text)
        self.setTextFormat(Qt.TextFormat.PlainText)
        self.setWordWrap(True)

    def setText(self, text: str) -> None:
        """Show another text."""
        super().setText(text)
        if self.isVisible():
            self._make_room()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Make room for the lines of another width."""
        super().resizeEvent(event)
        self._make_room()

    def _make_room(self) -> None:
        # An empty label has no height for a width: -1.
        self.setMinimumHeight(max(self.heightForWidth(self.width()), 0))


def plain_tip(text: str) -> str:
    """A tooltip that shows any text as it is; tooltips have no plain format.

    Only a text that Qt would take for rich text is changed, and looks the same.
    """
    if not Qt.mightBeRichText(text):
        return text
    return f'<p style="white-space: pre-wrap">{html.escape(text)}</p>'


def plain_entry(text: str) -> str:
    """A menu entry that shows any text as it is: `&` would underline what follows it."""
    return text.replace("&", "&&")


def name_entry(name: str) -> str:
    """A menu entry or button for a name; of a long one, its beginning and its end."""
    if len(name) > _LONGEST_NAME:
        side = _LONGEST_NAME // 2
        name = f"{name[: side - 1].rstrip()}…{name[-side:].lstrip()}"
    return plain_entry(name)


def sentence(text: str) -> str:
    """A remark as a sentence; the name of a channel stays as it is."""
    first, gap, rest = text.partition(" ")
    first = first if first in ARKIT_CHANNELS else f"{first[:1].upper()}{first[1:]}"
    return f"{first}{gap}{rest.removesuffix('.')}."
