"""Find the joints of eyes in a skeleton, by their names."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from faceedit_app.characters.character import EyeJoint
from faceedit_app.core.arrays import Doubles, Indices

_EYE = re.compile(r"eye(?!.?(brow|lash|lid|liner|shadow|highlight|socket))|目", re.IGNORECASE)
_NO_EYE = re.compile(r"lid|brow|lash|corner|bag|target|aim", re.IGNORECASE)
_FEWEST = 8  # vertices of an eye


def eye_joints(
    names: Sequence[str], places: Sequence[Doubles], joints: Indices, weights: Doubles
) -> tuple[EyeJoint, ...]:
    """The joints that carry the eyes of a mesh.

    Args:
        names, places: of the J joints; (3,) each, in the file's coordinates.
        joints, weights: (V, 4) the joints that each vertex follows, and how far.
    """
    found = []
    for number, (name, place) in enumerate(zip(names, places, strict=True)):
        if not _EYE.search(name) or _NO_EYE.search(name):
            continue
        share = np.where(joints == number, weights, 0.0).sum(axis=1)
        if np.count_nonzero(share > 0.5) >= _FEWEST:
            found.append(EyeJoint(place.astype(np.float32), share.astype(np.float32)))
    return tuple(found)
