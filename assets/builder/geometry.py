"""Modelling shared by several parts: grids of triangles, smoothing, rays, anchoring to a surface.

Normals, adjacency, borders, rays and fits are trimesh's. Ours is what it lacks: triangles that
join rows of vertices, and smoothing of any values by an amount that differs from place to place.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh
from numpy.typing import ArrayLike
from trimesh.ray.ray_triangle import RayMeshIntersector

from assets.builder.source import Floats, Ints

MIRROR = np.array([-1.0, 1.0, 1.0])  # flips the character's left and right


def smoothstep(low: float, high: float, x: ArrayLike) -> Floats:
    """0 below `low`, 1 above `high`, a smooth S in between; element by element."""
    t = np.clip((np.asarray(x, np.float64) - low) / (high - low), 0, 1)
    return np.asarray(t * t * (3 - 2 * t))


def mesh_of(vertices: Floats, faces: Ints) -> trimesh.Trimesh:
    """A mesh of exactly these vertices (V, 3), mm, and faces (F, 3): none merged, none dropped."""
    return trimesh.Trimesh(vertices, faces, process=False)


def vertex_normals(mesh: trimesh.Trimesh) -> Floats:
    """(V, 3) unit normals; zero where no face touches the vertex.

    Weighted by area, as the application lights the face; trimesh's own weigh by angle.
    """
    by_area = trimesh.triangles.cross(mesh.triangles)
    return np.asarray(trimesh.geometry.mean_vertex_normals(len(mesh.vertices), mesh.faces, by_area))


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


def fit_rigid(before: Floats, after: Floats) -> Floats:
    """The rotation and shift, (4, 4), that best move points `before` (P, 3) onto `after`."""
    matrix, _, _ = trimesh.registration.procrustes(before, after, reflection=False, scale=False)
    return np.asarray(matrix)


def smooth(values: Floats, mesh: trimesh.Trimesh, strength: Floats | float, rounds: int) -> Floats:
    """Move every vertex's value (V, ...) towards the mean of its neighbours'.

    `trimesh.smoothing` moves the vertices alone, and all by the same amount.

    Args:
        values: (V, ...) numbers on the vertices.
        mesh: which vertices are neighbours.
        strength: (V,) or one number in 0..1: 0 keeps a value, 1 replaces it.
        rounds: how often.
    """
    flat = values.reshape(len(values), -1)
    one_way = trimesh.graph.edges_to_coo(mesh.edges_unique, len(flat)).astype(np.float64)
    links = (one_way + one_way.T).tocsr()
    count = np.maximum(links @ np.ones((len(flat), 1)), 1)
    amount = np.broadcast_to(np.asarray(strength, np.float64), (len(flat),))[:, None]
    for _ in range(rounds):
        flat = flat + amount * (links @ flat / count - flat)
    return np.asarray(flat).reshape(values.shape)


def project_front(mesh: trimesh.Trimesh, xy: Floats) -> Floats:
    """Drop points (P, 2) along -Z onto the front-most face; (P, 3) mm, -inf deep for none."""
    origins = np.c_[xy, np.full(len(xy), mesh.bounds[1, 2] + 1.0)]
    directions = np.tile([0.0, 0.0, -1.0], (len(xy), 1))
    hits, ray, _ = _rays(mesh).intersects_location(origins, directions, multiple_hits=False)
    depth = np.full(len(xy), -np.inf)
    depth[ray] = hits[:, 2]
    return np.column_stack([xy, depth])


def cast_outermost(mesh: trimesh.Trimesh, origin: Floats, directions: Floats) -> Floats:
    """Distance (R,) from `origin` to the last face that each ray (R, 3) meets; NaN for none."""
    origins = np.tile(origin, (len(directions), 1))
    hits, ray, _ = _rays(mesh).intersects_location(origins, directions)
    distances = np.full(len(directions), -np.inf)
    np.maximum.at(distances, ray, np.linalg.norm(hits - origin, axis=1))
    return np.where(np.isfinite(distances), distances, np.nan)


def _rays(mesh: trimesh.Trimesh) -> RayMeshIntersector:
    """In double precision; `mesh.ray` is Embree, in single, on machines that have it."""
    return RayMeshIntersector(mesh)


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

    def __init__(self, mesh: trimesh.Trimesh) -> None:
        self.mesh = mesh
        self.normals = vertex_normals(mesh)

    def anchor(self, points: Floats) -> Anchors:
        """Tie each of the points (P, 3) to the closest point of the surface."""
        closest, _, face = trimesh.proximity.closest_point(self.mesh, points)
        weights = trimesh.triangles.points_to_barycentric(self.mesh.triangles[face], closest)
        return Anchors(np.asarray(self.mesh.faces)[face], weights)

    def position(self, anchors: Anchors, lift: float = 0.0) -> Floats:
        """The anchored points (P, 3), raised by `lift` mm along the normal."""
        points = anchors.read(np.asarray(self.mesh.vertices))
        return np.asarray(points + lift * trimesh.unitize(anchors.read(self.normals)))
