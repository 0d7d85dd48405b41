"""The plainest character on which the controls can be edited, and takes to edit."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.clip import Clip, Gap
from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX, control_named
from faceedit_app.core.rig import Material, Rig
from faceedit_app.editing.opening import open_session
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.take import Take
from support.takes import NoFile

# By control, its distance at rest in mm, and the mm that a channel at weight 1 adds to it.
_MOVES: dict[str, tuple[float, dict[str, float]]] = {
    "mouth_opening": (2.0, {"jawOpen": 40.0, "mouthClose": -20.0}),
    "mouth_width": (
        45.0,
        {"mouthStretchLeft": 10.0, "mouthStretchRight": 10.0, "mouthPucker": -20.0},
    ),
    "left_corner": (28.0, {"mouthSmileLeft": 12.0, "mouthFrownLeft": -6.0}),
    "right_corner": (28.0, {"mouthSmileRight": 12.0, "mouthFrownRight": -6.0}),
    "upper_lip": (
        50.0,
        {"mouthUpperUpLeft": -4.0, "mouthUpperUpRight": -4.0, "mouthRollUpper": 6.0},
    ),
    "lower_lip": (
        20.0,
        {"mouthLowerDownLeft": -4.0, "mouthLowerDownRight": -4.0, "mouthRollLower": 6.0},
    ),
    "left_eyelid": (10.0, {"eyeBlinkLeft": -9.0, "eyeWideLeft": 3.0}),
    "right_eyelid": (10.0, {"eyeBlinkRight": -9.0, "eyeWideRight": 3.0}),
    "left_brow": (27.0, {"browDownLeft": -6.0, "browOuterUpLeft": 2.0, "browInnerUp": 2.0}),
    "right_brow": (27.0, {"browDownRight": -6.0, "browOuterUpRight": 2.0, "browInnerUp": 2.0}),
    "jaw_side": (0.0, {"jawLeft": 6.0, "jawRight": -6.0}),
}


def tiny_rig() -> Rig:
    """Pairs of vertices, each moved along one axis, up or sideways, by a few channels.

    A control that `_MOVES` does not name is missing.
    """
    count = 2 * len(_MOVES)
    neutral = np.zeros((count, 3), np.float32)
    deltas = np.zeros((len(ARKIT_CHANNELS), count, 3), np.float32)
    pairs = np.full((len(CONTROL_IDS), 2), -1, np.int32)
    for place, (control, (rest, moves)) in enumerate(_MOVES.items()):
        first, second = pairs[CONTROL_INDEX[control]] = 2 * place, 2 * place + 1
        neutral[first] = (0.02 * place, 0.0, 0.0)
        neutral[second] = (0.02 * place, rest / 1000, 0.0)
        for channel, millimetres in moves.items():
            axis = 0 if control_named(control).sideways else 1
            deltas[ARKIT_CHANNELS.index(channel), second, axis] = millimetres / 1000
    return Rig(
        neutral=neutral,
        faces=np.array([[0, 1, 2]], np.int32),
        channels=ARKIT_CHANNELS,
        deltas=deltas,
        colors=np.ones((count, 4), np.float32),
        materials=(Material("skin", 0, 1),),
        control_pairs=pairs,
    )


def tiny_take(frames: int = 200, rate: float = 50.0, gaps: tuple[Gap, ...] = ()) -> Take:
    """A mouth that opens and closes, and eyes half open."""
    times = np.arange(frames) / rate
    for gap in gaps:
        times[gap.frame + 1 :] += gap.missing / rate
    weights = np.zeros((frames, len(ARKIT_CHANNELS)), np.float32)
    wave = 0.5 - 0.5 * np.cos(2 * np.pi * times)
    weights[:, ARKIT_CHANNELS.index("jawOpen")] = 0.4 * wave
    for channel in ("mouthPucker", "mouthSmileLeft", "mouthSmileRight"):
        weights[:, ARKIT_CHANNELS.index(channel)] = 0.3 * wave[::-1]
    for channel in ("eyeBlinkLeft", "eyeBlinkRight", "mouthRollLower", "mouthUpperUpLeft"):
        weights[:, ARKIT_CHANNELS.index(channel)] = 0.3
    clip = Clip(weights, ARKIT_CHANNELS, times, rate, gaps)
    return Take(Path("tiny.csv"), "Test", clip, (), (), NoFile())


def tiny_session(frames: int = 200, gaps: tuple[Gap, ...] = ()) -> EditSession:
    """The tiny take on the tiny rig, edited without networks."""
    return open_session(tiny_take(frames, gaps=gaps), tiny_rig())


def ball(rows: int = 24, columns: int = 32) -> Rig:
    """A ball of 8 cm with a mouth: `jawOpen` lowers its front below the middle."""
    latitude = np.linspace(0.0, np.pi, rows)
    longitude = np.linspace(0.0, 2.0 * np.pi, columns, endpoint=False)
    lat, lon = (g.ravel() for g in np.meshgrid(latitude, longitude, indexing="ij"))
    points = np.stack((np.sin(lat) * np.sin(lon), np.cos(lat), np.sin(lat) * np.cos(lon)), axis=1)
    faces = []
    for r in range(rows - 1):
        for c in range(columns):
            a, b = r * columns + c, r * columns + (c + 1) % columns
            faces += [(a, a + columns, b), (b, a + columns, b + columns)]
    vertices = (0.08 * points).astype(np.float32)
    jaw = np.zeros_like(vertices)
    front = (points[:, 2] > 0.5) & (np.abs(points[:, 1] + 0.35) < 0.3)
    jaw[front] = 0.0, -0.02, -0.015
    return Rig(
        neutral=vertices,
        faces=np.array(faces, np.int32),
        channels=("jawOpen",),
        deltas=jaw[None],
        colors=np.tile(np.array([0.5, 0.3, 0.2, 1.0], np.float32), (len(vertices), 1)),
        materials=(Material("skin", 0, len(faces)),),
        control_pairs=np.tile(np.array([0, 1], np.int32), (len(CONTROL_IDS), 1)),
    )
