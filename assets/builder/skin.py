"""The skin: the head and bust cut out of the body, with open eye sockets and no scalp."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import trimesh

from assets.builder import source as src
from assets.builder.geometry import fan, mesh_of
from assets.builder.parts import MATERIAL_INDEX, Part, make_part, settled, srgb
from assets.builder.settings import SKIN
from assets.builder.shapes import Face
from assets.builder.source import Bools, Floats, Ints


def head_faces(face: Face) -> Ints:
    """The body's triangles (F, 3) that can belong to the bust."""
    height = face.neutral[face.body][:, :, 1].min(1)
    return np.asarray(face.body[height > face.eye_height - SKIN.lowest])


def build_skin(face: Face, above_hairline: Floats, colors: Floats) -> Part:
    """Cut the skin out.

    Args:
        face: the posed base mesh.
        above_hairline: (13380,) radians above the hairline.
        colors: (13380, 3) sRGB.
    """
    faces = head_faces(face)
    faces = faces[above_hairline[faces].min(1) <= SKIN.under_hair]
    faces = faces[~_in_sockets(face, faces)]
    faces, cuts = _clip(faces, _inside_bust(face))
    start, stop, share = cuts

    def extend(values: Floats) -> Floats:
        """Append the values (..., V, 3) at the cut edges."""
        a, b = values[..., start, :], values[..., stop, :]
        return np.concatenate([values, a + (b - a) * share[:, None]], axis=-2)

    count = len(face.skin)
    index = np.r_[np.arange(count), np.full(len(share), -1)]
    corner = np.minimum(faces, count - 1)
    materials = skin_materials(face.mouth[corner], face.lips[corner])
    deltas = settled(extend(face.deltas[:, src.BODY]), SKIN.moves_from)
    return make_part("skin", extend(face.skin), faces, materials, extend(colors), deltas, index)


def skin_materials(mouth: Floats, lips: Floats) -> Ints:
    """The materials (F,) of triangles whose corners lie in mouth and lips so far, (F, 3) 0..1."""
    outside = np.where(lips.mean(1) > 0.5, MATERIAL_INDEX["lips"], MATERIAL_INDEX["skin"])
    return np.where(mouth.mean(1) > 0.5, MATERIAL_INDEX["mouth"], outside)


def _in_sockets(face: Face, faces: Ints) -> Bools:
    """(F,) which triangles of the sockets look at the eyeball and would show through."""
    dropped = np.zeros(len(faces), bool)
    for eye in face.eyes:
        corners = face.neutral[faces] - eye.centre
        normals = trimesh.triangles.cross(corners)
        near = np.linalg.norm(corners, axis=2).max(1) < SKIN.socket_reach * eye.radius
        behind = corners[:, :, 2].max(1) < SKIN.socket_front * eye.radius
        dropped |= near & behind & ((normals * corners.mean(1)).sum(1) < 0)
    return dropped


def _inside_bust(face: Face) -> Floats:
    """(13380,) positive inside the bust, negative outside, 0 on its border."""
    top = face.eye_height - SKIN.shoulder
    offset = (face.skin - [0, top, SKIN.bust_forward]) / SKIN.bust_radii
    return np.where(face.skin[:, 1] > top, 1.0, 1 - np.linalg.norm(offset, axis=1))


def _clip(faces: Ints, inside: Floats) -> tuple[Ints, tuple[Ints, Ints, Floats]]:
    """Cut triangles where `inside` (V,) changes its sign.

    Returns:
        triangles whose new vertices are numbered from V on, and for each new vertex the two
        ends of its edge and its share of the way between them.
    """
    edges: dict[tuple[int, int], int] = {}

    def cut(a: int, b: int) -> int:
        edge = (min(a, b), max(a, b))
        return edges.setdefault(edge, len(inside) + len(edges))

    kept = faces[(inside[faces] >= 0).all(1)].tolist()
    for corners in faces[(inside[faces] >= 0).any(1) & (inside[faces] < 0).any(1)].tolist():
        polygon = []
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
            if inside[a] >= 0:
                polygon.append(a)
            if (inside[a] >= 0) != (inside[b] >= 0):
                polygon.append(cut(a, b))
        kept += [[polygon[0], *pair] for pair in pairwise(polygon[1:])]
    start, stop = np.array(list(edges), np.int64).reshape(-1, 2).T
    return np.array(kept), (start, stop, inside[start] / (inside[start] - inside[stop]))


def build_base(skin: Part, cuts_from: int) -> Part:
    """The surface that closes the bust from below.

    Args:
        skin: the cut skin.
        cuts_from: the index of its first vertex on a cut edge.
    """
    loop = _border_loop(skin, cuts_from)
    rim = skin.vertices[loop]
    middle = rim.mean(0) + np.array([0, SKIN.base_rise, 0])
    vertices = np.concatenate([[middle], rim])
    deltas = np.concatenate([np.zeros((len(skin.deltas), 1, 3)), skin.deltas[:, loop]], axis=1)
    faces = fan(0, 1 + np.arange(len(loop)))
    if trimesh.triangles.cross(vertices[faces])[:, 1].sum() > 0:
        faces = faces[:, ::-1]
    return make_part("base", vertices, faces, "skin", srgb(SKIN.base_color), deltas)


def _border_loop(skin: Part, cuts_from: int) -> Ints:
    """The vertices of the longest border that runs along cut edges only, in order."""
    borders = [line.points for line in mesh_of(skin.vertices, skin.faces).outline().entities]
    longest = max((border for border in borders if border.min() >= cuts_from), key=len)
    return np.asarray(longest[:0:-1])  # the first vertex comes last again
