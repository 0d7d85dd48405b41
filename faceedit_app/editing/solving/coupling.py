"""mouthClose never exceeds jawOpen: it is a corrective, which tears any rig alone."""

from __future__ import annotations

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Bools, Doubles, Indices

_CLOSE, _JAW = ARKIT_INDEX["mouthClose"], ARKIT_INDEX["jawOpen"]


def room_of_close(weights: Doubles) -> Doubles:
    """(N,) by how much mouthClose exceeds jawOpen in weights (N, 52); a take may do that."""
    return np.maximum(weights[:, _CLOSE] - weights[:, _JAW], 0.0)


def couple(weights: Doubles, slack: Doubles, where: Bools | Indices) -> None:
    """Keep mouthClose <= jawOpen, in place.

    Args:
        weights: (N, 52).
        slack: (N,) by how much it may exceed jawOpen, see `room_of_close`.
        where: the frames.
    """
    limit = np.minimum(weights[:, _CLOSE], weights[:, _JAW] + slack)
    weights[where, _CLOSE] = limit[where]
