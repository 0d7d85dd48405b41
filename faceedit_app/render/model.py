"""The character as pyrender's meshes. Imports PyOpenGL: `contexts.choose_backend` comes first."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from itertools import accumulate
from typing import Any

import numpy as np
from numpy.typing import NDArray
from OpenGL import GL

from faceedit_app.core.arrays import Floats, Pixels
from faceedit_app.core.rig import Rig
from faceedit_app.render.difference import Tinter
from faceedit_app.render.hollows import HollowFinder
from faceedit_app.render.pyrender_parts import (
    FLOAT_SZ,
    GLTF,
    Material,
    MetallicRoughnessMaterial,
    Primitive,
    Texture,
)
from faceedit_app.render.surface import Group, NormalSolver, Shading, by_shading

# Materials are named after the shaders that draw them: these, or the variants in `Shading`.
BACKDROP, DEPTH = "backdrop", "depth"
# The shaders' places of attributes that may change in each frame, in pyrender's order, in which
# texture coordinates come before the colour.
_POSITION, _NORMAL, _COLOUR, _TEXTURED_COLOUR = 0, 1, 3, 4


class Stream:
    """Vertex values, (V, W) float32, in a buffer that is filled for each frame."""

    def __init__(self, values: Floats) -> None:
        self.width = values.shape[1]
        self.name = int(GL.glGenBuffers(1))
        GL.glBindBuffer(GL.GL_ARRAY_BUFFER, self.name)
        GL.glBufferData(GL.GL_ARRAY_BUFFER, values.nbytes, values, GL.GL_STREAM_DRAW)

    def fill(self, values: Floats) -> None:
        """Replace the values by others, contiguous and of the same shape."""
        GL.glBindBuffer(GL.GL_ARRAY_BUFFER, self.name)
        GL.glBufferSubData(GL.GL_ARRAY_BUFFER, 0, values.nbytes, values)

    def delete(self) -> None:
        """Free it."""
        GL.glDeleteBuffers(1, [self.name])


class SrgbTexture(Texture):  # type: ignore[misc]  # pyrender has no types
    """An sRGB texture of (H, W, 4) uint8 with alpha, top row first, which is read as linear light.

    pyrender would treat its values as linear.
    """

    def __init__(self, pixels: Pixels) -> None:
        super().__init__(source=pixels, source_channels="RGBA")

    def _add_to_context(self) -> None:
        super()._add_to_context()
        pixels = np.ascontiguousarray(self.source[::-1])
        height, width = pixels.shape[:2]
        self._bind()
        form = GL.GL_SRGB8_ALPHA8, width, height, 0, GL.GL_RGBA, GL.GL_UNSIGNED_BYTE
        GL.glTexImage2D(GL.GL_TEXTURE_2D, 0, *form, pixels)
        GL.glGenerateMipmap(GL.GL_TEXTURE_2D)
        self._unbind()


class LivePrimitive(Primitive):  # type: ignore[misc]  # pyrender has no types
    """A primitive with positions, normals and colours from streams.

    pyrender interleaves all attributes of a vertex in one buffer, which it cannot change later.

    Args:
        streams: the streams, by their place in the shaders.
        first: the row of the streams for this primitive's first vertex.
        attributes: pyrender's; those of the streams are given as well, for their shape.
    """

    def __init__(self, streams: dict[int, Stream], first: int, **attributes: object) -> None:
        super().__init__(**attributes)
        self._streams, self._first = streams, first

    def _add_to_context(self) -> None:
        super()._add_to_context()
        self._bind()
        for place, stream in self._streams.items():
            start = ctypes.c_void_p(FLOAT_SZ * stream.width * self._first)
            GL.glBindBuffer(GL.GL_ARRAY_BUFFER, stream.name)
            GL.glVertexAttribPointer(place, stream.width, GL.GL_FLOAT, GL.GL_FALSE, 0, start)
        self._unbind()


class Mesh:
    """Primitives that are drawn together: what pyrender's renderer asks of a mesh.

    pyrender's own can be made from trimesh's, and imports all of it for that.
    """

    def __init__(self, primitives: Sequence[Primitive]) -> None:
        self.primitives = primitives


class LiveMesh(Mesh):
    """Faces of the character with movable vertices, in one primitive for each material.

    Args:
        rig: the character.
        looks: (V, 4): `surface.vertex_looks`.
        parts: materials with their faces, (F, 3) each.

    Attributes:
        vertices: (N,) the character's vertices in the mesh, primitive by primitive.
    """

    def __init__(
        self, rig: Rig, looks: Floats, parts: Sequence[tuple[Material, NDArray[np.int32]]]
    ) -> None:
        own = [np.unique(faces, return_inverse=True) for _, faces in parts]
        self.vertices = np.concatenate([np.zeros(0, np.intp), *(vertices for vertices, _ in own)])
        firsts = accumulate((len(vertices) for vertices, _ in own), initial=0)
        self._normals_of = NormalSolver(
            rig.faces, len(rig.neutral), wanted=self.vertices, groups=rig.shading_groups
        )
        values = {
            _POSITION: rig.neutral[self.vertices],
            _NORMAL: self._normals_of(rig.neutral),
            _COLOUR: rig.colors[self.vertices],
        }
        self._streams = {place: Stream(value) for place, value in values.items()}
        primitives = [
            LivePrimitive(
                self._streams_of(material),
                first,
                positions=rig.neutral[vertices],
                normals=values[_NORMAL][first : first + len(vertices)],
                tangents=looks[vertices],  # pyrender's name for the third attribute, four wide
                texcoord_0=_texture_places(rig, vertices) if material.tex_flags else None,
                color_0=rig.colors[vertices],
                indices=corners.reshape(-1, 3),
                material=material,
                mode=GLTF.TRIANGLES,
            )
            for (material, _), (vertices, corners), first in zip(parts, own, firsts, strict=False)
        ]
        super().__init__(primitives)

    def _streams_of(self, material: Material) -> dict[int, Stream]:
        """The streams by their place in the shaders of a material."""
        colour = _TEXTURED_COLOUR if material.tex_flags else _COLOUR
        return {
            _POSITION: self._streams[_POSITION],
            _NORMAL: self._streams[_NORMAL],
            colour: self._streams[_COLOUR],
        }

    def move(self, vertices: Floats) -> None:
        """Move the vertices to `vertices` (V, 3), metres, of the whole character."""
        self._streams[_POSITION].fill(np.take(vertices, self.vertices, axis=0))
        self._streams[_NORMAL].fill(self._normals_of(vertices))

    def paint(self, colors: Floats) -> None:
        """Colour the vertices by `colors` (V, 4), linear RGB and alpha, of the whole character."""
        self._streams[_COLOUR].fill(np.take(colors, self.vertices, axis=0))

    def delete(self) -> None:
        """Free the streams; pyrender frees the rest."""
        for stream in self._streams.values():
            stream.delete()


class Model:
    """The character in two meshes, and the backdrop in a third.

    Args:
        rig: the character.
        looks: (V, 4): `surface.vertex_looks`.

    Attributes:
        still, moving: the faces that look the same whatever the face does, and the others.
        backdrop: one triangle that covers the picture.
        hollows: how far lids and lips are open, which shades what is behind them.
    """

    def __init__(self, rig: Rig, looks: Floats) -> None:
        textures = [SrgbTexture(pixels) for pixels in rig.textures]
        still, moving = [], []
        for group in by_shading(rig):
            material = _material(group, textures)
            still.append((material, group.still))
            moving.append((material, group.moving))
        self.still, self.moving = (
            LiveMesh(rig, looks, [part for part in parts if part[1].size])
            for parts in (still, moving)
        )
        corners = np.array([[-1.0, -1.0, 1.0], [3.0, -1.0, 1.0], [-1.0, 3.0, 1.0]])
        self.backdrop = Mesh([Primitive(corners, material=Material(BACKDROP, doubleSided=True))])
        self._colors, self._tinter, self._is_plain = rig.colors, Tinter(rig.colors), True
        self._still_at: Floats = np.take(rig.neutral, self.still.vertices, axis=0)
        self._find_hollows = HollowFinder(rig, self.still.vertices)
        self.hollows = self._find_hollows(rig.neutral)

    def move(self, vertices: Floats) -> bool:
        """Move the vertices to `vertices` (V, 3), metres.

        Returns:
            Whether that moved what no blendshape changes, as a turning head does.
        """
        self.moving.move(vertices)
        still = np.take(vertices, self.still.vertices, axis=0)
        turned = not np.array_equal(still, self._still_at)
        if turned:
            self._still_at = still
            self.still.move(vertices)
            self._find_hollows.turned(vertices)
        self.hollows = self._find_hollows(vertices)
        return turned

    def tint(self, tint: Floats | None) -> None:
        """Tint the vertices by `tint` (V,), 0..1; None removes the tint."""
        if tint is not None or not self._is_plain:
            colors = self._colors if tint is None else self._tinter(tint)
            self.still.paint(colors)
            self.moving.paint(colors)
        self._is_plain = tint is None

    def delete(self) -> None:
        """Free what pyrender does not free."""
        self.still.delete()
        self.moving.delete()


def _material(group: Group, textures: Sequence[Texture]) -> Material:
    # Only the skin is known to be closed; lashes and brows are thin.
    both_sides = group.shading is not Shading.FLESH
    if group.texture is None:
        mode = "BLEND" if group.sheer else "OPAQUE"
        return Material(group.shading.value, doubleSided=both_sides, alphaMode=mode)
    return MetallicRoughnessMaterial(
        group.shading.value,
        baseColorTexture=textures[group.texture],
        alphaCutoff=group.cutoff,
        doubleSided=both_sides,
    )


def _texture_places(rig: Rig, vertices: NDArray[np.integer[Any]]) -> Floats:
    """(N, 2) texture coordinates with OpenGL's origin, at the lower left."""
    assert rig.uv is not None
    places: Floats = rig.uv[vertices].copy()
    places[:, 1] = 1.0 - places[:, 1]
    return places
