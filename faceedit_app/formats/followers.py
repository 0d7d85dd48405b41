"""Whether the weights of one mesh follow those of another, as teeth follow the head.

What follows is edited along. Another person, or another take, has the same channels and perhaps the
same times, but moves in its own way.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles

_OFF = 1e-4  # share of the largest weight by which a follower may be off
WHOLE = 1.0


@dataclass(frozen=True)
class Following:
    """How a mesh follows another.

    Attributes:
        share: its weights are this share of the other's, above 0.
        channels: (K,) in which channels; it may be still in some of them.
    """

    share: float
    channels: Bools


def following(main: Doubles, other: Doubles, rounding: float = 0.0) -> Following | None:
    """How the weights `other` (T, K) follow `main` (T, K); None if they do not.

    Args:
        rounding: by how much the two may differ because their numbers are rounded.
    """
    if not main.size:
        return Following(WHOLE, np.zeros(main.shape[1], np.bool_))
    off = _OFF * float(np.abs(main).max()) + rounding
    moves, leads = np.ptp(other, axis=0) > off, np.ptp(main, axis=0) > off
    if leads.any() and not moves.any():
        return None
    for share in (WHOLE, _share(main[:, moves], other[:, moves])):
        alike: Bools = np.abs(other - share * main).max(axis=0) <= off
        if share > 0 and alike[moves].all():
            return Following(share, alike)
    return None


def _share(main: Doubles, other: Doubles) -> float:
    power = float((main * main).sum())
    return float((main * other).sum()) / power if power > 0 else 0.0
