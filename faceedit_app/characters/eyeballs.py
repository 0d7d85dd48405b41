"""Find the eyeballs of a character whose shapes do not close its eyes, such as visemes only.

Eyeballs are meshes or pieces of a mesh by themselves: the two largest of the same size that are
round, or that are named so.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import trimesh

from faceedit_app.characters.character import Character, Part
from faceedit_app.core.arrays import Doubles

_NAMED = re.compile(
    r"eye(?!.?(brow|lash|lid|liner|shadow))|iris|pupil|sclera|cornea|目", re.IGNORECASE
)
_FEWEST = 12  # vertices of an eyeball
_UNROUND = 0.1  # spread of the distances to its centre, as a share of their mean
_ALIKE = 0.15  # relative difference of the radii of the two
# Distance of the eyes in radii, and of the mouth from the middle between them in eye distances.
_APART, _MOUTH = (2.2, 9.0), (0.4, 2.5)


@dataclass(frozen=True)
class _Ball:
    centre: Doubles
    radius: float


def find_eyeballs(character: Character, mouth: Doubles) -> tuple[Doubles, Doubles] | None:
    """The centres of the two eyes, in no order, in the file's coordinates; None if not found.

    Args:
        mouth: (3,) its centre.
    """
    named = [part for part in character.parts if _NAMED.search(f"{part.name} {part.surface.name}")]
    for parts in (named, character.parts):
        balls = [ball for part in parts for ball in _balls(part)]
        pair = _largest_pair(balls, mouth)
        if pair is not None:
            return pair
    return None


def _balls(part: Part) -> Iterator[_Ball]:
    """The round pieces of a part; its vertices that seams repeat are joined first."""
    mesh = trimesh.Trimesh(part.neutral.astype(np.float64), part.faces, process=False)
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    labels = trimesh.graph.connected_component_labels(mesh.edges, len(mesh.vertices))
    for label in np.flatnonzero(np.bincount(labels) >= _FEWEST):
        centre, radius, spread = _sphere(np.asarray(mesh.vertices[labels == label]))
        if spread < _UNROUND * radius:
            yield _Ball(centre, radius)


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


def _largest_pair(balls: list[_Ball], mouth: Doubles) -> tuple[Doubles, Doubles] | None:
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
            return one.centre, other.centre
    return None
