"""Keeps closed lips closed: removes the slits that some blendshapes open at the corners."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assets.builder import source as src
from assets.builder.controls import LEFT_CORNER
from assets.builder.geometry import mesh_of, smoothstep
from assets.builder.settings import SHAPES
from assets.builder.source import Bools, Floats, Ints
from faceedit_app.core.arkit import ARKIT_INDEX

_STEP = 0.5  # mm between the columns in which the slit is measured


@dataclass(frozen=True)
class _Lips:
    """Which body vertices belong to the lower face half (with the jaw), and the lips' edges.

    Attributes:
        lower: (13380,) what the jaw carries further than the mouth corner.
        links: (E, 2) edges between vertices of the lips.
    """

    lower: Bools
    links: Ints

    def outline(self, pose: Floats, columns: Floats, lower: bool) -> Floats:
        """Height (C,) of the lip's edge at the x of each column; NaN where there is none."""
        links = self.links[(self.lower[self.links] == lower).all(1)]
        start, stop = pose[links[:, 0]], pose[links[:, 1]]
        run = stop[:, 0] - start[:, 0]
        share = (columns[:, None] - start[:, 0]) / np.where(np.abs(run) < 1e-9, 1e-9, run)
        height = start[:, 1] + share * (stop[:, 1] - start[:, 1])
        crossed = (share >= 0) & (share <= 1)
        worst = -np.inf if lower else np.inf
        height = np.where(crossed, height, worst)
        edge = height.max(1) if lower else height.min(1)
        return np.where(np.isfinite(edge), edge, np.nan)


def seal_lips(neutral: Floats, deltas: Floats, body: Ints, lips: Floats) -> Floats:
    """Close the slits of the neutral face and, in place, of the poses in `SHAPES.seal_poses`.

    Args:
        neutral: (N, 3) mm.
        deltas: (52, N, 3) mm; corrected in place.
        body: (F, 3) triangles of the skin.
        lips: (N,) mask of the lips.

    Returns:
        the neutral face with its lips sealed, (N, 3) mm.
    """
    jaw = deltas[ARKIT_INDEX["jawOpen"], :, 1]
    links = mesh_of(neutral, body).edges_unique
    links = links[(lips[links] > 0.5).all(1)]
    model = _Lips((jaw < jaw[LEFT_CORNER])[src.BODY], links)
    neutral = neutral.copy()
    upper, lower = _correction(model, neutral, neutral[src.BODY])
    neutral[src.BODY, 1] += upper + lower

    for pose, upper_shapes, lower_shapes in SHAPES.seal_poses:
        posed = neutral[src.BODY] + sum(deltas[ARKIT_INDEX[name], src.BODY] for name in pose)
        upper, lower = _correction(model, neutral, posed)
        for names, part in ((upper_shapes, upper), (lower_shapes, lower)):
            for name in names:
                share = _share(name, names, neutral[src.BODY, 0])
                deltas[ARKIT_INDEX[name], src.BODY, 1] += share * part
    return neutral


def _share(name: str, names: tuple[str, ...], x: Floats) -> Floats:
    """How much of a correction a shape takes: a pair of shapes shares it by the side."""
    if len(names) == 1:
        return np.ones_like(x)
    left = smoothstep(-SHAPES.seal_from[0], SHAPES.seal_from[0], x)
    return left if name.endswith("Left") else 1 - left


def _correction(lips: _Lips, neutral: Floats, posed: Floats) -> tuple[Floats, Floats]:
    """Vertical shifts (13380,), mm, of the upper and the lower side that close the slit."""
    pose = posed.copy()
    shifts = np.zeros((2, len(pose)))
    keep_middle = smoothstep(*SHAPES.seal_from, np.abs(neutral[src.BODY, 0]))
    region = np.unique(lips.links)
    reach = np.abs(pose[region, 0]).max()
    columns = np.arange(-reach, reach + _STEP, _STEP)
    for _ in range(SHAPES.seal_rounds):
        above = lips.outline(pose, columns, lower=False)
        below = lips.outline(pose, columns, lower=True)
        slit = np.nan_to_num(np.clip(above - below + SHAPES.seal_overlap, 0, None))
        seam = (above + below) / 2
        known = np.isfinite(seam)
        seam_at = np.interp(pose[:, 0], columns[known], seam[known])
        slit_at = np.interp(pose[:, 0], columns, slit)
        near = 1 - smoothstep(0, SHAPES.seal_reach, np.abs(pose[:, 1] - seam_at))
        near = near * (pose[:, 2] > pose[region, 2].max() - SHAPES.seal_depth)
        step = 0.5 * slit_at * near * keep_middle
        shifts[0] -= np.where(lips.lower, 0, step)
        shifts[1] += np.where(lips.lower, step, 0)
        pose[:, 1] = posed[:, 1] + shifts.sum(0)
    return shifts[0], shifts[1]
