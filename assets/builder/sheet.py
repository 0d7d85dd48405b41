"""Draws the character in every shape, as the application shows it, for review."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.rig import Rig
from faceedit_app.render import Camera, open_renderer
from faceedit_app.render.snapshot import write_png

_COLUMNS = 8
_CELL = (300, 340)  # pixels: width, height
_CAPTION = 22  # pixels
_CAPTION_SIZE = 14
_INK, _PAPER = (225, 228, 235), (30, 32, 38)
_SIDES = ("Left", "Right")
_VIEW = Camera(distance=0.72, target=(0.0, 0.012, -0.012))


@dataclass(frozen=True)
class Cell:
    """One picture: its caption, its weights, and how far the head is turned (degrees)."""

    caption: str
    weights: dict[str, float] = field(default_factory=dict)
    turned: float = 0.0


def _both(**stems: float) -> dict[str, float]:
    return {stem + side: weight for stem, weight in stems.items() for side in _SIDES}


VIEWS = (Cell("neutral"), Cell("three-quarter", turned=35), Cell("profile", turned=90))
COMBINATIONS = (
    Cell("blink", _both(eyeBlink=1)),
    Cell("smile", _both(mouthSmile=0.9, cheekSquint=0.4)),
    Cell("laugh", {"jawOpen": 0.3, **_both(mouthSmile=0.8, eyeSquint=0.4, mouthUpperUp=0.3)}),
    Cell("frown + brow down", _both(mouthFrown=1, browDown=1)),
    Cell("teeth", _both(mouthUpperUp=1, mouthLowerDown=1)),
    Cell("roll, both lips", {"mouthRollUpper": 1, "mouthRollLower": 1}),
    Cell("press", _both(mouthPress=1)),
    Cell("surprise", {"jawOpen": 0.5, "browInnerUp": 1, **_both(eyeWide=1, browOuterUp=1)}),
    Cell("jawOpen + mouthClose", {"jawOpen": 1, "mouthClose": 1}),
)


def cells() -> list[Cell]:
    """Everything on the sheet, in reading order."""
    shapes = [Cell(channel, {channel: 1.0}) for channel in ARKIT_CHANNELS]
    return [*VIEWS, *shapes, *COMBINATIONS]


def draw_sheet(rig: Rig, path: Path) -> None:
    """Write the sheet as PNG.

    Raises:
        Unavailable: this computer offers no OpenGL.
    """
    width, height = _CELL
    pictures = cells()
    rows = math.ceil(len(pictures) / _COLUMNS)
    sheet = Image.new("RGB", (_COLUMNS * width, rows * (height + _CAPTION)), _PAPER)
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(_CAPTION_SIZE)
    renderer = open_renderer(rig, width, height)
    try:
        for i, cell in enumerate(pictures):
            x, y = i % _COLUMNS * width, i // _COLUMNS * (height + _CAPTION)
            weights = np.array([cell.weights.get(name, 0.0) for name in rig.channels], np.float32)
            camera = _VIEW.orbit(math.radians(cell.turned), 0.0)
            image = renderer.draw(rig.vertices(weights), camera)
            sheet.paste(Image.fromarray(image[..., 2::-1].copy()), (x, y + _CAPTION))
            draw.text((x + 8, y + 3), cell.caption, fill=_INK, font=font)
    finally:
        renderer.close()
    write_png(path, np.asarray(sheet))
