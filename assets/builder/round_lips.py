"""Rounds the lips: in the source they open along straight lines, and pucker around an edge.

Only what lies between the middle of the lips and their corners moves, so that all distances, and
with them weights, stay as they are.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from assets.builder import source as src
from assets.builder.controls import LEFT_CORNER
from assets.builder.geometry import smoothstep
from assets.builder.settings import ROUND_LIPS, LipSides
from assets.builder.source import Floats
from faceedit_app.core.arkit import ARKIT_INDEX


def round_lips(neutral: Floats, deltas: Floats, lips: Floats) -> None:
    """Move the sides of the lips, in place.

    Args:
        neutral: (N, 3) mm.
        deltas: (52, N, 3) mm; corrected in place.
        lips: (N,) mask of the lips.
    """
    skin = neutral[src.BODY]
    jaw = deltas[ARKIT_INDEX["jawOpen"], :, 1]
    lower = (jaw < jaw[LEFT_CORNER])[src.BODY, None]
    distance = cKDTree(skin[lips[src.BODY] > 0.5]).query(skin)[0]
    near = 1 - smoothstep(0, ROUND_LIPS.reach, distance)
    share = np.abs(skin[:, 0]) / neutral[LEFT_CORNER, 0]
    for move in ROUND_LIPS.sides:
        amount = near * _sides(share, move)
        most = np.where(lower, move.lower, move.upper)
        deltas[ARKIT_INDEX[move.channel], src.BODY, 1:] += amount[:, None] * most


def _sides(share: Floats, move: LipSides) -> Floats:
    """How much of a move applies at shares of the way from the middle to a corner.

    1 at `move.most`, 0 at both ends. It begins gently, so that the middle stays round, and ends as
    it has to for that.
    """
    inside = np.clip(share, 0, 1)
    outer = move.late * (1 - move.most) / move.most
    return np.asarray((inside / move.most) ** move.late * ((1 - inside) / (1 - move.most)) ** outer)
