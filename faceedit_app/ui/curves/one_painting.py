"""Lets the window paint the changes of several scenes in one round."""

from __future__ import annotations

from collections.abc import Iterable

from PySide6.QtCore import QCoreApplication, QEvent, QObject
from PySide6.QtWidgets import QGraphicsScene, QWidget


class OnePainting(QObject):
    """Lets the window paint the changes of several scenes in one round.

    Qt has each scene report its changes in an event of its own, and paints the window at the end of
    each: eight plots take eight rounds, and what else has changed is painted in the first of them.

    Args:
        widget: any in the window.
    """

    def __init__(self, widget: QWidget) -> None:
        super().__init__(widget)
        self._widget = widget
        self._was_asked = False

    def join(self, scenes: Iterable[QGraphicsScene]) -> None:
        """Have the scenes report their changes now, and the window paint them soon."""
        window = self._widget.window()
        window.installEventFilter(self)
        for scene in scenes:
            QCoreApplication.sendPostedEvents(scene, QEvent.Type.MetaCall.value)
        window.removeEventFilter(self)
        if self._was_asked:
            self._was_asked = False
            QCoreApplication.postEvent(window, QEvent(QEvent.Type.UpdateRequest))

    def eventFilter(self, _window: QObject, event: QEvent) -> bool:
        """Keep the window from painting."""
        if event.type() == QEvent.Type.UpdateRequest:
            self._was_asked = True
            return True
        return False
