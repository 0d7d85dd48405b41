"""Find landmarks that our template and a scan share, on pictures of both."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray

from faceedit_app.characters.bounded import read_file
from faceedit_app.characters.making import Template
from faceedit_app.characters.points import MAIN_POINTS
from faceedit_app.characters.registration import Landmarks
from faceedit_app.characters.scans import Scan
from faceedit_app.core.arrays import Doubles, Floats, Indices
from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.core.errors import FileError
from faceedit_app.core.rig import Material, Rig
from faceedit_app.render.camera import default_camera, field_of_view
from faceedit_app.render.snapshot import snapshot
from faceedit_app.tracking.landmarker import FaceLandmarker

_FEWEST = 6
_SIZE = 512  # pixels of the pictures
_HEAD = 0.26  # metres; the assumed height of a scan
_CLAY = np.array([0.5, 0.38, 0.33, 1.0], np.float32)
_A_FACE = 4.0  # mm of misfit, below which no other orientation is tried
_NO_FACE = 12.0  # mm, from which it is none
_JITTER = 1.5  # pixels around a landmark; the frontmost hit counts, not one in a hole


def read_points(path: Path) -> dict[str, Doubles]:
    """Read control points on a scan: `{"chin": [x, y, z], ...}` in the scan's own unit.

    Raises:
        FileError: it is something else, or has too few points.
    """
    remedy = f"name at least {_FEWEST} of {', '.join(MAIN_POINTS)}"
    try:
        stored = json.loads(read_file(path, 1 << 20))
        points = {
            name: np.array(stored[name], np.float64) for name in MAIN_POINTS if name in stored
        }
    except (ValueError, TypeError, OverflowError, RecursionError) as error:
        raise FileError(path, "does not say where points are", remedy) from error
    if len(points) < _FEWEST or any(
        place.shape != (3,) or not np.isfinite(place).all() for place in points.values()
    ):
        raise FileError(path, "does not say where enough points are", remedy)
    return points


def find_landmarks(
    template: Template, scan: Scan, path: Path, landmarker: Path | None
) -> Landmarks:
    """Find landmarks of a scan on a picture of it.

    Args:
        template: the template.
        scan: the scan.
        path: the scan's file, for messages.
        landmarker: other networks than those that ship with FaceEdit.

    Raises:
        Unavailable, FileError: the networks cannot be loaded, or find no face.
    """
    landmarks = scan_landmarks(template, scan, FaceLandmarker(landmarker))
    if landmarks is None or len(landmarks.positions) < _FEWEST:
        remedy = "use a scan that shows eyes, nose and mouth"
        raise FileError(
            path,
            "shows no face",
            remedy,
            command_remedy=f"{remedy}, or give its control points with --points",
        )
    return landmarks


def scan_landmarks(template: Template, scan: Scan, finder: FaceLandmarker) -> Landmarks | None:
    """Find landmarks on both heads; None if no face is found in any orientation.

    The crown of a painted head, or the folds of a neck, can look like a face to the networks: the
    orientation counts in which the landmarks lie as on a face.
    """
    own = seen_landmarks(template.rig, finder)
    if own is None:
        return None
    best, least = None, _NO_FACE
    for axes in _axes():
        rig, to_scan = _posed(scan, axes)
        found = seen_landmarks(rig, finder)
        if found is None:
            continue
        pairs = _pairs(template, own, rig, found, to_scan)
        if len(pairs.positions) < _FEWEST:
            continue
        misfit = pairs.misfit(template.vertices, template.faces)
        if misfit < least:
            best, least = pairs, misfit
        if least < _A_FACE:
            break
    return best


def _axes() -> Iterator[Doubles]:
    """The 24 orientations along the axes of a file, the most likely first."""
    for up, forward in ((1, 2), (2, 1), (1, 0), (2, 0), (0, 1), (0, 2)):
        for up_sign, forward_sign in product((1.0, -1.0), repeat=2):
            y, z = np.zeros(3), np.zeros(3)
            # With Z up, faces look along -Y.
            y[up], z[forward] = up_sign, -forward_sign if up == 2 else forward_sign
            yield np.stack((np.cross(y, z), y, z))


def _posed(scan: Scan, axes: Doubles) -> tuple[Rig, Doubles]:
    """A scan as a rig to draw, and the transform (4, 4) back to the scan."""
    turned = scan.vertices @ axes.T
    low, high = turned.min(axis=0), turned.max(axis=0)
    scale = _HEAD / max(float(high[1] - low[1]), 1e-9)
    middle = (low + high) / 2
    back = np.eye(4)
    back[:3, :3] = axes.T / scale
    back[:3, 3] = axes.T @ middle
    return drawable(((turned - middle) * scale).astype(np.float32), scan), back


def drawable(vertices: Floats, scan: Scan) -> Rig:
    """A scan with its vertices (V, 3) elsewhere, metres, as a rig to draw."""
    colors = np.tile(_CLAY, (len(vertices), 1)) if scan.colors is None else scan.colors
    return Rig(
        neutral=vertices,
        faces=scan.faces,
        channels=("jawOpen",),
        deltas=np.zeros((1, *vertices.shape), np.float32),
        colors=colors,
        # Not skin: a scan's triangles may face either way.
        materials=(Material("scan", 0, len(scan.faces)),),
        control_pairs=np.full((len(CONTROL_IDS), 2), -1, np.int32),
    )


def seen_landmarks(
    rig: Rig, finder: FaceLandmarker
) -> tuple[Indices, NDArray[np.intp], Doubles] | None:
    """The landmarks on a head: their numbers, triangles and places (metres), or None."""
    weights = np.zeros(len(rig.channels), np.float32)
    camera = default_camera(rig)
    pixels = finder.find(snapshot(rig, weights, _SIZE, _SIZE, camera))
    if pixels is None:
        return None
    pose = camera.pose()
    half = math.tan(field_of_view(1.0) / 2)
    offsets = np.array([(0, 0), *product((-_JITTER, _JITTER), repeat=2)])
    around = pixels[:, None] + offsets
    x = (around[..., 0] / _SIZE * 2 - 1) * half
    y = (1 - around[..., 1] / _SIZE * 2) * half
    rays = np.stack((x, y, -np.ones_like(x)), axis=-1).reshape(-1, 3) @ pose[:3, :3].T
    mesh = trimesh.Trimesh(rig.neutral.astype(np.float64), rig.faces, process=False)
    starts = np.tile(pose[:3, 3], (len(rays), 1))
    places, which, triangles = mesh.ray.intersects_location(starts, rays, multiple_hits=False)
    if not len(places):
        return None
    landmark = which // len(offsets)
    depth = np.linalg.norm(places - pose[:3, 3], axis=1)
    order = np.lexsort((depth, landmark))
    numbers, first = np.unique(landmark[order], return_index=True)
    chosen = order[first]
    return numbers.astype(np.intp), np.asarray(triangles)[chosen], places[chosen]


def _pairs(
    template: Template,
    own: tuple[Indices, NDArray[np.intp], Doubles],
    rig: Rig,
    found: tuple[Indices, NDArray[np.intp], Doubles],
    to_scan: Doubles,
) -> Landmarks:
    """The landmarks on both heads, on the template's skin."""
    _, ours, theirs = np.intersect1d(own[0], found[0], return_indices=True)
    corners = template.vertex_of[template.rig.faces[own[1][ours]]]
    on_skin = (corners >= 0).all(axis=1)
    surface = trimesh.Trimesh(template.vertices, template.faces, process=False)
    places, distance, triangles = surface.nearest.on_surface(1000.0 * own[2][ours])
    weights = trimesh.triangles.points_to_barycentric(surface.triangles[triangles], places)
    good = on_skin & (distance < 1.0)
    positions = trimesh.transform_points(found[2][theirs], to_scan)
    return Landmarks(triangles[good].astype(np.intp), weights[good], positions[good])
