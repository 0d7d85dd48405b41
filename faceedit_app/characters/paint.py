"""The colours of a scan's surface, and a picture of them for a head that was fitted to it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product

import numpy as np
import trimesh
import xatlas
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt
from scipy.spatial import cKDTree

from faceedit_app.characters.base_colors import linear, srgb
from faceedit_app.characters.skin import skin_of
from faceedit_app.core.arrays import Bools, Doubles, Floats, Indices, Pixels

SIZE = 1024  # pixels per side of the new picture
_SAMPLES = 200_000  # of a surface, by which its nearest triangle is found
_AT_ONCE = 1 << 18  # texels


@dataclass(frozen=True)
class Paint:
    """A coloured surface.

    Attributes:
        vertices: (V, 3).
        faces: (F, 3).
        colors: (V, 4) linear RGBA, which multiplies the picture.
        uv: (V, 2), (0, 0) at the upper left of the picture.
        picture_of: (F,) the picture of each triangle, -1 if it has none.
        pictures: (H, W, 4) uint8 each, sRGB and alpha.
    """

    vertices: Doubles
    faces: NDArray[np.integer]
    colors: Floats
    uv: Floats
    picture_of: NDArray[np.integer]
    pictures: tuple[Pixels, ...] = field(repr=False)

    @cached_property
    def _triangles(self) -> Doubles:
        corners: Doubles = self.vertices[self.faces]
        return corners

    def of_skin(self, positions: Doubles) -> Paint:
        """Only the skin, which has landmarks at `positions` (L, 3)."""
        mesh = trimesh.Trimesh(self.vertices, self.faces, process=False)
        mesh.merge_vertices(merge_tex=True, merge_norm=True)
        kept = skin_of(mesh, positions)
        return self._only(kept) if kept.any() else self

    def near(self, low: Doubles, high: Doubles) -> Paint:
        """Only the triangles that reach into a box from `low` to `high`, (3,) each."""
        inside = (self._triangles.max(axis=1) > low) & (self._triangles.min(axis=1) < high)
        return self._only(inside.all(axis=1))

    def _only(self, kept: Bools) -> Paint:
        return replace(self, faces=self.faces[kept], picture_of=self.picture_of[kept])

    @property
    def of_vertices(self) -> Floats:
        """(V, 4) the colours of its vertices, linear RGBA."""
        colors = self.colors.copy()
        for number, picture in enumerate(self.pictures):
            rows = np.unique(self.faces[self.picture_of == number])
            colors[rows] *= _looked_up(picture, self.uv[rows])
        return colors

    @cached_property
    def _samples(self) -> tuple[cKDTree, Indices]:
        """Places all over the surface, and the triangle of each."""
        mesh = trimesh.Trimesh(self.vertices, self.faces, process=False)
        places, triangles = trimesh.sample.sample_surface(mesh, _SAMPLES, seed=0)
        return cKDTree(places), np.asarray(triangles, np.intp)

    def at(self, places: Doubles, far: float) -> tuple[Floats, Doubles]:
        """The colours at the places of the surface that are nearest to others.

        Args:
            places: (N, 3) the others.
            far: the distance from which a place of the surface does not count.

        Returns:
            (N, 4) linear RGBA, and (N,) distances; 0 and infinity for those that do not count.
        """
        tree, triangle_of = self._samples
        nearest = tree.query(places, distance_upper_bound=far)[1]
        colors = np.zeros((len(places), 4), np.float32)
        away = np.full(len(places), np.inf)
        rows = np.flatnonzero(nearest < len(triangle_of))
        found = triangle_of[nearest[rows]]
        corners = self._triangles[found]
        weights = trimesh.triangles.points_to_barycentric(corners, places[rows])
        weights = np.nan_to_num(weights, nan=1 / 3).clip(0.0, None)
        weights /= np.maximum(weights.sum(axis=1, keepdims=True), 1e-12)
        away[rows] = np.linalg.norm(
            np.einsum("nk,nkx->nx", weights, corners) - places[rows], axis=1
        )
        vertices = self.faces[found]
        colors[rows] = np.einsum("nk,nkc->nc", weights, self.colors[vertices])
        uv = np.einsum("nk,nkc->nc", weights, self.uv[vertices])
        for number, picture in enumerate(self.pictures):
            mine = np.flatnonzero(self.picture_of[found] == number)
            colors[rows[mine]] *= _looked_up(picture, uv[mine])
        return colors, away


def _looked_up(picture: Pixels, uv: Doubles) -> Floats:
    """(N, 4) linear RGBA of a picture at uv (N, 2), between its pixels; it repeats."""
    size = np.array(picture.shape[1::-1])
    place = uv * size - 0.5
    first = np.floor(place).astype(np.int64)
    part = (place - first).astype(np.float32)
    total = np.zeros((len(uv), 4), np.float32)
    for corner in product((0, 1), repeat=2):
        column, row = ((first + np.array(corner)) % size).T
        weight = np.abs(1 - np.array(corner) - part).prod(axis=1)
        total += weight[:, None] * picture[row, column]
    total /= 255.0
    total[:, :3] = linear(total[:, :3])
    return total


@dataclass(frozen=True)
class Atlas:
    """A mesh cut open and laid flat.

    Attributes:
        vertex_of: (N,) the vertex of the mesh that each flat one comes from.
        faces: (F, 3) the same triangles, of flat vertices.
        uv: (N, 2), 0..1.
    """

    vertex_of: Indices
    faces: Indices
    uv: Floats

    @classmethod
    def of(cls, vertices: Doubles, faces: NDArray[np.integer]) -> Atlas:
        """Lay a mesh flat."""
        vertex_of, flat, uv = xatlas.parametrize(
            vertices.astype(np.float32), faces.astype(np.uint32)
        )
        return cls(vertex_of.astype(np.intp), flat.astype(np.intp), uv.astype(np.float32))

    def texels(self, size: int) -> tuple[Indices, Indices, Doubles]:
        """The pixels of a square picture that its triangles cover.

        Returns:
            pixels: (P,) the number of each, row by row.
            triangles: (P,) the triangle on it.
            weights: (P, 3) the place in it.
        """
        corners = self.uv[self.faces].astype(np.float64) * size - 0.5
        low = np.floor(corners.min(axis=1)).astype(np.int64)
        counts = np.ceil(corners.max(axis=1)).astype(np.int64) - low + 1
        sizes = counts.prod(axis=1)
        triangles = np.repeat(np.arange(len(sizes)), sizes)
        within = np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes, sizes)
        below, aside = np.divmod(within, counts[triangles, 0])
        pixels = low[triangles] + np.stack((aside, below), axis=1)
        weights = _barycentric(corners[triangles], pixels.astype(np.float64))
        inside = (weights > -1e-6).all(axis=1) & (pixels >= 0).all(axis=1)
        inside &= (pixels < size).all(axis=1)
        numbers = pixels[inside, 1] * size + pixels[inside, 0]
        return numbers.astype(np.intp), triangles[inside].astype(np.intp), weights[inside]


def _barycentric(corners: Doubles, places: Doubles) -> Doubles:
    """(N, 3) of places (N, 2) in triangles (N, 3, 2); of flat triangles, outside."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    p = places - corners[:, 0]
    area = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    area = np.where(np.abs(area) > 1e-12, area, np.inf)
    second = (p[:, 0] * b[:, 1] - p[:, 1] * b[:, 0]) / area
    third = (a[:, 0] * p[:, 1] - a[:, 1] * p[:, 0]) / area
    weights: Doubles = np.stack((1 - second - third, second, third), axis=1)
    weights[~np.isfinite(area)] = -1.0
    return weights


def painted(
    atlas: Atlas,
    vertices: Doubles,
    own: Floats,
    paint: Paint,
    far: float,
) -> Pixels:
    """A picture for a mesh, with the colours of a surface that it lies on.

    What is farther away keeps the mesh's own colours, in the tone of the rest.

    Args:
        vertices: (V, 3) the mesh, in the coordinates of `paint`.
        own: (V, 3) its own colours, linear.
        far: the distance from which a colour of the surface does not count.

    Returns:
        (SIZE, SIZE, 4) uint8, sRGB and alpha.
    """
    pixels, triangles, weights = atlas.texels(SIZE)
    corners = atlas.vertex_of[atlas.faces[triangles]]
    mine = np.einsum("pk,pkc->pc", weights, own[corners])
    seen = np.zeros((len(pixels), 4), np.float32)
    away = np.zeros(len(pixels))
    local = paint.near(vertices.min(axis=0) - far, vertices.max(axis=0) + far)
    for start in range(0, len(pixels), _AT_ONCE):
        rows = slice(start, start + _AT_ONCE)
        places = np.einsum("pk,pkx->px", weights[rows], vertices[corners[rows]])
        seen[rows], away[rows] = local.at(places, far)
    share = np.clip(2.0 - 2.0 * away / far, 0.0, 1.0) * (seen[:, 3] > 0.5)
    known = share > 0.99
    if known.any():
        tone = np.median(seen[known, :3], axis=0) / np.median(mine[known], axis=0).clip(1e-3)
        mine = mine * tone
    colors = share[:, None] * seen[:, :3] + (1 - share[:, None]) * mine
    flat = np.zeros((SIZE * SIZE, 3))
    covered: Bools = np.zeros(SIZE * SIZE, np.bool_)
    flat[pixels], covered[pixels] = srgb(colors), True
    # Beyond the edges the nearest colour goes on, so that none bleeds in.
    empty = ~covered.reshape(SIZE, SIZE)
    nearest = distance_transform_edt(empty, return_distances=False, return_indices=True)
    picture = np.full((SIZE, SIZE, 4), 255, np.uint8)
    picture[..., :3] = np.round(255 * flat.reshape(SIZE, SIZE, 3)[tuple(nearest)])
    return picture
