"""Teeth and gums along the arch of the helper teeth, and the helper's tongue."""

from __future__ import annotations

import numpy as np
import trimesh
from scipy.spatial import ConvexHull

from assets.builder import source as src
from assets.builder.geometry import bridge_rows, fan, fit_rigid, smoothstep
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
        vertices, faces, colors = _gum(arch, jaw, bite, upward)
        motion = _jaw_motion(face, helper, vertices)
        parts.append(make_part(f"{name}Gum", vertices, faces, "gums", colors, motion))
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
    vertices: list[Floats] = []
    faces: list[Ints] = []
    per_tooth = len(TEETH.levels) * TEETH.sides
    for side in (1, -1):
        along = arch.length / 2
        for i, width in enumerate(_widths(arch, jaw)):
            root, tip = _heights(jaw, bite, upward, i)
            tooth = _tooth(arch, along + side * width / 2, width, TEETH.depths[i], root, tip)
            along += side * width
            faces.append(_tooth_faces(tooth) + len(vertices) * per_tooth)
            vertices.append(tooth)
    points, triangles = np.concatenate(vertices), np.concatenate(faces)
    outward = points[triangles].mean(1) - [0, points[:, 1].mean(), arch.middle[1]]
    outward[:, 1] = 0
    normals, _ = trimesh.triangles.normals(points[triangles])
    towards = (normals * trimesh.unitize(outward)).sum(1)
    return points, triangles[towards > jaw.back_faces], _tooth_colors(len(vertices))


def _widths(arch: Arch, jaw: Jaw) -> Floats:
    """Widths of the six teeth of one side, mm."""
    return np.array(jaw.widths) * arch.length / 2 * TEETH.filled / sum(jaw.widths)


def _heights(jaw: Jaw, bite: float, upward: int, i: int) -> tuple[float, float]:
    """Y of the root end and of the tip of a side's tooth `i`, mm."""
    tip = bite - jaw.tip_drop + (jaw.second_short if i == 1 else 0)
    return tip + upward * jaw.heights[i], tip


def _tooth_colors(count: int) -> Floats:
    """(count * levels * sides, 3) sRGB: dark where a tooth meets its neighbours."""
    meets = smoothstep(0.75, 1.0, np.abs(np.cos(_corners())))
    one = np.array(TEETH.level_tints)[:, None] * (1 - meets[:, None] * TEETH.between_shade)
    return np.tile(srgb(TEETH.color) * one.reshape(-1, 3), (count, 1))


def _corners() -> Floats:
    """The corners of a tooth's cross-section as angles from its tangent, radians."""
    return (np.arange(TEETH.sides) + 0.5) * 2 * np.pi / TEETH.sides


def _tooth(arch: Arch, along: float, width: float, depth: float, root: float, tip: float) -> Floats:
    """(levels * sides, 3) mm: superelliptic cross-sections from the root to the tip."""
    point, tangent, normal = arch.frame(along)
    angle = _corners()
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
    # The walls at which it touches its neighbours cannot be seen.
    across = np.abs(np.cos(_corners()))[walls % TEETH.sides].min(1)
    walls = walls[across < TEETH.touching]
    cap = fan(last, last + np.arange(1, TEETH.sides))[:-1]
    faces = np.concatenate([walls, cap])
    outward = tooth[faces].mean(1) - tooth.mean(0)
    inverted = (trimesh.triangles.cross(tooth[faces]) * outward).sum(1) < 0
    return np.where(inverted[:, None], faces[:, ::-1], faces)


def _gum(arch: Arch, jaw: Jaw, bite: float, upward: int) -> tuple[Floats, Ints, Floats]:
    """The gum of one row of teeth: vertices, faces and colours.

    Its edge runs around each tooth, and its tips lie between the teeth.
    """
    along, edge, between = _gum_edge(arch, jaw, bite, upward)
    rows = []
    for distance, on_tooth, in_gap in TEETH.gum_rows:
        front = on_tooth + (in_gap - on_tooth) * between
        for place, height, forward in zip(along, edge, front, strict=True):
            point, _, normal = arch.frame(place)
            x, z = point + normal * forward
            rows.append((x, height + upward * distance, z))
    faces = bridge_rows(len(TEETH.gum_rows), len(along), closed=False)
    colors = np.tile(srgb(TEETH.gum_color), (len(rows), 1))
    colors[: len(along)] = srgb(TEETH.gum_edge_color)
    return np.array(rows), faces[:, ::-1] if upward > 0 else faces, colors


def _gum_edge(arch: Arch, jaw: Jaw, bite: float, upward: int) -> tuple[Floats, Floats, Floats]:
    """Columns of the gum: place on the arch, height of the edge, mm, and 0..1 between teeth."""
    share = np.arange(TEETH.gum_columns) / TEETH.gum_columns
    sides = []
    for side in (1, -1):
        start, columns = arch.length / 2, []
        for i, width in enumerate(_widths(arch, jaw)):
            root, _ = _heights(jaw, bite, upward, i)
            between = np.abs(2 * share - 1) ** 2.2
            edge = root - upward * (TEETH.gum_over + TEETH.gum_between * between)
            columns.append(np.c_[start + side * width * share, edge, between])
            start += side * width
        sides.append(np.concatenate(columns))
    left, right = sides
    along, edge, between = np.concatenate([right[:0:-1], left]).T
    return along, edge, between


def _tongue(face: Face) -> Part:
    quads = face.mesh.group("helper-tongue")
    used, index = np.unique(quads, return_inverse=True)
    quads = index.reshape(quads.shape)
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    narrow = np.array([TEETH.tongue_narrow, 1, 1])
    vertices = face.neutral[used] * narrow
    back = smoothstep(*TEETH.tongue_lower_between, vertices[:, 2])
    x, y = vertices[:, 0], vertices[:, 1].copy()
    low, high = np.quantile(y, [0.3, 0.7])
    top = smoothstep(low, high, y + TEETH.tongue_lower * back * 0.5)
    depth, width = TEETH.tongue_groove
    furrow = np.exp(-((x / width) ** 2)) * top
    vertices[:, 1] -= TEETH.tongue_lower * back + depth * furrow
    vertices[:, 1] -= TEETH.tongue_round * (x / np.abs(x).max()) ** 2 * top
    color = srgb(TEETH.tongue_color)
    color = color + (srgb(TEETH.tongue_groove_color) - color) * furrow[:, None]
    deltas = face.deltas[:, used] * narrow
    return make_part("tongue", vertices + TEETH.tongue_shift, faces, "tongue", color, deltas)
