"""Assemble the parts of a character into one mesh, with a channel for each shape."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import fast_simplification
import numpy as np
from numpy.typing import NDArray

from faceedit_app.characters.character import Character, MeshPart
from faceedit_app.characters.face_frame import FaceFrame
from faceedit_app.characters.gaze import LOOKS, Eye, find_eyes, gaze_moves, is_turned_by
from faceedit_app.characters.matches import Half, Share
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.arrays import Doubles, Floats, Indices

MOST_TRIANGLES = 250_000  # more are decimated
DECIMATED_TO = 120_000
_NECK = 0.09  # metres of a body below the chin that are kept
_BODY = 0.25  # metres below the neck that make it a body
_ARMS = 0.25  # metres to either side; arms are farther out
_SEAM = 0.006  # metres over which the halves of a shape fade


@dataclass(frozen=True)
class Assembly:
    """All parts as one mesh.

    Attributes:
        neutral: (V, 3) float32, metres, in the face's coordinates.
        faces: (F, 3) int32.
        channels: the K ARKit channels that have shapes.
        deltas: (K, V, 3) float32, metres.
        part_of: (V,) int32, the part of each vertex.
        vertex_of: (V,) int32, the number of each vertex in its part.
        parts: the parts, cut and decimated.
        runs: per part its first triangle and the one after its last.
        eyes: the left and the right eye, if they are turned because they have no shapes.
    """

    neutral: Floats
    faces: NDArray[np.int32]
    channels: tuple[str, ...]
    deltas: Floats
    part_of: NDArray[np.int32]
    vertex_of: NDArray[np.int32]
    parts: tuple[MeshPart, ...]
    runs: tuple[tuple[int, int], ...]
    eyes: tuple[Eye, Eye] | None = None

    def moves(self, channel: str) -> Floats | None:
        """(V, 3) metres: the displacements of a channel, or None if it has none."""
        if channel not in self.channels:
            return None
        moves: Floats = self.deltas[self.channels.index(channel)]
        return moves


class Assembler:
    """Assembles the parts of a character.

    Args:
        character: as read from its file.
        shares: the shapes that make each channel.
        alike: other spellings of a target's name.

    Attributes:
        remarks: sentences about what was cut away or decimated.
    """

    def __init__(
        self,
        character: Character,
        shares: Mapping[str, Sequence[Share]],
        alike: Mapping[str, Sequence[str]],
    ) -> None:
        self._character, self._shares, self._alike = character, shares, alike
        self.remarks: list[str] = []

    def target(self, part: int, name: str) -> Floats | None:
        """The displacements of a part's target, under its name or another spelling."""
        return _target(self._character.parts[part], name, self._alike)

    def assemble(self, frame: FaceFrame) -> Assembly:
        """The head as one mesh, small enough to animate."""
        kept = self._head(frame)
        total = sum(len(faces) for _, _, faces in kept)
        if total > MOST_TRIANGLES:
            share = DECIMATED_TO / total
            self.remarks.append(
                f"{total:,} triangles were decimated to about {DECIMATED_TO:,}".replace(",", " ")
            )
        parts, numbers, vertices = [], [], []
        for number, rows, faces in kept:
            part = replace(self._character.parts[number], faces=faces).only(rows)
            if total > MOST_TRIANGLES:
                part, inner = _decimated(part, share)
                rows = rows[inner]
            parts.append(part)
            numbers.append(np.full(len(rows), number, np.int32))
            vertices.append(rows.astype(np.int32))
        return self._joined(frame, parts, numbers, vertices)

    def _joined(
        self,
        frame: FaceFrame,
        parts: list[MeshPart],
        numbers: list[NDArray[np.int32]],
        vertices: list[NDArray[np.int32]],
    ) -> Assembly:
        starts = np.cumsum([0, *(len(part.neutral) for part in parts)])
        runs = np.cumsum([0, *(len(part.faces) for part in parts)]).tolist()
        faces = np.concatenate(
            [part.faces + np.int32(s) for part, s in zip(parts, starts[:-1], strict=True)]
        )
        places = [frame.places(part.neutral) for part in parts]
        mouth = self._mouth_height(frame)
        channels = tuple(c for c in ARKIT_CHANNELS if self._shares.get(_named(c, frame.swapped)))
        deltas = np.zeros((len(channels), int(starts[-1]), 3), np.float32)
        for k, channel in enumerate(channels):
            for share in self._shares[_named(channel, frame.swapped)]:
                for part, place, start in zip(parts, places, starts[:-1], strict=True):
                    moves = _target(part, share.name, self._alike)
                    if moves is not None:
                        how = share.weight * _mask(share.half, place, mouth, frame.swapped)
                        rows = slice(start, start + len(place))
                        deltas[k, rows] += (how * frame.moves(moves)).astype(np.float32)
        part_of = np.concatenate(numbers)
        eyes = find_eyes(parts, frame, mouth, deltas)
        looks = [k for k, channel in enumerate(channels) if channel in LOOKS]
        if eyes is not None and not is_turned_by(eyes, deltas[looks]):
            self.remarks.append(self._turned(eyes, part_of, bool(looks)))
            gaze = gaze_moves(eyes, np.concatenate(places), frame)
            for k in looks:  # which move the lids
                deltas[k] += gaze.pop(channels[k])
            channels = (*channels, *gaze)
            deltas = np.concatenate([deltas, *(moves[None] for moves in gaze.values())])
        else:
            eyes = None
        return Assembly(
            np.concatenate(places).astype(np.float32),
            faces,
            channels,
            deltas,
            part_of,
            np.concatenate(vertices),
            tuple(parts),
            tuple(pairwise(runs)),
            eyes,
        )

    def _turned(self, eyes: tuple[Eye, Eye], part_of: NDArray[np.int32], has_looks: bool) -> str:
        """A sentence about eyes without shapes."""
        says = "the eyes have no shapes; they are turned instead"
        if has_looks:
            says = "the shapes of looks do not move the eyes; they are turned as well"
        nodes = [eye.nodes(self._character.parts, part_of) for eye in eyes]
        if self._character.format == "glTF" and not all(nodes):
            says += ", but not in a GLB that is exported: they are parts of larger meshes"
        return says

    def _head(self, frame: FaceFrame) -> list[tuple[int, Indices, NDArray[np.int32]]]:
        """What to keep of each part: its number, its vertices, and its triangles."""
        places = [frame.places(part.neutral) for part in self._character.parts]
        floor = self._chin(frame, places) - _NECK
        lowest = min(float(place[:, 1].min()) for place in places)
        is_body = lowest < floor - _BODY
        kept = []
        for number, (part, place) in enumerate(zip(self._character.parts, places, strict=True)):
            faces = part.faces
            if is_body:
                inside = (place[:, 1] > floor) & (np.abs(place[:, 0]) < _ARMS)
                faces = faces[inside[faces].any(axis=1)]
            if len(faces):
                kept.append((number, np.unique(faces).astype(np.intp), faces))
        if is_body:
            self.remarks.append("the body below the neck was cut away")
        return kept

    def _chin(self, frame: FaceFrame, places: list[Doubles]) -> float:
        """The height of the lowest vertex that the mouth's shapes clearly move, metres."""
        lowest = 0.0
        for channel in ("jawOpen", "mouthPucker", "mouthFunnel", "mouthSmileLeft"):
            for number, place in enumerate(places):
                for share in self._shares.get(channel, ()):
                    moves = self.target(number, share.name)
                    if moves is not None:
                        far = np.linalg.norm(moves, axis=1) * frame.scale > 0.004
                        lowest = min(lowest, float(place[far, 1].min(initial=0.0)))
        return max(lowest, -0.16)

    def _mouth_height(self, frame: FaceFrame) -> float:
        """The mean height of the vertices that open the mouth, metres; the eyes are at 0."""
        total = weight = 0.0
        for number, part in enumerate(self._character.parts):
            for channel in ("mouthPucker", "mouthFunnel", "jawOpen"):
                for share in self._shares.get(channel, ()):
                    moves = self.target(number, share.name)
                    if moves is not None:
                        far = np.linalg.norm(moves, axis=1)
                        total += float(frame.places(part.neutral)[:, 1] @ far)
                        weight += float(far.sum())
        return total / weight if weight else -0.06


def _named(channel: str, swapped: bool) -> str:
    """The file's name for a channel."""
    if not swapped:
        return channel
    if channel.endswith("Left"):
        return channel.removesuffix("Left") + "Right"
    return channel.removesuffix("Right") + "Left" if channel.endswith("Right") else channel


def _target(part: MeshPart, name: str, alike: Mapping[str, Sequence[str]]) -> Floats | None:
    for spelling in (name, *alike.get(name, ())):
        if spelling in part.targets:
            return part.targets[spelling]
    return None


def _mask(half: Half, places: Doubles, mouth: float, swapped: bool) -> Doubles:
    """(V, 1) in 0..1, how much of a shape applies at each vertex."""
    mask = np.ones(len(places))
    words = half.split()
    for word, side in (("left", 1.0), ("right", -1.0)):
        if word in words:
            mask *= _ramp((-side if swapped else side) * places[:, 0])
    for word, side in (("upper", 1.0), ("lower", -1.0)):
        if word in words:
            mask *= _ramp(side * (places[:, 1] - 0.45 * mouth))
    return mask[:, None]


def _ramp(distance: Doubles) -> Doubles:
    """0 to 1 across a seam, smoothly."""
    t = np.clip(distance / _SEAM / 2 + 0.5, 0.0, 1.0)
    return t * t * (3 - 2 * t)


def _decimated(part: MeshPart, share: float) -> tuple[MeshPart, Indices]:
    """A part reduced to a share of its triangles, and the vertices that are kept.

    Quadric edge collapse (Garland and Heckbert 1997), which keeps the rims of lips and lids. Each
    new vertex takes shapes and texture from the nearest vertex that it replaces.
    """
    if share >= 1 or len(part.faces) < 200:
        return part, np.arange(len(part.neutral))
    places, faces, collapses = fast_simplification.simplify(
        part.neutral, part.faces, 1.0 - share, return_collapses=True, preserve_border=True
    )
    places, faces, mapping = fast_simplification.replay_simplification(
        part.neutral, part.faces, collapses
    )
    distance = np.linalg.norm(part.neutral - places[mapping], axis=1)
    order = np.lexsort((distance, mapping))
    owners, first = np.unique(mapping[order], return_index=True)
    nearest = np.zeros(len(places), np.intp)
    nearest[owners] = order[first]
    chosen = replace(
        part,
        neutral=places.astype(np.float32),
        faces=faces.astype(np.int32),
        targets={name: moves[nearest] for name, moves in part.targets.items()},
        uv=None if part.uv is None else part.uv[nearest],
        colors=None if part.colors is None else part.colors[nearest],
        eyes=tuple(replace(eye, share=eye.share[nearest]) for eye in part.eyes),
    )
    return chosen, nearest
