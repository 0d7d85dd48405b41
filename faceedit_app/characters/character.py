"""A character as read from its file: parts with morph targets, not yet fitted to a face."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arrays import Floats, Indices

Faces = NDArray[np.int32]


@dataclass(frozen=True)
class Texture:
    """An encoded picture in the file.

    Attributes:
        name: for messages.
        content: the picture file's bytes: PNG, JPEG, WebP or KTX2.
    """

    name: str
    content: bytes = field(repr=False)


@dataclass(frozen=True)
class Surface:
    """How a part is drawn.

    Attributes:
        name: of the material.
        color: linear RGBA, 0..1, that multiplies colours and texture.
        texture: the base colour (sRGB), placed by the part's `uv`.
        roughness, metallic: 0..1.
        cutoff: pixels with less alpha are not drawn; 0 for opaque surfaces.
    """

    name: str = ""
    color: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    texture: Texture | None = None
    roughness: float = 0.6
    metallic: float = 0.0
    cutoff: float = 0.0


@dataclass(frozen=True)
class EyeJoint:
    """A joint that turns an eye.

    Attributes:
        place: (3,) in the file's unit and axes.
        share: (V,) in 0..1, how far each vertex of the part follows it.
        node: its number in a glTF file.
    """

    place: Floats
    share: Floats = field(repr=False)
    node: int | None = None


@dataclass(frozen=True)
class MeshPart:
    """One mesh with one material, at its place in the scene at rest.

    Attributes:
        name: unique in the character.
        neutral: (V, 3) float32, in the file's unit and axes.
        faces: (F, 3) int32, counter-clockwise seen from outside.
        targets: morph targets by name, (V, 3) float32 displacements at weight 1.
        uv: (V, 2) float32; (0, 0) is the upper left corner of the texture.
        colors: (V, 4) float32, linear RGBA.
        surface: how it is drawn.
        eyes: the joints of eyes that it follows.
        rest: by morph target, the weight that it has in the file if it is not 0.
        node: the number of its node in a glTF file, if that places it: a skin does not.
    """

    name: str
    neutral: Floats
    faces: Faces
    targets: Mapping[str, Floats] = field(default_factory=dict)
    uv: Floats | None = None
    colors: Floats | None = None
    surface: Surface = field(default_factory=Surface)
    eyes: tuple[EyeJoint, ...] = ()
    rest: Mapping[str, float] = field(default_factory=dict)
    node: int | None = None

    def only(self, kept: Indices) -> MeshPart:
        """The part with only some vertices, in order; its faces must use no others."""
        if len(kept) == len(self.neutral):
            return self
        place = np.zeros(len(self.neutral), np.int32)
        place[kept] = np.arange(len(kept), dtype=np.int32)
        return replace(
            self,
            neutral=self.neutral[kept],
            faces=place[self.faces],
            targets={name: moves[kept] for name, moves in self.targets.items()},
            uv=None if self.uv is None else self.uv[kept],
            colors=None if self.colors is None else self.colors[kept],
            eyes=tuple(replace(eye, share=eye.share[kept]) for eye in self.eyes),
        )


@dataclass(frozen=True)
class PartVertex:
    """A vertex of a character's file: the part's name and the vertex number."""

    part: str
    vertex: int


@dataclass(frozen=True)
class Character:
    """The content of a character file.

    Attributes:
        path: the file or folder.
        format: its name for the user, such as `VRM 0`.
        parts: at least one; parts with a morph target of the same name move together.
        remarks: sentences about what could not be read or was changed while reading.
        attribution: author and licence, if the file has them.
        points: the control points, if the file has them, as FaceEdit's own files do.
    """

    path: Path
    format: str
    parts: tuple[MeshPart, ...]
    remarks: tuple[str, ...] = ()
    attribution: str = ""
    points: Mapping[str, PartVertex] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Shown to the user."""
        return self.path.stem if self.path.suffix else self.path.name

    @property
    def targets(self) -> tuple[str, ...]:
        """The names of all morph targets, without repeats, in the file's order."""
        return tuple(dict.fromkeys(name for part in self.parts for name in part.targets))

    def shaped(self, played: Collection[str]) -> Character:
        """The character with the morph targets that are not played as they are in the file.

        Such are those that make a body thin or a face someone's.
        """
        parts = []
        for part in self.parts:
            kept = {n: w for n, w in part.rest.items() if n not in played and n in part.targets}
            moves = sum((w * part.targets[n] for n, w in kept.items()), np.float32(0.0))
            parts.append(replace(part, neutral=part.neutral + moves) if kept else part)
        return replace(self, parts=tuple(parts))

    @property
    def meshes(self) -> dict[str, str]:
        """By morph target, the name of the first part that has it."""
        return {name: part.name for part in reversed(self.parts) for name in part.targets}

    @property
    def vertex_count(self) -> int:
        """The number of vertices of all parts."""
        return sum(len(part.neutral) for part in self.parts)

    @property
    def triangle_count(self) -> int:
        """The number of triangles of all parts."""
        return sum(len(part.faces) for part in self.parts)


def unique_names(names: list[str]) -> list[str]:
    """The names made unique: a second `Head` becomes `Head (2)`."""
    seen: dict[str, int] = {}
    out = []
    for name in names:
        seen[name] = seen.get(name, 0) + 1
        out.append(name if seen[name] == 1 else f"{name} ({seen[name]})")
    return out
