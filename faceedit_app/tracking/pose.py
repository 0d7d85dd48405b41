"""How the head is turned in each picture: a weak perspective camera fitted to landmarks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from faceedit_app.core.arrays import Doubles

_DEPTH = 0.25  # weight of the landmarks' depth, which is much less exact than their place
_STEPS = 4  # of Gauss and Newton; more change nothing


@dataclass(frozen=True)
class Poses:
    """The pose of the head in T pictures.

    A point X (mm, the rig's axes) is seen at `scale * (turn @ X)[:2] + shift`, in pixels with the
    second axis upwards.

    Attributes:
        turns: (T, 3, 3) rotations.
        scales: (T,) pixels per millimetre.
        shifts: (T, 2) pixels.
    """

    turns: Doubles
    scales: Doubles
    shifts: Doubles

    @property
    def angles(self) -> Doubles:
        """(T, 3) yaw, pitch and roll in radians.

        Positive: turned to the person's right, down, and tilted to the person's right. For yaw and
        pitch these are the signs that Live Link Face uses for the eyes.
        """
        yaw, pitch, roll = Rotation.from_matrix(self.turns).as_euler("YXZ").T
        return np.stack((-yaw, pitch, roll), axis=1)

    def on_face(self, seen: Doubles, depth: Doubles) -> Doubles:
        """Where seen points (T, n, 2), pixels, lie on the face across and up, (T, n, 2) mm.

        Args:
            depth: (T, n) or (n,) mm, their third coordinate on the face.
        """
        flat = (seen - self.shifts[:, None]) / self.scales[:, None, None]
        flat = flat - self.turns[:, None, :2, 2] * np.broadcast_to(depth, flat.shape[:2])[..., None]
        back = np.linalg.inv(self.turns[:, :2, :2])
        placed: Doubles = np.einsum("tij,tnj->tni", back, flat)
        return placed


@dataclass(frozen=True)
class Lens:
    """What makes near parts of a face look larger.

    Attributes:
        middle: (2,) pixels, the middle of the picture.
        distance: mm from the camera to the head.
    """

    middle: Doubles
    distance: float

    def flatten(self, seen: Doubles, poses: Poses, points: Doubles) -> Doubles:
        """Landmarks (T, n, 3) as if they were seen from far away.

        Args:
            points: (n, 3) or (T, n, 3) mm, the same points on the face.
        """
        points = np.broadcast_to(points, seen.shape)
        nearer = np.einsum("tj,tnj->tn", poses.turns[:, 2], points) / self.distance
        flat = seen.copy()
        flat[..., :2] = self.middle + (seen[..., :2] - self.middle) * (1.0 - nearer)[..., None]
        return flat


def fit_poses(seen: Doubles, points: Doubles, weights: Doubles) -> Poses:
    """Fit the pose of each picture by Gauss and Newton's method, from Procrustes' solution.

    Args:
        seen: (T, n, 3) pixels: across, up, and the depth, larger is nearer.
        points: (n, 3) or (T, n, 3) mm, the same points on the face.
        weights: (n,) how much each counts.
    """
    used = weights > 0
    seen, points = seen[:, used], np.broadcast_to(points, seen.shape)[:, used]
    share = weights[used] / weights[used].sum()
    middle, centre = share @ seen, share @ points
    theirs, ours = seen - middle[:, None], points - centre[:, None]
    turns, scales = _procrustes(theirs, ours, share)
    # The shift is found in closed form: everything is centred.
    trust = np.sqrt(share)[:, None] * np.array([1.0, 1.0, _DEPTH])
    for _ in range(_STEPS):
        turned = scales[:, None, None] * (ours @ turns.transpose(0, 2, 1))
        x, y, z = np.moveaxis(turned, -1, 0)
        none = np.zeros_like(x)
        slopes = np.stack(  # by a turn around each axis, and by the scale
            [
                np.stack([none, z, -y, x]),
                np.stack([-z, none, x, y]),
                np.stack([y, -x, none, z]),
            ]
        )
        slopes = slopes.transpose(2, 3, 0, 1) * trust[..., None]
        flat = slopes.reshape(len(seen), -1, 4)
        away = ((theirs - turned) * trust).reshape(len(seen), -1, 1)
        across = flat.transpose(0, 2, 1)
        step = np.linalg.solve(across @ flat, across @ away)[..., 0]
        turns = Rotation.from_rotvec(step[:, :3]).as_matrix() @ turns
        scales = scales * np.exp(step[:, 3])
    shifts = middle[:, :2] - scales[:, None] * np.einsum("tij,tj->ti", turns[:, :2], centre)
    return Poses(turns, scales, shifts)


def _procrustes(theirs: Doubles, ours: Doubles, share: Doubles) -> tuple[Doubles, Doubles]:
    """Rotations (T, 3, 3) and scales (T,) from our centred points to theirs."""
    product = np.einsum("n,tni,tnj->tij", share, theirs, ours)
    left, values, right = np.linalg.svd(product)
    signs = np.ones_like(values)
    signs[:, 2] = np.sign(np.linalg.det(left @ right))
    turns = (left * signs[:, None]) @ right
    size = np.einsum("n,tni,tni->t", share, ours, ours)
    return turns, (values * signs).sum(axis=1) / size
