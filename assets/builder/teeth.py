"""Teeth and gums along the arch of the helper teeth, and the helper's tongue."""

from __future__ import annotations

import numpy as np
import trimesh
from scipy.spatial import ConvexHull

from assets.builder import source as src
from assets.builder.geometry import bridge_rows, fan, fit_rigid
from assets.builder.parts import CHANNEL_COUNT, Part, make_part, srgb
from assets.builder.settings import TEETH, Jaw
from assets.builder.shapes import Face
from assets.builder.source import Floats, Ints

_HULL_MARGIN = 2.0  # mm: what lies this close to the back end of the arch is its straight back


class Arch:
    """The outer curve of one row of teeth, seen from above.

    Attributes:
        length: mm along the curve, from the character's right to the left.
        middle: (2,) a point (x, z) inside, which determines the outside.
    """

    def __init__(self, helper: Floats, jaw: Jaw) -> None:
        flat = helper[:, [0, 2]]
        back = helper[:, 2].min()
        outline = flat[ConvexHull(flat).vertices]
        outline = outline[outline[:, 1] > back + _HULL_MARGIN]
        outline = outline[np.argsort(np.arctan2(outline[:, 0], outline[:, 1] - back))]
        self._points = outline * [TEETH.narrow, 1] - [0, jaw.back]
        steps = np.linalg.norm(np.diff(self._points, axis=0), axis=1)
        self._along = np.r_[0, np.cumsum(steps)]
        self.length = float(self._along[-1])
        self.middle = np.array([0, helper[:, 2].mean()])

    def at(self, along: float) -> Floats:
        """The point (x, z) at a length along the curve."""
        return np.array([np.interp(along, self._along, axis) for axis in self._points.T])

    def frame(self, along: float) -> tuple[Floats, Floats, Floats]:
        """Point, tangent and outward normal there, each (x, z)."""
        point = self.at(along)
        tangent = trimesh.unitize(self.at(along + 1.0) - self.at(along - 1.0))
        normal = np.array([-tangent[1], tangent[0]])
        return point, tangent, normal if normal @ (point - self.middle) > 0 else -normal


def build_teeth(face: Face) -> list[Part]:
    """Upper and lower teeth with their gums, and the tongue."""
    parts = [_tongue(face)]
    for name, helper, jaw, upward in (
        ("upper", src.UPPER_TEETH, TEETH.upper, 1),
        ("lower", src.LOWER_TEETH, TEETH.lower, -1),
    ):
        points = face.neutral[helper]
        arch = Arch(points, jaw)
        front = points[np.abs(points[:, 0]) < 2, 1]
        bite = front.min() if upward > 0 else front.max()
        vertices, faces, colors = _row(arch, jaw, bite, upward)
        motion = _jaw_motion(face, helper, vertices)
        parts.append(make_part(f"{name}Teeth", vertices, faces, "teeth", colors, motion))
        vertices, faces = _gum(arch, bite, upward)
        motion = _jaw_motion(face, helper, vertices)
        color = srgb(TEETH.gum_color)
        parts.append(make_part(f"{name}Gum", vertices, faces, "gums", color, motion))
    return parts


def _jaw_motion(face: Face, helper: slice, points: Floats) -> Floats:
    """(52, P, 3) mm: every shape moves a row of teeth as a rigid body."""
    deltas = np.zeros((CHANNEL_COUNT, len(points), 3))
    before = face.neutral[helper]
    for i, moved in enumerate(face.deltas[:, helper]):
        if np.abs(moved).max() >= TEETH.moves_from:
            motion = fit_rigid(before, before + moved)
            deltas[i] = trimesh.transform_points(points, motion) - points
    return deltas


def _row(arch: Arch, jaw: Jaw, bite: float, upward: int) -> tuple[Floats, Ints, Floats]:
    """One row of teeth: vertices, faces and colours."""
    widths = np.array(jaw.widths) * arch.length / 2 * TEETH.filled / sum(jaw.widths)
    vertices: list[Floats] = []
    faces: list[Ints] = []
    per_tooth = len(TEETH.levels) * TEETH.sides
    for side in (1, -1):
        along = arch.length / 2
        for i, width in enumerate(widths):
            tip = bite - jaw.tip_drop + (jaw.second_short if i == 1 else 0)
            root = tip + upward * jaw.heights[i]
            tooth = _tooth(arch, along + side * width / 2, width, TEETH.depths[i], root, tip)
            along += side * width
            faces.append(_tooth_faces(tooth) + len(vertices) * per_tooth)
            vertices.append(tooth)
    points, triangles = np.concatenate(vertices), np.concatenate(faces)
    outward = points[triangles].mean(1) - [0, points[:, 1].mean(), arch.middle[1]]
    outward[:, 1] = 0
    normals, _ = trimesh.triangles.normals(points[triangles])
    towards = (normals * trimesh.unitize(outward)).sum(1)
    shade = np.ones((len(vertices), len(TEETH.levels), TEETH.sides, 1))
    shade[:, 0] = TEETH.root_shade
    return points, triangles[towards > TEETH.back_faces], srgb(TEETH.color) * shade.reshape(-1, 1)


def _tooth(arch: Arch, along: float, width: float, depth: float, root: float, tip: float) -> Floats:
    """(levels * sides, 3) mm: superelliptic cross-sections from the root to the tip."""
    point, tangent, normal = arch.frame(along)
    angle = (np.arange(TEETH.sides) + 0.5) * 2 * np.pi / TEETH.sides
    across, out = (
        np.sign(wave) * np.abs(wave) ** exponent
        for wave, exponent in zip((np.cos(angle), np.sin(angle)), TEETH.squareness, strict=True)
    )
    levels = []
    for height, wide, deep in TEETH.levels:
        flat = point + np.outer(across * width / 2 * wide, tangent)
        flat = flat + np.outer((out * deep - 1) * depth / 2, normal)
        levels.append(
            np.c_[flat[:, 0], np.full(TEETH.sides, root + (tip - root) * height), flat[:, 1]]
        )
    return np.concatenate(levels)


def _tooth_faces(tooth: Floats) -> Ints:
    """Triangles of one tooth without its root end, turned outwards."""
    last = (len(TEETH.levels) - 1) * TEETH.sides
    walls = bridge_rows(len(TEETH.levels), TEETH.sides, closed=True)
    cap = fan(last, last + np.arange(1, TEETH.sides))[:-1]
    faces = np.concatenate([walls, cap])
    outward = tooth[faces].mean(1) - tooth.mean(0)
    inverted = (trimesh.triangles.cross(tooth[faces]) * outward).sum(1) < 0
    return np.where(inverted[:, None], faces[:, ::-1], faces)


def _gum(arch: Arch, bite: float, upward: int) -> tuple[Floats, Ints]:
    """A band over the roots of one row of teeth."""
    ends = TEETH.gum_ends * arch.length
    rows = []
    for height, front in TEETH.gum_rows:
        for along in np.linspace(ends, arch.length - ends, TEETH.gum_columns):
            point, _, normal = arch.frame(along)
            x, z = point + normal * front
            rows.append((x, bite + upward * height, z))
    faces = bridge_rows(len(TEETH.gum_rows), TEETH.gum_columns, closed=False)
    return np.array(rows), faces if upward > 0 else faces[:, ::-1]


def _tongue(face: Face) -> Part:
    quads = face.mesh.group("helper-tongue")
    used, index = np.unique(quads, return_inverse=True)
    quads = index.reshape(quads.shape)
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    narrow = np.array([TEETH.tongue_narrow, 1, 1])
    vertices = face.neutral[used] * narrow + TEETH.tongue_shift
    color = srgb(TEETH.tongue_color)
    deltas = face.deltas[:, used] * narrow
    return make_part("tongue", vertices, faces, "tongue", color, deltas)
