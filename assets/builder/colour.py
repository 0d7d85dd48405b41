"""Colours: the painted skin, and the shade baked into everything."""

from __future__ import annotations

import numpy as np
import trimesh

from assets.builder import source as src
from assets.builder.brows import BrowArch
from assets.builder.geometry import mesh_of, project_front, smooth, smoothstep, vertex_normals
from assets.builder.parts import MATERIAL_INDEX, Part, srgb
from assets.builder.settings import BROWS, COLOUR, HAIR
from assets.builder.shapes import Face
from assets.builder.skin import head_faces
from assets.builder.source import Bools, Floats, Ints


def paint_skin(face: Face, arch: BrowArch, above_hairline: Floats) -> Floats:
    """(13380, 3) sRGB."""
    skin = face.skin
    eye_height = face.eye_height
    color = np.tile(srgb(COLOUR.skin), (len(skin), 1)) * _texture(skin)

    def blend(hexadecimal: str, amount: Floats) -> None:
        nonlocal color
        share = np.clip(amount, 0, 1)[:, None]
        color = color + (srgb(hexadecimal) - color) * share

    def spot(centre: Floats, radius: float) -> Floats:
        return np.asarray(np.exp(-((skin - centre) ** 2).sum(1) / radius**2))

    nose = _nose_tip(face)
    cheek = skin[np.linalg.norm(face.delta("cheekSquintLeft")[src.BODY], axis=1).argmax()]
    cheek = np.array([cheek[0] * COLOUR.blush_out, eye_height - COLOUR.blush_below_eyes, cheek[2]])
    blush = spot(cheek, COLOUR.blush_radius) + spot(cheek * [-1, 1, 1], COLOUR.blush_radius)
    blend(COLOUR.blush, COLOUR.blush_amount * blush)
    blend(COLOUR.nose, COLOUR.nose_amount * spot(nose, COLOUR.nose_radius))
    blend(COLOUR.ears, COLOUR.ears_amount * face.ears[src.BODY])
    blend(COLOUR.lids, COLOUR.lids_amount * face.lids[src.BODY])
    for eye in face.eyes:
        rim = (np.linalg.norm(skin - eye.centre, axis=1) - eye.radius) / COLOUR.lid_edge_width
        front = np.abs(skin[:, 1] - eye_height) < COLOUR.lid_edge_reach
        front &= skin[:, 2] > eye.centre[2]
        blend(COLOUR.lid_edge, COLOUR.lid_edge_amount * np.exp(-(rim**2)) * front)
    blend(COLOUR.lips, COLOUR.lips_amount * face.lips[src.BODY])
    blend(COLOUR.mouth, face.mouth[src.BODY])
    blend(BROWS.color, COLOUR.brow_amount * _under_brow(face, arch))
    root = smoothstep(*COLOUR.hairline_between, above_hairline)
    blend(HAIR.color, COLOUR.hairline_amount * root**2)
    return color


def _nose_tip(face: Face) -> Floats:
    heights = face.eye_height - np.arange(0.0, COLOUR.nose_search)
    middle = np.c_[np.zeros_like(heights), heights]
    profile = project_front(mesh_of(face.skin, head_faces(face)), middle)
    return np.asarray(profile[profile[:, 2].argmax()])


def _under_brow(face: Face, arch: BrowArch) -> Floats:
    x, y = face.skin[:, 0], face.skin[:, 1]
    share = arch.share(x)
    front = face.skin[:, 2] > face.eyes[0].centre[2]
    band = np.exp(-(((y - arch.height(x)) / COLOUR.brow_width) ** 2))
    fade = 1 - smoothstep(*COLOUR.brow_fade, share)
    return np.asarray(band * fade * (share > COLOUR.brow_from) * front)


def _texture(points: Floats) -> Floats:
    """(P, 3) factors around 1: a mottled skin out of a few octaves of smooth noise."""
    random = np.random.default_rng(COLOUR.texture_seed)
    factor = np.ones((len(points), 3))
    for size, bright, red in COLOUR.texture:
        factor += bright * _noise(points / size, random)[:, None]
        factor[:, 1:] -= red * _noise(points / size + 50, random)[:, None]
    return factor


def _noise(points: Floats, random: np.random.Generator) -> Floats:
    """Smooth noise in about -1..1 at (P, 3) points of a lattice of size 1."""
    lattice = random.uniform(-1, 1, (32, 32, 32))
    corner = np.floor(points).astype(int)
    share = smoothstep(0, 1, points - corner)
    total = np.zeros(len(points))
    for offset in np.ndindex(2, 2, 2):
        weight = np.where(np.array(offset), share, 1 - share).prod(1)
        total += weight * lattice[tuple(((corner + offset) % 32).T)]
    return total


def shade(part: Part) -> Floats:
    """Colours (V, 3), sRGB, of the joined character darkened where little sky is seen."""
    occluders = _faces_of(part, "skin", "lips", "mouth", "hair", "sclera")
    sky = _visible_sky(part.vertices, occluders)
    sky = smooth(sky, mesh_of(part.vertices, part.faces), COLOUR.sky_smoothing, COLOUR.sky_rounds)
    uses = {name: _vertices_of(part, name) for name in MATERIAL_INDEX}
    sky = np.clip(sky / np.quantile(sky[uses["skin"]], COLOUR.sky_full), 0, 1)
    darkest = np.where(uses["lips"], COLOUR.darkest_lips, COLOUR.darkest)
    light = (darkest + (1 - darkest) * sky)[:, None] ** np.array(COLOUR.shade_tint)
    outside = (uses["skin"] | uses["lips"] | uses["hair"]) & ~uses["mouth"]
    colors = np.where(outside[:, None], part.colors * light, part.colors)

    depth = part.vertices[uses["lips"], 2].max() - part.vertices[:, 2]
    for where, (start, stop, amount) in (
        (uses["mouth"] | uses["gums"], COLOUR.depth_mouth),
        (uses["tongue"], COLOUR.depth_tongue),
        (uses["teeth"], COLOUR.depth_teeth),
    ):
        light = (1 - amount * smoothstep(start, stop, depth))[:, None]
        dimmed = colors * light ** np.array(COLOUR.depth_tint)
        colors = np.where(where[:, None], dimmed, colors)
    return np.clip(colors, 0, 1)


def _faces_of(part: Part, *materials: str) -> Ints:
    return part.faces[np.isin(part.materials, [MATERIAL_INDEX[name] for name in materials])]


def _vertices_of(part: Part, material: str) -> Bools:
    used = np.zeros(len(part.vertices), bool)
    used[_faces_of(part, material)] = True
    return used


def _visible_sky(vertices: Floats, faces: Ints) -> Floats:
    """(V,) share of the sky that each vertex sees, weighted by the cosine and brightness.

    For each of many directions, points strewn over the occluders give a depth map.
    """
    occluders = mesh_of(vertices, faces)
    samples, _ = trimesh.sample.sample_surface(occluders, COLOUR.sky_samples, seed=COLOUR.sky_seed)
    normals = vertex_normals(occluders)
    raised = vertices + COLOUR.sky_lift * normals
    low, high = vertices.min(0), vertices.max(0)
    centre, scale = (low + high) / 2, COLOUR.sky_pixels / np.linalg.norm(high - low)
    seen, total = np.zeros(len(vertices)), np.zeros(len(vertices))
    for direction in _sky_directions():
        aside = np.cross(direction, [0, 0, 1] if abs(direction[2]) < 0.9 else [1, 0, 0])
        plane = np.stack([aside, np.cross(direction, aside)], axis=1) / np.linalg.norm(aside)

        def pixel(points: Floats, plane: Floats = plane) -> Ints:
            grid = ((points - centre) @ plane * scale + COLOUR.sky_pixels / 2).astype(np.int64)
            x, y = np.clip(grid, 0, COLOUR.sky_pixels - 1).T
            return np.asarray(x * COLOUR.sky_pixels + y)

        depth = np.full(COLOUR.sky_pixels**2, -np.inf)
        np.maximum.at(depth, pixel(samples), (samples - centre) @ direction)
        behind = depth[pixel(raised)] - (raised - centre) @ direction
        hidden = np.clip((behind - COLOUR.sky_bias) / COLOUR.sky_soft, 0, 1)
        weight = np.clip(normals @ direction, 0, None)
        weight *= 1 + COLOUR.sky_from_above * direction[1]
        seen += weight * (1 - hidden)
        total += weight
    return seen / np.maximum(total, 1e-9)


def _sky_directions() -> Floats:
    """(D, 3) unit vectors, evenly spread over the sphere (a Fibonacci spiral)."""
    i = np.arange(COLOUR.sky_directions) + 0.5
    height = 1 - 2 * i / COLOUR.sky_directions
    turn = np.pi * (1 + 5**0.5) * i
    flat = np.sqrt(1 - height**2)
    return np.stack([np.cos(turn) * flat, height, np.sin(turn) * flat], axis=1)
