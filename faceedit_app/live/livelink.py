"""Packets of Live Link Face, which Unreal's Apple ARKit Face Support receives.

One datagram a frame, big-endian: version (1 byte), device and subject (length and UTF-8 text each),
time (frame number, part of a frame, frames per second as a fraction), the number of values (1
byte), and the values: 52 weights in ARKit's order and nine rotations.
"""

from __future__ import annotations

import struct

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.live.pose import ROTATIONS, BadPacket, Pose, checked

_VERSION = 6
_DEVICE = b"00000000-0000-0000-0000-FACEED170000"  # 36 characters, like the application's
_TIME = struct.Struct(">ifii")
_LONGEST_NAME = 256  # bytes
_RATE_UNIT = 1000  # 59.94 is 59940 / 1000
_COUNT = len(ARKIT_CHANNELS) + len(ROTATIONS)


def encode(pose: Pose) -> bytes:
    """The datagram of a pose."""
    numerator, denominator = _fraction(pose.rate)
    exact = (pose.seconds or 0.0) * numerator / denominator
    frame = int(np.floor(exact + 1e-6))
    part = max(exact - frame, 0.0)
    rotations = np.zeros(len(ROTATIONS)) if pose.rotations is None else pose.rotations
    values = np.concatenate([pose.weights, rotations]).astype(">f4").tobytes()
    return (
        bytes([_VERSION])
        + _text(_DEVICE)
        + _text(pose.subject.encode()[:_LONGEST_NAME])
        + _TIME.pack(frame, part, numerator, denominator)
        + bytes([_COUNT])
        + values
    )


def decode(packet: bytes) -> Pose:
    """The pose of a datagram.

    Raises:
        BadPacket: it is not one of Live Link Face.
    """
    try:
        if packet[0] != _VERSION:
            raise BadPacket("its version is unknown")
        _, place = _read_text(packet, 1)
        subject, place = _read_text(packet, place)
        frame, part, numerator, denominator = _TIME.unpack_from(packet, place)
        count = packet[place + _TIME.size]
        values = np.frombuffer(packet, ">f4", count, place + _TIME.size + 1).astype(np.float32)
    except (struct.error, IndexError, ValueError) as error:
        raise BadPacket(str(error) or "it is cut off") from error
    weights = len(ARKIT_CHANNELS)
    if count < weights or numerator <= 0 or denominator <= 0:
        raise BadPacket("it has no face")  # as the application sends while it sees none
    rate = numerator / denominator
    rotations = values[weights:_COUNT] if count >= _COUNT else None
    seconds = (frame + float(part)) / rate
    return checked(Pose(values[:weights], seconds, rate, subject, rotations))


def _fraction(rate: float) -> tuple[int, int]:
    whole = round(rate)
    return (whole, 1) if abs(rate - whole) < 1e-6 else (round(rate * _RATE_UNIT), _RATE_UNIT)


def _text(content: bytes) -> bytes:
    return struct.pack(">i", len(content)) + content


def _read_text(packet: bytes, place: int) -> tuple[str, int]:
    (length,) = struct.unpack_from(">i", packet, place)
    start, stop = place + 4, place + 4 + length
    if not 0 <= length <= _LONGEST_NAME or stop > len(packet):
        raise BadPacket("a name is cut off")
    return packet[start:stop].decode("utf-8", "replace").rstrip("\0"), stop
