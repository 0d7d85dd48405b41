"""What the shader needs to know of each vertex: its normal and how its surface takes light."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from faceedit_app.core.rig import Rig

Floats = NDArray[np.float32]


@dataclass(frozen=True)
class Look:
    """How a kind of surface takes light.

    Attributes:
        flesh: 0..1, how far light travels beneath it (soft, warm shadow edges).
        wet: 0..1, whether it mirrors the small catch light beside the camera.
        hair: 0..1, whether its highlight follows strands.
    """

    flesh: float = 0.0
    wet: float = 0.0
    hair: float = 0.0


# By material name; every other name is matt and solid.
LOOKS = {
    "skin": Look(flesh=1.0),
    "lips": Look(flesh=0.8, wet=0.12),
    "mouth": Look(flesh=0.6, wet=0.1),
    "gums": Look(flesh=0.6, wet=0.35),
    "tongue": Look(flesh=0.7, wet=0.3),
    "sclera": Look(flesh=0.35, wet=1.0),
    "iris": Look(wet=1.0),
    "pupil": Look(wet=1.0),
    "teeth": Look(flesh=0.3, wet=0.6),
    "hair": Look(hair=1.0),
}


def vertex_looks(rig: Rig) -> Floats:
    """(V, 4) float32: roughness, flesh, wet, hair of each vertex, all 0..1.

    A vertex that several materials share takes the mean over its corners, which is what makes
    the border of the lips soft.
    """
    total = np.zeros((len(rig.neutral), 4), np.float64)
    corners = np.zeros(len(rig.neutral), np.float64)
    for material in rig.materials:
        look = LOOKS.get(material.name, Look())
        row = np.array([material.roughness, look.flesh, look.wet, look.hair])
        count = np.bincount(
            rig.faces[material.start : material.stop].ravel(), minlength=len(rig.neutral)
        )
        total += count[:, None] * row
        corners += count
    result: Floats = (total / np.maximum(corners, 1.0)[:, None]).astype(np.float32)
    return result


class NormalSolver:
    """Exact area-weighted vertex normals, by one sparse product a frame.

    Args:
        faces: (F, 3) int, counter-clockwise seen from outside.
        vertex_count: V.
    """

    def __init__(self, faces: NDArray[np.int32], vertex_count: int) -> None:
        corners = faces.ravel()
        owners = np.repeat(np.arange(len(faces), dtype=np.int32), 3)
        ones = np.ones(len(corners), np.float32)
        self._gather = sparse.csr_matrix((ones, (corners, owners)), (vertex_count, len(faces)))
        self._a, self._b, self._c = (np.ascontiguousarray(column) for column in faces.T)

    def __call__(self, vertices: Floats) -> Floats:
        """(V, 3) float32 vertices -> (V, 3) float32 unit normals; zero where no face is."""
        first = vertices[self._a]
        u, v = vertices[self._b] - first, vertices[self._c] - first
        areas = np.empty_like(u)  # the cross product, whose length is twice the area
        areas[:, 0] = u[:, 1] * v[:, 2] - u[:, 2] * v[:, 1]
        areas[:, 1] = u[:, 2] * v[:, 0] - u[:, 0] * v[:, 2]
        areas[:, 2] = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
        normals: Floats = self._gather @ areas
        lengths = np.sqrt(np.einsum("vx,vx->v", normals, normals))
        normals /= np.maximum(lengths, np.float32(1e-20))[:, None]
        return normals
