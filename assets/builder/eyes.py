"""Painted eyeballs on the best-fit spheres of the helper eyes; looks are rotations."""

from __future__ import annotations

import numpy as np

from assets.builder.geometry import bridge_rows, fan, fit_rigid, smoothstep
from assets.builder.parts import CHANNEL_COUNT, MATERIAL_INDEX, Part, make_part, srgb
from assets.builder.settings import EYES
from assets.builder.shapes import Eye, Face
from assets.builder.source import Floats, Ints


def build_eye(face: Face, eye: Eye) -> Part:
    """One eyeball."""
    directions = _directions()
    vertices = eye.centre + directions * eye.radius * EYES.radius
    deltas = np.zeros((CHANNEL_COUNT, len(vertices), 3))
    helper = face.neutral[eye.helper]
    for i, moved in enumerate(face.deltas[:, eye.helper]):
        if np.abs(moved).max() > EYES.moves_from:
            rotation = fit_rigid(helper, helper + moved)[:3, :3]
            deltas[i] = (vertices - eye.centre) @ (rotation.T - np.eye(3))
    faces, materials = _faces()
    return make_part(f"eye{eye.side}", vertices, faces, materials, _colors(), deltas)


def _directions() -> Floats:
    """(V, 3) unit vectors: the pole in front, then ring by ring."""
    angles = np.deg2rad([ring.angle for ring in EYES.rings[1:]])[:, None]
    around = np.arange(EYES.columns) * 2 * np.pi / EYES.columns
    ring = np.stack(
        [
            np.sin(angles) * np.cos(around),
            np.sin(angles) * np.sin(around),
            np.broadcast_to(np.cos(angles), (len(angles), EYES.columns)),
        ],
        axis=-1,
    )
    return np.concatenate([[[0.0, 0.0, 1.0]], ring.reshape(-1, 3)])


def _faces() -> tuple[Ints, Ints]:
    """Triangles (F, 3) and their materials (F,)."""
    cap = fan(0, 1 + np.arange(EYES.columns))
    bands = 1 + bridge_rows(len(EYES.rings) - 1, EYES.columns, closed=True)
    per_ring = [EYES.columns] + [2 * EYES.columns] * (len(EYES.rings) - 2)
    kinds = [MATERIAL_INDEX[ring.material] for ring in EYES.rings[:-1]]
    return np.concatenate([cap, bands]), np.repeat(kinds, per_ring)


def _colors() -> Floats:
    """(V, 3) sRGB."""
    streaks = np.random.default_rng(EYES.seed).uniform(*EYES.streaks, EYES.columns)[:, None]
    rings = [srgb(ring.color) * (1 + ring.streaks * (streaks - 1)) for ring in EYES.rings[1:]]
    colors = np.concatenate([[srgb(EYES.rings[0].color)], *rings])
    height = smoothstep(*EYES.lid_shade_from, _directions()[:, 1])
    return np.asarray(colors * (1 - EYES.lid_shade * height)[:, None])
