"""The orbit camera of the viewport."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.controls import CONTROL_INDEX, LIDS, MOUTH_WIDTH
from faceedit_app.core.rig import Rig

FIELD_OF_VIEW = math.radians(22.0)  # vertical; a portrait lens, which flatters the nose
PITCH_LIMIT = math.radians(80.0)
DISTANCE_LIMITS = (0.15, 3.0)  # metres
PAN_LIMIT = 0.3  # metres from the origin, on each axis
NARROW = 0.8  # width / height; narrower views are as wide as one of this shape
NEAR, FAR = 0.02, 6.0  # metres

# Portrait framing, as fractions of the height from the chin to the crown.
_HEADROOM, _NECKROOM = 0.08, 0.14
_MOVING = 3e-3  # metres at weight 1; vertices that move more belong to the face


@dataclass(frozen=True)
class Camera:
    """The place and direction of the camera.

    Attributes:
        yaw: radians around the face; 0 is the front, positive sees the character's left.
        pitch: radians above the face's level.
        distance: metres from `target`.
        target: the point in the middle of the picture, metres.
    """

    yaw: float = 0.0
    pitch: float = 0.0
    distance: float = 0.85
    target: tuple[float, float, float] = (0.0, 0.03, 0.0)

    def orbit(self, dx: float, dy: float) -> Camera:
        """Turn by `dx` radians around the face and `dy` radians upwards, up to a limit."""
        yaw = math.remainder(self.yaw + dx, math.tau)
        return replace(self, yaw=yaw, pitch=_clamp(self.pitch + dy, -PITCH_LIMIT, PITCH_LIMIT))

    def zoom(self, factor: float) -> Camera:
        """Multiply the distance by `factor`, up to a limit; below 1 moves nearer."""
        return replace(self, distance=_clamp(self.distance * factor, *DISTANCE_LIMITS))

    def pan(self, dx: float, dy: float) -> Camera:
        """Move camera and target by metres in the view plane, rightwards and upwards."""
        moved = np.asarray(self.target) + self.pose()[:3, :2] @ (dx, dy)
        x, y, z = (_clamp(float(v), -PAN_LIMIT, PAN_LIMIT) for v in moved)
        return replace(self, target=(x, y, z))

    def pose(self) -> Doubles:
        """Camera to world, (4, 4) float64, metres; the camera looks along its own -Z."""
        sy, cy = math.sin(self.yaw), math.cos(self.yaw)
        sp, cp = math.sin(self.pitch), math.cos(self.pitch)
        backward = np.array([sy * cp, sp, cy * cp])
        pose = np.eye(4)
        pose[:3, 0] = cy, 0.0, -sy
        pose[:3, 1] = -sy * sp, cp, -cy * sp
        pose[:3, 2] = backward
        pose[:3, 3] = np.asarray(self.target) + self.distance * backward
        return pose

    def project(self, places: Floats, width: float, height: float) -> Doubles:
        """Where places (N, 3), metres, are in a picture of this size.

        Returns:
            (N, 3): pixels from the left and from the top, and metres in front of the camera.
        """
        pose = self.pose()
        seen = (places - pose[:3, 3]) @ pose[:3, :3]
        depth = -seen[:, 2]
        scale = height / 2.0 / _half_height(width / height) / np.maximum(depth, NEAR)
        across, down = width / 2.0 + scale * seen[:, 0], height / 2.0 - scale * seen[:, 1]
        return np.stack((across, down, depth), axis=1)


def field_of_view(aspect: float) -> float:
    """The vertical field of view, radians, of a view of `aspect` = width / height."""
    return 2.0 * math.atan(_half_height(aspect))


class Aim(StrEnum):
    """What the camera can be pointed at."""

    FRONT = "front"
    LEFT = "left"  # the character's left side
    RIGHT = "right"
    MOUTH = "mouth"
    EYES = "eyes"


# The controls whose points enclose a detail, and the width of the view relative to them.
_DETAILS = {Aim.MOUTH: ((MOUTH_WIDTH,), 2.4), Aim.EYES: (LIDS, 2.2)}
_LOW = 0.7  # height of a detail relative to its width
_SIDES = {Aim.LEFT: math.pi / 2, Aim.RIGHT: -math.pi / 2}


def aimed_camera(rig: Rig, aim: Aim, aspect: float = 1.0) -> Camera:
    """The whole head from one side, or a detail from the front, in a view of `aspect`.

    From the front if the character lacks the controls of the detail.
    """
    if aim in _SIDES:
        return _portrait(rig, aspect, _SIDES[aim])
    if aim not in _DETAILS:
        return default_camera(rig, aspect)
    names, share = _DETAILS[aim]
    pairs = rig.control_pairs[[CONTROL_INDEX[name] for name in names]]
    points = rig.neutral[pairs[pairs.min(axis=1) >= 0].ravel()]
    if not len(points):
        return default_camera(rig, aspect)
    low, high = points.min(axis=0), points.max(axis=0)
    width = share * float(high[0] - low[0])
    half = _half_height(aspect)
    distance = max(width / aspect, _LOW * width) / (2.0 * half)
    x, y, z = ((low + high) / 2.0).tolist()
    return Camera(distance=_clamp(distance, *DISTANCE_LIMITS), target=(x, y, z))


def default_camera(rig: Rig, aspect: float = 1.0) -> Camera:
    """A portrait: crown to just below the chin in the middle of a view of width / height `aspect`.

    The face is what blendshapes move, so a bust or body below it does not count.
    """
    return _portrait(rig, aspect, 0.0)


def _portrait(rig: Rig, aspect: float, yaw: float) -> Camera:
    """See `default_camera`; from the front or, a quarter turn away, from a side."""
    across, along = (0, 2) if yaw == 0.0 else (2, 0)
    moving = rig.farthest_moves > _MOVING
    face = rig.neutral[moving] if moving.any() else rig.neutral
    chin = float(face[:, 1].min())
    crown = float(rig.neutral[:, 1].max())
    height = crown - chin
    top, bottom = crown + _HEADROOM * height, chin - _NECKROOM * height
    head = rig.neutral[rig.neutral[:, 1] >= chin]
    left, right = float(head[:, across].min()), float(head[:, across].max())
    # Near parts look larger: measure at the widest part, mid-depth.
    depth = float(np.mean(head[:, along]))
    half = _half_height(aspect)
    width_needed = (1.0 + _HEADROOM) * (right - left) / (2.0 * half * aspect)
    distance = max((top - bottom) / (2.0 * half), width_needed)
    middle, height = (left + right) / 2.0, (top + bottom) / 2.0
    target = (middle, height, depth) if across == 0 else (depth, height, middle)
    return Camera(yaw, distance=_clamp(distance, *DISTANCE_LIMITS), target=target)


def _half_height(aspect: float) -> float:
    return math.tan(FIELD_OF_VIEW / 2.0) * max(1.0, NARROW / aspect)


def _clamp(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)
