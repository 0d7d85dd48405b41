"""The shader's input for each vertex: its normal, and how its surface reflects light."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from faceedit_app.core.arrays import Floats, Indices
from faceedit_app.core.rig import Material, Rig


class Shading(Enum):
    """The variants of the shader, in drawing order; the value is the name it defines.

    Variants are used instead of branches, because software OpenGL computes both sides of a branch.
    """

    FLESH = "FLESH"
    PLAIN = "PLAIN"
    WET = "WET"
    HAIR = "HAIR"
    THIN = "THIN"


SHEER = (Shading.HAIR, Shading.THIN)  # what can be sheer: it is drawn after what it covers


@dataclass(frozen=True)
class Look:
    """How a kind of surface reflects light.

    Attributes:
        shading: the variant of the shader.
        flesh: 0..1, how far light travels beneath it (soft, warm shadow edges).
        wet: 0..1, how strongly it mirrors the small catch light next to the camera.
        shaded: 0..1, how much of the baked shade applies.
    """

    shading: Shading = Shading.PLAIN
    flesh: float = 0.0
    wet: float = 0.0
    shaded: float = 0.0


# By a word in the material's name; the first match counts.
LOOKS = {
    "skin": Look(Shading.FLESH, flesh=1.0, shaded=1.0),
    "lips": Look(Shading.FLESH, flesh=0.8, shaded=0.8),
    "mouth": Look(Shading.FLESH, flesh=1.0, shaded=0.4),
    "gums": Look(Shading.WET, flesh=0.8, wet=0.3, shaded=0.5),
    "tongue": Look(Shading.WET, flesh=1.0, wet=0.12, shaded=0.5),
    "tears": Look(Shading.WET, flesh=0.8, wet=0.35, shaded=0.5),
    "sclera": Look(Shading.WET, flesh=0.5, wet=1.0, shaded=0.7),
    "iris": Look(Shading.WET, wet=1.0, shaded=0.5),
    "pupil": Look(Shading.WET, wet=1.0, shaded=0.5),
    "teeth": Look(Shading.WET, flesh=0.7, wet=0.35, shaded=0.45),
    "lashes": Look(Shading.THIN),
    "brows": Look(Shading.THIN),
    "hair": Look(Shading.HAIR, shaded=0.6),
}
OTHER_LOOK = Look(flesh=0.4, shaded=0.6)
_SHARPEST = 0.08  # roughness; below this a highlight is smaller than a pixel


def look_of(material: Material) -> Look:
    """The look of a material, by its surface or its name."""
    name = (material.surface or material.name).casefold()
    return next((look for word, look in LOOKS.items() if word in name), OTHER_LOOK)


def vertex_looks(rig: Rig, shade: Floats) -> Floats:
    """(V, 4) float32 in 0..1: roughness, flesh, wet and arriving light of each vertex.

    A vertex of several materials takes the mean over its corners, which makes the border of the
    lips soft.

    Args:
        rig: the character.
        shade: (V,) float32 in 0..1, the share of the light from above that arrives.
    """
    total = np.zeros((len(rig.neutral), 4), np.float64)
    corners = np.zeros(len(rig.neutral), np.float64)
    for material in rig.materials:
        look = look_of(material)
        row = np.array([max(material.roughness, _SHARPEST), look.flesh, look.wet, look.shaded])
        count = np.bincount(
            rig.faces[material.start : material.stop].ravel(), minlength=len(rig.neutral)
        )
        total += count[:, None] * row
        corners += count
    looks: Floats = (total / np.maximum(corners, 1.0)[:, None]).astype(np.float32)
    looks[:, 3] = 1.0 - looks[:, 3] * (1.0 - shade)
    return looks


@dataclass(frozen=True)
class Group:
    """Faces that one variant of the shader draws, with one texture.

    Attributes:
        shading: the variant.
        texture: which of the rig's textures it has, if one.
        cutoff: pixels with less alpha are not drawn; 0 draws all.
        sheer: whether one can see through some of it, by the alpha of its vertices.
        still, moving: (F', 3) int32, the faces that look the same whatever the face does, and the
            others.
    """

    shading: Shading
    still: NDArray[np.int32]
    moving: NDArray[np.int32]
    texture: int | None = None
    cutoff: float = 0.0
    sheer: bool = False


def by_shading(rig: Rig) -> list[Group]:
    """The faces of each variant of the shader and each texture, in drawing order."""
    runs: dict[tuple[Shading, bool, int | None, float], list[NDArray[np.int32]]] = {}
    order = {shading: place for place, shading in enumerate(Shading)}
    through = rig.colors[:, 3] < 1.0
    for material in sorted(rig.materials, key=lambda m: (order[look_of(m).shading], m.cutoff)):
        shading = look_of(material).shading
        faces = rig.faces[material.start : material.stop]
        can_be_sheer = shading in SHEER and material.texture is None
        sheer = through[faces].any(axis=1) & can_be_sheer
        for part, is_sheer in ((faces[~sheer], False), (faces[sheer], True)):
            if len(part):
                kind = shading, is_sheer, material.texture, material.cutoff
                runs.setdefault(kind, []).append(part)
    alive = _alive(rig)
    groups = []
    for (shading, is_sheer, texture, cutoff), parts in runs.items():
        faces = np.concatenate(parts)
        # What is wet is shaded by lids and lips, also where it stays; and what shows through
        # something has to be drawn before it.
        moving = alive[faces].any(axis=1) | (shading is Shading.WET) | is_sheer
        still, others = _in_a_row(faces[~moving]), _in_a_row(faces[moving])
        groups.append(Group(shading, still, others, texture, cutoff, is_sheer))
    return groups


def _alive(rig: Rig) -> NDArray[np.bool_]:
    """(V,) whether blendshapes change a vertex: its place, or its normal through its faces."""
    alive: NDArray[np.bool_] = np.any(rig.deltas, axis=(0, 2))
    alive[rig.faces[alive[rig.faces].any(axis=1)]] = True
    return alive


def _in_a_row(faces: NDArray[np.int32]) -> NDArray[np.int32]:
    """The faces, ordered so that faces with shared vertices follow each other.

    Software OpenGL caches the last few hundred transformed vertices.
    """
    order = faces.min(axis=1).argsort(kind="stable")
    return np.ascontiguousarray(faces[order])


class NormalSolver:
    """Exact area-weighted vertex normals, by one sum over faces per frame and coordinate.

    Coordinates are kept in separate rows, on which numpy is several times as fast as on triples.

    trimesh's normals are as exact but take two and a half times as long, half a millisecond more
    in each frame (docs/adr/0011-pyrender.md); they are used where meshes are built.

    Args:
        faces: (F, 3) int, counter-clockwise seen from outside.
        vertex_count: V.
        wanted: (N,) the vertices to compute; None = all, and N is V.
        groups: (V,) int; vertices with the same number share a normal; None = each has its own.
    """

    def __init__(
        self,
        faces: NDArray[np.int32],
        vertex_count: int,
        *,
        wanted: Indices | None = None,
        groups: NDArray[np.int32] | None = None,
    ) -> None:
        owned, owners_count = faces, vertex_count
        rows = wanted
        if groups is not None:
            owned, owners_count = groups[faces], int(groups.max()) + 1
            rows = (groups if wanted is None else groups[wanted]).astype(np.intp)
        if rows is not None:
            is_wanted = np.zeros(owners_count, bool)
            is_wanted[rows] = True
            used = is_wanted[owned].any(axis=1)
            faces, owned = faces[used], owned[used]
        corners = owned.ravel()
        # A matrix of ones in compressed rows, each with its faces in order, so that the bits of
        # a sum do not depend on which vertices are wanted.
        ends = np.cumsum(np.bincount(corners, minlength=owners_count), dtype=np.int32)
        owners = (np.argsort(corners, kind="stable") // 3).astype(np.int32)
        ones = np.ones(len(owners), np.float32)
        sums = csr_matrix((ones, owners, np.append(np.int32(0), ends)), (owners_count, len(faces)))
        self._sums = sums if rows is None else sums[rows]
        self._corners = np.ascontiguousarray(faces.T, np.intp)

    def __call__(self, vertices: Floats) -> Floats:
        """(V, 3) float32 vertices -> (N, 3) float32 unit normals; zero without faces."""
        corners = np.take(np.ascontiguousarray(vertices.T), self._corners, axis=1)  # (3, 3, F)
        u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        normals = np.empty((3, self._sums.shape[0]), np.float32)
        for x, y, z in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            # The cross product; its length is twice the area.
            normals[x] = self._sums @ (u[y] * v[z] - u[z] * v[y])
        lengths = np.sqrt((normals * normals).sum(axis=0))
        normals /= np.maximum(lengths, np.float32(1e-20))
        return np.ascontiguousarray(normals.T)
