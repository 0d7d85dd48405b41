"""Valid packets of every protocol of faces over the network."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.arrays import Floats
from faceedit_app.core.errors import FileError
from faceedit_app.lab.attacks.reader import Reader, Wrong
from faceedit_app.live.pose import BadPacket, Pose
from faceedit_app.live.protocols import PROTOCOLS, Protocol


def packet_readers() -> Iterator[Reader]:
    """The decoders of packets; each is given a datagram as a file."""
    weights = np.linspace(0.0, 1.0, len(ARKIT_CHANNELS), dtype=np.float32)
    pose = Pose(weights, 1.5, 60.0, "FaceEdit", np.linspace(-0.5, 0.5, 9, dtype=np.float32))
    for protocol in PROTOCOLS:
        packet = _text(weights) if protocol.encode is None else protocol.encode(pose)
        yield Reader("packets", ".bin", packet, partial(_decode, protocol))


def _text(weights: Floats) -> bytes:
    """A datagram of iFacialMocap, which FaceEdit does not send."""
    named = zip(ARKIT_CHANNELS, weights.tolist(), strict=True)
    values = "|".join(f"{name}-{100 * weight:.0f}" for name, weight in named)
    return f"{values}|=head#-21.4,-6.1,-1.5,0.05,-0.13,-0.47|rightEye#6.0,3.1,0.2|".encode()


def _decode(protocol: Protocol, path: Path) -> None:
    """Decode a packet; a face must be made of finite numbers."""
    try:
        pose = protocol.decoder()(path.read_bytes())
    except BadPacket as error:
        raise FileError(path, str(error), "check the sender") from error
    if pose is None:
        return
    turns = np.zeros(1) if pose.rotations is None else pose.rotations
    if not (np.isfinite(pose.weights).all() and np.isfinite(turns).all()):
        raise Wrong("a pose is not finite")
