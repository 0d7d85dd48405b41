"""Painted eyeballs on the best-fit spheres of the helper eyes, and what is wet around them.

Looks are rotations.
"""

from __future__ import annotations

import numpy as np
import trimesh

from assets.builder.geometry import Surface, bridge_rows, fan, fit_rigid, smoothstep
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
    random = np.random.default_rng(EYES.seed)
    fibres = random.uniform(*EYES.streaks, EYES.columns)[:, None]
    around = np.arange(EYES.columns) * 2 * np.pi / EYES.columns
    lit = np.stack([np.cos(around), np.sin(around)], axis=1) @ EYES.glow_from
    glow = 1 + EYES.glow * np.clip(lit, -0.5, 1)[:, None]
    rings = [srgb(ring.color) * (1 + ring.streaks * (fibres * glow - 1)) for ring in EYES.rings[1:]]
    colors = np.concatenate([[srgb(EYES.rings[0].color)], *rings])
    x, y, _ = _directions().T
    lid = EYES.lid_shade * smoothstep(*EYES.lid_shade_from, y)
    corner = EYES.corner_shade * smoothstep(*EYES.corner_shade_from, np.abs(x))
    shade = 1 - (1 - lid) * (1 - corner)
    return np.asarray(colors * (1 - shade[:, None] * EYES.shade_tint))


def build_wet(face: Face, eye: Eye, skin: Part, surface: Surface) -> list[Part]:
    """The wet edge of the lower lid and the caruncle, the pink flesh in the inner corner."""
    anchors = surface.anchor(face.neutral[eye.lower[1]])
    motion = anchors.read(skin.deltas)
    return [_tear_line(face, eye, motion), _caruncle(face, eye, motion[:, :1])]


def _tear_line(face: Face, eye: Eye, motion: Floats) -> Part:
    inner, edge = eye.lower[0], eye.lower[1]
    low = face.neutral[inner] + (face.neutral[edge] - face.neutral[inner]) * EYES.tear_width
    low[:, 1] += EYES.tear_lift
    out = trimesh.unitize(face.neutral[inner] + [0, EYES.tear_climb, 0] - eye.centre)
    high = eye.centre + out * (eye.radius * EYES.radius + EYES.tear_lift)
    faces = bridge_rows(2, len(inner), closed=False)
    return make_part(
        f"tears{eye.side}",
        np.concatenate([high, low]),
        faces if eye.side == "Left" else faces[:, ::-1],
        "tears",
        srgb(EYES.tear_color),
        np.concatenate([motion, motion], axis=1),
    )


def _caruncle(face: Face, eye: Eye, motion: Floats) -> Part:
    rows, columns = EYES.caruncle_grid
    outwards = 1.0 if eye.side == "Left" else -1.0
    tilt = np.pi * (np.arange(rows) + 0.5)[:, None] / rows
    turn = np.arange(columns) * 2 * np.pi / columns
    ball = np.stack(
        np.broadcast_arrays(np.sin(tilt) * np.cos(turn), np.cos(tilt), np.sin(tilt) * np.sin(turn)),
        axis=-1,
    ).reshape(-1, 3)
    corner = eye.lower[1][0]
    centre = face.neutral[corner] + np.array(EYES.caruncle_shift) * [outwards, 1, 1]
    return make_part(
        f"caruncle{eye.side}",
        centre + ball * EYES.caruncle_radii,
        bridge_rows(rows, columns, closed=True)[:, ::-1],
        "tears",
        srgb(EYES.caruncle_color),
        np.repeat(motion, len(ball), axis=1),
    )
