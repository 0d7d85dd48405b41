"""Joins the parts into one rig in metres."""

from __future__ import annotations

import numpy as np

from assets.builder.brows import BrowArch, build_brow, build_brow_down
from assets.builder.colour import paint_skin, shade
from assets.builder.controls import control_pairs
from assets.builder.eyes import build_eye, build_wet
from assets.builder.geometry import Surface, mesh_of
from assets.builder.hair import above_hairline, build_hair, find_hairline
from assets.builder.lashes import build_lashes
from assets.builder.lower_lip import round_lower_lip
from assets.builder.parts import Part
from assets.builder.settings import ATTRIBUTION, MATERIALS, NAME, OUTPUT
from assets.builder.shapes import Face, pose_face
from assets.builder.skin import build_base, build_skin
from assets.builder.source import Floats, Source
from assets.builder.teeth import build_teeth
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.rig import Material, Rig

_METRES_PER_MM = 0.001


def build_rig(source: Source) -> Rig:
    """The whole character."""
    face = pose_face(source)
    line, arch = find_hairline(face), BrowArch(face)
    above = above_hairline(face, line)
    skin = build_skin(face, above, paint_skin(face, arch, above))
    surface = Surface(mesh_of(skin.vertices, skin.faces))
    parts = [skin, build_base(skin, len(face.skin))]
    for eye in face.eyes:
        parts.append(build_brow_down(eye.side, arch, skin, surface))
        parts.append(build_brow(eye.side, arch, skin, surface))
    for eye in face.eyes:
        parts += build_lashes(face, eye, skin, surface)
    parts += [build_eye(face, eye) for eye in face.eyes]
    for eye in face.eyes:
        parts += build_wet(face, eye, skin, surface)
    parts += build_teeth(face)
    parts += build_hair(line, skin, surface)
    return _to_rig(round_lower_lip(_join(parts), face), face)


def _join(parts: list[Part]) -> Part:
    """One part without unused vertices, its triangles sorted by material."""
    offsets = np.cumsum([0] + [len(part.vertices) for part in parts])
    faces = np.concatenate(
        [part.faces + offset for part, offset in zip(parts, offsets[:-1], strict=True)]
    )
    materials = np.concatenate([part.materials for part in parts])
    order = np.argsort(materials, kind="stable")
    used, corners = np.unique(faces[order], return_inverse=True)
    return Part(
        "character",
        np.concatenate([part.vertices for part in parts])[used],
        np.concatenate([part.deltas for part in parts], axis=1)[:, used],
        corners.reshape(-1, 3),
        materials[order],
        np.concatenate([part.colors for part in parts])[used],
        np.concatenate([part.base_index for part in parts])[used],
        np.concatenate([part.cover for part in parts])[used],
    )


def _to_rig(part: Part, face: Face) -> Rig:
    """Metres around the origin, linear colours; rounded, so that every machine agrees."""
    eye = face.eyes[0].centre
    origin = np.array([0, eye[1] - OUTPUT.origin_below_eyes, eye[2] - OUTPUT.origin_behind_eyes])
    colors = np.ones((len(part.vertices), 4), np.float32)
    colors[:, :3] = (np.round(shade(part) * 255) / 255) ** OUTPUT.gamma
    colors[:, 3] = np.round(part.cover * 255) / 255
    starts = np.searchsorted(part.materials, np.arange(len(MATERIALS) + 1))
    materials = tuple(
        Material(name, int(start), int(stop), roughness)
        for (name, roughness), start, stop in zip(
            MATERIALS.items(), starts[:-1], starts[1:], strict=True
        )
    )
    return Rig(
        neutral=_metres(part.vertices - origin),
        faces=part.faces.astype(np.int32),
        channels=ARKIT_CHANNELS,
        deltas=_metres(part.deltas),
        colors=colors,
        materials=materials,
        control_pairs=control_pairs(part.base_index).astype(np.int32),
        name=NAME,
        attribution=ATTRIBUTION,
    )


def _metres(millimetres: Floats) -> np.ndarray:
    """Rounded float32 metres, without negative zeros."""
    return (np.round(millimetres * _METRES_PER_MM, OUTPUT.digits) + 0.0).astype(np.float32)
