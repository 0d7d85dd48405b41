"""What the builder of the character does with meshes, against slow and obvious versions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import trimesh
from support.places import ROOT


@pytest.fixture
def geometry(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The builder's module; the builder is no part of the installed package."""
    monkeypatch.syspath_prepend(str(ROOT))
    from assets.builder import geometry

    return geometry


@pytest.fixture(scope="module")
def ball() -> trimesh.Trimesh:
    """A sphere of radius 2 around (1, 0, 0), of 320 flat faces."""
    ball: trimesh.Trimesh = trimesh.creation.icosphere(subdivisions=2, radius=2.0)
    ball.apply_translation([1.0, 0.0, 0.0])
    return ball


def test_nothing_is_merged_or_dropped(geometry: Any) -> None:
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 1, 0], [9, 9, 9]])
    faces = np.array([[0, 1, 2], [0, 1, 3], [0, 0, 1]])
    mesh = geometry.mesh_of(vertices, faces)
    np.testing.assert_array_equal(mesh.vertices, vertices)
    np.testing.assert_array_equal(mesh.faces, faces)


def test_normals_are_weighted_by_area(geometry: Any, ball: trimesh.Trimesh) -> None:
    sums = np.zeros_like(ball.vertices)
    for face, corners in zip(ball.faces, ball.triangles, strict=True):
        sums[face] += np.cross(corners[1] - corners[0], corners[2] - corners[0])
    sums /= np.linalg.norm(sums, axis=1, keepdims=True)
    np.testing.assert_allclose(geometry.vertex_normals(ball), sums, atol=1e-12)


def test_smoothing_takes_the_mean_of_the_neighbours(geometry: Any, ball: trimesh.Trimesh) -> None:
    random = np.random.default_rng(3)
    count = len(ball.vertices)
    # A hole, so that there are edges with a face on one side only; and its middle on its own.
    holed = geometry.mesh_of(ball.vertices, ball.faces[(ball.faces != 7).all(axis=1)])
    values, strength = random.normal(size=(count, 2)), random.random(count)
    expected = values
    for _ in range(3):
        following = expected.copy()
        for vertex in range(count):
            touching = holed.faces[(holed.faces == vertex).any(axis=1)]
            others = sorted(set(touching.ravel().tolist()) - {vertex})
            mean = expected[others].mean(axis=0) if others else np.zeros(2)
            following[vertex] += strength[vertex] * (mean - expected[vertex])
        expected = following
    np.testing.assert_allclose(geometry.smooth(values, holed, strength, 3), expected, atol=1e-12)
    np.testing.assert_array_equal(geometry.smooth(values, holed, 0.0, 3), values)


def test_points_drop_onto_the_front(geometry: Any, ball: trimesh.Trimesh) -> None:
    points = geometry.project_front(ball, np.array([[1.0, 0.1], [2.0, 0.3], [5.0, 0.0]]))
    np.testing.assert_array_equal(points[:, :2], [[1.0, 0.1], [2.0, 0.3], [5.0, 0.0]])
    expected = np.sqrt(4.0 - (points[:2, 0] - 1.0) ** 2 - points[:2, 1] ** 2)
    np.testing.assert_allclose(points[:2, 2], expected, atol=0.05)
    assert points[2, 2] == -np.inf


def test_rays_reach_the_last_face(geometry: Any, ball: trimesh.Trimesh) -> None:
    directions = np.array([[1.0, 0.02, 0.03], [-1.0, 0.02, 0.03], [0.0, 1.0, 0.0]])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    distances = geometry.cast_outermost(ball, np.array([-2.0, 0.0, 0.0]), directions)
    assert distances[0] == pytest.approx(5.0, abs=0.05), "not at 1, where it goes in"
    assert np.isnan(distances[1:]).all()


def test_a_rigid_motion_is_found_again(geometry: Any) -> None:
    random = np.random.default_rng(4)
    before = random.normal(size=(20, 3)) * 30 + [0, 700, 0]
    matrix = trimesh.transformations.rotation_matrix(0.4, [1, 2, 3], [5, 690, 7])
    after = trimesh.transform_points(before, matrix)
    np.testing.assert_allclose(geometry.fit_rigid(before, after), matrix, atol=1e-9)
    mirrored = geometry.fit_rigid(before, before * [-1, 1, 1])
    assert np.linalg.det(mirrored[:3, :3]) == pytest.approx(1.0), "no reflection"


def test_anchored_points_go_with_the_surface(geometry: Any, ball: trimesh.Trimesh) -> None:
    surface = geometry.Surface(ball)
    directions = np.random.default_rng(5).normal(size=(40, 3))
    points = [1.0, 0.0, 0.0] + 2.2 * directions / np.linalg.norm(directions, axis=1)[:, None]
    anchors = surface.anchor(points)
    closest, _, _ = trimesh.proximity.closest_point(ball, points)
    np.testing.assert_allclose(surface.position(anchors), closest, atol=1e-9)
    np.testing.assert_allclose(anchors.weights.sum(axis=1), 1.0)
    field = np.stack([ball.vertices * 2.0, ball.vertices + 1.0])
    read = anchors.read(field)
    np.testing.assert_allclose(read[0], 2.0 * surface.position(anchors), atol=1e-9)
    np.testing.assert_allclose(read[1], 1.0 + surface.position(anchors), atol=1e-9)
    lifted = surface.position(anchors, lift=0.5) - surface.position(anchors)
    np.testing.assert_allclose(np.linalg.norm(lifted, axis=1), 0.5)
    assert ((lifted * (points - [1.0, 0.0, 0.0])).sum(axis=1) > 0).all(), "outwards"
