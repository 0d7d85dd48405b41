"""Films of the shipped character, whose weights are known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.lab.evaluation.film_file import write_film
from faceedit_app.render.camera import default_camera
from faceedit_app.render.renderer import open_renderer
from support.faces import shipped_rig

SIZE = 320
RATE = 25.0
# Pictures of faces, by where they are seen from, their size, and the bytes of their weights.
_drawn: dict[tuple[float, int, bytes], NDArray[np.uint8]] = {}


def speaking(frames: int = 40) -> NDArray[np.float32]:
    """(T, 52) weights: the mouth opens three times and shuts between, the eyes blink once."""
    weights = np.zeros((frames, len(ARKIT_INDEX)), np.float32)
    phase = np.linspace(0.0, 3 * np.pi, frames)
    weights[:, ARKIT_INDEX["jawOpen"]] = 0.45 * np.maximum(np.sin(phase), 0.0) ** 2
    weights[:, ARKIT_INDEX["jawOpen"]] += 0.35 * np.maximum(-np.sin(phase), 0.0) ** 2
    middle = frames // 2
    for offset, blink in ((-2, 0.4), (-1, 1.0), (0, 1.0), (1, 0.5)):
        for side in ("Left", "Right"):
            weights[middle + offset, ARKIT_INDEX[f"eyeBlink{side}"]] = blink
    return weights


def face_pictures(
    weights: NDArray[np.float32], yaw: float = 0.0, size: int = SIZE
) -> list[NDArray[np.uint8]]:
    """(size, size, 3) RGB pictures of the character, seen from `yaw` radians to its left."""
    return turning_pictures([(row, yaw) for row in weights], size)


def turning_pictures(
    faces: Sequence[tuple[NDArray[np.float32], float]], size: int = SIZE
) -> list[NDArray[np.uint8]]:
    """(size, size, 3) RGB pictures of the character, by its weights and where it is seen from.

    Faces that come again, in one film or several, are drawn once.
    """
    rig, wanted = shipped_rig(), [(yaw, size, row.tobytes()) for row, yaw in faces]
    new = {key: face for key, face in zip(wanted, faces, strict=True) if key not in _drawn}
    if new:
        renderer = open_renderer(rig, size, size)
        try:
            for key, (row, yaw) in new.items():
                camera = replace(default_camera(rig), yaw=yaw)
                picture = renderer.draw(rig.vertices(rig.from_arkit(row)), camera)
                _drawn[key] = np.ascontiguousarray(picture[..., 2::-1])
        finally:
            renderer.close()
    return [_drawn[key].copy() for key in wanted]


def make_face_film(
    path: Path,
    pictures: Sequence[NDArray[np.uint8]],
    times: Sequence[float] | None = None,
    rate: float = RATE,
) -> Path:
    """A film of pictures, at a steady rate or at times in seconds."""
    shown = np.arange(len(pictures)) / rate if times is None else np.array(times)
    write_film(path, pictures, shown, rate)
    return path
