"""Find the eyeballs of a character whose shapes do not close its eyes, such as visemes only.

Eyeballs are meshes or pieces of a mesh by themselves: the two largest of the same size that are
round, or that are named so.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import trimesh

from faceedit_app.characters.character import Character, MeshPart
from faceedit_app.core.arrays import Doubles, Indices

_NAMED = re.compile(
    r"eye(?!.?(brow|lash|lid|liner|shadow))|iris|pupil|sclera|cornea|目", re.IGNORECASE
)
_FEWEST = 12  # vertices of an eyeball
_UNROUND = 0.1  # spread of the distances to its centre, as a share of their mean
_ALIKE = 0.15  # relative difference of the radii of the two
# Distance of the eyes in radii, and of the mouth from the middle between them in eye distances.
_APART, _MOUTH = (2.2, 9.0), (0.4, 2.5)


@dataclass(frozen=True)
class Ball:
    """A round piece of a mesh.

    Attributes:
        centre: (3,).
        radius: its own.
    """

    centre: Doubles
    radius: float


def find_eyeballs(character: Character, mouth: Doubles) -> tuple[Doubles, Doubles] | None:
    """The centres of the two eyes, in no order, in the file's coordinates; None if not found.

    Args:
        mouth: (3,) its centre.
    """
    pair = find_pair(character.parts, mouth)
    return None if pair is None else (pair[0].centre, pair[1].centre)


def find_pair(parts: Sequence[MeshPart], mouth: Doubles) -> tuple[Ball, Ball] | None:
    """The two eyeballs, in no order; None if not found."""
    named = [part for part in parts if _NAMED.search(f"{part.name} {part.surface.name}")]
    for some in (named, parts):
        balls = [ball for part in some for ball in _balls(part)]
        pair = _largest_pair(balls, mouth)
        if pair is not None:
            return pair
    return None


def _balls(part: MeshPart) -> Iterator[Ball]:
    """The round pieces of a part."""
    for rows in pieces(part):
        if len(rows) >= _FEWEST:
            centre, radius, spread = _sphere(part.neutral[rows].astype(np.float64))
            if spread < _UNROUND * radius:
                yield Ball(centre, radius)


def pieces(part: MeshPart) -> list[Indices]:
    """The vertices of each connected piece of a part, joined where seams repeat them."""
    _, number = trimesh.grouping.unique_rows(part.neutral)
    edges = number[part.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)]
    labels = trimesh.graph.connected_component_labels(edges, int(number.max()) + 1)[number]
    order = np.argsort(labels, kind="stable")
    ends = np.cumsum(np.bincount(labels))[:-1]
    return [rows.astype(np.intp) for rows in np.split(order, ends) if len(rows)]


def _sphere(places: Doubles) -> tuple[Doubles, float, float]:
    """The sphere nearest to places (N, 3): centre, radius, and the spread of the distances.

    Linear least squares on |p|^2 = 2 c.p + (r^2 - |c|^2): many eyes are only the front half.
    """
    middle = places.mean(axis=0)
    around = places - middle
    system = np.column_stack((2.0 * around, np.ones(len(around))))
    solution = np.linalg.lstsq(system, np.square(around).sum(axis=1), rcond=None)[0]
    radii = np.linalg.norm(around - solution[:3], axis=1)
    return middle + solution[:3], float(radii.mean()), float(radii.std())


def _largest_pair(balls: list[Ball], mouth: Doubles) -> tuple[Ball, Ball] | None:
    balls = sorted(balls, key=lambda ball: -ball.radius)[:24]
    for one, other in combinations(balls, 2):
        apart = float(np.linalg.norm(one.centre - other.centre))
        middle = (one.centre + other.centre) / 2
        away = float(np.linalg.norm(mouth - middle))
        if (
            abs(one.radius - other.radius) < _ALIKE * one.radius
            and _APART[0] < apart / one.radius < _APART[1]
            and _MOUTH[0] < away / max(apart, 1e-12) < _MOUTH[1]
        ):
            return one, other
    return None
