"""The turns of a head as files of 3D programs hold them: a joint in the neck, and its rotation."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.head import Head, turn
from faceedit_app.core.rig import Rig

HEAD_JOINT = "head"


@dataclass(frozen=True)
class Turning:
    """How the head of a rig turns: as `Head` turns it in the viewport.

    A skin of two joints says the same: each vertex follows the head's by its `share`.

    Attributes:
        pivot: (3,) metres, where the head's joint is.
        share: (V,) float32 in 0..1, how far each vertex follows.
        matrices: (T, 3, 3) the rotation on each frame.
    """

    pivot: Doubles
    share: Floats = field(repr=False)
    matrices: Doubles = field(repr=False)

    @classmethod
    def of(cls, rig: Rig, rotations: Floats) -> Turning:
        """The turns of a take.

        Args:
            rotations: (T, 9) radians, as in `Clip.rotations`.
        """
        head = Head(rig)
        return cls(head.pivot, head.share.astype(np.float32), turns(rotations))

    @property
    def quaternions(self) -> Floats:
        """(T, 4) x, y, z, w; neighbours lie in the same half, so that they can be interpolated."""
        return quaternions(self.matrices)


def turns(rotations: Floats) -> Doubles:
    """(T, 3, 3) the rotation of the head on each frame of rotations (T, 9), in radians."""
    heads = rotations[:, :3].astype(np.float64)
    return np.stack([turn(*head) for head in heads])


def quaternions(matrices: Doubles) -> Floats:
    """Rotations (T, 3, 3) as (T, 4) x, y, z, w, float32."""
    found = Rotation.from_matrix(matrices).as_quat()
    flips = np.cumprod(np.where((found[1:] * found[:-1]).sum(axis=1) < 0, -1.0, 1.0))
    found[1:] *= flips[:, None]
    result: Floats = found.astype(np.float32)
    return result
