"""Lashes: tapered strands along the helper lashes, fine hair between them, a line at the roots."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh

from assets.builder.geometry import Surface, bridge_rows, smoothstep
from assets.builder.parts import CHANNEL_COUNT, Part, make_part, srgb
from assets.builder.settings import LASHES, LashRow
from assets.builder.shapes import Eye, Face
from assets.builder.source import Floats, Ints
from faceedit_app.core.arkit import ARKIT_INDEX

_STRAND = ((0, 1, 3), (0, 3, 2), (2, 3, 4))  # two root vertices, two in the middle, the tip


@dataclass(frozen=True)
class _Edge:
    """The edge of a lid, tied to the skin: the helper lashes close further than the lid does.

    Attributes:
        points: (C, 3) mm.
        deltas: (52, C, 3) mm.
        outer, tips: (C, 3) mm, the helper's rows next to the edge and at its tips, moved with it.
    """

    points: Floats
    deltas: Floats
    outer: Floats
    tips: Floats


def build_lashes(face: Face, eye: Eye, skin: Part, surface: Surface) -> list[Part]:
    """The lashes and lines of the upper and the lower lid."""
    parts = []
    for lid, rows, row in (
        ("upper", eye.upper, LASHES.upper),
        ("lower", eye.lower, LASHES.lower),
    ):
        edge = _edge(face, rows, skin, surface)
        parts.append(_strands(f"{lid}Lashes{eye.side}", edge, eye, row, skin, surface))
        # After the strands, which it would hide where it lies in front of them.
        parts.append(_down(f"{lid}Down{eye.side}", edge, eye, row, skin, surface))
        parts.append(_line(f"{lid}Line{eye.side}", edge, row))
    return parts


def _edge(face: Face, rows: Ints, skin: Part, surface: Surface) -> _Edge:
    helper = face.neutral[rows]
    anchors = surface.anchor(helper[1])
    points = surface.position(anchors, LASHES.root_lift)
    moved = points - helper[1]
    return _Edge(points, anchors.read(skin.deltas), helper[2] + moved, helper[-1] + moved)


def _strands(name: str, edge: _Edge, eye: Eye, row: LashRow, skin: Part, surface: Surface) -> Part:
    random = np.random.default_rng(LASHES.seed)
    along = np.linspace(LASHES.ends[0], len(edge.points) - LASHES.ends[1], row.strands)
    along = along + random.uniform(-LASHES.jitter, LASHES.jitter, row.strands)
    length = row.length * random.uniform(*LASHES.length_spread, row.strands)
    hairs = _hairs(edge, eye, row, along, length, skin, surface)

    aside = trimesh.unitize(np.gradient(hairs.root, axis=0)) * row.width / 2
    slim = aside * LASHES.middle_width
    slimming = hairs.closing * LASHES.closed_slimming
    vertices = [hairs.root - aside, hairs.root + aside]
    vertices += [hairs.middle - slim, hairs.middle + slim, hairs.tip]
    deltas = [
        hairs.root_delta + slimming * aside,
        hairs.root_delta - slimming * aside,
        hairs.middle_delta + slimming * slim,
        hairs.middle_delta - slimming * slim,
        hairs.tip_delta,
    ]
    first = np.arange(row.strands)[:, None] * len(vertices)
    faces = np.concatenate([first + np.array(corners) for corners in _STRAND])
    return make_part(
        name,
        np.stack(vertices, axis=1).reshape(-1, 3),
        faces,
        "lashes",
        srgb(row.color) * np.repeat(random.uniform(*LASHES.brightness, row.strands), 5)[:, None],
        np.stack(deltas, axis=2).reshape(CHANNEL_COUNT, -1, 3),
        cover=np.tile(LASHES.cover, row.strands),
    )


def _down(name: str, edge: _Edge, eye: Eye, row: LashRow, skin: Part, surface: Surface) -> Part:
    """A sheet between the strands, which thins out to their tips: single hairs look like a comb."""
    along = np.linspace(LASHES.ends[0], len(edge.points) - LASHES.ends[1], LASHES.down_columns)
    length = np.full(len(along), row.length * LASHES.down_length)
    hairs = _hairs(edge, eye, row, along, length, skin, surface)
    ends = smoothstep(0, LASHES.down_fade, np.minimum(along - along[0], along[-1] - along))
    return make_part(
        name,
        np.concatenate([hairs.root, hairs.middle, hairs.tip]),
        bridge_rows(3, len(along), closed=False),
        "lashes",
        srgb(row.color),
        np.concatenate([hairs.root_delta, hairs.middle_delta, hairs.tip_delta], axis=1),
        cover=np.outer(row.down_cover, ends).ravel(),
    )


@dataclass(frozen=True)
class _Hairs:
    """Hairs of a lid.

    Attributes:
        root, middle, tip: (S, 3) mm.
        root_delta, middle_delta, tip_delta: (52, S, 3) mm.
        closing: (52, S, 1) how far each channel closes an upper lid; 1 is shut.
    """

    root: Floats
    middle: Floats
    tip: Floats
    root_delta: Floats
    middle_delta: Floats
    tip_delta: Floats
    closing: Floats


def _hairs(
    edge: _Edge,
    eye: Eye,
    row: LashRow,
    along: Floats,
    length: Floats,
    skin: Part,
    surface: Surface,
) -> _Hairs:
    """Hairs at fractional columns (S,) of the helper, with lengths (S,) as shares of its."""
    anchors = surface.anchor(_between(edge.points, along))
    root = surface.position(anchors, LASHES.root_lift)
    root_delta = anchors.read(skin.deltas)
    tip = _between(edge.tips, _clumped(along, row.clump) + LASHES.sweep)
    tip = root + (tip - root) * length[:, None]
    tip_delta, closing = root_delta, np.zeros((CHANNEL_COUNT, len(along), 1))
    if row is LASHES.upper:
        closing = _closing(eye, root_delta)
        tip_delta = tip_delta + closing * _turn_when_closed(eye, root, root_delta, tip)
    bend = [0.0, -row.bend, LASHES.bend_forward]
    middle = root + (tip - root) * LASHES.bend_at + bend
    middle_delta = root_delta + (tip_delta - root_delta) * LASHES.bend_at
    return _Hairs(root, middle, tip, root_delta, middle_delta, tip_delta, closing)


def _clumped(along: Floats, clump: int) -> Floats:
    """Places of the tips (S,): strands lean together in groups of `clump`."""
    group = np.arange(len(along)) // clump
    middle = np.bincount(group, along) / np.bincount(group)
    return np.asarray(along + (middle[group] - along) * LASHES.clumping)


def _closing(eye: Eye, root_delta: Floats) -> Floats:
    """How far each channel closes the upper lid at each strand, (52, S, 1); 1 is shut."""
    blink = root_delta[ARKIT_INDEX[f"eyeBlink{eye.side}"]]
    closing = root_delta[:, :, 1] / np.minimum(blink[:, 1], -LASHES.blink_from)
    return np.asarray(np.clip(closing, *LASHES.turn_limits)[..., None])


def _turn_when_closed(eye: Eye, root: Floats, root_delta: Floats, tip: Floats) -> Floats:
    """Displacements (S, 3) that turn the tips of the upper lashes down when the lid is closed."""
    blink = root_delta[ARKIT_INDEX[f"eyeBlink{eye.side}"]]
    strand = tip - root
    out = trimesh.unitize(root + blink - eye.centre)
    closed = trimesh.unitize(LASHES.closed_out * out - [0, LASHES.closed_down, 0])
    return np.asarray(closed * np.linalg.norm(strand, axis=1, keepdims=True) - strand)


def _line(name: str, edge: _Edge, row: LashRow) -> Part:
    """A thin strip along the edge of the lid."""
    outer = edge.points + (edge.outer - edge.points) * row.liner
    return make_part(
        name,
        np.concatenate([edge.points, outer]),
        bridge_rows(2, len(outer), closed=False),
        "lashes",
        srgb(row.liner_color),
        np.concatenate([edge.deltas, edge.deltas], axis=1),
        cover=np.repeat(LASHES.line_cover, len(outer)),
    )


def _between(points: Floats, along: Floats) -> Floats:
    """Points (C, 3) of columns at fractional columns (S,): (S, 3)."""
    column = np.clip(np.floor(along).astype(int), 0, len(points) - 2)
    share = np.clip(along - column, None, 1)[:, None]
    return np.asarray(points[column] * (1 - share) + points[column + 1] * share)
