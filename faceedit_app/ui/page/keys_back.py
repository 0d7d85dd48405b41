"""Gives the keys back to the curves from a slider, a field or a list that is done or gone."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QAbstractSlider,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QLineEdit,
    QTabWidget,
    QWidget,
)

from faceedit_app.ui.look.widgets import ENTER

_TAKING = QAbstractSlider | QAbstractSpinBox | QComboBox | QLineEdit | QAbstractItemView
_MOUSE = Qt.FocusReason.MouseFocusReason


class KeysBack(QObject):
    """The one rule for what would keep Space, the arrows, B and Z to itself.

    A click elsewhere in the window takes the keys from it, and so do the mouse on a slider or on
    the arrows of a number field, and Enter in a number field that takes what was typed. Who goes
    by Tab keeps them until then. A click into a text or a list is meant for it.

    What has the keys and is hidden or disabled gives them back, too. Qt would hand them on to what
    Tab reaches next, which nobody asked for.

    Attributes:
        home: what gets the keys; the window itself while it is hidden.
    """

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self._window = window
        self.home: QWidget = window
        self._taking: QWidget | None = None
        app = QApplication.instance()
        assert isinstance(app, QApplication)
        self._app = app
        app.focusChanged.connect(self._watch)

    def _watch(self, old: QWidget | None, now: QWidget | None) -> None:
        """See all events only while one of them has the focus: it would cost time."""
        is_here = now is not None and now.window() is self._window
        takes = is_here and isinstance(now, _TAKING)
        if takes and self._taking is None:
            self._app.installEventFilter(self)
        elif not takes and self._taking is not None:
            self._app.removeEventFilter(self)
        self._taking = now if takes else None
        if is_here and old is not None and old.window() is self._window and _is_gone(old):
            self.give()  # comes back here, unless that has the keys already

    def give(self) -> None:
        """Give the keys back."""
        (self.home if self.home.isVisible() else self._window).setFocus(_MOUSE)

    def come_back(self) -> None:
        """The window is used again; meanwhile, what had the keys may have gone."""
        focus = self._window.focusWidget()
        if focus is not None and _is_gone(focus):
            self.give()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Notice a press, a release, and Enter."""
        taking, kind = self._taking, event.type()
        if taking is None or not isinstance(watched, QWidget):
            return False
        if kind == QEvent.Type.MouseButtonPress and watched.window() is self._window:
            if not self._is_for(taking, watched):
                self.give()
        elif kind == QEvent.Type.MouseButtonRelease and watched is taking:
            if isinstance(taking, QAbstractSlider | QAbstractSpinBox):
                self.give()
        elif kind == QEvent.Type.KeyPress and isinstance(event, QKeyEvent) and watched is taking:
            return self._enter(taking, event)
        return False

    def _enter(self, taking: QWidget, event: QKeyEvent) -> bool:
        """Whether a key was Enter in a number field; one in a list goes back to the list."""
        if event.key() not in ENTER or not isinstance(taking, QAbstractSpinBox):
            return False
        if in_list(taking):
            return False
        taking.event(event)  # the number is taken first
        if taking.hasAcceptableInput():  # else another one is typed
            self.give()
        return True

    @staticmethod
    def _is_for(taking: QWidget, pressed: QWidget) -> bool:
        """Whether a press is for the widget with the focus, or what belongs to it."""
        if isinstance(taking, QComboBox):
            return False  # what it opens is another window, which gives the focus back
        part = taking.parentWidget() if isinstance(taking, QAbstractItemView) else taking
        return part is not None and (part is pressed or part.isAncestorOf(pressed))


def _is_gone(widget: QWidget) -> bool:
    """Whether a widget can no longer have the keys."""
    return not (widget.isVisible() and widget.isEnabled())


def turn_to(tabs: QTabWidget, page: QWidget, home: QWidget) -> None:
    """Show another page of tabs; home gets the keys of the page that is hidden.

    Qt would give them to the first field of the other page, whichever that is.
    """
    before, focus = tabs.currentWidget(), QApplication.focusWidget()
    if page is not before and focus is not None and before.isAncestorOf(focus):
        home.setFocus()
    tabs.setCurrentWidget(page)


def in_list(field: QWidget) -> bool:
    """Whether a field was opened in a row of a list."""
    viewport = field.parentWidget()
    return viewport is not None and isinstance(viewport.parentWidget(), QAbstractItemView)
