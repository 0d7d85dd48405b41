"""Deformation transfer between heads with the same mesh (paper, section 2).

Sumner and Popovic 2004, in the gradient form of Botsch et al. 2006: each triangle of the target
should rotate and stretch like its twin. The best vertices solve one sparse system, which is
factored once for all shapes. Gradients do not determine position, and parts far from still vertices
would drift, so each vertex is also drawn softly to where the source's own displacement puts it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from faceedit_app.core.arrays import Bools, Doubles

_FLAT = 1e-12
_DRIFT = 30.0  # mm up to which gradients dominate; beyond, displacements do


class Transfer:
    """Transfers shapes from one head to another.

    Args:
        source, target: (V, 3) neutral vertices of both, mm.
        faces: (F, 3) of both.
        still: (V,) vertices that no shape moves; they stay in place and hold the others.
    """

    def __init__(
        self, source: Doubles, target: Doubles, faces: NDArray[np.integer], still: Bools
    ) -> None:
        self._source, self._target, self._faces = source, target, faces
        self._inverse = np.linalg.inv(_frames(source, faces))
        frames = np.linalg.inv(_frames(target, faces))
        corners = target[faces]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = np.linalg.norm(across, axis=1) / 2
        # The gradient of a function on each triangle, from its values at the three corners.
        gradient = np.stack((-(frames[:, 0] + frames[:, 1]), frames[:, 0], frames[:, 1]), axis=1)
        rows = np.repeat(np.arange(3 * len(faces)).reshape(-1, 1, 3), 3, axis=1)
        columns = np.repeat(faces[:, :, None], 3, axis=2)
        self._gradient = sparse.csr_matrix(
            (gradient.ravel(), (rows.ravel(), columns.ravel())), (3 * len(faces), len(target))
        )
        self._weighted = self._gradient.T @ sparse.diags_array(np.repeat(area, 3))
        owned = np.bincount(faces.ravel(), np.repeat(area, 3), len(target)) / 3
        self._anchor = owned / _DRIFT**2
        self._system = (self._weighted @ self._gradient + sparse.diags_array(self._anchor)).tocsc()
        self._free, self._held = np.flatnonzero(~still), np.flatnonzero(still)
        self._factors = splu(
            self._system[self._free][:, self._free].tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            options={"SymmetricMode": True},
        )

    def __call__(self, moves: Doubles) -> Doubles:
        """(V, 3) displacements of the source -> (V, 3) of the target."""
        turned = _frames(self._source + moves, self._faces) @ self._inverse
        wanted = turned.transpose(0, 2, 1).reshape(-1, 3)
        right = self._weighted @ wanted + self._anchor[:, None] * (self._target + moves)
        right -= self._system[:, self._held] @ self._target[self._held]
        placed = self._target.copy()
        placed[self._free] = self._factors.solve(right[self._free])
        return placed - self._target


def _frames(vertices: Doubles, faces: NDArray[np.integer]) -> Doubles:
    """(F, 3, 3) per triangle two edges and the normal, as columns."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    length = np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), _FLAT)
    # The normal is as long as an edge, so that it stretches with the triangle.
    frames: Doubles = np.stack((b - a, c - a, normal / np.sqrt(length)), axis=2)
    return frames
