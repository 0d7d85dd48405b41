"""Draw one picture of the face, for `faceedit render`."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.arrays import Floats, Pixels
from faceedit_app.core.atomic import PNG, begins_with, write_keeping
from faceedit_app.core.head import Head
from faceedit_app.core.rig import Rig
from faceedit_app.render.camera import Camera, default_camera
from faceedit_app.render.renderer import open_renderer


def snapshot(
    rig: Rig,
    weights: Floats,
    width: int,
    height: int,
    camera: Camera | None = None,
    rotation: Floats | None = None,
) -> Pixels:
    """Draw one frame, antialiased.

    Args:
        rig: the character, with K channels.
        weights: (52,) in ARKit order, or (K,) in the rig's order if K is not 52.
        width, height: pixels.
        camera: the camera; None = a portrait from the front.
        rotation: yaw, pitch and roll of the head in radians; None = straight.

    Returns:
        (height, width, 3) uint8, RGB, top row first.

    Raises:
        Unavailable: this computer offers no OpenGL.
    """
    weights = np.asarray(weights, np.float32)
    if len(weights) == len(ARKIT_CHANNELS):
        weights = rig.from_arkit(weights)
    renderer = open_renderer(rig, width, height)
    try:
        vertices = rig.vertices(weights)
        if rotation is not None:
            vertices = Head(rig).turned(vertices, rotation)
        camera = camera or default_camera(rig, width / height)
        image = renderer.draw(vertices, camera, smooth=True)
        return np.ascontiguousarray(image[..., 2::-1])
    finally:
        renderer.close()


def write_png(path: Path | str, image: Pixels) -> Path | None:
    """Write (H, W, 3) uint8 RGB as PNG, completely or not at all.

    Returns:
        The copy that was kept of a file that was no PNG; None if there was none.

    Raises:
        FileError: the file cannot be written.
    """
    from PIL import Image

    buffer = io.BytesIO()
    Image.fromarray(image).save(buffer, "PNG")  # `optimize` takes 8 times as long for 9 %
    return write_keeping(path, buffer.getvalue(), begins_with(PNG))
