"""The camera: where it can be, and where it can be pointed."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from support.cameras import seen
from support.faces import shipped_rig
from support.rigs import ball

from faceedit_app.core.controls import CONTROL_INDEX, LIDS, MOUTH_WIDTH
from faceedit_app.core.rig import Rig
from faceedit_app.render import (
    Aim,
    Camera,
    aimed_camera,
    default_camera,
)
from faceedit_app.render.camera import DISTANCE_LIMITS, PITCH_LIMIT, field_of_view


@pytest.fixture(scope="module")
def rig() -> Rig:
    return ball()


def test_orbit_turns_around_the_target_and_stops_short_of_the_pole() -> None:
    camera = Camera().orbit(0.4, 10.0)
    assert camera.pitch == PITCH_LIMIT
    position = camera.pose()[:3, 3]
    assert np.linalg.norm(position - camera.target) == pytest.approx(camera.distance)
    assert Camera().orbit(math.tau + 0.1, 0.0).yaw == pytest.approx(0.1)


def test_positive_yaw_sees_the_characters_left() -> None:
    assert Camera().orbit(0.5, 0.0).pose()[0, 3] > 0.0
    assert Camera().orbit(0.0, 0.5).pose()[1, 3] > Camera().pose()[1, 3]


def test_zoom_is_limited() -> None:
    assert Camera().zoom(1e-6).distance == DISTANCE_LIMITS[0]
    assert Camera().zoom(1e6).distance == DISTANCE_LIMITS[1]


def test_pan_moves_in_the_view_plane() -> None:
    camera = Camera(yaw=math.pi / 2)  # from the character's left: rightwards is -Z
    moved = np.subtract(camera.pan(0.02, 0.01).target, camera.target)
    np.testing.assert_allclose(moved, [0.0, 0.01, -0.02], atol=1e-9)


def test_the_pose_is_a_rotation_that_looks_at_the_target() -> None:
    camera = Camera(0.3, -0.2, 0.6, (0.01, 0.02, 0.03))
    ahead = camera.pose() @ [0.0, 0.0, -camera.distance, 1.0]
    np.testing.assert_allclose(ahead, [*camera.target, 1.0], atol=1e-12)
    rotation = camera.pose()[:3, :3]
    np.testing.assert_allclose(rotation.T @ rotation, np.eye(3), atol=1e-12)
    assert np.linalg.det(rotation) == pytest.approx(1.0)


@pytest.mark.parametrize("aspect", [0.4, 0.8, 1.0, 1.8])
def test_default_camera_sees_the_whole_head(rig: Rig, aspect: float) -> None:
    camera = default_camera(rig, aspect)
    points = np.hstack((rig.neutral, np.ones((len(rig.neutral), 1), np.float32)))
    x, y, z, _ = np.linalg.inv(camera.pose()) @ points.T
    face = rig.neutral[:, 1] >= rig.neutral[np.abs(rig.deltas).max((0, 2)) > 0, 1].min()
    half = np.tan(field_of_view(aspect) / 2.0)
    assert np.abs(y / -z / half)[face].max() < 1.0
    assert np.abs(x / -z / (half * aspect))[face].max() < 1.0


# --- where the camera can be pointed ---------------------------------------------------------


@pytest.mark.parametrize("aspect", [0.5, 1.0, 1.8])
def test_details_fill_the_view_and_lie_in_its_middle(aspect: float) -> None:
    rig = shipped_rig()
    for aim, names in ((Aim.MOUTH, (MOUTH_WIDTH,)), (Aim.EYES, LIDS)):
        camera = aimed_camera(rig, aim, aspect)
        pairs = rig.control_pairs[[CONTROL_INDEX[name] for name in names]].ravel()
        places = np.array([seen(camera, rig.neutral[i], aspect) for i in pairs])
        assert np.abs(places).max() < 0.9, "all of it is in view"
        assert np.ptp(places[:, 0]) > 0.3, "and not from far away"
        assert np.abs(places.mean(axis=0)).max() < 0.1
        assert camera.yaw == 0


def test_sides_are_the_characters_own() -> None:
    rig = shipped_rig()
    left, right = (aimed_camera(rig, aim).pose()[:3, 3] for aim in (Aim.LEFT, Aim.RIGHT))
    assert left[0] > 0.2, "+X is the character's left"
    assert right[0] < -0.2
    assert aimed_camera(rig, Aim.FRONT) == default_camera(rig)
    head = rig.neutral[rig.neutral[:, 1] > 0.0]
    for aim in (Aim.LEFT, Aim.RIGHT):
        across = np.array([seen(aimed_camera(rig, aim), point, 1.0)[0] for point in head[::40]])
        assert -1.0 < across.min() < 0.0 < across.max() < 1.0


def test_a_character_without_the_controls_of_a_detail_is_seen_from_the_front() -> None:
    rig = shipped_rig()
    bare = dataclasses.replace(rig, control_pairs=np.full_like(rig.control_pairs, -1))
    for aim in (Aim.MOUTH, Aim.EYES):
        assert aimed_camera(bare, aim) == default_camera(bare)
