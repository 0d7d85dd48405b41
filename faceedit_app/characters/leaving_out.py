"""Leave out the hair, brows or lashes that a made character has from FaceEdit's own."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from faceedit_app.core.rig import Material, Rig

PARTS: tuple[str, ...] = ("hair", "brows", "lashes")  # materials of FaceEdit's own character


def without_parts(rig: Rig, parts: Collection[str]) -> Rig:
    """A rig without some of its materials, and without the vertices that only they use.

    Args:
        rig: of a character that was made of FaceEdit's own.
        parts: some of `PARTS`.
    """
    materials: list[Material] = []
    runs, stop = [], 0
    for material in rig.materials:
        if material.name not in parts:
            runs.append(rig.faces[material.start : material.stop])
            start, stop = stop, stop + len(runs[-1])
            materials.append(replace(material, start=start, stop=stop))
    faces, pairs = np.concatenate(runs), rig.control_pairs
    kept = np.union1d(faces, pairs[pairs >= 0])
    number = np.full(len(rig.neutral), -1, np.int32)
    number[kept] = np.arange(len(kept), dtype=np.int32)
    return replace(
        rig,
        neutral=rig.neutral[kept],
        faces=number[faces],
        deltas=np.ascontiguousarray(rig.deltas[:, kept]),
        colors=rig.colors[kept],
        materials=tuple(materials),
        control_pairs=np.where(pairs >= 0, number[pairs], -1).astype(np.int32),
        uv=None if rig.uv is None else rig.uv[kept],
        shading_groups=None if rig.shading_groups is None else rig.shading_groups[kept],
        shade=None if rig.shade is None else rig.shade[kept],
    )
