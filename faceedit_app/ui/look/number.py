"""A field for a number."""

from __future__ import annotations

import re

from PySide6.QtCore import QEvent, QLocale, QObject, Qt
from PySide6.QtGui import QFocusEvent, QKeyEvent, QValidator, QWheelEvent
from PySide6.QtWidgets import QDialog, QDoubleSpinBox, QStyledItemDelegate, QWidget

from faceedit_app.ui.look.number_text import NumberText
from faceedit_app.ui.look.refused import show_refused
from faceedit_app.ui.look.widgets import ENTER

_NUMBER = re.compile(r"[+-]?(?:\d{1,30}(?:[.,]\d{0,30})?|[.,]\d{1,30})", re.ASCII)
_AWAY = (Qt.FocusReason.PopupFocusReason, Qt.FocusReason.ActiveWindowFocusReason)


class NumberBox(QDoubleSpinBox):
    """A number field that takes a decimal comma as well as a point.

    Qt's own reads the comma as a thousands separator, or in a German or French system the point:
    1,5 s would become 15 s. Numbers are shown with a point, as in the rest of the window.

    Qt's own also swallows keys, and forgets a text that is no number when the field is left. Here,
    it stays with the reason beside it, and Esc brings back the number, or closes a dialog.

    The wheel changes the number only while the field has the focus, not in passing.
    """

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setLineEdit(NumberText())
        plain = QLocale.c()
        plain.setNumberOptions(
            QLocale.NumberOption.OmitGroupSeparator | QLocale.NumberOption.RejectGroupSeparator
        )
        self.setLocale(plain)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)  # the wheel does not give it the focus
        self._before: float | None = None  # the number before what is being typed
        self.lineEdit().textEdited.connect(self._begin)
        self.lineEdit().textChanged.connect(self._forgive)

    # --- what is typed -----------------------------------------------------------------------

    def why_not(self, text: str) -> str:
        """Why a text cannot be taken, in one line; "" if it can."""
        number = self.number_in(text)
        if number is not None and self.minimum() <= number <= self.maximum():
            return ""
        what = "number" if self.decimals() else "whole number"
        low, high = (self._plain(limit) for limit in (self.minimum(), self.maximum()))
        return f"Type a {what} from {low} to {high}{self.suffix()}"

    def number_in(self, text: str) -> float | None:
        """The number that a text is, with its unit or without; None if it is none."""
        text = self.typed(text)
        for part in (self.prefix().strip(), self.suffix().strip()):
            for _ in range(2):  # a unit may be typed beside the one that stands there
                text = text.strip().removeprefix(part).removesuffix(part)
        if _NUMBER.fullmatch(text := text.strip()) is None:
            return None
        number = float(text.replace(",", "."))
        if not self.decimals() and number != round(number):
            return None
        return round(number, self.decimals())

    def typed(self, text: str) -> str:
        """A text without that which stands for no number, behind which it was typed."""
        return text.strip().removeprefix(self.specialValueText())

    def _plain(self, number: float) -> str:
        text = f"{number:.{self.decimals()}f}"
        return text.rstrip("0").rstrip(".") if "." in text else text

    def _is_special(self, text: str) -> bool:
        return bool(self.specialValueText()) and text.strip() == self.specialValueText()

    def validate(self, text: str, position: int) -> tuple[QValidator.State, str, int]:
        """Let anything be typed; only what can be taken is acceptable."""
        text, position = self._with_one_unit(text, position)
        wrong = not self._is_special(text) and self.why_not(text)
        state = QValidator.State.Intermediate if wrong else QValidator.State.Acceptable
        return state, text, position

    def _with_one_unit(self, text: str, position: int) -> tuple[str, int]:
        """A text without the unit that was typed before the one that stands there, and the cursor.

        The cursor stays in front of the unit, where Qt keeps it.
        """
        unit, number = self.suffix().strip(), text.removesuffix(self.suffix()).rstrip()
        if not unit or text.strip() == number or not number.endswith(unit):
            return text, position
        number = number.removesuffix(unit).rstrip()
        if _NUMBER.fullmatch(number) is None:
            return text, position
        return number + self.suffix(), min(position, len(number))

    def valueFromText(self, text: str) -> float:
        """The number that was typed."""
        number = self.number_in(text)
        if self._is_special(text):
            return self.minimum()
        return self.value() if number is None else number

    # --- what cannot be taken ----------------------------------------------------------------

    @property
    def is_typed(self) -> bool:
        """Whether something is typed that was not taken yet, or cannot be."""
        return self._before is not None or not self.hasAcceptableInput()

    def refuses(self) -> bool:
        """Whether what is typed cannot be taken; the reason is shown then.

        The number is then as before, also if the beginning of the text was one.
        """
        text = self.lineEdit().text()
        reason = "" if self.hasAcceptableInput() else self.why_not(text)
        if not reason:
            self._before = None
        elif self._before not in (None, self.value()):
            self.setValue(self._before)
            self.lineEdit().setText(text)
        show_refused(self, reason)
        return bool(reason)

    def _begin(self) -> None:
        if self._before is None:
            self._before = self.value()

    def stepBy(self, steps: int) -> None:
        """Change the number; what was typed is taken, or forgotten."""
        super().stepBy(steps)
        self._before = None
        self._forgive()

    def setValue(self, value: float) -> None:
        """Show a number in place of what was typed, which is forgotten.

        The number before it is forgotten, too: it may be that of another edit or selection.
        """
        super().setValue(value)
        self._before = None
        self._forgive()  # Qt does not say that the text has changed

    def _forgive(self) -> None:
        if self.property("refused") and self.hasAcceptableInput():
            show_refused(self, "")

    def event(self, event: QEvent) -> bool:
        """Esc belongs to a field that holds what cannot be taken."""
        if (
            event.type() == QEvent.Type.ShortcutOverride
            and isinstance(event, QKeyEvent)
            and self._takes_back(event)
        ):
            event.accept()
            return True
        return super().event(event)

    def _takes_back(self, event: QKeyEvent) -> bool:
        """Whether a key brings back the number; a dialog is closed with all that is in it."""
        is_escape = event.key() == Qt.Key.Key_Escape and not isinstance(self.window(), QDialog)
        return is_escape and not self.hasAcceptableInput()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Enter takes the number, or says why it cannot be; Esc then brings the old one back."""
        if event.key() in ENTER and self.refuses():
            self.selectAll()
        elif self._takes_back(event):
            self.setValue(self.value() if self._before is None else self._before)
            self.selectAll()
        else:
            super().keyPressEvent(event)

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Take the number; what is none stays."""
        text = "" if self.hasAcceptableInput() else self.lineEdit().text()
        number, before = self.value(), self._before
        super().focusOutEvent(event)
        if text and self.value() == number:
            self.lineEdit().setText(text)
            self._before = before
        else:
            self._before = None
        if event.reason() not in _AWAY:
            self.refuses()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Change the number, if it has the focus."""
        if self.hasFocus():
            super().wheelEvent(event)
        else:
            event.ignore()


class NumberDelegate(QStyledItemDelegate):
    """Edits numbers in a list or table; a field with a text that is none stays open."""

    def refuses(self, editor: QWidget) -> bool:
        """Whether what is typed into a field cannot be taken; the reason is shown then."""
        return isinstance(editor, NumberBox) and editor.refuses()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Keep a field open that holds what cannot be taken; Esc closes it."""
        kind = event.type()
        leaves = kind == QEvent.Type.FocusOut or (
            kind == QEvent.Type.KeyPress
            and isinstance(event, QKeyEvent)
            and event.key() in (*ENTER, Qt.Key.Key_Tab, Qt.Key.Key_Backtab)
        )
        if leaves and isinstance(watched, QWidget) and self.refuses(watched):
            return kind == QEvent.Type.KeyPress
        return super().eventFilter(watched, event)


def may_accept(dialog: QWidget) -> bool:
    """Whether all numbers of a dialog can be taken; else the first that cannot gets the focus."""
    for box in dialog.findChildren(NumberBox):
        if box.isVisible() and box.refuses():
            box.setFocus()
            box.selectAll()
            return False
    return True
