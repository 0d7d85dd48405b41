"""Fields whose text cannot be taken: it stays, marked, with the reason beside it."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, QPoint, Qt
from PySide6.QtWidgets import QLabel, QWidget

_GAP = 3  # pixels between a field and the reason


def show_refused(field: QWidget, reason: str, otherwise: str = "") -> None:
    """Mark a field, and show beside it why its text cannot be taken.

    The reason stays until it is taken back, or the field is hidden; a tooltip would go at the click
    that left the field.

    Args:
        reason: one line; "" takes mark and reason back.
        otherwise: what screen readers say of the field while it is not marked.
    """
    if bool(field.property("refused")) != bool(reason):
        field.setProperty("refused", bool(reason))
        _restyle(field)
    field.setAccessibleDescription(reason or otherwise)
    shown = reason_in(field.window())
    if reason:
        (shown or _Reason(field.window())).show_beside(field, reason)
    elif shown is not None and shown.field is field:
        shown.end()


def _restyle(field: QWidget) -> None:
    """Apply the style again, which would also bring back the first font of a field and its text."""
    fonts = [(widget, widget.font()) for widget in (field, *field.findChildren(QWidget))]
    field.style().unpolish(field)
    field.style().polish(field)
    for widget, font in fonts:
        if widget.font() != font:
            widget.setFont(font)


def reason_in(window: QWidget) -> _Reason | None:
    """The reason that is shown in a window, if there is one."""
    return window.findChild(_Reason, options=Qt.FindChildOption.FindDirectChildrenOnly)


class _Reason(QLabel):
    """Why the text of a field cannot be taken.

    Attributes:
        field: the field.
    """

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self.setObjectName("reason")
        self.setTextFormat(Qt.TextFormat.PlainText)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.field: QWidget | None = None

    def show_beside(self, field: QWidget, reason: str) -> None:
        """Show a reason below a field, or above it if there is no room."""
        if self.field is not field:
            self._let_go()
            self.field = field
            field.installEventFilter(self)
        self.setText(reason)
        self.adjustSize()
        self._move(field)
        self.show()
        self.raise_()

    def _move(self, field: QWidget) -> None:
        room = self.parentWidget()
        assert room is not None
        corner = field.mapTo(room, QPoint(0, 0))
        below = corner.y() + field.height() + _GAP
        fits = below + self.height() <= room.height()
        left = max(min(corner.x(), room.width() - self.width() - _GAP), 0)
        self.move(left, below if fits else max(corner.y() - self.height() - _GAP, 0))

    def end(self) -> None:
        """Go away."""
        self._let_go()
        self.hide()
        self.setParent(None)
        self.deleteLater()

    def _let_go(self) -> None:
        if self.field is not None:
            self.field.removeEventFilter(self)
        self.field = None

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Go with the field."""
        if event.type() == QEvent.Type.Hide:
            self.end()
        elif event.type() in (QEvent.Type.Move, QEvent.Type.Resize) and self.field is not None:
            self._move(self.field)
        return False
