"""Soft shade under chin, nose and brows: how much of a wide light above reaches each vertex.

It is worked out once when a character is opened, on a few expressions, because shadows that
follow every frame would cost half the time of the frame.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy import sparse

from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.rig import Rig

# Takes vertices (V, 3) and a world-to-clip matrix (4, 4); returns depths (N, N) float32 in 0..1,
# the first row at the bottom of clip space.
DepthOf = Callable[[Floats, Doubles], Floats]

DIRECTIONS = 20
_CENTRE = np.array([0.0, 0.68, 0.73])  # of the wide light, as seen from the face: above, in front
_SPREAD = np.radians(52.0)  # half its opening angle
_OFFSET = 0.001  # metres along the normal: a vertex does not shade itself
_BIAS = 0.0025  # metres of depth
_REACH = 0.42  # metres from the light to the face; what is farther gets less
_WRAP = 0.3  # light also counts where the surface turns slightly away
_SMOOTHING = 2  # rounds of averaging with the neighbours

# A vertex keeps the brightest of these: lids and lips must not carry shade out of their folds.
EXPRESSIONS: tuple[dict[str, float], ...] = (
    {},
    {"eyeBlinkLeft": 1.0, "eyeBlinkRight": 1.0, "jawOpen": 0.5, "mouthFunnel": 0.4},
)


def bake_shade(rig: Rig, normals_of: Callable[[Floats], Floats], depth_of: DepthOf) -> Floats:
    """The part of the light from above that arrives, (V,) float32 in 0..1."""
    brightest = np.zeros(len(rig.neutral), np.float32)
    for expression in EXPRESSIONS:
        weights = np.zeros(len(rig.channels), np.float32)
        for channel, value in expression.items():
            if channel in rig.channel_index:
                weights[rig.channel_index[channel]] = value
        vertices = rig.vertices(weights)
        arrived = _arrived(rig, vertices, normals_of(vertices), depth_of)
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


def _arrived(rig: Rig, vertices: Floats, normals: Floats, depth_of: DepthOf) -> Floats:
    centre = (vertices.min(0) + vertices.max(0)) / 2.0
    radius = float(np.linalg.norm(vertices - centre, axis=1).max()) * 1.05
    points = vertices + _OFFSET * normals - centre
    seen = np.zeros(len(vertices))
    possible = np.full(len(vertices), 1e-6)
    for direction in light_directions():
        basis = _look_along(direction)
        clip = np.eye(4)
        clip[:3, :3] = basis * [[1.0], [1.0], [-1.0]] / radius  # nearer to the light is less
        clip[:3, 3] = -clip[:3, :3] @ centre
        depth = depth_of(vertices, clip)
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
    """Where the controls are measured, (3,) metres."""
    vertices = rig.control_pairs[rig.has_control].ravel()
    if not len(vertices):
        vertices = np.arange(len(rig.neutral), dtype=np.int32)
    centre: Doubles = rig.neutral[vertices].mean(axis=0, dtype=np.float64)
    return centre


def _look_along(backward: Doubles) -> Doubles:
    """(3, 3) rows right, up, backward of a camera that looks along -`backward`."""
    right = np.cross([0.0, 1.0, 0.0] if abs(backward[1]) < 0.95 else [1.0, 0.0, 0.0], backward)
    right /= np.linalg.norm(right)
    return np.stack((right, np.cross(backward, right), backward))


def _neighbour_average(rig: Rig) -> sparse.csr_matrix:
    count = len(rig.neutral)
    a, b = np.concatenate((rig.faces[:, :2], rig.faces[:, 1:], rig.faces[:, ::2])).T
    rows = np.concatenate((a, b, np.arange(count)))
    columns = np.concatenate((b, a, np.arange(count)))
    links = sparse.csr_matrix((np.ones(len(rows), np.float32), (rows, columns)), (count, count))
    links.data[:] = 1.0
    return sparse.diags_array(1.0 / links.sum(axis=1).A1.astype(np.float32)) @ links
