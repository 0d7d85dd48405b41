"""Small widgets that several parts of the window share."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

from PySide6.QtCore import QPointF, QSize, Qt
from PySide6.QtGui import (
    QAction,
    QColor,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPen,
)
from PySide6.QtWidgets import (
    QComboBox,
    QDialog,
    QFrame,
    QHBoxLayout,
    QLabel,
    QMenu,
    QPushButton,
    QSizePolicy,
    QToolButton,
    QWidget,
)

from faceedit_app.ui.look.guard import guarded
from faceedit_app.ui.look.icons import SIZE
from faceedit_app.ui.look.palette import FAINT, TEXT
from faceedit_app.ui.look.texts import name_entry
from faceedit_app.ui.look.theme import GAP, MARGIN

Shown = TypeVar("Shown", bound=QDialog)

ENTER = (Qt.Key.Key_Return, Qt.Key.Key_Enter)
_TITLE_BAR = 40  # pixels, roughly; the frame is known only once the window is shown


class Segment(QToolButton):
    """A button of a group. Enter presses it too, since Space always plays."""

    def __init__(self, action: QAction, name: str, text: str) -> None:
        super().__init__()
        self.setObjectName(name)
        action.setIconText(text)  # for the button; the menu shows the text
        self.setDefaultAction(action)
        self.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextOnly)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Enter presses the button."""
        if event.key() in ENTER:
            self.click()
        else:
            super().keyPressEvent(event)


class OneClick(QToolButton):
    """A button for which a double click is one click."""

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Ignore the second press."""
        event.accept()


class OnePush(QPushButton):
    """As `OneClick`, with a text instead of an icon."""

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Ignore the second press."""
        event.accept()


class Choice(QComboBox):
    """A drop-down list; draws its own arrow, since the style sheet removes Fusion's."""

    def __init__(self) -> None:
        super().__init__()
        # A click does not take the focus, so that the arrows still move the playhead.
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)

    @guarded
    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the list and its arrow."""
        super().paintEvent(event)
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(QColor(TEXT if self.isEnabled() else FAINT), 1.5))
        x, y = self.width() - 12.0, self.height() / 2
        painter.drawPolyline(
            [QPointF(x - 3.5, y - 1.75), QPointF(x, y + 1.75), QPointF(x + 3.5, y - 1.75)]
        )


class Elided(QLabel):
    """A line of text that ends in an ellipsis if there is not enough room.

    It never widens the window; the tooltip has the whole line.

    Attributes:
        short: what is shown in place of a line that does not fit; "" for its beginning.
    """

    def __init__(self) -> None:
        super().__init__()
        self.short = ""
        self.setTextFormat(Qt.TextFormat.PlainText)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)

    @property
    def shown(self) -> str:
        """The visible text."""
        room, metrics, text = self.contentsRect().width(), self.fontMetrics(), self.text()
        if self.short and metrics.horizontalAdvance(text) > room:
            text = self.short
        return metrics.elidedText(text, Qt.TextElideMode.ElideRight, room)

    @guarded
    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the text in the style sheet's colour."""
        with QPainter(self) as painter:
            align = int(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
            role, look = self.foregroundRole(), self.palette()
            place, enabled = self.contentsRect(), self.isEnabled()
            self.style().drawItemText(painter, place, align, look, enabled, self.shown, role)


def segments(*choices: tuple[QAction, str]) -> QWidget:
    """Joined buttons for a choice between checkable actions."""
    box = QWidget()
    row = QHBoxLayout(box)
    row.setContentsMargins(0, 0, 0, 0)
    row.setSpacing(1)
    for i, (action, text) in enumerate(choices):
        place = "left" if i == 0 else "right" if i == len(choices) - 1 else "middle"
        row.addWidget(Segment(action, f"segment_{place}", text))
    return box


def icon_button(
    action: QAction, name: str = "icon", text: str = "", *, repeats: bool = False
) -> QToolButton:
    """An action as an icon. It has a shortcut, so it does not take the focus.

    Args:
        repeats: the action is one to do many times, such as a step or Undo: quick clicks all count.
            For others, a double click is one click.
    """
    button = QToolButton() if repeats else OneClick()
    if text:  # under a style sheet Qt leaves a pixel or two between icon and text
        action.setIconText(text if action.icon().isNull() else f"\N{FOUR-PER-EM SPACE}{text}")
    button.setObjectName(name)
    button.setDefaultAction(action)
    button.setIconSize(QSize(SIZE, SIZE))
    style = Qt.ToolButtonStyle
    button.setToolButtonStyle(style.ToolButtonTextBesideIcon if text else style.ToolButtonIconOnly)
    button.setFocusPolicy(Qt.FocusPolicy.NoFocus)
    button.setAccessibleName(action.text().replace("&", ""))
    return button


def caption(text: str, buddy: QWidget | None = None) -> QLabel:
    """A muted label for a widget."""
    label = QLabel(text)
    label.setObjectName("caption")
    if buddy is not None:
        label.setBuddy(buddy)
        label.setToolTip(buddy.toolTip())
        buddy.setAccessibleName(text)
    return label


def context_menu(parent: QWidget, *groups: Iterable[QAction]) -> QMenu:
    """A menu of actions with lines between the groups; it is deleted when closed."""
    menu = QMenu(parent)
    menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    for group in groups:
        if not menu.isEmpty():
            menu.addSeparator()
        menu.addActions(list(group))
    return menu


def list_files(
    menu: QMenu, paths: Iterable[Path], choose: Callable[[Path], object], none: str
) -> None:
    """Fill a menu with files, or with a line that there is `none`."""
    menu.clear()
    for path in paths:
        action = menu.addAction(name_entry(path.name))
        action.setStatusTip(str(path))
        action.triggered.connect(lambda _checked=False, p=path: choose(p))
    if menu.isEmpty():
        menu.addAction(none).setEnabled(False)


def divider() -> QFrame:
    """A thin vertical line between groups."""
    line = QFrame()
    line.setObjectName("line")
    line.setFixedSize(1, 18)
    return line


def resize_on_screen(dialog: QWidget, width: int, height: int) -> None:
    """Give a dialog a size in pixels, or what the screen has room for, so that its buttons show."""
    room = dialog.screen().availableSize()
    dialog.resize(min(width, room.width()), min(height, room.height() - _TITLE_BAR))


def bar_row(box: QWidget, name: str) -> QHBoxLayout:
    """Make a widget a horizontal bar; returns the row to fill it with."""
    box.setObjectName(name)
    box.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
    row = QHBoxLayout(box)
    row.setContentsMargins(MARGIN, GAP // 2 + 1, MARGIN, GAP // 2 + 1)
    row.setSpacing(GAP // 2)
    return row


@contextmanager
def shown_once(dialog: Shown) -> Iterator[Shown]:
    """A dialog that is deleted when it was answered; else its parent would keep it as a child."""
    try:
        yield dialog
    finally:
        dialog.deleteLater()
