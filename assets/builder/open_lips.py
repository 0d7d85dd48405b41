"""Rounds the mouth: the source's lips open along straight lines from the corners, like a rhombus.

Only what lies between the middle of the lips and their corners moves, so that all distances, and
with them weights, stay as they are.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from assets.builder import source as src
from assets.builder.controls import LEFT_CORNER
from assets.builder.geometry import smoothstep
from assets.builder.settings import OPEN_LIPS
from assets.builder.source import Floats
from faceedit_app.core.arkit import ARKIT_INDEX


def round_mouth(neutral: Floats, deltas: Floats, lips: Floats) -> None:
    """Move the sides of the lips further apart, in place.

    Args:
        neutral: (N, 3) mm.
        deltas: (52, N, 3) mm; corrected in place.
        lips: (N,) mask of the lips.
    """
    skin = neutral[src.BODY]
    jaw = deltas[ARKIT_INDEX["jawOpen"], :, 1]
    lower = (jaw < jaw[LEFT_CORNER])[src.BODY]
    distance = cKDTree(skin[lips[src.BODY] > 0.5]).query(skin)[0]
    near = 1 - smoothstep(0, OPEN_LIPS.reach, distance)
    share = np.abs(skin[:, 0]) / neutral[LEFT_CORNER, 0]
    for channel, above, below, most in OPEN_LIPS.apart:
        sides = near * _sides(share, most)
        deltas[ARKIT_INDEX[channel], src.BODY, 1] += sides * np.where(lower, -below, above)


def _sides(share: Floats, most: float) -> Floats:
    """How much of a move applies at shares of the way from the middle to a corner.

    1 at `most`, 0 at both ends. It begins gently, so that the middle stays round, and ends as it
    has to for that.
    """
    inside = np.clip(share, 0, 1)
    outer = 2 * (1 - most) / most
    return np.asarray((inside / most) ** 2 * ((1 - inside) / (1 - most)) ** outer)
