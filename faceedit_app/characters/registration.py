"""Fit our template to another head by non-rigid registration (paper, section 2).

trimesh does the registration itself (Amberg et al. 2007, "Optimal Step Nonrigid ICP"). This module
adds the initial alignment, the landmarks, and the parts that a scan lacks: mouth bag, teeth, eyes
and hair follow the fitted skin.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.interpolate import RBFInterpolator
from trimesh.registration import nricp_amberg, procrustes

from faceedit_app.core.arrays import Doubles, Indices

# Stiffness, weight of the landmarks, weight of the normals and rounds of each step; the landmarks
# dominate at first and have no weight at the end. With a last stiffness of 0.004 instead of 0.006,
# the neck is drawn to the jaw of heads that have none.
_STEPS = ((0.02, 10.0, 0.5, 10), (0.02, 5.0, 0.5, 8), (0.015, 2.5, 0.5, 6), (0.006, 1.0, 0.0, 5))
_ENOUGH_TO_JUDGE = 40  # landmarks needed to reject outliers
_TOO_FAR = 0.05  # share of the head's size; a vertex farther away has no match
_ANCHORS = 1500  # skin vertices that the unfitted parts follow


@dataclass(frozen=True)
class Landmarks:
    """Corresponding places on a template and a head.

    Attributes:
        triangles: (L,) triangles of the template.
        weights: (L, 3) barycentric coordinates in these.
        positions: (L, 3) places on the head.
    """

    triangles: Indices
    weights: Doubles
    positions: Doubles

    @classmethod
    def at_vertices(
        cls, faces: NDArray[np.integer], vertices: Sequence[int], positions: Doubles
    ) -> Landmarks:
        """Landmarks at vertices of the template."""
        triangles = np.array([int((faces == v).any(axis=1).argmax()) for v in vertices], np.intp)
        weights = (faces[triangles] == np.asarray(vertices)[:, None]).astype(np.float64)
        return cls(triangles, weights, positions)

    def on(self, vertices: Doubles, faces: NDArray[np.integer]) -> Doubles:
        """(L, 3) their places on the template."""
        places: Doubles = np.einsum("lk,lkx->lx", self.weights, vertices[faces[self.triangles]])
        return places

    def plausible(self, vertices: Doubles, faces: NDArray[np.integer]) -> Landmarks:
        """The landmarks without outliers, which are far from a smooth map of the template.

        Landmarks that fell through an eye hole or into the mouth would ruin a fit. The map is of
        second order and is fitted again without the outliers.
        """
        source = self.on(vertices, faces)
        if len(source) < _ENOUGH_TO_JUDGE:
            return self
        centred = (source - source.mean(axis=0)) / np.ptp(source, axis=0).max()
        x, y, z = centred.T
        terms = np.stack(
            (np.ones_like(x), x, y, z, x * x, y * y, z * z, x * y, y * z, x * z), axis=1
        )
        good = np.ones(len(source), np.bool_)
        for _ in range(6):
            found = np.linalg.lstsq(terms[good], self.positions[good], rcond=None)[0]
            error = np.linalg.norm(terms @ found - self.positions, axis=1)
            good &= error < 3.5 * np.median(error[good])
        return Landmarks(self.triangles[good], self.weights[good], self.positions[good])

    def misfit(self, vertices: Doubles, faces: NDArray[np.integer]) -> float:
        """Median distance between the two faces' landmarks, turned and scaled onto each other.

        It is in the template's unit: some millimetres between any two faces, much more if what was
        found is no face.
        """
        source = self.on(vertices, faces)
        placed = procrustes(self.positions, source, reflection=False)[1]
        return float(np.median(np.linalg.norm(placed - source, axis=1)))


@dataclass(frozen=True)
class FittedTemplate:
    """A template fitted to another head.

    Attributes:
        vertices: (V, 3) the template's vertices, in the head's coordinates.
        similarity: (4, 4) the initial alignment.
    """

    vertices: Doubles
    similarity: Doubles


def register(
    vertices: Doubles,
    faces: NDArray[np.integer],
    landmarks: Landmarks,
    target: trimesh.Trimesh,
) -> FittedTemplate:
    """Fit a template to a head.

    Args:
        vertices, faces: (V, 3) and (F, 3) of the template.
        landmarks: places on both.
        target: the head, in any unit and place.
    """
    here = landmarks.on(vertices, faces)
    similarity = procrustes(here, landmarks.positions, reflection=False)[0]
    start = trimesh.transform_points(vertices, similarity)
    fitted = nricp_amberg(
        trimesh.Trimesh(start, faces, process=False),
        target,
        source_landmarks=(landmarks.triangles, landmarks.weights),
        target_positions=landmarks.positions,
        steps=_STEPS,
        distance_threshold=_TOO_FAR,
        use_faces=True,
        use_vertex_normals=True,
    )
    return FittedTemplate(np.asarray(fitted, np.float64), np.asarray(similarity, np.float64))


def carry(fitted: FittedTemplate, before: Doubles, anchors: Indices, others: Doubles) -> Doubles:
    """Move vertices that were not fitted along with the fitted ones: (N, 3).

    Args:
        fitted: the fitted template.
        before: (V, 3) its vertices before the fit.
        anchors: the vertices that the others follow.
        others: (N, 3) the other vertices of the template.
    """
    start = trimesh.transform_points(before, fitted.similarity)
    moved = fitted.vertices - start
    chosen = anchors[:: max(len(anchors) // _ANCHORS, 1)]
    smooth = RBFInterpolator(start[chosen], moved[chosen], neighbors=40, kernel="linear")
    there = trimesh.transform_points(others, fitted.similarity)
    carried: Doubles = there + smooth(there)
    return carried


def distances(fitted: Doubles, target: trimesh.Trimesh) -> Doubles:
    """(V,) distances of vertices from the head's surface."""
    far: Doubles = np.asarray(target.nearest.on_surface(fitted)[1], np.float64)
    return far
