"""Make blendshapes for a head that has none (paper, section 2).

Our character is the template: its skin is fitted to the scan, its mouth, teeth, eyes and hair
follow, its shapes are transferred, and lids and lips are trimmed until they meet where they meet on
the template.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.interpolate import RBFInterpolator
from trimesh.registration import procrustes

from faceedit_app.characters.closed_lips import LipSeam
from faceedit_app.characters.paint import Atlas, Paint, painted
from faceedit_app.characters.points import MAIN_POINTS, PAIRS
from faceedit_app.characters.registration import (
    FittedTemplate,
    Landmarks,
    carry,
    distances,
    register,
)
from faceedit_app.characters.scans import Scan
from faceedit_app.characters.skin import skin_of
from faceedit_app.characters.transfer import Transfer
from faceedit_app.core.arrays import Bools, Doubles, Floats, Indices
from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.core.rig import Rig

_SKIN = ("skin", "lips")  # materials of the template that scans show
_EYES = ("sclera", "iris", "pupil")
_MM = 1000.0
_STILL = 1e-4  # mm; a vertex that shapes move less is still
_ANCHORS = 1200
_COLOR_FROM = 6.0  # mm; skin nearer than this takes the scan's colours
_FRONT, _UNDER_CHIN = -20.0, 15.0  # mm; anything farther back or lower is not the face
_SHUT = 0.5  # share of what the template's own blink leaves open
_MOST_TRIM = 6.0  # mm; the largest trim


@dataclass(frozen=True)
class Template:
    """The skin of a character as one welded mesh in millimetres.

    Attributes:
        rig: the character.
        vertices: (W, 3).
        faces: (F, 3).
        moves: (K, W, 3) the displacements of each channel.
        vertex_of: (V,) the welded vertex of each vertex of the rig, -1 if it is not skin.
        points: the welded vertices of the control points.
    """

    rig: Rig
    vertices: Doubles
    faces: NDArray[np.int64]
    moves: Doubles
    vertex_of: Indices
    points: Mapping[str, int]

    @classmethod
    def of(cls, rig: Rig) -> Template:
        """Make a template of a character."""
        faces = np.concatenate(
            [rig.faces[m.start : m.stop] for m in rig.materials if m.name in _SKIN]
        )
        keys = np.round(rig.neutral[faces.ravel()] * 1e6).astype(np.int64)
        _, first, number = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        vertex_of = np.full(len(rig.neutral), -1, np.intp)
        vertex_of[faces.ravel()] = number.ravel()
        kept = faces.ravel()[first]
        points = {
            name: int(vertex_of[rig.control_pairs[CONTROL_IDS.index(control), end]])
            for control, *names in PAIRS
            for end, name in enumerate(names)
            if name in MAIN_POINTS
        }
        return cls(
            rig,
            _MM * rig.neutral[kept].astype(np.float64),
            number.reshape(-1, 3),
            _MM * rig.deltas[:, kept].astype(np.float64),
            vertex_of,
            points,
        )

    @cached_property
    def lip_seam(self) -> LipSeam:
        """Where its lips meet."""
        jaw = self.moves[self.rig.channel_index["jawOpen"]]
        inner = self.points["inner_upper_lip"], self.points["inner_lower_lip"]
        return LipSeam.of(self.vertices, self.faces, jaw, *inner)

    def landmarks(self, points: Mapping[str, Doubles]) -> Landmarks:
        """Landmarks from the places (3,) of some control points on a scan."""
        names = [name for name in self.points if name in points]
        vertices = [self.points[name] for name in names]
        positions = np.array([points[name] for name in names], np.float64)
        return Landmarks.at_vertices(self.faces, vertices, positions)


@dataclass(frozen=True)
class Made:
    """A head with new shapes.

    Attributes:
        rig: its rig, with the template's place, size and mesh.
        skin: (W, 3) mm, its welded skin.
        moves: (K, W, 3) mm, the displacements of each channel.
        to_scan: (4, 4) from the rig's millimetres to the scan's coordinates.
        face: (W,) which skin vertices are the face, without neck, ears and the back of the head.
        parted: mm by which the lips of the scan were parted; those of the rig are closed.
    """

    rig: Rig
    skin: Doubles
    moves: Doubles
    to_scan: Doubles
    face: Bools
    parted: float = 0.0

    def distance_to(self, scan: Scan) -> tuple[float, float]:
        """Median and 95th percentile of the distance from the face's skin to the scan, mm."""
        front = self.skin[self.face]
        scale = float(np.cbrt(np.linalg.det(self.to_scan[:3, :3])))
        mesh = trimesh.Trimesh(scan.vertices, scan.faces, process=False)
        far = distances(trimesh.transform_points(front, self.to_scan), mesh) / scale
        return float(np.median(far)), float(np.percentile(far, 95))


def make(template: Template, scan: Scan, landmarks: Landmarks, name: str) -> Made:
    """Make blendshapes for a scan.

    Args:
        template: the character whose shapes are transferred.
        scan: the head.
        landmarks: places on both.
        name: the name of the new character.
    """
    landmarks = landmarks.plausible(template.vertices, template.faces)
    surface = _surface(scan, landmarks.positions)
    fitted = register(template.vertices, template.faces, landmarks, surface)
    back = np.linalg.inv(fitted.similarity)
    skin = trimesh.transform_points(fitted.vertices, back)
    still = np.abs(template.moves).max(axis=(0, 2)) < _STILL
    transfer = Transfer(template.vertices, skin, template.faces, still)
    moves = np.stack([transfer(one) for one in template.moves])
    closed, parted = skin, 0.0
    if "jawOpen" in template.rig.channel_index:
        jaw = template.rig.channel_index["jawOpen"]
        closed, parted = template.lip_seam.closed(skin, moves[jaw])
    here = FittedTemplate(closed, np.eye(4))  # the fit, in the template's coordinates
    trim(moves, closed, template)
    rig = _rig(template, here, moves, scan, fitted, name)
    if scan.paint is not None:
        paint = scan.paint.of_skin(landmarks.positions)
        rig = _with_picture(template, rig, paint, fitted)
    chin = template.vertices[template.points["chin"], 1]
    face = (template.vertices[:, 2] > _FRONT) & (template.vertices[:, 1] > chin - _UNDER_CHIN)
    return Made(rig, skin, moves, fitted.similarity, face, parted)


def trim(moves: Doubles, skin: Doubles, template: Template) -> None:
    """Make lids and lips meet as they do on the template, in place.

    The shape that closes them is scaled in proportion to its displacements, which keeps its form.
    """
    index = template.rig.channel_index
    for lower, upper, channels in (
        ("left_lower_lid", "left_upper_lid", ("eyeBlinkLeft",)),
        ("right_lower_lid", "right_upper_lid", ("eyeBlinkRight",)),
        ("inner_upper_lip", "inner_lower_lip", ("jawOpen", "mouthClose")),
    ):
        if any(channel not in index for channel in channels):
            continue
        rows = [index[channel] for channel in channels]
        held, moved = template.points[lower], template.points[upper]
        wanted = _SHUT * _gap(template.vertices, template.moves[rows], held, moved)
        have = _gap(skin, moves[rows], held, moved)
        if len(channels) == 2:  # closed lips are as far apart as at rest
            wanted = skin[moved] - skin[held]
        lack = wanted - have
        closing = np.linalg.norm(template.moves[rows[-1]], axis=1)
        if np.linalg.norm(lack) < _MOST_TRIM and closing[moved] > 0:
            moves[rows[-1]] += np.minimum(closing / closing[moved], 1.0)[:, None] * lack


def _gap(vertices: Doubles, moves: Doubles, held: int, moved: int) -> Doubles:
    """(3,) vector from one vertex to another, with shapes at 1."""
    posed = vertices + moves.sum(axis=0)
    gap: Doubles = posed[moved] - posed[held]
    return gap


def _surface(scan: Scan, positions: Doubles) -> trimesh.Trimesh:
    """The skin of a scan as a mesh of its own."""
    mesh = trimesh.Trimesh(scan.vertices, scan.faces, process=False)
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    kept = skin_of(mesh, positions)
    if kept.any():
        mesh.update_faces(kept)
        mesh.remove_unreferenced_vertices()
    return mesh


def _rig(
    template: Template,
    here: FittedTemplate,
    moves: Doubles,
    scan: Scan,
    fitted: FittedTemplate,
    name: str,
) -> Rig:
    """The template's rig with another skin, and with the parts that follow it."""
    rig = template.rig
    neutral = _MM * rig.neutral.astype(np.float64)
    deltas = _MM * rig.deltas.astype(np.float64)
    is_skin = template.vertex_of >= 0
    anchors = np.arange(len(template.vertices))
    others = np.flatnonzero(~is_skin)
    neutral[others] = carry(here, template.vertices, anchors, neutral[others])
    for eye in _eyeballs(rig):
        before = _MM * rig.neutral[eye].astype(np.float64)
        placed = procrustes(before, neutral[eye], reflection=False)[1]
        neutral[eye] = placed  # keep it round
    deltas[:, others] += _carried(template, moves, _MM * rig.neutral[others].astype(np.float64))
    neutral[is_skin] = here.vertices[template.vertex_of[is_skin]]
    deltas[:, is_skin] = moves[:, template.vertex_of[is_skin]]
    return replace(
        rig,
        neutral=(neutral / _MM).astype(np.float32),
        deltas=(deltas / _MM).astype(np.float32),
        colors=_colors(template, scan, fitted),
        name=name,
    )


def _eyeballs(rig: Rig) -> Sequence[Indices]:
    """The vertices of each eye."""
    faces = [rig.faces[m.start : m.stop] for m in rig.materials if m.name in _EYES]
    if not faces:
        return ()
    vertices = np.unique(np.concatenate(faces))
    left = rig.neutral[vertices, 0] > 0
    return tuple(vertices[side].astype(np.intp) for side in (left, ~left) if side.any())


def _carried(template: Template, moves: Doubles, others: Doubles) -> Doubles:
    """(K, N, 3) mm by which the new shapes differ from the template's, at other vertices."""
    live = np.abs(template.moves).max(axis=(0, 2)) > _STILL
    chosen = np.flatnonzero(live)
    chosen = chosen[:: max(len(chosen) // _ANCHORS, 1)]
    change = (moves - template.moves)[:, chosen]
    count = len(change)
    values = change.transpose(1, 0, 2).reshape(len(chosen), -1)
    smooth = RBFInterpolator(template.vertices[chosen], values, neighbors=24, kernel="linear")
    carried: Doubles = smooth(others).reshape(len(others), count, 3).transpose(1, 0, 2)
    far = np.linalg.norm(others[:, None] - template.vertices[chosen][None, ::8], axis=2).min(axis=1)
    fading: Doubles = carried * np.clip(1.5 - far / 20.0, 0.0, 1.0)[None, :, None]
    return fading


def _with_picture(template: Template, rig: Rig, paint: Paint, fitted: FittedTemplate) -> Rig:
    """The rig with a picture of the scan on its skin; cuts in the picture repeat vertices."""
    atlas = Atlas.of(template.vertices, template.faces)
    is_skin = [material.name in _SKIN for material in rig.materials]
    runs = [(m.start, m.stop) for m in rig.materials if m.name in _SKIN]
    corners = np.concatenate([rig.faces[start:stop] for start, stop in runs]).ravel()
    own = np.zeros((len(template.vertices), 3), np.float32)
    own[template.vertex_of[corners]] = template.rig.colors[corners, :3]
    scale = float(np.cbrt(np.linalg.det(fitted.similarity[:3, :3])))
    picture = painted(atlas, fitted.vertices, own, paint, _COLOR_FROM * scale)

    flat = atlas.faces.ravel()
    pairs, number_of = np.unique(np.stack((corners, flat), 1), axis=0, return_inverse=True)
    _, first = np.unique(pairs[:, 0], return_index=True)
    is_first = np.zeros(len(pairs), np.bool_)
    is_first[first] = True  # it keeps its number; the others are added
    numbers = pairs[:, 0].astype(np.int32)
    numbers[~is_first] = len(rig.neutral) + np.arange(int((~is_first).sum()))
    source = np.concatenate((np.arange(len(rig.neutral)), pairs[~is_first, 0]))
    faces, done = rig.faces.copy(), 0
    for start, stop in runs:
        count = 3 * (stop - start)
        faces[start:stop] = numbers[number_of.ravel()[done : done + count]].reshape(-1, 3)
        done += count
    uv = np.zeros((len(source), 2), np.float32)
    uv[numbers] = atlas.uv[pairs[:, 1]]
    colors = rig.colors[source]
    colors[numbers] = 1.0
    return replace(
        rig,
        neutral=rig.neutral[source],
        faces=faces,
        deltas=np.ascontiguousarray(rig.deltas[:, source]),
        colors=colors,
        materials=tuple(
            replace(material, texture=0) if skin else material
            for material, skin in zip(rig.materials, is_skin, strict=True)
        ),
        uv=uv,
        textures=(picture,),
        shading_groups=source.astype(np.int32),
        shade=None if rig.shade is None else rig.shade[source],
    )


def _colors(template: Template, scan: Scan, fitted: FittedTemplate) -> Floats:
    """The template's colours, with the scan's on the skin."""
    colors = template.rig.colors.copy()
    if scan.colors is None:
        return colors
    mesh = trimesh.Trimesh(scan.vertices, scan.faces, process=False)
    places, distance, triangles = mesh.nearest.on_surface(fitted.vertices)
    weights = trimesh.triangles.points_to_barycentric(mesh.triangles[triangles], places)
    seen = np.einsum("vk,vkc->vc", weights, scan.colors[scan.faces[triangles]])
    scale = float(np.cbrt(np.linalg.det(fitted.similarity[:3, :3])))
    near: Bools = np.asarray(distance < _COLOR_FROM * scale) & (seen[:, 3] > 0.5)
    skin = np.flatnonzero(template.vertex_of >= 0)
    rows = template.vertex_of[skin]
    taken = near[rows]
    colors[skin[taken], :3] = np.clip(seen[rows[taken], :3], 0.0, 1.0)
    return colors
