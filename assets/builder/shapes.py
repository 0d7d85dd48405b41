"""The posed neutral face and the 52 cleaned-up blendshapes, still on the whole base mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh
from scipy.spatial import cKDTree

from assets.builder import source as src
from assets.builder.geometry import MIRROR, mesh_of, smooth, smoothstep
from assets.builder.lips import seal_lips
from assets.builder.round_lips import round_lips
from assets.builder.settings import NEUTRAL, SHAPES
from assets.builder.source import BaseMesh, Floats, Ints, Source
from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX, mirrored_channel

SIDES = ("Left", "Right")


@dataclass(frozen=True)
class Eye:
    """The sphere behind one pair of lids, and the rows of its helper lashes.

    Attributes:
        side: "Left" or "Right" of the character.
        helper: the vertices of the helper eyeball.
        centre: (3,) mm.
        radius: mm.
        upper, lower: (rows, columns) vertex indices of the helper lashes, from the lid's skin
            (row 0; row 1 is the edge of the lid) to the tips, from the nose outwards.
    """

    side: str
    helper: slice
    centre: Floats
    radius: float
    upper: Ints
    lower: Ints


@dataclass(frozen=True)
class Face:
    """The base mesh in its neutral pose, with displacements per channel.

    Attributes:
        mesh: topology and texture coordinates of the base mesh.
        neutral: (N, 3) mm.
        deltas: (52, N, 3) mm, in the order of `ARKIT_CHANNELS`.
        body: (F, 3) the triangles of the body's skin.
        lips, mouth, lids, ears: (N,) masks in 0..1.
        eyes: left, right.
    """

    mesh: BaseMesh
    neutral: Floats
    deltas: Floats
    body: Ints
    lips: Floats
    mouth: Floats
    lids: Floats
    ears: Floats
    eyes: tuple[Eye, Eye]

    def delta(self, channel: str) -> Floats:
        """Displacements (N, 3), mm, of one channel."""
        return np.asarray(self.deltas[ARKIT_INDEX[channel]])

    @property
    def eye_height(self) -> float:
        """Y of the eyes' centres, mm: the origin of most vertical measures."""
        return float(self.eyes[0].centre[1])

    @property
    def skin(self) -> Floats:
        """(13380, 3) mm: the body's own vertices, without helper geometry."""
        return self.neutral[src.BODY]


def pose_face(source: Source) -> Face:
    """Read, symmetrise, pose and clean up."""
    mesh = source.mesh
    mirror = cKDTree(mesh.vertices).query(mesh.vertices * MIRROR)[1]
    deltas = _symmetric_deltas(source, mirror)
    neutral = _neutral(source, deltas, mirror)
    eyes = _eye("Left", mesh, neutral), _eye("Right", mesh, neutral)
    _close_lids(neutral, deltas, eyes[0])
    for channel, gain in SHAPES.gains:
        deltas[ARKIT_INDEX[channel]] *= gain

    lips, mouth = source.mask("lips"), source.mask("inside-mouth")
    body = _triangulate(mesh.group("body"), neutral, deltas)
    _smooth_cheeks(neutral, deltas, body, lips, eyes)
    neutral = seal_lips(neutral, deltas, body, lips)
    round_lips(neutral, deltas, lips)
    for eye in eyes:
        _clear_eyeball(neutral, deltas, body, eye)
    lids, ears = source.mask("eyelids"), source.mask("ears")
    _round_ears(neutral, body, ears)
    return Face(mesh, neutral, deltas, body, lips, mouth, lids, ears, eyes)


def _symmetric_deltas(source: Source, mirror: Ints) -> Floats:
    """All face units; each is averaged with its mirrored partner, from which it differs."""
    raw = {channel: source.face_unit(channel) for channel in ARKIT_CHANNELS}
    return np.stack(
        [
            (raw[channel] + raw[mirrored_channel(channel)][mirror] * MIRROR) / 2
            for channel in ARKIT_CHANNELS
        ]
    )


def _neutral(source: Source, deltas: Floats, mirror: Ints) -> Floats:
    neutral = source.mesh.vertices.copy()
    for name, weight in NEUTRAL.targets:
        neutral += weight * source.target(name)
    neutral += NEUTRAL.lips_together * deltas[ARKIT_INDEX["mouthClose"]]
    for side in SIDES:
        neutral += NEUTRAL.lids_relaxed * deltas[ARKIT_INDEX[f"eyeBlink{side}"]]
    return np.asarray((neutral + neutral[mirror] * MIRROR) / 2)


def _eye(side: str, mesh: BaseMesh, neutral: Floats) -> Eye:
    helper = src.LEFT_EYE if side == "Left" else src.RIGHT_EYE
    centre, _, _ = trimesh.nsphere.fit_nsphere(neutral[helper])
    # The root of the mean square, not trimesh's mean, which lies half a micrometre farther out.
    radius = float(np.sqrt(((neutral[helper] - centre) ** 2).sum(1).mean()))
    skin = cKDTree(neutral[src.BODY])
    rows = []
    for part in ("2", "1"):  # 2 is the upper lid
        grid = _grid_rows(mesh.group(f"helper-{side[0].lower()}-eyelashes-{part}"), neutral, skin)
        rows.append(grid[:, np.argsort(np.abs(neutral[grid[1], 0]))])
    return Eye(side, helper, centre, radius, *rows)


def _grid_rows(quads: Ints, neutral: Floats, skin: cKDTree) -> Ints:
    """Order a strip of quads into a grid (rows, columns); row 0 is the long border on the skin."""
    edges = np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2)
    edges.sort(axis=1)
    border = edges[trimesh.grouping.group_rows(edges, require_count=1)]
    (loop,) = trimesh.graph.fill_traversals(trimesh.graph.traversals(border, "dfs"), border)
    vertices, counts = np.unique(quads, return_counts=True)
    corners = np.flatnonzero(np.isin(loop[:-1], vertices[counts == 1]))
    loop = np.r_[loop[corners[0] : -1], loop[: corners[0] + 1]]  # from a corner round to it
    corners -= corners[0]
    stops = [*corners[1:], len(loop) - 1]
    paths = [loop[a : b + 1].tolist() for a, b in zip(corners, stops, strict=True)]
    longest = max(map(len, paths))
    long_paths = [path for path in paths if len(path) == longest]
    rows = [min(long_paths, key=lambda path: float(skin.query(neutral[path])[0].mean()))]
    used = set(rows[0])
    neighbours = trimesh.graph.neighbors(edges)
    while True:
        following_row = [[v for v in neighbours[u] if v not in used] for u in rows[-1]]
        if any(len(choice) != 1 for choice in following_row):
            return np.array(rows)
        rows.append([choice[0] for choice in following_row])
        used.update(rows[-1])


def _close_lids(neutral: Floats, deltas: Floats, eye: Eye) -> None:
    """Scale the blinks, which over-close by 4 mm, so that the lids just meet."""
    upper, lower = eye.upper[1], eye.lower[1]
    x = neutral[lower, 0]
    columns = x.min() + np.linspace(*SHAPES.blink_columns) * (x.max() - x.min())

    def gap(pose: Floats) -> Floats:
        above = np.interp(columns, pose[upper, 0], pose[upper, 1])
        return np.asarray(above - np.interp(columns, pose[lower, 0], pose[lower, 1]))

    before, after = gap(neutral), gap(neutral + deltas[ARKIT_INDEX["eyeBlinkLeft"]])
    ends = SHAPES.blink_columns_ignored
    factor = (before / (before - after))[ends:-ends].max() + SHAPES.blink_overlap
    for side in SIDES:
        deltas[ARKIT_INDEX[f"eyeBlink{side}"]] *= min(1.0, factor)


def _triangulate(quads: Ints, neutral: Floats, deltas: Floats) -> Ints:
    """Split each quad along the diagonal that is the shorter one in a smile and an open jaw.

    The rule is the same on both sides of the face, so that creases are too.
    """
    poses = [
        neutral,
        neutral + deltas[ARKIT_INDEX["mouthSmileLeft"]] + deltas[ARKIT_INDEX["mouthSmileRight"]],
        neutral + deltas[ARKIT_INDEX["jawOpen"]],
    ]
    length = [
        sum(np.linalg.norm(pose[quads[:, i]] - pose[quads[:, i + 2]], axis=1) for pose in poses)
        for i in (0, 1)
    ]
    first = (np.round(length[0], 4) <= np.round(length[1], 4))[:, None]
    start = np.where(first, quads[:, [0, 1, 2]], quads[:, [1, 2, 3]])
    return np.concatenate([start, np.where(first, quads[:, [0, 2, 3]], quads[:, [1, 3, 0]])])


def _smooth_cheeks(
    neutral: Floats, deltas: Floats, body: Ints, lips: Floats, eyes: tuple[Eye, Eye]
) -> None:
    """Smooth a few displacement fields away from the lips, the mouth and the eyes."""
    skin = neutral[src.BODY]
    distance = cKDTree(skin[lips[src.BODY] > 0.5]).query(skin)[0]
    strength = SHAPES.smooth_strength * smoothstep(*SHAPES.smooth_keep_lips, distance)
    strength *= smoothstep(*SHAPES.smooth_keep_middle, np.abs(skin[:, 0]))
    for eye in eyes:
        away = np.linalg.norm(skin - eye.centre, axis=1)
        strength *= smoothstep(*SHAPES.smooth_keep_eyes, away)
    mesh = mesh_of(skin, body)
    for channel in SHAPES.smoothed:
        field = deltas[ARKIT_INDEX[channel], src.BODY]
        deltas[ARKIT_INDEX[channel], src.BODY] = smooth(field, mesh, strength, SHAPES.smooth_rounds)


def _clear_eyeball(neutral: Floats, deltas: Floats, body: Ints, eye: Eye) -> None:
    """Keep the skin under an eye in front of the eyeball when squint, cheek and smile add up."""
    cheek, *others = (ARKIT_INDEX[channel + eye.side] for channel in SHAPES.under_eye)
    skin = neutral[src.BODY]
    posed = skin + deltas[[cheek, *others], src.BODY].sum(axis=0)
    before = np.linalg.norm(skin - eye.centre, axis=1) - eye.radius
    away = posed - eye.centre
    missing = SHAPES.eye_clearance - (np.linalg.norm(away, axis=1) - eye.radius)
    # The lid itself touches the eyeball.
    pushed = (before > SHAPES.eye_clear_from) & (skin[:, 2] > eye.centre[2])
    amount = smooth(np.where(pushed, missing.clip(0), 0.0), mesh_of(skin, body), 0.5, 1)
    amount = np.maximum(amount, missing.clip(0)) * pushed
    deltas[cheek, src.BODY] += amount[:, None] * trimesh.unitize(away)


def _round_ears(neutral: Floats, body: Ints, ears: Floats) -> None:
    """Smooth the ears, most of all their boxy lobes, in place."""
    skin, mask = neutral[src.BODY], ears[src.BODY]
    middle = skin[mask > 0.5, 1].mean()
    lobe = smoothstep(*NEUTRAL.ear_lobe, middle - skin[:, 1])
    whole, most = NEUTRAL.ear_strength
    strength = mask * (whole + (most - whole) * lobe)
    neutral[src.BODY] = smooth(skin, mesh_of(skin, body), strength, NEUTRAL.ear_rounds)
