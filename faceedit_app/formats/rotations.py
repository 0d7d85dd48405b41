"""Rotations of head and eyes, in radians, by their names in a file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from faceedit_app.core.arkit import ROTATION_INDEX, ROTATIONS
from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.formats.lost_faces import letters

_BY_LETTERS = {letters(name): name for name in ROTATIONS}


def rotation_named(name: str) -> str | None:
    """The rotation that a name means, such as headYaw for `HeadYaw` or `head_yaw`, or None."""
    return _BY_LETTERS.get(letters(name))


def found_rotations(names: Sequence[Any]) -> dict[str, int]:
    """Where names of a file mean rotations, in the order of `ROTATIONS`; none if two mean one."""
    meant = [rotation_named(name) if isinstance(name, str) else None for name in names]
    if any(meant.count(name) > 1 for name in ROTATIONS):
        return {}
    return {name: meant.index(name) for name in ROTATIONS if name in meant}


def all_rotations(values: Doubles, names: Sequence[str]) -> Floats | None:
    """(T, 9) as in `Clip.rotations`, of those (T, N) of some names.

    Returns:
        None if there are no names, or a value is not a finite number.
    """
    if not names or not np.isfinite(values).all():
        return None
    out = np.zeros((len(values), len(ROTATIONS)), np.float32)
    out[:, [ROTATION_INDEX[name] for name in names]] = values
    return out
