"""Paints the changes of several scenes in one round."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QCoreApplication, QEvent, QObject
from PySide6.QtWidgets import QGraphicsScene, QWidget

_META_CALL, _UPDATE_REQUEST = QEvent.Type.MetaCall, QEvent.Type.UpdateRequest


class OnePainting(QObject):
    """Paints the changes of several scenes in one round.

    Qt has each scene pass on its changes in an event of its own, at the end of which it paints the
    window. So a step of a drag would paint it nine times, and wait for the face before the plots
    are painted. Here the first of these events brings the others with it.

    Args:
        widget: any widget of the scenes' window.
        scenes: the scenes.
    """

    def __init__(self, widget: QWidget, scenes: Sequence[QGraphicsScene]) -> None:
        super().__init__(widget)
        self._widget, self._scenes = widget, scenes
        self._is_collecting, self._is_stale = False, False
        for scene in scenes:
            scene.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Collect the changes of all scenes, and keep the window from painting meanwhile."""
        kind = event.type()
        if self._is_collecting:
            if kind == _UPDATE_REQUEST:
                self._is_stale = True
                return True
        elif kind == _META_CALL:
            self._collect(watched, event)
            return True
        return False

    def _collect(self, scene: QObject, event: QEvent) -> None:
        """Deliver this event of a scene, and those that wait for the others; then paint."""
        window = self._widget.window()
        self._is_collecting = True
        window.installEventFilter(self)
        scene.event(event)
        for other in self._scenes:
            QCoreApplication.sendPostedEvents(other, _META_CALL.value)
        window.removeEventFilter(self)
        self._is_collecting = False
        if self._is_stale:
            self._is_stale = False
            # At once, as Qt does: a scene does not learn where an item was that moves and is
            # painted before the scene has passed on its move.
            QCoreApplication.sendEvent(window, QEvent(_UPDATE_REQUEST))
