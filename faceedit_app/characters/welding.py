"""Weld vertices that coincide and move together, which removes texture and normal seams."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh

from faceedit_app.characters.assembly import Assembly
from faceedit_app.core.arrays import Floats, Indices

_TOGETHER = 2e-5  # metres
_ALIKE = 1e-4  # metres of movement, in each of three mixtures of all shapes


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
    faces = number[assembly.faces]
    a, b, c = faces.T
    return Weld(first, number, faces[(a != b) & (b != c) & (c != a)])
