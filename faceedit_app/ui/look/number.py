"""A field for a number."""

from __future__ import annotations

from PySide6.QtCore import QLocale, Qt
from PySide6.QtGui import QValidator, QWheelEvent
from PySide6.QtWidgets import QDoubleSpinBox, QWidget


class NumberBox(QDoubleSpinBox):
    """A number field that takes a decimal comma as well as a point.

    Qt's own reads the comma as a thousands separator, or in a German or French system the point:
    1,5 s would become 15 s. Numbers are shown with a point, as in the rest of the window.

    The wheel changes the number only while the field has the focus, not in passing.
    """

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        plain = QLocale.c()
        plain.setNumberOptions(
            QLocale.NumberOption.OmitGroupSeparator | QLocale.NumberOption.RejectGroupSeparator
        )
        self.setLocale(plain)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)  # the wheel does not give it the focus

    def validate(self, text: str, position: int) -> tuple[QValidator.State, str, int]:
        """Accept what Qt does, with a point in place of a comma."""
        state, text, position = super().validate(text.replace(",", "."), position)
        return state, text, position

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Change the number, if it has the focus."""
        if self.hasFocus():
            super().wheelEvent(event)
        else:
            event.ignore()
