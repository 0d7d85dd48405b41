"""Bake soft shade under chin, nose and brows: how much light from above reaches each vertex.

It is computed once when a character is opened, on a few expressions, because shadows that follow
every frame would take half the time of a frame.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from scipy.sparse import csr_matrix, diags_array, identity

from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.controls import CONTROLS
from faceedit_app.core.rig import Rig

# Takes vertices (V, 3), metres, the poses (4, 4) of cameras with parallel rays, which look along
# their own -Z, and half the height that they see. Yields depths (N, N) float32 for each pose, the
# first row at the bottom: 0 is as far from the camera as that half height, 1 three times as far.
DepthsOf = Callable[[Floats, Sequence[Doubles], float], Iterator[Floats]]

DIRECTIONS = 20
_CENTRE = np.array([0.0, 0.68, 0.73])  # direction of the wide light from the face: above, in front
_SPREAD = np.radians(52.0)  # half its opening angle
_OFFSET = 0.001  # metres along the normal, so that a vertex does not shade itself
_BIAS = 0.0025  # metres of depth
_REACH = 0.42  # metres from the light to the face; what is farther gets less
_WRAP = 0.3  # light also counts on surfaces that face slightly away
_SMOOTHING = 2  # rounds of averaging with the neighbours

# A vertex takes the brightest of these: lids and lips must not carry shade out of their folds.
EXPRESSIONS: tuple[dict[str, float], ...] = (
    {},
    {"eyeBlinkLeft": 1.0, "eyeBlinkRight": 1.0, "jawOpen": 0.5, "mouthFunnel": 0.4},
)


def bake_shade(rig: Rig, normals_of: Callable[[Floats], Floats], depths_of: DepthsOf) -> Floats:
    """The share of the light from above that reaches each vertex, (V,) float32 in 0..1."""
    brightest = np.zeros(len(rig.neutral), np.float32)
    last: Floats | None = None
    for expression in EXPRESSIONS:
        weights = np.zeros(len(rig.channels), np.float32)
        for channel, value in expression.items():
            if channel in rig.channel_index:
                weights[rig.channel_index[channel]] = value
        vertices = rig.vertices(weights)
        if last is not None and np.array_equal(vertices, last):
            continue  # a scan has no expressions
        last = vertices
        arrived = _arrived(rig, vertices, normals_of(vertices), depths_of)
        brightest = np.maximum(brightest, arrived)
    average = _neighbour_average(rig)
    for _ in range(_SMOOTHING):
        brightest = average @ brightest
    return brightest


def light_directions() -> Doubles:
    """(DIRECTIONS, 3) float64 unit vectors towards the light, spread evenly over its cap."""
    index = np.arange(DIRECTIONS) + 0.5
    cosine = 1.0 - (1.0 - np.cos(_SPREAD)) * index / DIRECTIONS
    sine = np.sqrt(1.0 - cosine**2)
    angle = np.pi * (3.0 - np.sqrt(5.0)) * index
    basis = _look_along(_CENTRE)
    return np.stack((sine * np.cos(angle), sine * np.sin(angle), cosine), axis=1) @ basis


def _arrived(rig: Rig, vertices: Floats, normals: Floats, depths_of: DepthsOf) -> Floats:
    centre = (vertices.min(0) + vertices.max(0)) / 2.0
    radius = float(np.linalg.norm(vertices - centre, axis=1).max()) * 1.05
    points = vertices + _OFFSET * normals - centre
    directions = light_directions()
    bases = [_look_along(direction) for direction in directions]
    poses = [_pose(basis, centre, radius) for basis in bases]
    seen = np.zeros(len(vertices))
    possible = np.full(len(vertices), 1e-6)
    depths = depths_of(vertices, poses, radius)
    for direction, basis, depth in zip(directions, bases, depths, strict=True):
        place = points @ basis.T / radius  # -1..1
        size = len(depth)
        column, row = ((place[:, :2].T + 1.0) * (size / 2.0)).astype(int).clip(0, size - 1)
        own = (1.0 - place[:, 2]) / 2.0
        weight = np.maximum(normals @ direction + _WRAP, 0.0)
        visible = own - _BIAS / (2.0 * radius) <= depth[row, column]
        seen += weight * visible
        possible += weight
    arrived = seen / np.maximum(possible, 0.35 * possible.max())
    lamp = _face_centre(rig) + _REACH * _CENTRE
    far = np.sum((vertices - lamp) ** 2, axis=1) / _REACH**2
    shade: Floats = (arrived * np.minimum(1.0 / far, 1.0)).astype(np.float32)
    return shade


def _face_centre(rig: Rig) -> Doubles:
    """The centre of the control points of lips and lids, (3,) metres."""
    main = np.array([not control.optional for control in CONTROLS])
    vertices = rig.control_pairs[rig.has_control & main].ravel()
    if not len(vertices):
        vertices = np.arange(len(rig.neutral), dtype=np.int32)
    centre: Doubles = rig.neutral[vertices].mean(axis=0, dtype=np.float64)
    return centre


def _pose(basis: Doubles, centre: Doubles, radius: float) -> Doubles:
    """(4, 4) of a camera with these axes, as rows, that has `centre` two radii before it."""
    view = np.eye(4)
    view[:3, :3], view[:3, 3] = basis, -basis @ centre - [0.0, 0.0, 2.0 * radius]
    return np.asarray(np.linalg.inv(view), np.float64)


def _look_along(backward: Doubles) -> Doubles:
    """(3, 3) rows right, up, backward of a camera that looks along -`backward`."""
    right = np.cross([0.0, 1.0, 0.0] if abs(backward[1]) < 0.95 else [1.0, 0.0, 0.0], backward)
    right /= np.linalg.norm(right)
    return np.stack((right, np.cross(backward, right), backward))


def _neighbour_average(rig: Rig) -> csr_matrix:
    """(V, V) matrix that averages values over each vertex and its neighbours."""
    import trimesh  # 0.4 s; the shipped character has its shade

    count = len(rig.neutral)
    edges = trimesh.Trimesh(rig.neutral, rig.faces, process=False).edges_unique
    links = trimesh.graph.edges_to_coo(edges, count).astype(np.float32)
    links = (links + links.T + identity(count, np.float32)).tocsr()
    links.data[:] = 1.0
    return diags_array(1.0 / links.sum(axis=1).A1.astype(np.float32)) @ links
