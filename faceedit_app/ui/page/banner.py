"""A strip across the window for messages that need no answer."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSizePolicy,
    QToolButton,
)

from faceedit_app.ui.look.icons import icon, picture
from faceedit_app.ui.look.palette import ACCENT, ORANGE
from faceedit_app.ui.look.texts import plain_label, plain_tip
from faceedit_app.ui.look.theme import GAP, MARGIN


class Banner(QFrame):
    """Shows messages, one a line, until they are dismissed."""

    def __init__(self) -> None:
        super().__init__()
        self._messages: dict[str, str] = {}  # message: details
        self._offered: tuple[str, Callable[[], None]] | None = None  # message, what can be done
        self.setObjectName("banner")
        self._sign = QLabel()
        self.text = plain_label()
        # A long path must not widen the window.
        self.text.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        close = QToolButton()
        close.setObjectName("icon")
        close.setIcon(icon("close"))
        close.setToolTip("Dismiss")
        close.setAccessibleName("Dismiss")
        close.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        close.clicked.connect(self.dismiss)
        self.button = QPushButton()
        self.button.setAccessibleName("What the message offers")
        self.button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.button.clicked.connect(self._accept)
        row = QHBoxLayout(self)
        row.setContentsMargins(MARGIN, 3, MARGIN, 3)
        row.setSpacing(GAP)
        row.addWidget(self._sign)
        row.addWidget(self.text, 1)
        row.addWidget(self.button)
        row.addWidget(close)
        self.hide()

    def show_message(self, text: str, detail: str = "") -> None:
        """Show a message below any others, with details in its tooltip."""
        self._messages.pop(text, None)
        self._messages[text] = detail
        self._show()

    def offer(self, text: str, button: str, act: Callable[[], None]) -> None:
        """Show a message with a button; it replaces the last one that had one."""
        self.withdraw()
        self._offered = text, act
        self.button.setText(button)
        self.button.setAccessibleName(button)
        self.show_message(text)

    def withdraw(self) -> None:
        """Remove the message with a button."""
        if self._offered is not None:
            self.remove(self._offered[0])

    def _accept(self) -> None:
        if self._offered is not None:
            act = self._offered[1]
            self.withdraw()
            act()

    def remove(self, text: str) -> None:
        """Remove a message that no longer holds."""
        self._messages.pop(text, None)
        self._show()

    def dismiss(self) -> None:
        """Remove all messages."""
        self._messages.clear()
        self._show()

    def _show(self) -> None:
        if self._offered is not None and self._offered[0] not in self._messages:
            self._offered = None
        self.button.setVisible(self._offered is not None)
        self.text.setText("\n".join(self._messages))
        self.text.setToolTip(plain_tip("\n".join(filter(None, self._messages.values()))))
        self._show_kind()
        self.setVisible(bool(self._messages))

    @property
    def warns(self) -> bool:
        """Whether anything shown is a warning; what can be done about something is none."""
        offered = self._offered[0] if self._offered is not None else None
        return any(text != offered for text in self._messages)

    def _show_kind(self) -> None:
        name, color = ("warning", ORANGE) if self.warns else ("info", ACCENT)
        self._sign.setPixmap(picture(name, color, 16, self.devicePixelRatioF()))
        self.setProperty("warns", self.warns)
        self.style().polish(self)
