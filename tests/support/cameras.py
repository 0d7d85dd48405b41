"""What a camera sees."""

from __future__ import annotations

import math

import numpy as np

from faceedit_app.render import Camera
from faceedit_app.render.camera import field_of_view


def seen(camera: Camera, point: np.ndarray, aspect: float) -> np.ndarray:
    """Where a point is in the view: -1..1 to the right and up."""
    x, y, z, _ = np.linalg.inv(camera.pose()) @ np.append(point, 1.0)
    half = -z * math.tan(field_of_view(aspect) / 2.0)
    return np.array([x / (half * aspect), y / half])
