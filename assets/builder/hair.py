"""Hair combed back from the hairline to a bun, with fine strands that soften its edge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh
from scipy.interpolate import PchipInterpolator

from assets.builder import source as src
from assets.builder.geometry import (
    Surface,
    bridge_rows,
    cast_outermost,
    fan,
    mesh_of,
    smoothstep,
)
from assets.builder.parts import CHANNEL_COUNT, Part, make_part, settled, srgb, table
from assets.builder.settings import COLOUR, HAIR
from assets.builder.shapes import Face
from assets.builder.skin import head_faces
from assets.builder.source import Floats

_EAR = 0.35  # mask value from which a vertex belongs to an ear


def _spherical(azimuth: Floats, elevation: Floats) -> Floats:
    """Unit vectors (..., 3); azimuth 0 looks forward, both in radians."""
    flat = np.cos(elevation)
    parts = np.sin(azimuth) * flat, np.sin(elevation), np.cos(azimuth) * flat
    return np.stack(np.broadcast_arrays(*parts), axis=-1)


def _round_mean(values: Floats) -> Floats:
    """Average each of (C,) values on a closed ring with its two neighbours."""
    return np.asarray(0.25 * np.roll(values, 1) + 0.5 * values + 0.25 * np.roll(values, -1))


@dataclass(frozen=True)
class Hairline:
    """Where the hair begins, seen from a centre inside the skull.

    Attributes:
        centre: (3,) mm.
        skull: the head without the ears, mm.
        azimuths, elevations: (C,) radians of the line, column by column around the head.
    """

    centre: Floats
    skull: trimesh.Trimesh
    azimuths: Floats
    elevations: Floats

    def reach(self, directions: Floats) -> Floats:
        """Distance (R,) from the centre to the skull; gaps are filled around the head."""
        distance = cast_outermost(self.skull, self.centre, directions)
        gaps = np.isnan(distance)
        column = np.arange(len(distance))
        distance[gaps] = np.interp(
            column[gaps], column[~gaps], distance[~gaps], period=len(distance)
        )
        return distance

    def elevation(self, azimuths: Floats) -> Floats:
        """The line's elevation at any azimuth, radians."""
        return np.interp(azimuths, self.azimuths, self.elevations, period=2 * np.pi)

    def divided(self, columns: int) -> Hairline:
        """The same line in more columns."""
        azimuths = np.arange(columns) * 2 * np.pi / columns
        return Hairline(self.centre, self.skull, azimuths, self.elevation(azimuths))

    def above(self, points: Floats) -> Floats:
        """How far points (P, 3) lie above the line, radians."""
        x, y, z = (points - self.centre).T
        return np.asarray(np.arctan2(y, np.hypot(x, z)) - self.elevation(np.arctan2(x, z)))


def find_hairline(face: Face) -> Hairline:
    """Cast the tuned heights of the hairline onto the skull."""
    skin, eye_height = face.skin, face.eye_height
    ear = face.ears[src.BODY] > _EAR
    ear_top = skin[ear, 1].max()
    ear_middle = skin[ear & (skin[:, 0] > 0)].mean(0)
    centre = np.array([0, eye_height + HAIR.centre_up, ear_middle[2] + HAIR.centre_forward])
    faces = head_faces(face)
    above = skin[faces][:, :, 1].min(1) > eye_height - HAIR.skull_below
    skull = mesh_of(skin, faces[~ear[faces].any(1) & above])

    azimuths = np.arange(HAIR.columns) * 2 * np.pi / HAIR.columns
    knots = [
        (angle, reference + height)
        for rows, reference in (
            (HAIR.line_over_eyes, eye_height),
            (HAIR.line_over_ear_top, ear_top),
            (HAIR.line_over_ear_middle, ear_middle[1]),
        )
        for angle, height in rows
    ]
    degrees = np.rad2deg(np.minimum(azimuths, 2 * np.pi - azimuths))
    heights = PchipInterpolator(*np.array(knots).T)(degrees)
    jitter = np.random.default_rng(HAIR.seed).uniform(-1, 1, HAIR.columns)
    heights = heights + HAIR.line_jitter * jitter
    scan = np.deg2rad(np.linspace(*HAIR.scan))
    rays = _spherical(azimuths[:, None], scan).reshape(-1, 3)
    distances = cast_outermost(skull, centre, rays).reshape(len(azimuths), -1)
    elevations = np.zeros(HAIR.columns)
    for i, distance in enumerate(distances):
        hit = ~np.isnan(distance)
        reached = centre[1] + distance[hit] * np.sin(scan[hit])
        order = np.argsort(reached)
        elevations[i] = np.interp(heights[i], reached[order], scan[hit][order])
    elevations = (elevations + np.roll(elevations[::-1], 1)) / 2  # the same on both sides
    return Hairline(centre, skull, azimuths, _round_mean(elevations))


def above_hairline(face: Face, line: Hairline) -> Floats:
    """(13380,) radians above the hairline; negative on the ears and below the head."""
    ear = face.ears[src.BODY] > _EAR
    below = face.skin[:, 1] < face.eye_height - HAIR.skull_below
    return np.where(ear | below, -0.5, line.above(face.skin))


def build_hair(line: Hairline, skin: Part, surface: Surface) -> list[Part]:
    """The combed cap, the bun and the wisps."""
    random = np.random.default_rng(HAIR.seed)
    line = line.divided(HAIR.cap_columns)
    pole = _spherical(np.array(np.pi), np.deg2rad(HAIR.pole))
    shade = random.uniform(*HAIR.shade, HAIR.cap_columns)
    cap, crown = _cap(line, pole, shade, skin, surface)
    return [
        cap,
        _bun(line.centre + pole * (crown + HAIR.bun_out), pole),
        _wisps(line, skin, surface),
    ]


def _cap(
    line: Hairline, pole: Floats, shade: Floats, skin: Part, surface: Surface
) -> tuple[Part, float]:
    """The cap, and the skull's distance from the centre at the pole, mm."""
    start = _spherical(line.azimuths, line.elevations)
    angle = np.arccos(np.clip(start @ pole, -1, 1))[:, None]
    locks = _locks(line.azimuths)
    rows, colors, reaches = [], [], []
    middle, decrease = HAIR.middle_shade
    for i, share in enumerate(HAIR.rings):
        along = np.sin((1 - share) * angle) * start + np.sin(share * angle) * pole
        direction = along / np.sin(angle)
        reach = line.reach(direction)
        for _ in range(HAIR.smoothing if i > 2 else 0):
            reach = _round_mean(reach)
        reaches.append(reach)
        thickness = table(HAIR.thickness, np.array([share]))
        lock = locks * smoothstep(*HAIR.locks_from, share)
        rows.append(line.centre + direction * (reaches[-1] + thickness + lock)[:, None])
        bright = shade * (1 + HAIR.lock_shade * lock) * (middle - decrease * abs(share - 0.5))
        colors.append(_on_scalp(bright, float(table(HAIR.scalp, np.array(share)))))
    crown = float(reaches[-1].mean())
    top = line.centre + pole * (crown + HAIR.thickness[-1][1])
    vertices = np.concatenate([*rows, [top]])
    rings = len(HAIR.rings)
    last = (rings - 1) * HAIR.cap_columns + np.arange(HAIR.cap_columns)
    faces = np.concatenate(
        [bridge_rows(rings, HAIR.cap_columns, closed=True)[:, ::-1], fan(len(vertices) - 1, last)]
    )
    fade = np.r_[np.repeat(np.exp(-np.array(HAIR.rings) / HAIR.move_fade), HAIR.cap_columns), 0]
    deltas = surface.anchor(vertices).read(skin.deltas) * fade[:, None]
    color = np.concatenate([*colors, [srgb(HAIR.color)]])
    aside = np.abs((np.rad2deg(line.azimuths) + 180) % 360 - 180)
    cover = np.maximum.outer(
        table(HAIR.cover, np.array(HAIR.rings)), smoothstep(*HAIR.cover_span, aside)
    )
    cap = make_part(
        "hair",
        vertices,
        faces,
        "hair",
        color,
        settled(deltas, HAIR.moves_from),
        cover=np.r_[cover.ravel(), 1],
    )
    return cap, crown


def _locks(azimuths: Floats) -> Floats:
    """How high the locks stand over the cap, (C,) mm: uneven waves around the head."""
    random = np.random.default_rng(HAIR.seed + 1)
    height = np.zeros_like(azimuths)
    for waves, amplitude in HAIR.locks:
        phase, sway = random.uniform(0, 2 * np.pi, 2)
        wave = np.sin(waves * azimuths + phase + 1.5 * np.sin(2 * azimuths + sway))
        height += amplitude * (2 * np.abs(wave) ** 0.8 - 1)  # round ridges, narrow furrows
    return height


def _on_scalp(bright: Floats, scalp: Floats | float) -> Floats:
    """Colours (..., 3), sRGB, of hair of a brightness, through which so much scalp shows."""
    hair = srgb(HAIR.color) * np.asarray(bright)[..., None]
    return np.asarray(hair + (srgb(COLOUR.skin) - hair) * np.asarray(scalp)[..., None])


def _bun(centre: Floats, out: Floats) -> Part:
    """A grooved, slightly flattened ball."""
    right = np.array([1.0, 0.0, 0.0])
    up = np.cross(out, right)
    tilt = np.pi * np.arange(1, HAIR.bun_rows)[:, None] / HAIR.bun_rows
    turn = 2 * np.pi * np.arange(HAIR.bun_columns) / HAIR.bun_columns
    wave = np.cos(HAIR.bun_grooves * (turn + tilt / 2))
    ball = (
        np.stack(
            np.broadcast_arrays(
                np.sin(tilt) * np.cos(turn),
                np.sin(tilt) * np.sin(turn),
                np.cos(tilt) * HAIR.bun_flat,
            ),
            axis=-1,
        )
        * (1 + HAIR.bun_groove * wave)[..., None]
    )
    local = np.concatenate([ball.reshape(-1, 3), [[0, 0, HAIR.bun_flat]]]) * HAIR.bun_radius
    vertices = centre + local @ np.stack([right, up, out])
    front, light, dark = HAIR.bun_front
    bright = (1 + HAIR.bun_shade * wave) * np.where(tilt < front * np.pi, light, dark)
    color = srgb(HAIR.color) * np.r_[bright.ravel(), 1.0][:, None]
    faces = bridge_rows(HAIR.bun_rows - 1, HAIR.bun_columns, closed=True)
    cap = fan(len(vertices) - 1, np.arange(HAIR.bun_columns))
    return make_part("bun", vertices, np.concatenate([faces, cap]), "hair", color)


def _wisps(line: Hairline, skin: Part, surface: Surface) -> Part:
    """Thin strands that root in front of the hairline and lie on the combed hair."""
    azimuth, before, length, slope, width, shade = _wisp_choices()
    elevation = line.elevation(azimuth)
    reach = line.reach(_spherical(azimuth, elevation))
    root = line.centre + _spherical(azimuth, elevation - before / reach) * reach[:, None]
    behind = length - before
    tip_azimuth = azimuth + slope * behind / reach
    tip_elevation = line.elevation(tip_azimuth) + behind / reach
    tip_direction = _spherical(tip_azimuth, tip_elevation)
    tip_reach = line.reach(tip_direction) + table(HAIR.wisp_tip_lift, behind)
    tip = line.centre + tip_direction * tip_reach[:, None]
    anchors = surface.anchor(root)
    root = surface.position(anchors, HAIR.wisp_root_lift)
    out = trimesh.unitize(root - line.centre)
    aside = trimesh.unitize(np.cross(tip - root, out)) * width[:, None] / 2
    middle = (root + tip) / 2 + out * HAIR.wisp_bulge
    vertices = np.stack([root, middle - aside, middle + aside, tip], axis=1)
    delta = anchors.read(skin.deltas)
    half, end = HAIR.wisp_follow
    deltas = np.stack([delta, delta * half, delta * half, delta * end], axis=2)
    count = len(root)
    first = np.arange(count)[:, None] * 4
    root_skin, middle_skin, tip_skin = HAIR.wisp_scalp
    return make_part(
        "wisps",
        vertices.reshape(-1, 3),
        np.concatenate([first + np.array(corners) for corners in ((0, 2, 1), (1, 2, 3))]),
        "hair",
        _on_scalp(
            np.repeat(shade, 4), np.tile([root_skin, middle_skin, middle_skin, tip_skin], count)
        ),
        settled(deltas.reshape(CHANNEL_COUNT, -1, 3), HAIR.moves_from),
        cover=np.tile(HAIR.wisp_cover, count),
    )


def _wisp_choices() -> tuple[Floats, ...]:
    """For each wisp: azimuth (radians), root in front of the line (mm), length (mm), slope
    aside, width (mm), shade.
    """
    random = np.random.default_rng(HAIR.seed)
    count = HAIR.wisps
    azimuth = np.linspace(-HAIR.wisp_span, HAIR.wisp_span, count)
    azimuth = np.deg2rad(azimuth + random.uniform(-HAIR.wisp_jitter, HAIR.wisp_jitter, count))
    before = random.uniform(*HAIR.wisp_before, count)
    length = random.uniform(*HAIR.wisp_length, count)
    slope = random.normal(0, HAIR.wisp_lean, count)
    width = random.uniform(*HAIR.wisp_width, count)
    shade = random.uniform(*HAIR.wisp_shade, count)
    return azimuth, before, length, slope, width, shade
