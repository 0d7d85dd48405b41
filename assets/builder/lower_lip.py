"""Rounds the lower lip, on which the base mesh has a vertex every 5 mm; the upper one, every 2 mm.

A mouth that opens wide would bend the lip by half a right angle at its middle vertex. New columns
of vertices lie on curves through the old ones, in the neutral face and in every blendshape alike,
so that the lip is round in every pose. The old vertices, and with them all distances, stay.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from assets.builder.geometry import bridge_rows
from assets.builder.parts import Part
from assets.builder.settings import LOWER_LIP
from assets.builder.shapes import Face
from assets.builder.skin import skin_materials
from assets.builder.source import Floats, Ints


@dataclass(frozen=True)
class _Columns:
    """The lip with its new columns.

    Attributes:
        grid: (R, C) vertices, old and new, row by row.
        sources: (M, 4) old vertices, neighbours in a row, of which each new one is a sum.
        weights: (M, 4) their shares.
    """

    grid: Ints
    sources: Ints
    weights: Floats

    def extend(self, values: Floats) -> Floats:
        """Values (..., V, X) of the old vertices, followed by those of the new: (..., V + M, X)."""
        new = np.einsum("mp,...mpx->...mx", self.weights, values[..., self.sources, :])
        return np.concatenate([values, new], axis=-2)


def round_lower_lip(part: Part, face: Face) -> Part:
    """Put columns of vertices between those of the lower lip.

    Args:
        part: the whole character. Its vertices keep their numbers; new ones follow them.
        face: the base mesh.
    """
    number = {int(base): vertex for vertex, base in enumerate(part.base_index) if base >= 0}
    coarse = np.array([[number[base] for base in row] for row in LOWER_LIP.rows])
    columns = _split(coarse, len(part.vertices))
    count = len(columns.weights)
    finer = replace(
        part,
        vertices=columns.extend(part.vertices),
        deltas=columns.extend(part.deltas),
        colors=np.clip(columns.extend(part.colors), 0, 1),
        base_index=np.r_[part.base_index, np.full(count, -1)],
        cover=np.r_[part.cover, np.ones(count)],
    )
    masks = np.stack([face.mouth, face.lips], axis=1)[part.base_index]  # nothing reads those of -1
    # Diagonals that change their direction in the middle would crease the lip there.
    row_count, column_count = columns.grid.shape
    lip = columns.grid.ravel()[bridge_rows(row_count, column_count, closed=False)]
    mouth, lips = columns.extend(masks)[lip].transpose(2, 0, 1)
    around, materials = _around(part, coarse[:, 1:-1], columns.grid)
    faces = np.concatenate([around, lip])
    materials = np.r_[materials, skin_materials(mouth, lips)]
    order = np.argsort(materials, kind="stable")
    return replace(finer, faces=faces[order], materials=materials[order])


def _split(coarse: Ints, first: int) -> _Columns:
    """New columns between those of `coarse`, numbered from `first` on.

    The outermost columns of `coarse` only guide the curves.
    """
    rows = len(coarse)
    grid, sources, weights = [coarse[:, 1]], [], []
    for column, pieces in enumerate(LOWER_LIP.pieces):
        for share in np.arange(1, pieces) / pieces:
            grid.append(first + np.arange(rows))
            first += rows
            sources.append(coarse[:, column : column + 4])
            weights.append(np.tile(_curve(share), (rows, 1)))
        grid.append(coarse[:, column + 2])
    return _Columns(np.stack(grid, axis=1), np.concatenate(sources), np.concatenate(weights))


def _curve(share: float) -> Floats:
    """Weights (4,) of four points for a cubic curve through the two in the middle.

    Args:
        share: of the way from the second point to the third.
    """
    third = share**2 * (3 - 2 * share)
    leaving = LOWER_LIP.bulge * share * (1 - share) ** 2
    arriving = LOWER_LIP.bulge * share**2 * (share - 1)
    return np.array([-leaving, 1 - third - arriving, third + leaving, arriving])


def _around(part: Part, coarse: Ints, grid: Ints) -> tuple[Ints, Ints]:
    """The triangles that are not between `coarse`'s vertices, and their materials.

    Those above and below it are split where `grid` splits their edge.
    """
    kept = ~np.isin(part.faces, coarse).all(1)
    faces, materials = part.faces[kept], part.materials[kept]
    stops = np.cumsum([0, *LOWER_LIP.pieces])
    for row in (grid[0], grid[-1]):
        for start, stop in pairwise(stops):
            faces, materials = _fanned(faces, materials, row[start : stop + 1])
    return faces, materials


def _fanned(faces: Ints, materials: Ints, edge: Ints) -> tuple[Ints, Ints]:
    """Split the triangle at the edge from the first vertex of `edge` to its last."""
    (at,) = np.flatnonzero(np.isin(faces, edge[[0, -1]]).sum(1) == 2)
    (tip,) = set(faces[at]) - set(edge)
    corners = faces[at].tolist()
    forward = corners[(corners.index(edge[0]) + 1) % 3] == edge[-1]
    line = edge if forward else edge[::-1]
    fan = np.stack([line[:-1], line[1:], np.full(len(line) - 1, tip)], axis=1)
    kept = np.arange(len(faces)) != at
    return (
        np.concatenate([faces[kept], fan]),
        np.concatenate([materials[kept], np.full(len(fan), materials[at])]),
    )
