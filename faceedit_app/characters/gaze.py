"""Give a character without eyeLook shapes its gaze: its eyes are turned about their middle.

Eyes are what the file's own joints of eyes carry; if it has none, the two eyeballs, with whatever
lies inside them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from faceedit_app.characters.character import Part
from faceedit_app.characters.eyeballs import find_pair, pieces
from faceedit_app.characters.face_frame import FaceFrame
from faceedit_app.core.arrays import Doubles, Floats

# Degrees about the face's X (down) and Y (to its left) at weight 1, for the left eye.
_ANGLES = {"Up": (-25.0, 0.0), "Down": (25.0, 0.0), "In": (0.0, -30.0), "Out": (0.0, 30.0)}
LOOKS: tuple[str, ...] = tuple(
    f"eyeLook{way}{side}" for side in ("Left", "Right") for way in _ANGLES
)
_INSIDE = 1.12  # radii; a piece that lies within turns with its eyeball
_STILL = 1e-5  # metres

# An eye: (3,) metres, about which it turns, and (V,) in 0..1 how far each vertex follows.
_Eye = tuple[Doubles, Doubles]


def gaze_moves(
    parts: Sequence[Part],
    places: Sequence[Doubles],
    frame: FaceFrame,
    mouth: float,
    deltas: Floats,
) -> dict[str, Floats]:
    """(V, 3) metres by channel, for all parts as one mesh; empty if the eyes are not found.

    Args:
        parts: the parts of a character.
        places: (V, 3) metres of each part, in the face's coordinates.
        frame: of the file.
        mouth: its height, metres; the eyes are at 0.
        deltas: (K, V, 3) metres, the shapes that the character has.
    """
    eyes = _by_joints(parts, frame) or _by_balls(parts, frame, mouth, deltas)
    if len(eyes) != 2 or eyes[0][0][0] * eyes[1][0][0] >= 0:  # one on either side
        return {}
    eyes.sort(key=lambda eye: -eye[0][0])
    everywhere = np.concatenate(places)
    moves = {}
    for side, mirror, (middle, share) in zip(("Left", "Right"), (1.0, -1.0), eyes, strict=True):
        around = everywhere - middle
        for way, (about_x, about_y) in _ANGLES.items():
            turn = Rotation.from_euler("xy", (about_x, mirror * about_y), degrees=True)
            turned = share[:, None] * (turn.apply(around) - around)
            moves[f"eyeLook{way}{side}"] = turned.astype(np.float32)
    return moves


def _by_joints(parts: Sequence[Part], frame: FaceFrame) -> list[_Eye]:
    """The eyes of the file's joints, of which several parts may follow the same."""
    found: dict[tuple[float, ...], Doubles] = {}
    count, start = sum(len(part.neutral) for part in parts), 0
    for part in parts:
        for eye in part.eyes:
            key = tuple(np.round(eye.place.astype(np.float64), 6).tolist())
            share = found.setdefault(key, np.zeros(count))
            share[start : start + len(part.neutral)] = eye.share
        start += len(part.neutral)
    return [(frame.places(np.array(place)), share) for place, share in found.items() if share.any()]


def _by_balls(parts: Sequence[Part], frame: FaceFrame, mouth: float, deltas: Floats) -> list[_Eye]:
    """The eyeballs, and the pieces inside them that no shape moves, such as an iris."""
    centre = frame.origin + np.array([0.0, mouth, 0.05]) @ frame.axes / frame.scale
    pair = find_pair(parts, centre)
    if pair is None:
        return []
    still = np.abs(deltas).max(axis=(0, 2), initial=0.0) < _STILL
    shares = [np.zeros(deltas.shape[1]) for _ in pair]
    start = 0
    for part in parts:
        for rows in pieces(part):
            for ball, share in zip(pair, shares, strict=True):
                away = np.linalg.norm(part.neutral[rows] - ball.centre, axis=1)
                if away.max() < _INSIDE * ball.radius and still[start + rows].all():
                    share[start + rows] = 1.0
        start += len(part.neutral)
    middles = [frame.places(ball.centre) for ball in pair]
    return [eye for eye in zip(middles, shares, strict=True) if eye[1].any()]
