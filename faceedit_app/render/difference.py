"""Tint a face by its distance from another: the colours, in numpy."""

from __future__ import annotations

import numpy as np

from faceedit_app.core.arrays import Floats
from faceedit_app.core.rig import MILLIMETRES, Rig

FULL = 4.0  # mm from the other face; the distance of the full tint
# Violet, linear RGB: darker than skin, bluer than lips, and unlike the window's own colours.
COLOUR = (0.15, 0.04, 0.55)


def tint_of(vertices: Floats, others: Floats) -> Floats:
    """The tint of each vertex, (V,) float32: 0 where both faces agree, 1 from `FULL` on.

    Args:
        vertices, others: (V, 3) float32, metres, of the same character.
    """
    apart = vertices - others
    apart *= np.float32(MILLIMETRES / FULL)
    lengths: Floats = np.sqrt(np.einsum("vx,vx->v", apart, apart))
    return np.minimum(lengths, np.float32(1.0), out=lengths)


class Tinter:
    """Computes the colours of a tinted character.

    Args:
        colors: (V, 4) float32 in 0..1, linear RGB and alpha.
    """

    def __init__(self, colors: Floats) -> None:
        # Interpolating square roots gives visually even steps; with linear values the first half
        # of the way from light skin to a dark colour would hardly show.
        self._plain = np.sqrt(colors)
        self._way = np.sqrt(np.array([*COLOUR, 1.0], np.float32)) - self._plain
        self._way[:, 3] = 0.0

    def __call__(self, tint: Floats) -> Floats:
        """Colours (V, 4) float32 for a `tint` (V,) in 0..1."""
        mixed: Floats = self._way * tint[:, None]
        mixed += self._plain
        mixed *= mixed
        return mixed


def ramp(rig: Rig, steps: int) -> Floats:
    """The colours of tinted skin, (steps, 3) float32, sRGB in 0..1, from no tint to full."""
    skin = [rig.faces[m.start : m.stop] for m in rig.materials if "skin" in m.name.casefold()]
    vertices = np.unique(np.concatenate(skin) if skin else rig.faces)
    colors = np.tile(np.median(rig.colors[vertices], axis=0), (steps, 1)).astype(np.float32)
    tinted = Tinter(colors)(np.linspace(0.0, 1.0, steps, dtype=np.float32))[:, :3]
    low = tinted <= 0.0031308
    srgb: Floats = np.where(low, 12.92 * tinted, 1.055 * tinted ** (1 / 2.4) - 0.055)
    return np.clip(srgb, 0.0, 1.0)
