"""A face at one moment, as it is sent and received."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.arrays import Floats

ROTATIONS = tuple(
    part + axis for part in ("Head", "LeftEye", "RightEye") for axis in ("Yaw", "Pitch", "Roll")
)
_LARGEST = 10.0  # a weight beyond it is damage


class BadPacket(ValueError):
    """A packet is not what it should be; the text says how, as a phrase."""


@dataclass(frozen=True)
class Pose:
    """A face at one moment.

    Attributes:
        weights: (52,) float32 in ARKit order.
        seconds: of the sender's clock; None if it does not send it.
        rate: nominal frames per second.
        subject: the sender's name for the face.
        rotations: (9,) float32 radians, see `ROTATIONS`.
    """

    weights: Floats
    seconds: float | None = None
    rate: float = 60.0
    subject: str = ""
    rotations: Floats | None = None


def second_of_day(now: float | None = None) -> float:
    """Seconds since local midnight.

    Args:
        now: as from `time.time`; None = this moment.
    """
    now = time.time() if now is None else now  # asked for once: a second may end between two
    clock = time.localtime(now)
    return clock.tm_hour * 3600.0 + clock.tm_min * 60.0 + clock.tm_sec + now % 1.0


def checked(pose: Pose) -> Pose:
    """The pose, if its numbers can be right.

    Raises:
        BadPacket: they cannot.
    """
    if pose.weights.shape != (len(ARKIT_CHANNELS),):
        raise BadPacket("it lacks some channels")
    if not (np.isfinite(pose.weights).all() and np.abs(pose.weights).max() <= _LARGEST):
        raise BadPacket("a weight is impossible")
    if pose.rotations is not None and not np.isfinite(pose.rotations).all():
        raise BadPacket("a rotation is not a number")
    return pose
