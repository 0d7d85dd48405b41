"""How a head turns: the rotations of a take, applied to the vertices of a character."""

from __future__ import annotations

import numpy as np

from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.controls import CONTROL_INDEX, LIDS
from faceedit_app.core.rig import Rig

# A skull turns on the neck below and behind the eyes; metres from between them, for an adult.
_PIVOT = (0.0, -0.075, -0.095)
# The neck bends between these heights below the eyes; the chin is above it.
_NECK = (0.125, 0.185)


class Head:
    """Turns the vertices of a character about its neck; what is below the neck stays.

    Args:
        rig: the character.

    Attributes:
        pivot: (3,) metres, about which it turns.
        share: (V,) in 0..1, how far each vertex follows.
    """

    def __init__(self, rig: Rig) -> None:
        eyes = _between_the_eyes(rig)
        self.pivot: Doubles = eyes + np.array(_PIVOT)
        below = eyes[1] - rig.neutral[:, 1]
        left = np.clip((_NECK[1] - below) / (_NECK[1] - _NECK[0]), 0.0, 1.0)
        self.share: Doubles = left * left * (3.0 - 2.0 * left)

    def turned(self, vertices: Floats, rotation: Floats) -> Floats:
        """Vertices (V, 3) after the head has turned.

        Args:
            vertices: metres.
            rotation: yaw, pitch and roll in radians. Positive is to the person's right, down, and
                tilted to the person's right, as Live Link Face writes them.
        """
        around = vertices - self.pivot
        moved = around @ turn(*rotation[:3].astype(np.float64)).T - around
        turned: Floats = (vertices + self.share[:, None] * moved).astype(np.float32)
        return turned


def turn(yaw: float, pitch: float, roll: float) -> Doubles:
    """(3, 3) the matrix of a rotation; see `Head.turned` for the directions."""
    cy, sy = np.cos(-yaw), np.sin(-yaw)
    cp, sp = np.cos(pitch), np.sin(pitch)
    cr, sr = np.cos(roll), np.sin(roll)
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_x = np.array([[1, 0, 0], [0, cp, -sp], [0, sp, cp]])
    about_z = np.array([[cr, -sr, 0], [sr, cr, 0], [0, 0, 1]])
    matrix: Doubles = about_y @ about_x @ about_z
    return matrix


def _between_the_eyes(rig: Rig) -> Doubles:
    """(3,) metres."""
    lids = [CONTROL_INDEX[name] for name in LIDS]
    if rig.has_control[lids].all():
        middle: Doubles = rig.neutral[rig.control_pairs[lids].ravel()].mean(axis=0)
        return middle.astype(np.float64)
    low, high = rig.neutral.min(axis=0), rig.neutral.max(axis=0)
    return np.array([0.5 * (low[0] + high[0]), 0.6 * high[1] + 0.4 * low[1], high[2]], np.float64)
