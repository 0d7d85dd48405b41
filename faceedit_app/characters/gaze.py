"""Give a character whose shapes do not turn its eyes its gaze: they are turned about their middle.

Eyes are what the file's own joints of eyes carry; if it has none, the two eyeballs, with whatever
lies inside them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from faceedit_app.characters.character import MeshPart
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
_WHOLE = 0.5  # share of a vertex that follows an eye and nothing else


@dataclass(frozen=True)
class Eye:
    """An eye that is turned about its middle.

    Attributes:
        place: (3,) its middle, in the file's coordinates.
        share: (V,) in 0..1, how far each vertex of the mesh follows it.
        joint: the number of its joint in a glTF file, if it has one.
    """

    place: Doubles
    share: Doubles = field(repr=False)
    joint: int | None = None

    def nodes(self, parts: Sequence[MeshPart], part_of: NDArray[np.int32]) -> set[int]:
        """The numbers of its joint, or of the nodes of which everything follows it, in a glTF file.

        Args:
            parts: of the file.
            part_of: (V,) the part of each vertex of the mesh.
        """
        if self.joint is not None:
            return {self.joint}
        follow: set[int] = set()
        stay: set[int] = set()
        for number, part in enumerate(parts):
            shares = self.share[part_of == number]
            if part.node is not None and len(shares):
                (follow if shares.min() > _WHOLE else stay).add(part.node)
        return follow - stay


def find_eyes(
    parts: Sequence[MeshPart], frame: FaceFrame, mouth: float, deltas: Floats
) -> tuple[Eye, Eye] | None:
    """The left and the right eye of a character, or None if they are not found.

    Args:
        parts: the parts of a character.
        frame: of the file.
        mouth: its height, metres; the eyes are at 0.
        deltas: (K, V, 3) metres, the shapes that the character has, of all parts as one mesh.
    """
    eyes = _by_joints(parts) or _by_balls(parts, frame, mouth, deltas)
    if len(eyes) != 2:
        return None
    sides = [float(frame.places(eye.place)[0]) for eye in eyes]
    if sides[0] * sides[1] >= 0:  # one on either side
        return None
    return (eyes[0], eyes[1]) if sides[0] > 0 else (eyes[1], eyes[0])


def is_turned_by(eyes: tuple[Eye, Eye], deltas: Floats) -> bool:
    """Whether shapes (K, V, 3), metres, move the eyes: those of looks may move only the lids."""
    theirs = (eyes[0].share > _WHOLE) | (eyes[1].share > _WHOLE)
    return bool(np.abs(deltas[:, theirs]).max(initial=0.0) > _STILL)


def gaze_moves(eyes: tuple[Eye, Eye], places: Doubles, frame: FaceFrame) -> dict[str, Floats]:
    """(V, 3) metres by channel, the moves of looks.

    Args:
        places: (V, 3) metres in the face's coordinates.
    """
    moves = {}
    for side, mirror, eye in zip(("Left", "Right"), (1.0, -1.0), eyes, strict=True):
        around = places - frame.places(eye.place)
        for way, (about_x, about_y) in _ANGLES.items():
            turn = Rotation.from_euler("xy", (about_x, mirror * about_y), degrees=True)
            turned = eye.share[:, None] * (turn.apply(around) - around)
            moves[f"eyeLook{way}{side}"] = turned.astype(np.float32)
    return moves


def gaze_turns(weights: Mapping[str, Floats]) -> tuple[Doubles, Doubles]:
    """(T, 3, 3) each: how the left and the right eye are turned, in the face's coordinates.

    Args:
        weights: (T,) of each channel of `LOOKS`.
    """
    turns = []
    for side, mirror in (("Left", 1.0), ("Right", -1.0)):
        angles = sum(
            np.outer(weights[f"eyeLook{way}{side}"], (about_x, mirror * about_y))
            for way, (about_x, about_y) in _ANGLES.items()
        )
        turns.append(Rotation.from_euler("xy", angles, degrees=True).as_matrix())
    return turns[0], turns[1]


def _by_joints(parts: Sequence[MeshPart]) -> list[Eye]:
    """The eyes of the file's joints, of which several parts may follow the same."""
    found: dict[tuple[float, ...], Doubles] = {}
    nodes: dict[tuple[float, ...], int | None] = {}
    count, start = sum(len(part.neutral) for part in parts), 0
    for part in parts:
        for eye in part.eyes:
            key = tuple(np.round(eye.place.astype(np.float64), 6).tolist())
            share = found.setdefault(key, np.zeros(count))
            nodes[key] = eye.node
            share[start : start + len(part.neutral)] = eye.share
        start += len(part.neutral)
    return [Eye(np.array(at), share, nodes[at]) for at, share in found.items() if share.any()]


def _by_balls(
    parts: Sequence[MeshPart], frame: FaceFrame, mouth: float, deltas: Floats
) -> list[Eye]:
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
    return [Eye(b.centre, share) for b, share in zip(pair, shares, strict=True) if share.any()]
