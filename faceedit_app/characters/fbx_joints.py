"""The objects of an FBX file that hold a joint: its bone, and the vertices that follow it."""

from __future__ import annotations

import numpy as np

from faceedit_app.characters.fbx_tree import Record
from faceedit_app.core.arrays import Doubles


def bone_children(place: Doubles) -> tuple[Record, ...]:
    """The records of a bone's `Model` at a place (3,), centimetres."""
    properties = (
        Record("P", ("InheritType", "enum", "", "", 1)),
        Record("P", ("DefaultAttributeIndex", "int", "Integer", "", 0)),
        Record("P", ("Lcl Translation", "Lcl Translation", "", "A", *place.tolist())),
    )
    return Record("Version", (232,)), Record("Properties70", (), properties)


def cluster_children(place: Doubles, share: Doubles) -> tuple[Record, ...]:
    """The records of the `Cluster` of a bone at a place (3,), centimetres.

    Args:
        share: (V,) in 0..1, how far each vertex follows the bone.
    """
    follow = np.flatnonzero(share > 0).astype(np.int32)
    there, back = np.eye(4), np.eye(4)  # FBX has the translation in the last row
    there[3, :3], back[3, :3] = place, -place
    return (
        Record("Version", (100,)),
        Record("UserData", ("", "")),
        Record("Indexes", (follow,)),
        Record("Weights", (share[follow],)),
        Record("Transform", (back.ravel(),)),
        Record("TransformLink", (there.ravel(),)),
    )
