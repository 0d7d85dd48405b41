"""Packets of the Virtual Motion Capture protocol (OSC), which VSeeFace, Warudo and Unity receive.

A frame is an OSC bundle: `/VMC/Ext/Blend/Val` with name and value for each channel, then
`/VMC/Ext/Blend/Apply` (protocol.vmc.info; OSC 1.0, opensoundcontrol.stanford.edu). Some senders
send the messages one by one. The turns of head and eyes, if there are any, are bones:
`/VMC/Ext/Bone/Pos` with name, place and quaternion, in Unity's axes: X to the right of who looks
out of the face, Y up, Z forward.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from typing import Any

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.arrays import Floats
from faceedit_app.core.names import canonical_channel
from faceedit_app.live.pose import BadPacket, Pose, checked

_BUNDLE = b"#bundle\0"
_NOW = struct.pack(">Q", 1)  # the time tag of “at once”
_VALUE, _APPLY, _CLOCK = "/VMC/Ext/Blend/Val", "/VMC/Ext/Blend/Apply", "/VMC/Ext/T"
_BONE = "/VMC/Ext/Bone/Pos"
_BONES = {"Head": slice(0, 3), "LeftEye": slice(3, 6), "RightEye": slice(6, 9)}
_DEEPEST = 8


def encode(pose: Pose) -> bytes:
    """The bundle of a pose."""
    messages = [_message("/VMC/Ext/OK", 1), _message(_CLOCK, float(pose.seconds or 0.0))]
    if pose.rotations is not None:
        for name, part in _BONES.items():
            turned = _quaternion(*pose.rotations[part].tolist())
            messages.append(_message(_BONE, name, 0.0, 0.0, 0.0, *turned))
    for name, weight in zip(ARKIT_CHANNELS, pose.weights.tolist(), strict=True):
        messages.append(_message(_VALUE, name, float(weight)))
    messages.append(_message(_APPLY))
    return _BUNDLE + _NOW + b"".join(struct.pack(">i", len(m)) + m for m in messages)


class Decoder:
    """Collects messages until a frame is whole."""

    def __init__(self) -> None:
        self._weights = np.zeros(len(ARKIT_CHANNELS), np.float32)
        self._rotations: Floats | None = None
        self._seconds: float | None = None
        self._is_new = False

    def __call__(self, packet: bytes) -> Pose | None:
        """The pose that a datagram completes; None if it completes none.

        Raises:
            BadPacket: it is not OSC.
        """
        pose = None
        for address, values in _messages(packet):
            if address == _VALUE and len(values) >= 2:
                channel = canonical_channel(str(values[0]))
                if channel is not None and isinstance(values[1], float | int):
                    self._weights[ARKIT_INDEX[channel]] = values[1]
                    self._is_new = True
            elif address == _CLOCK and values and isinstance(values[0], float):
                self._seconds = values[0]
            elif address == _BONE and len(values) >= 8 and values[0] in _BONES:
                self._turn(_BONES[values[0]], values[4:8])
            elif address == _APPLY and self._is_new:
                turned = None if self._rotations is None else self._rotations.copy()
                pose = checked(Pose(self._weights.copy(), self._seconds, rotations=turned))
                self._is_new = False
        return pose

    def _turn(self, part: slice, quaternion: list[Any]) -> None:
        if not all(isinstance(value, float) for value in quaternion):
            raise BadPacket("a bone does not have a quaternion")
        if self._rotations is None:
            self._rotations = np.zeros(9, np.float32)
        self._rotations[part] = _angles(*quaternion)


def _quaternion(yaw: float, pitch: float, roll: float) -> tuple[float, float, float, float]:
    """The quaternion x, y, z, w in Unity's axes, of angles as in `core.head.turn`.

    Our X goes the other way; so the turns about Y and Z do, too.
    """
    (sx, cx), (sy, cy), (sz, cz) = (
        (math.sin(angle / 2), math.cos(angle / 2)) for angle in (pitch, yaw, -roll)
    )
    return (
        cy * sx * cz + sy * cx * sz,
        sy * cx * cz - cy * sx * sz,
        cy * cx * sz - sy * sx * cz,
        cy * cx * cz + sy * sx * sz,
    )


def _angles(x: float, y: float, z: float, w: float) -> tuple[float, float, float]:
    """The yaw, pitch and roll of a quaternion in Unity's axes, radians."""
    length = math.sqrt(x * x + y * y + z * z + w * w)
    if not 1e-6 < length < math.inf:
        raise BadPacket("a bone has no rotation")
    x, y, z, w = x / length, y / length, z / length, w / length
    pitch = math.asin(min(max(2 * (w * x - y * z), -1.0), 1.0))
    yaw = math.atan2(2 * (x * z + w * y), 1 - 2 * (x * x + y * y))
    roll = math.atan2(2 * (x * y + w * z), 1 - 2 * (x * x + z * z))
    return yaw, pitch, -roll


def _message(address: str, *values: str | float | int) -> bytes:
    kinds = "".join({str: "s", float: "f", int: "i"}[type(value)] for value in values)
    return _padded(address) + _padded(f",{kinds}") + b"".join(map(_argument, values))


def _argument(value: str | float | int) -> bytes:
    if isinstance(value, str):
        return _padded(value)
    return struct.pack(">f" if isinstance(value, float) else ">i", value)


def _padded(text: str) -> bytes:
    content = text.encode()
    return content + b"\0" * (4 - len(content) % 4)


def _messages(packet: bytes, depth: int = 0) -> Iterator[tuple[str, list[Any]]]:
    """The messages of a datagram, and of bundles in it."""
    if depth > _DEEPEST:
        raise BadPacket("its bundles are nested too deep")
    try:
        if not packet.startswith(_BUNDLE):
            yield _parse(packet)
            return
        place = len(_BUNDLE) + len(_NOW)
        while place < len(packet):
            (length,) = struct.unpack_from(">i", packet, place)
            place += 4
            if not 0 < length <= len(packet) - place:
                raise BadPacket("a message is cut off")
            yield from _messages(packet[place : place + length], depth + 1)
            place += length
    except (struct.error, ValueError, IndexError) as error:
        raise BadPacket(str(error) or "it is cut off") from error


def _parse(message: bytes) -> tuple[str, list[Any]]:
    address, place = _string(message, 0)
    if not address.startswith("/"):
        raise BadPacket("it is not OSC")
    if place >= len(message):
        return address, []
    kinds, place = _string(message, place)
    values: list[Any] = []
    for kind in kinds.removeprefix(","):
        if kind == "s":
            text, place = _string(message, place)
            values.append(text)
        elif kind in "fi":
            values.append(struct.unpack_from(">" + kind, message, place)[0])
            place += 4
        else:  # nothing that FaceEdit needs
            break
    return address, values


def _string(message: bytes, place: int) -> tuple[str, int]:
    stop = message.index(b"\0", place)
    return message[place:stop].decode("utf-8", "replace"), (stop + 4) // 4 * 4
