"""Keys that do the same wherever the focus is."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QEvent, QObject, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QAbstractSlider,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QLineEdit,
    QWidget,
)

from faceedit_app.ui.look.number import NumberBox
from faceedit_app.ui.look.widgets import ENTER
from faceedit_app.ui.page.keys_back import KeysBack, in_list
from faceedit_app.ui.page.time_entry import TimeEntry
from faceedit_app.ui.state.actions import Actions

GLANCE = Qt.Key.Key_B
_ADJUSTING = {
    Qt.Key.Key_Left,
    Qt.Key.Key_Right,
    Qt.Key.Key_Up,
    Qt.Key.Key_Down,
    Qt.Key.Key_Home,
    Qt.Key.Key_End,
}
_STEPPING = {Qt.Key.Key_Up, Qt.Key.Key_Down}
_FIELDS = QLineEdit | QAbstractSpinBox


class KeyArbiter(QObject):
    """Decides between a shortcut and the widget that has the focus.

    Space plays, even from a number field in which nothing is typed yet; the arrows move a focused
    slider, choice or list, and the playhead otherwise; holding B shows the tracked face. What is
    typed into a field belongs to it. A key whose command is not possible says why.

    Args:
        window: whose keys they are.
        actions: the commands.
        say: shows a line to the user.

    Attributes:
        back: gives the keys back to the curves.

    Signals:
        glancing(bool): B was pressed or released.
    """

    glancing = Signal(bool)

    def __init__(self, window: QWidget, actions: Actions, say: Callable[[str], None]) -> None:
        super().__init__(window)
        self._window, self._actions, self._say = window, actions, say
        self._held = False
        self.back = KeysBack(window)
        window.installEventFilter(self)
        app = QApplication.instance()
        assert isinstance(app, QApplication)
        app.focusChanged.connect(self._watch)

    def _watch(self, _old: QWidget | None, now: QWidget | None) -> None:
        """Filter only the focused widget's events; filtering all would cost time."""
        if now is not None and now.window() is self._window:
            now.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Decide between shortcut and widget, and watch for B."""
        kind = event.type()
        if kind == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent):
            return self._override(event)
        if kind in (QEvent.Type.KeyPress, QEvent.Type.KeyRelease) and isinstance(event, QKeyEvent):
            is_down = kind == QEvent.Type.KeyPress
            if self._glance(event, is_down):
                return True
            if is_down and watched is self._window:  # no widget wanted it
                self._explain(event)
            return is_down and _would_search(watched, event) and self._explain(event)
        if kind == QEvent.Type.WindowDeactivate and watched is self._window:
            self._hold(False)
        elif kind == QEvent.Type.WindowActivate and watched is self._window:
            self.back.come_back()
        return False

    def _override(self, event: QKeyEvent) -> bool:
        focus = self._focus()
        if focus is None:
            return False
        plain = event.modifiers() == Qt.KeyboardModifier.NoModifier
        if plain and event.key() == Qt.Key.Key_Space and not _takes_space(focus):
            event.ignore()  # consumed unaccepted, so that the shortcut gets it
            return True
        adjusts = isinstance(focus, QAbstractSlider | QComboBox | QAbstractItemView)
        steps = isinstance(focus, QAbstractSpinBox) and event.key() in (*_STEPPING, *ENTER)
        if plain and (steps or (adjusts and event.key() in _ADJUSTING)):
            event.accept()  # for the widget, not a shortcut
            return True
        return False

    def _explain(self, event: QKeyEvent) -> bool:
        """Say why the command of a key is not possible; Enter also ends what is typed.

        Returns:
            Whether the key has such a command.
        """
        why_not = "" if event.key() in ENTER else self._actions.why_not(event)
        if why_not:
            self._say(why_not)
        return bool(why_not)

    def _glance(self, event: QKeyEvent, down: bool) -> bool:
        if event.key() != GLANCE or event.isAutoRepeat():
            return event.key() == GLANCE and self._held
        focus = self._focus()
        if down and (focus is None or isinstance(focus, _FIELDS) or event.modifiers()):
            return False
        if down == self._held:
            return down
        self._hold(down)
        return True

    def _hold(self, down: bool) -> None:
        if down != self._held:
            self._held = down
            self.glancing.emit(down)

    def _focus(self) -> QWidget | None:
        """The widget in this window that gets keys; None while a menu or dialog gets them."""
        if QApplication.activePopupWidget() or QApplication.activeModalWidget():
            return None
        focus = QApplication.focusWidget() or self._window
        return focus if focus.window() is self._window else None


def _would_search(watched: QObject, event: QKeyEvent) -> bool:
    """Whether a list or a choice would look for a row that begins with a letter."""
    return isinstance(watched, QComboBox | QAbstractItemView) and event.text().isalnum()


def _takes_space(widget: QWidget) -> bool:
    """Whether Space is for a widget: a text, a field in a list, a number or time that is typed."""
    if isinstance(widget, TimeEntry):
        return widget.isModified()
    if isinstance(widget, NumberBox):
        return widget.is_typed or in_list(widget)
    return isinstance(widget, QLineEdit)
