"""Small geometric tools: normals, fits, rays, smoothing and attachment to a surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from assets.builder.source import Floats, Ints

MIRROR = np.array([-1.0, 1.0, 1.0])  # flips the character's left and right


def smoothstep(low: float, high: float, x: ArrayLike) -> Floats:
    """0 below `low`, 1 above `high`, a smooth S in between; element by element."""
    t = np.clip((np.asarray(x, np.float64) - low) / (high - low), 0, 1)
    return np.asarray(t * t * (3 - 2 * t))


def unit(vectors: Floats) -> Floats:
    """(..., 3) vectors scaled to length 1; a zero vector stays zero."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.maximum(length, 1e-12))


def face_normals(vertices: Floats, faces: Ints) -> Floats:
    """(F, 3) normals whose length is twice the triangle's area."""
    a, b, c = vertices[faces[:, 0]], vertices[faces[:, 1]], vertices[faces[:, 2]]
    return np.cross(b - a, c - a)


def vertex_normals(vertices: Floats, faces: Ints) -> Floats:
    """(V, 3) unit normals, weighted by area; zero where no face touches the vertex."""
    normals = np.zeros_like(vertices)
    weighted = face_normals(vertices, faces)
    for corner in range(3):
        np.add.at(normals, faces[:, corner], weighted)
    return unit(normals)


def bridge_rows(rows: int, columns: int, closed: bool) -> Ints:
    """Triangles that join a grid of `rows` x `columns` vertices, stored row by row.

    A closed grid joins its last column to its first. Faces turn counter-clockwise seen from the
    side on which the columns run to the right and the rows run downwards.
    """
    column = np.arange(columns if closed else columns - 1)
    following = (column + 1) % columns
    triangles = []
    for row in range(rows - 1):
        top, below = row * columns, (row + 1) * columns
        triangles.append(np.c_[top + column, below + column, below + following])
        triangles.append(np.c_[top + column, below + following, top + following])
    return np.concatenate(triangles)


def fan(centre: int, ring: Ints) -> Ints:
    """Triangles (R, 3) from one vertex to the consecutive vertices of a closed ring."""
    return np.stack([np.full(len(ring), centre), ring, np.roll(ring, -1)], axis=1)


@dataclass(frozen=True)
class RigidMotion:
    """x -> rotation @ (x - source) + goal. Rotation (3, 3), centres (3,) mm."""

    rotation: Floats
    source: Floats
    goal: Floats

    def displacement(self, points: Floats) -> Floats:
        """How far each of the points (P, 3) moves, mm."""
        return (points - self.source) @ self.rotation.T + self.goal - points


def fit_rigid(before: Floats, after: Floats) -> RigidMotion:
    """The rotation and shift that best move `before` (P, 3) onto `after` (Kabsch)."""
    source, goal = before.mean(0), after.mean(0)
    u, _, vt = np.linalg.svd((before - source).T @ (after - goal))
    flip = np.diag([1.0, 1.0, np.linalg.det(vt.T @ u.T)])
    return RigidMotion(vt.T @ flip @ u.T, source, goal)


def fit_sphere(points: Floats) -> tuple[Floats, float]:
    """Centre (3,) and radius of the least-squares sphere through points (P, 3)."""
    system = np.c_[2 * points, np.ones(len(points))]
    solution = np.linalg.lstsq(system, (points**2).sum(1), rcond=None)[0]
    centre = solution[:3]
    return centre, float(np.sqrt(solution[3] + centre @ centre))


def edges(faces: Ints) -> Ints:
    """(E, 2) directed edges, each pair of neighbours once in either direction."""
    one_way = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    return np.unique(np.concatenate([one_way, one_way[:, ::-1]]), axis=0)


def smooth(values: Floats, links: Ints, strength: Floats | float, rounds: int) -> Floats:
    """Move every vertex's value (V, ...) towards the mean of its neighbours'.

    Args:
        values: (V, ...) numbers on the vertices.
        links: (E, 2) directed edges.
        strength: (V,) or one number in 0..1: 0 keeps a value, 1 replaces it.
        rounds: how often.
    """
    flat = values.reshape(len(values), -1)
    count = np.maximum(np.bincount(links[:, 0], minlength=len(flat)), 1)[:, None]
    amount = np.broadcast_to(np.asarray(strength, np.float64), (len(flat),))[:, None]
    for _ in range(rounds):
        total = np.zeros_like(flat)
        np.add.at(total, links[:, 0], flat[links[:, 1]])
        flat = flat + amount * (total / count - flat)
    return flat.reshape(values.shape)


def project_front(vertices: Floats, faces: Ints, xy: Floats) -> Floats:
    """Drop points (P, 2) along -Z onto the front-most face; returns (P, 3), mm."""
    a, b, c = vertices[faces[:, 0]], vertices[faces[:, 1]], vertices[faces[:, 2]]
    area = (b[:, 1] - c[:, 1]) * (a[:, 0] - c[:, 0]) + (c[:, 0] - b[:, 0]) * (a[:, 1] - c[:, 1])
    area = np.where(np.abs(area) < 1e-9, 1e-9, area)
    hits = []
    for x, y in xy:
        u = ((b[:, 1] - c[:, 1]) * (x - c[:, 0]) + (c[:, 0] - b[:, 0]) * (y - c[:, 1])) / area
        v = ((c[:, 1] - a[:, 1]) * (x - c[:, 0]) + (a[:, 0] - c[:, 0]) * (y - c[:, 1])) / area
        inside = (u >= 0) & (v >= 0) & (u + v <= 1)
        depth = u * a[:, 2] + v * b[:, 2] + (1 - u - v) * c[:, 2]
        hits.append((x, y, depth[inside].max(initial=-np.inf)))
    return np.array(hits)


def cast_outermost(origin: Floats, directions: Floats, vertices: Floats, faces: Ints) -> Floats:
    """Distance (R,) from `origin` to the last face that each ray (R, 3) meets; NaN for none."""
    a, b, c = (vertices[faces[:, corner]] - origin for corner in range(3))
    edge1, edge2 = b - a, c - a
    distances = np.full(len(directions), np.nan)
    for i, direction in enumerate(directions):
        p = np.cross(direction, edge2)
        determinant = (edge1 * p).sum(1)
        determinant = np.where(np.abs(determinant) < 1e-9, 1e-9, determinant)
        q = np.cross(-a, edge1)
        u, v = (-a * p).sum(1) / determinant, q @ direction / determinant
        t = (edge2 * q).sum(1) / determinant
        hit = (u >= -1e-6) & (v >= -1e-6) & (u + v <= 1 + 1e-6) & (t > 0)
        if hit.any():
            distances[i] = t[hit].max()
    return distances


@dataclass(frozen=True)
class Anchors:
    """Points tied to a surface: corner indices (P, 3) and barycentric weights (P, 3)."""

    corners: Ints
    weights: Floats

    def read(self, field: Floats) -> Floats:
        """Interpolate vertex values (..., V, 3) at the points: (..., P, 3)."""
        return np.asarray(np.einsum("pc,...pcx->...px", self.weights, field[..., self.corners, :]))


class Surface:
    """A triangle mesh onto which points can be anchored."""

    CANDIDATES = 12  # the closest triangle is looked for among those with the nearest centres

    def __init__(self, vertices: Floats, faces: Ints) -> None:
        self.vertices, self.faces = vertices, faces
        self.normals = vertex_normals(vertices, faces)
        self._centres = cKDTree(vertices[faces].mean(1))

    def anchor(self, points: Floats) -> Anchors:
        """Tie each of the points (P, 3) to (nearly) the closest point of the surface."""
        corners = self.faces[self._centres.query(points, self.CANDIDATES)[1]]  # (P, k, 3)
        a, b, c = (self.vertices[corners[..., i]] for i in range(3))
        e0, e1, r = b - a, c - a, points[:, None] - a
        d00, d01, d11 = (e0 * e0).sum(-1), (e0 * e1).sum(-1), (e1 * e1).sum(-1)
        d20, d21 = (r * e0).sum(-1), (r * e1).sum(-1)
        area = np.maximum(d00 * d11 - d01 * d01, 1e-9)
        v, w = (d11 * d20 - d01 * d21) / area, (d00 * d21 - d01 * d20) / area
        weights = np.clip(np.stack([1 - v - w, v, w], -1), 0, 1)
        weights /= weights.sum(-1, keepdims=True)
        foot = weights[..., :1] * a + weights[..., 1:2] * b + weights[..., 2:] * c
        best = np.linalg.norm(foot - points[:, None], axis=-1).argmin(1)
        row = np.arange(len(points))
        return Anchors(corners[row, best], weights[row, best])

    def position(self, anchors: Anchors, lift: float = 0.0) -> Floats:
        """The anchored points (P, 3), raised by `lift` mm along the normal."""
        return anchors.read(self.vertices) + lift * unit(anchors.read(self.normals))
