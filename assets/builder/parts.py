"""A part of the character, and what is shared by the modules that build parts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from assets.builder.settings import MATERIALS
from assets.builder.source import Floats, Ints
from faceedit_app.core.arkit import ARKIT_CHANNELS

MATERIAL_INDEX = {name: i for i, name in enumerate(MATERIALS)}
CHANNEL_COUNT = len(ARKIT_CHANNELS)


@dataclass(frozen=True)
class Part:
    """A mesh with its own vertices.

    Attributes:
        name: for messages.
        vertices: (V, 3) mm.
        deltas: (52, V, 3) mm.
        faces: (F, 3).
        materials: (F,) indices into `MATERIALS`.
        colors: (V, 3) sRGB, 0..1.
        base_index: (V,) the base-mesh vertex that each vertex is, or -1.
        cover: (V,) 0..1, how much it hides of what is behind it.
    """

    name: str
    vertices: Floats
    deltas: Floats
    faces: Ints
    materials: Ints
    colors: Floats
    base_index: Ints
    cover: Floats


def make_part(
    name: str,
    vertices: Floats,
    faces: Ints,
    material: str | NDArray[np.int64],
    color: Floats,
    deltas: Floats | None = None,
    base_index: Ints | None = None,
    cover: Floats | None = None,
) -> Part:
    """A part; one material, one colour, no motion and full cover are spread over all of it."""
    count = len(vertices)
    kind = MATERIAL_INDEX[material] if isinstance(material, str) else material
    return Part(
        name,
        vertices,
        np.zeros((CHANNEL_COUNT, count, 3)) if deltas is None else deltas,
        faces,
        np.array(np.broadcast_to(kind, len(faces))),
        np.clip(np.broadcast_to(color, (count, 3)), 0, 1),
        np.full(count, -1) if base_index is None else base_index,
        np.ones(count) if cover is None else cover,
    )


def settled(deltas: Floats, least: float) -> Floats:
    """Displacements (52, V, 3) without those of vertices that no channel moves by `least` mm.

    What stands still is drawn once for many pictures.
    """
    moves = np.linalg.norm(deltas, axis=2).max(0) >= least
    return np.asarray(deltas * moves[:, None])


def srgb(hexadecimal: str) -> Floats:
    """`rrggbb` as (3,) numbers in 0..1."""
    return np.frombuffer(bytes.fromhex(hexadecimal), np.uint8) / 255.0


def table(rows: tuple[tuple[float, float], ...], x: Floats) -> Floats:
    """Linear interpolation in a table of (x, y)."""
    points, values = np.array(rows, np.float64).T
    return np.asarray(np.interp(x, points, values))
