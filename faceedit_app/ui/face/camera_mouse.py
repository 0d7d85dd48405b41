"""Moving the camera with the mouse on the viewport."""

from __future__ import annotations

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QApplication

from faceedit_app.render import Camera

ORBIT = 0.008  # radians per pixel
ZOOM_STEP = 0.88  # per notch of the wheel


class CameraMouse:
    """A press and the moves that follow it: left orbits, middle or right pans."""

    def __init__(self) -> None:
        self._pressed: QPointF | None = None  # place of a press that has not moved yet
        self._grabbed: QPointF | None = None

    @property
    def is_held(self) -> bool:
        """Whether the camera is being moved."""
        return self._grabbed is not None

    def press(self, at: QPointF) -> None:
        """A button was pressed."""
        self._grabbed = self._pressed = at

    def release(self) -> None:
        """All buttons were released, or the release was lost."""
        self._grabbed = self._pressed = None

    def is_click(self, at: QPointF) -> bool:
        """Whether a release here would be a click."""
        near = QApplication.startDragDistance()
        return self._pressed is not None and (at - self._pressed).manhattanLength() < near

    def moved(self, camera: Camera, event: QMouseEvent, metres: float) -> Camera | None:
        """The camera after a move of the mouse; None if it stays.

        Args:
            camera: where it is now.
            event: the move.
            metres: size of a pixel at the face.
        """
        at, buttons = event.position(), event.buttons()
        if self._grabbed is None:
            return None
        if self.is_click(at) and buttons & Qt.MouseButton.RightButton:
            return None  # may still become a click, for the menu
        self._pressed = None
        moved, self._grabbed = at - self._grabbed, at
        if buttons & Qt.MouseButton.LeftButton:
            return camera.orbit(-moved.x() * ORBIT, moved.y() * ORBIT)
        return camera.pan(-moved.x() * metres, moved.y() * metres)
