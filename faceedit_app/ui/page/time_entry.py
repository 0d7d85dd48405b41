"""A field over a time label of the transport, to type a time to go to."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtGui import QFocusEvent, QKeyEvent
from PySide6.QtWidgets import QLineEdit, QWidget

from faceedit_app.ui.look.refused import show_refused


class TimeEntry(QLineEdit):
    """Shown while a time is being typed.

    Signals:
        ended(): the time was entered, or typing was cancelled.
    """

    ended = Signal()

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._go: Callable[[str], None] | None = None
        self.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.setAcceptDrops(False)  # dropped files go to the window
        self.returnPressed.connect(self._try)
        self.textEdited.connect(lambda: self._show_refused(""))
        self.hide()

    def begin(self, over: QWidget, text: str, name: str, go: Callable[[str], None]) -> None:
        """Appear in place of a label.

        Args:
            text: the initial text, selected.
            name: of the field, for screen readers.
            go: goes to the time typed; raises ValueError with a message for the user.
        """
        self._go = go
        self.setAccessibleName(name)
        self._show_refused("")
        wide = self.fontMetrics().horizontalAdvance(text) + 24
        place = over.geometry().adjusted(min(over.width() - wide, -4), -2, 4, 2)
        self.setGeometry(place)
        self.setText(text)
        self.selectAll()
        self.show()
        self.raise_()
        self.setFocus(Qt.FocusReason.OtherFocusReason)

    def _try(self) -> None:
        assert self._go is not None
        try:
            self._go(self.text())
        except ValueError as error:
            self._show_refused(str(error))
            self.selectAll()
            return
        self._end()

    def _show_refused(self, reason: str) -> None:
        show_refused(self, reason, "Enter goes there, Esc cancels")

    def _end(self) -> None:
        self.hide()
        self.ended.emit()

    def event(self, event: QEvent) -> bool:
        """Typed keys are not shortcuts; Space plays until something is typed."""
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent):
            plain = event.modifiers() in (
                Qt.KeyboardModifier.NoModifier,
                Qt.KeyboardModifier.ShiftModifier,
                Qt.KeyboardModifier.KeypadModifier,
            )
            if plain and (self.isModified() or event.key() != Qt.Key.Key_Space):
                event.accept()
                return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Esc cancels."""
        if event.key() == Qt.Key.Key_Escape:
            self._end()
        else:
            super().keyPressEvent(event)

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Losing the focus cancels, unless to a menu or another window."""
        super().focusOutEvent(event)
        if event.reason() not in (
            Qt.FocusReason.PopupFocusReason,
            Qt.FocusReason.ActiveWindowFocusReason,
        ):
            self.hide()
