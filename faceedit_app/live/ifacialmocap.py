"""Packets of iFacialMocap: one text a frame, whole numbers from 0 to 100.

`mouthSmile_R-0|eyeLookOut_L-12|…|=head#rx,ry,rz,x,y,z|rightEye#rx,ry,rz|leftEye#rx,ry,rz|`, angles
in degrees; newer versions write `&` for `-` (ifacialmocap.com). The phone sends once it has been
greeted.
"""

from __future__ import annotations

import math
import re

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.names import canonical_channel
from faceedit_app.live.pose import BadPacket, Pose, checked

GREETING = b"iFacialMocap_sahuasouryya9218sauhuiayeta91555dy3719"
_ENTRY = re.compile(r"([A-Za-z_]+)\s*[-&]\s*(-?\d{1,4}(?:\.\d{1,9})?)")
_PARTS = {"head": 0, "leftEye": 3, "rightEye": 6}


def decode(packet: bytes) -> Pose:
    """The pose of a datagram.

    Raises:
        BadPacket: it is not one of iFacialMocap.
    """
    text = packet.decode("utf-8", "replace")
    weights = np.zeros(len(ARKIT_CHANNELS), np.float32)
    rotations = np.zeros(9, np.float32)
    found = False
    for entry in text.split("|"):
        name, mark, numbers = entry.strip().lstrip("=").partition("#")
        if mark and name in _PARTS:
            rotations[_PARTS[name] : _PARTS[name] + 3] = _angles(numbers)
            continue
        match = _ENTRY.fullmatch(entry.strip())
        channel = canonical_channel(match[1]) if match else None
        if match and channel is not None:
            weights[ARKIT_INDEX[channel]] = float(match[2]) / 100.0
            found = True
    if not found:
        raise BadPacket("it has no channel")
    return checked(Pose(weights, rotations=rotations))


def _angles(numbers: str) -> tuple[float, float, float]:
    """Yaw, pitch and roll in radians, of x, y and z in degrees."""
    try:
        x, y, z = (math.radians(float(number)) for number in numbers.split(",")[:3])
    except ValueError as error:
        raise BadPacket("an angle is not a number") from error
    return y, x, z
