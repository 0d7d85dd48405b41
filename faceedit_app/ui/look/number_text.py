"""The text in a number field."""

from __future__ import annotations

from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QAbstractSpinBox, QLineEdit


class NumberText(QLineEdit):
    """A double click selects all of a number.

    Qt takes the point in a number for the end of a word: a double click on 0.60 selects one half of
    it, and 0.1 typed over that becomes 0.01.
    """

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Select all but the unit."""
        box = self.parentWidget()
        if isinstance(box, QAbstractSpinBox):
            box.selectAll()
        event.accept()
