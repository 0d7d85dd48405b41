"""A strip across the window for messages that need no answer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

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

Holds = Callable[[], bool]


@dataclass(frozen=True)
class _Message:
    """What belongs to a message.

    Attributes:
        detail: for the tooltip.
        lasts: it is not about the take.
        holds: whether it is still true.
    """

    detail: str
    lasts: bool
    holds: Holds | None


class Banner(QFrame):
    """Shows messages, one a line, until they are dismissed or no longer true.

    A message is about the open take unless it `lasts`: it goes when another take opens. While that
    is read and the open one is not shown, the messages are put aside.
    """

    def __init__(self) -> None:
        super().__init__()
        self._messages: dict[str, _Message] = {}
        self._offered: tuple[str, Callable[[], None]] | None = None  # message, what can be done
        self._is_aside = False
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

    def show_message(
        self, text: str, detail: str = "", lasts: bool = False, holds: Holds | None = None
    ) -> None:
        """Show a message below any others.

        Args:
            text: the message.
            detail: for the tooltip.
            lasts: it stays when another take is opened.
            holds: asked after each change of the take; once it is False, the message goes.
        """
        self._messages.pop(text, None)
        self._messages[text] = _Message(detail, lasts, holds)
        self._show()

    def leave_take(self) -> None:
        """Another take is open: remove what was said about the last one."""
        self._keep(lambda message: message.lasts)

    def put_aside(self, aside: bool) -> None:
        """Hide the messages for a while, or show them again."""
        self._is_aside = aside
        self._show()

    def review(self) -> set[str]:
        """The take has changed: remove what is no longer true, and return it."""
        return self._keep(lambda message: message.holds is None or message.holds())

    def _keep(self, wanted: Callable[[_Message], bool]) -> set[str]:
        gone = {text for text, message in self._messages.items() if not wanted(message)}
        for text in gone:
            del self._messages[text]
        if gone:
            self._show()
        return gone

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
        details = (message.detail for message in self._messages.values())
        self.text.setToolTip(plain_tip("\n".join(filter(None, details))))
        self._show_kind()
        self.setVisible(bool(self._messages) and not self._is_aside)

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
