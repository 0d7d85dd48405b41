"""Weld vertices that coincide and move together, which removes texture and normal seams."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from faceedit_app.characters.assembly import Assembly
from faceedit_app.core.arrays import Floats, Indices

_TOGETHER = 2e-5  # metres
_ALIKE = 1e-4  # metres of movement, in each of three mixtures of all shapes
# The same along the borders of two parts: each is rounded to a grid of its own if it is quantised.
_BORDERS_TOGETHER, _BORDERS_ALIKE = 6e-5, 3e-4
_OF_MOVE = 0.05  # of a movement; may differ as well


@dataclass(frozen=True)
class Weld:
    """The welded mesh of an assembly.

    Attributes:
        first: (N,) the first original vertex of each welded vertex.
        number: (V,) the welded vertex of each vertex.
        faces: (F', 3) of welded vertices, without collapsed triangles.
    """

    first: Indices
    number: Indices
    faces: Indices


def weld(assembly: Assembly) -> Weld:
    """Weld an assembly.

    Closed lips coincide but do not move together: they stay separate.
    """
    mixture = np.random.default_rng(0).uniform(0.5, 1.5, (3, len(assembly.channels)))
    moved: Floats = np.einsum("mk,kvx->vmx", mixture.astype(np.float32), assembly.deltas)
    count = len(assembly.neutral)
    keys = np.hstack((assembly.neutral / _TOGETHER, moved.reshape(count, -1) / _ALIKE))
    first, number = trimesh.grouping.unique_rows(keys, digits=0)
    joined = _joined_borders(assembly, first, number[assembly.faces], moved.reshape(count, -1))
    first, number = first[np.unique(joined, return_index=True)[1]], joined[number]
    faces = number[assembly.faces]
    a, b, c = faces.T
    return Weld(first, number, faces[(a != b) & (b != c) & (c != a)])


def _joined_borders(
    assembly: Assembly, first: Indices, faces: Indices, moved: Floats
) -> NDArray[np.intp]:
    """(N,) the new number of each welded vertex, where the borders of two parts meet.

    Args:
        first: (N,) the first original vertex of each welded vertex.
        faces: (F, 3) of welded vertices.
        moved: (V, 9) metres of movement of the original vertices.
    """
    apart = np.arange(len(first))
    if len(assembly.parts) < 2:
        return apart
    edges = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    once = edges[trimesh.grouping.group_rows(edges, require_count=1)]
    border = np.unique(once)
    rows = first[border]
    pairs = cKDTree(assembly.neutral[rows]).query_pairs(_BORDERS_TOGETHER, output_type="ndarray")
    one, other = rows[pairs[:, 0]], rows[pairs[:, 1]]
    allowed = _BORDERS_ALIKE + _OF_MOVE * np.abs(moved[one]).max(axis=1)
    alike = np.abs(moved[one] - moved[other]).max(axis=1) < allowed
    meet = border[pairs[alike & (assembly.part_of[one] != assembly.part_of[other])]]
    graph = coo_matrix((np.ones(len(meet)), (meet[:, 0], meet[:, 1])), (len(first), len(first)))
    # The labels are in the order of the first vertex of each.
    labels: NDArray[np.intp] = connected_components(graph, directed=False)[1].astype(np.intp)
    return labels
