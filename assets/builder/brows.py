"""Eyebrows: one-triangle strands tied to the skin along an arch."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import trimesh
from scipy.interpolate import PchipInterpolator

from assets.builder.geometry import MIRROR, Surface, bridge_rows, project_front, smoothstep
from assets.builder.parts import CHANNEL_COUNT, Part, make_part, srgb, table
from assets.builder.settings import BROWS, COLOUR
from assets.builder.shapes import Face
from assets.builder.source import Floats


class BrowArch:
    """The middle line of the left brow as a height over x; the right one mirrors it."""

    def __init__(self, face: Face) -> None:
        points = face.neutral[list(BROWS.path)]
        x, y = points[:, 0].copy(), points[:, 1] + BROWS.raise_path
        x[0], y[0] = BROWS.inner_end, y[1] - BROWS.inner_drop
        order = np.argsort(x)
        self.start, self.stop = float(x.min()), float(x.max() + BROWS.outer_extra)
        self._height: Callable[[Floats], Floats] = PchipInterpolator(x[order], y[order])

    def height(self, x: Floats) -> Floats:
        """Y of the middle line at |x|, mm."""
        return np.asarray(self._height(np.clip(np.abs(x), self.start, self.stop)))

    def share(self, x: Floats) -> Floats:
        """Where |x| lies along the brow: 0 at the inner end, 1 at the outer one."""
        return np.asarray((np.abs(x) - self.start) / (self.stop - self.start))


def build_brow(side: str, arch: BrowArch, skin: Part, surface: Surface) -> Part:
    """The strands of one brow; both sides draw the same random numbers and so mirror one another.

    Args:
        side: of the character.
        arch: where the brow lies.
        skin, surface: what it is tied to.
    """
    random = np.random.default_rng(BROWS.seed)
    count = BROWS.strands
    t = np.sort((np.arange(count) + random.uniform(0, 1, count)) / count)
    across = random.uniform(-1, 1, count)
    lean = np.where(across > 0, BROWS.lean[1], BROWS.lean[0])
    angle = np.deg2rad(table(BROWS.angles, t) + lean + random.normal(0, BROWS.angle_spread, count))
    length = table(BROWS.lengths, t) * random.uniform(*BROWS.length_spread, count)
    x = arch.start + (t + random.normal(0, BROWS.scatter, count)) * (arch.stop - arch.start)
    y = arch.height(x) + across * _thickness(t) / 2
    root = np.c_[x, y]
    tip = root + np.c_[np.cos(angle), np.sin(angle)] * length[:, None]
    flip = MIRROR[:2] if side == "Right" else np.ones(2)

    roots = surface.anchor(project_front(surface.mesh, root * flip))
    tips = surface.anchor(project_front(surface.mesh, tip * flip))
    root_points = surface.position(roots, BROWS.root_lift)
    tip_points = surface.position(tips, BROWS.tip_lift)
    aside = np.cross(tip_points - root_points, trimesh.unitize(roots.read(surface.normals)))
    aside = trimesh.unitize(aside) * BROWS.width / 2
    # Widest some way along, so that a strand is pointed at both ends, not cut off at its root. A
    # straight strand would dive under the round of the temple.
    middles = surface.anchor(root_points + (tip_points - root_points) * BROWS.widest_at)
    widest = surface.position(middles, BROWS.widest_lift)
    vertices = np.stack([root_points - aside, widest + aside, tip_points], axis=1)
    root_delta, widest_delta, tip_delta = (
        anchors.read(skin.deltas) for anchors in (roots, middles, tips)
    )
    deltas = np.stack([root_delta, widest_delta, tip_delta], axis=2)
    shade = np.repeat(random.uniform(*BROWS.brightness, count), 3)[:, None]
    return make_part(
        f"brow{side}",
        vertices.reshape(-1, 3),
        np.arange(3 * count).reshape(-1, 3),
        "brows",
        srgb(BROWS.color) * shade,
        deltas.reshape(CHANNEL_COUNT, -1, 3),
        cover=np.tile(BROWS.cover, count),
    )


def build_brow_down(side: str, arch: BrowArch, skin: Part, surface: Surface) -> Part:
    """The short, fine hair under the strands: a band without an edge."""
    flip = MIRROR[:2] if side == "Right" else np.ones(2)
    start, stop, columns = BROWS.down_along
    t = np.linspace(start, stop, columns)
    rows = np.array(BROWS.down_rows)
    x = arch.start + t * (arch.stop - arch.start)
    height = arch.height(x) + rows[:, :1] * _thickness(t) / 2 * table(BROWS.down_taper, t)
    points = np.stack([np.broadcast_to(x, height.shape), height], axis=-1).reshape(-1, 2)
    anchors = surface.anchor(project_front(surface.mesh, points * flip))
    faces = bridge_rows(len(rows), columns, closed=False)
    return make_part(
        f"brow{side}Down",
        surface.position(anchors, BROWS.down_lift),
        faces if side == "Right" else faces[:, ::-1],
        "brows",
        srgb(BROWS.color) + (srgb(COLOUR.skin) - srgb(BROWS.color)) * BROWS.down_skin,
        anchors.read(skin.deltas),
        cover=(rows[:, 1:] * table(BROWS.down_cover, t)).ravel(),
    )


def _thickness(t: Floats) -> Floats:
    """Thickness of the brow, mm: fullest in the inner third, tapering outwards."""
    body = BROWS.ends + (1 - BROWS.ends) * np.sin(np.pi * np.clip(t * BROWS.swell, 0, 1))
    taper = 1 - BROWS.taper * smoothstep(*BROWS.taper_between, t)
    return np.asarray(BROWS.thickness * body * taper)
