"""Moving the camera with keys, while the viewport has the focus."""

from __future__ import annotations

import math

from PySide6.QtCore import Qt
from PySide6.QtGui import QKeyEvent

from faceedit_app.render import Camera

TURN = math.radians(5.0)  # per press
SHIFT = 12.0  # pixels per press
CLOSER = 0.93  # of the distance, per press
_KEY, _SHIFT = Qt.Key, Qt.KeyboardModifier.ShiftModifier
# Directions of a mouse drag: right, up.
_WAYS = {
    _KEY.Key_Left: (-1, 0),
    _KEY.Key_Right: (1, 0),
    _KEY.Key_Up: (0, 1),
    _KEY.Key_Down: (0, -1),
}
_ZOOMS = {_KEY.Key_Plus: CLOSER, _KEY.Key_Equal: CLOSER, _KEY.Key_Minus: 1 / CLOSER}


def moved_by_key(camera: Camera, event: QKeyEvent, metres: float) -> Camera | None:
    """The camera after a key press; None if the key does not move it.

    Args:
        metres: size of a pixel at the face.
    """
    # Arrows and signs of the number pad count too.
    keys = event.modifiers() & ~Qt.KeyboardModifier.KeypadModifier
    if keys not in (Qt.KeyboardModifier.NoModifier, _SHIFT):
        return None
    key = _KEY(event.key())
    if key in _ZOOMS:  # “+” needs Shift on many keyboards
        return camera.zoom(_ZOOMS[key])
    if key not in _WAYS:
        return None
    right, up = _WAYS[key]
    if keys == _SHIFT:
        return camera.pan(-right * SHIFT * metres, -up * SHIFT * metres)
    return camera.orbit(-right * TURN, -up * TURN)
