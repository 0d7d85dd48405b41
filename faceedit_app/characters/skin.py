"""Find the skin of a scan among eyeballs, teeth, hair and clothes."""

from __future__ import annotations

import numpy as np
import trimesh

from faceedit_app.core.arrays import Bools, Doubles

_SPLINTER = 0.02  # share of all triangles; a smaller piece that has a landmark is no skin


def skin_of(mesh: trimesh.Trimesh, positions: Doubles) -> Bools:
    """(F,) the triangles of the connected pieces that have landmarks.

    Args:
        mesh: a scan, whose vertices are joined where it is cut for its texture.
        positions: (L, 3) landmarks on it.
    """
    labels = trimesh.graph.connected_component_labels(mesh.face_adjacency, len(mesh.faces))
    _, _, triangles = mesh.nearest.on_surface(positions)
    kept: Bools = np.isin(labels, np.unique(labels[triangles]))
    sizes = np.bincount(labels)
    kept &= sizes[labels] > _SPLINTER * len(mesh.faces)
    return kept
