"""Find the joints of eyes in a skeleton, by their names."""

from __future__ import annotations

import re

import numpy as np

from faceedit_app.characters.character import EyeJoint
from faceedit_app.core.arrays import Doubles

_EYE = re.compile(r"eye(?!.?(brow|lash|lid|liner|shadow|highlight|socket))|目", re.IGNORECASE)
_NO_EYE = re.compile(r"lid|brow|lash|corner|bag|target|aim", re.IGNORECASE)
_FEWEST = 8  # vertices of an eye


def is_eye(name: str) -> bool:
    """Whether a joint may turn an eye, by its name."""
    return bool(_EYE.search(name)) and not _NO_EYE.search(name)


def eye_joint(place: Doubles, share: Doubles, node: int | None = None) -> EyeJoint | None:
    """A joint that is_eye says is one; None if it carries too little of the mesh.

    Args:
        place: (3,) in the file's coordinates.
        share: (V,) in 0..1, how far each vertex of the mesh follows it.
        node: its number in a glTF file.
    """
    if np.count_nonzero(share > 0.5) < _FEWEST:
        return None
    return EyeJoint(place.astype(np.float32), share.astype(np.float32), node)
