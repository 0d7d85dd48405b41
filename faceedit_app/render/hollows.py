"""What shades the eyeballs and the inside of the mouth: how far lids and lips are open.

The shade of the skin is baked, because nothing that covers it moves much. Lids and lips do: an
eyeball is dark under its lid, and the teeth are dark behind lips that have just parted.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from faceedit_app.core.arrays import Doubles, Floats, Indices
from faceedit_app.core.controls import CONTROL_INDEX, LIDS, LIP_OPENING, MOUTH_WIDTH
from faceedit_app.core.rig import Rig

_REFERENCES = 40  # vertices at most, from which it is seen how the head is turned


class Hollows(NamedTuple):
    """The shader's values of the same names.

    Attributes:
        lids: (4, 4) float32, in columns: the middle of the upper and of the lower lid, first of the
            left eye; metres, and 1, or 0 if the character has no such point.
        lips: (4, 4) float32, likewise: upper and lower lip, left and right corner of the mouth.
        head: (3, 3) float32 how the head is turned; its columns point to its left, up and forward.
    """

    lids: Floats
    lips: Floats
    head: Floats


class HollowFinder:
    """Finds them in the vertices of each picture.

    Args:
        rig: the character.
        still: vertices that no blendshape moves.
    """

    def __init__(self, rig: Rig, still: Indices) -> None:
        names = (*LIDS, LIP_OPENING, MOUTH_WIDTH)
        points = rig.control_pairs[[CONTROL_INDEX[name] for name in names]].ravel()
        self._points = points.clip(0)
        self._known = (points >= 0).astype(np.float32)
        self._still = still[:: max(1, len(still) // _REFERENCES)]
        at_rest = rig.neutral[self._still].astype(np.float64)
        self._at_rest = at_rest - at_rest.mean(axis=0) if len(at_rest) else at_rest
        self._turn = np.eye(3, dtype=np.float32)

    def turned(self, vertices: Floats) -> None:
        """Learn how the head is turned from vertices (V, 3), metres."""
        if len(self._still) >= 3:
            now = vertices[self._still].astype(np.float64)
            self._turn = _rotation(self._at_rest, now - now.mean(axis=0)).astype(np.float32)

    def __call__(self, vertices: Floats) -> Hollows:
        """The hollows of vertices (V, 3), metres."""
        columns = np.empty((4, len(self._points)), np.float32)
        columns[:3], columns[3] = vertices[self._points].T, self._known
        return Hollows(columns[:, :4], columns[:, 4:], self._turn)


def _rotation(before: Doubles, after: Doubles) -> Doubles:
    """The rotation (3, 3) that best turns centred points `before` (N, 3) to `after` (Kabsch)."""
    u, _, v = np.linalg.svd(after.T @ before)
    mirrored = np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ v))])
    return np.asarray(u @ mirrored @ v, np.float64)
