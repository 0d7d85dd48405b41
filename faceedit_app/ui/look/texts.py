"""Show texts from files as they are, never as rich text that could load pictures or hold links."""

from __future__ import annotations

import html

from PySide6.QtGui import Qt
from PySide6.QtWidgets import QLabel

from faceedit_app.core.arkit import ARKIT_CHANNELS


def plain_label(text: str = "") -> QLabel:
    """A label that shows any text as it is."""
    label = QLabel(text)
    label.setTextFormat(Qt.TextFormat.PlainText)
    return label


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


def sentence(text: str) -> str:
    """A remark as a sentence; the name of a channel stays as it is."""
    first, gap, rest = text.partition(" ")
    first = first if first in ARKIT_CHANNELS else f"{first[:1].upper()}{first[1:]}"
    return f"{first}{gap}{rest.removesuffix('.')}."
