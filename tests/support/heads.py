"""A small head whose shapes and points are known: a curved sheet with a mouth and two eyes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.arrays import Doubles

MOUTH, HALF_MOUTH = -66.0, 22.0  # mm: height of the lips, and how far the corners are out
EYE, EYE_WIDTH, EYE_HEIGHT = 31.5, 15.0, 4.5
BROW = 18.0  # mm above the eyes
STEP = 3.0
JAW = 24.0  # mm that jawOpen lowers the lower lip


@dataclass(frozen=True)
class Head:
    """A head in millimetres, between the eyes at 0: Y up, Z forward, X its own left.

    Attributes:
        vertices: (V, 3).
        faces: (F, 3), counter-clockwise from outside.
        targets: (V, 3) each, by ARKit channel.
        uv: (V, 2), (0, 0) at the upper left.
        points: where control points are, (3,) each; some exactly, some within a step.
    """

    vertices: Doubles
    faces: np.ndarray
    targets: Mapping[str, Doubles]
    uv: Doubles
    points: Mapping[str, Doubles]


def _depth(x: Doubles, y: Doubles) -> Doubles:
    """How far forward the sheet is: a forehead, a nose, lips and a chin."""
    face = -0.006 * x**2 - 0.0012 * (y + 30) ** 2
    nose = 16 * np.exp(-(x**2) / 60 - (y + 28) ** 2 / 160)
    lips = 5 * np.exp(-(x**2) / 300 - (y - MOUTH) ** 2 / 60)
    chin = 6 * np.exp(-(x**2) / 200 - (y - MOUTH + 27) ** 2 / 60)
    depth: Doubles = face + nose + lips + chin
    return depth


@lru_cache(maxsize=1)
def small_head() -> Head:
    """The head; about 3,000 vertices."""
    columns = np.arange(-66, 66.1, STEP)
    rows = np.concatenate((np.arange(57, MOUTH - 0.1, -STEP), np.arange(MOUTH, -117.1, -STEP)))
    lip = int(np.flatnonzero(rows == MOUTH)[0])  # of two rows in one place, the upper
    x, y = (grid.ravel() for grid in np.meshgrid(columns, rows))
    width = len(columns)
    number = np.arange(len(x)).reshape(len(rows), width)
    # Beyond the mouth corners the two rows are one.
    outside = np.abs(columns) >= HALF_MOUTH - 0.5
    number[lip + 1, outside] = number[lip, outside]
    quads = []
    for i in range(len(rows) - 1):
        if i == lip:
            continue  # between the lips there is nothing
        for j in range(width - 1):
            middle = (columns[j] + columns[j + 1]) / 2, (rows[i] + rows[i + 1]) / 2
            if not _in_eye(*middle):
                quads.append(
                    (number[i, j], number[i + 1, j], number[i + 1, j + 1], number[i, j + 1])
                )
    corners = np.array(quads)
    faces = np.concatenate((corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]))
    used, faces = np.unique(faces, return_inverse=True)
    faces = faces.reshape(-1, 3)
    x, y = x[used], y[used]
    upper = used < (lip + 1) * width
    x, y = (
        x + 0.0,
        y + np.where((y == MOUTH) & (np.abs(x) < HALF_MOUTH - 0.5), np.where(upper, 0.2, -0.2), 0),
    )
    vertices = np.stack((x, y, _depth(x, y)), axis=1)
    uv = np.stack(((x + 66) / 132, (57 - y) / 174), axis=1)
    lower = ~upper
    return Head(vertices, faces, _targets(vertices, lower), uv, _points(vertices, lower))


def _in_eye(x: float, y: float) -> bool:
    return ((abs(x) - EYE) / EYE_WIDTH) ** 2 + (y / EYE_HEIGHT) ** 2 < 1


def _bump(v: Doubles, x: float, y: float, size: float) -> Doubles:
    """(V,) 1 at a place and 0 far from it."""
    bump: Doubles = np.exp(-((v[:, 0] - x) ** 2 + (v[:, 1] - y) ** 2) / (2 * size**2))
    return np.where(bump < 0.02, 0.0, bump)


def _targets(v: Doubles, lower: np.ndarray) -> dict[str, Doubles]:
    x, y = v[:, 0], v[:, 1]
    narrow = np.clip(1 - (x / 60) ** 2, 0, 1)
    across = np.clip(1 - (x / HALF_MOUTH) ** 2, 0, 1) * narrow
    below = np.where(lower, np.exp(-(np.clip(y - MOUTH, -60, 0) ** 2) / 5000), 0.0)
    jaw = below * np.maximum(
        across, np.clip((MOUTH - 6 - y) / 30, 0, 1) * np.clip(1 - (x / 60) ** 2, 0, 1)
    )
    near_lip = jaw * np.exp(-((y - MOUTH) ** 2) / 60)
    near = _bump(v, 0, MOUTH, 14)
    up = np.where(lower, 0.0, 1.0)

    def move(
        dx: Doubles | float = 0.0, dy: Doubles | float = 0.0, dz: Doubles | float = 0.0
    ) -> Doubles:
        return np.stack([np.broadcast_to(np.asarray(d, float), x.shape) for d in (dx, dy, dz)], 1)

    targets = {
        "jawOpen": move(dy=-JAW * jaw, dz=-4 * jaw),
        "mouthClose": move(dy=JAW * near_lip, dz=4 * near_lip),
        "mouthPucker": move(dx=-0.35 * x * near, dz=6 * near),
        "mouthFunnel": move(dy=np.where(lower, -3.0, 3.0) * near * across, dz=5 * near),
        "mouthRollUpper": move(dy=-1.5 * near * up * across, dz=-3 * near * up),
        "mouthRollLower": move(dy=1.5 * near * (1 - up) * across, dz=-3 * near * (1 - up)),
        "browInnerUp": move(dy=4 * (_bump(v, 24, BROW, 8) + _bump(v, -24, BROW, 8))),
    }
    for side, s in (("Left", 1.0), ("Right", -1.0)):
        corner = _bump(v, s * HALF_MOUTH, MOUTH, 9)
        half = np.clip(0.5 + s * x / 12, 0, 1)
        eye = _bump(v, s * EYE, 0, 13)
        top = np.clip((y + 1) / 3, 0, 1) * np.clip((16 - y) / 8, 0, 1)
        brow = _bump(v, s * 30, BROW, 9)
        inside = np.clip(1 - ((x - s * EYE) / (EYE_WIDTH + 1)) ** 2, 0, 1)
        lid = top * np.sqrt(inside)
        targets |= {
            f"mouthSmile{side}": move(dx=s * 6 * corner, dy=5 * corner),
            f"mouthFrown{side}": move(dy=-5 * corner),
            f"mouthStretch{side}": move(dx=s * 5 * corner, dy=-2 * corner),
            f"mouthUpperUp{side}": move(dy=4 * near * up * half * across),
            f"mouthLowerDown{side}": move(dy=-4 * near * (1 - up) * half * across),
            f"mouthPress{side}": move(dz=-2 * corner),
            f"eyeBlink{side}": move(dy=-2 * EYE_HEIGHT * lid, dz=0.5 * lid),
            f"eyeWide{side}": move(dy=2 * lid),
            f"eyeSquint{side}": move(dy=2 * eye * (1 - top)),
            f"browDown{side}": move(dx=-s * 2 * brow, dy=-5 * brow),
            f"browOuterUp{side}": move(dy=4 * _bump(v, s * 36, BROW, 8)),
            f"jaw{side}": move(dx=s * 5 * jaw),
        }
    places = {
        "cheek": (42, -34),
        "nose": (8, -34),
        "eye": (EYE, -8),
        "jaw": (0, -95),
    }
    for channel in ARKIT_CHANNELS:
        if channel not in targets:
            sign = -1.0 if channel.endswith("Right") else 1.0
            word = next((w for w in places if channel.startswith(w)), "mouth")
            px, py = places.get(word, (0, MOUTH))
            spot = _bump(v, sign * px, py, 9)
            targets[channel] = move(dx=sign * 2 * spot, dy=2 * spot, dz=spot)
    return {channel: targets[channel] for channel in ARKIT_CHANNELS}


def _points(v: Doubles, lower: np.ndarray) -> dict[str, Doubles]:
    def nearest(x: float, y: float, of: np.ndarray | None = None) -> Doubles:
        far = (v[:, 0] - x) ** 2 + (v[:, 1] - y) ** 2
        place: Doubles = v[np.where(True if of is None else of, far, np.inf).argmin()]
        return place

    return {
        "inner_upper_lip": nearest(0, MOUTH + 0.2, ~lower),
        "inner_lower_lip": nearest(0, MOUTH - 0.2, lower),
        "left_mouth_corner": nearest(HALF_MOUTH, MOUTH),
        "right_mouth_corner": nearest(-HALF_MOUTH, MOUTH),
        "left_upper_lid": nearest(EYE, EYE_HEIGHT),
        "left_lower_lid": nearest(EYE, -EYE_HEIGHT),
        "right_upper_lid": nearest(-EYE, EYE_HEIGHT),
        "right_lower_lid": nearest(-EYE, -EYE_HEIGHT),
        "chin": nearest(0, MOUTH - 27),
        "left_eye_corner": nearest(EYE - EYE_WIDTH, 0),
        "right_eye_corner": nearest(-EYE + EYE_WIDTH, 0),
        "left_brow": nearest(30, BROW),
        "right_brow": nearest(-30, BROW),
    }
