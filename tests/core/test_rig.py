"""The rig's array expressions against slow, obvious ones."""

from __future__ import annotations

import numpy as np
import pytest
from support.faces import random_rig, shipped_rig

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.controls import CONTROLS
from faceedit_app.core.rig import MILLIMETRES, Rig

SOME = ("jawOpen", "mouthClose", "eyeBlinkLeft", "notInArkit")


def slow_vertices(rig: Rig, weights: np.ndarray) -> np.ndarray:
    moved = rig.neutral.astype(np.float64)
    for k, weight in enumerate(weights):
        moved = moved + float(weight) * rig.deltas[k]
    return moved


def slow_controls(rig: Rig, weights: np.ndarray) -> np.ndarray:
    least = [-np.inf if control.sideways else 0 for control in CONTROLS]
    return np.asarray(np.maximum(slow_signed_controls(rig, weights), least))


def slow_signed_controls(rig: Rig, weights: np.ndarray) -> np.ndarray:
    rows = []
    for frame in weights:
        at = slow_vertices(rig, frame)
        row = []
        for control, (a, b) in zip(CONTROLS, rig.control_pairs, strict=True):
            length = MILLIMETRES * np.linalg.norm(at[b] - at[a])
            rest, now = rig.neutral[b, 1] - rig.neutral[a, 1], at[b, 1] - at[a, 1]
            if control.sideways:
                length = MILLIMETRES * (at[b, 0] - at[a, 0])
            row.append(-length if control.shuts and rest * now < 0 else length)
        rows.append(row)
    return np.array(rows)


def random_weights(rig: Rig, frames: int) -> np.ndarray:
    random = np.random.default_rng(frames)
    return random.random((frames, len(rig.channels))).astype(np.float32)


@pytest.mark.parametrize("channels", [ARKIT_CHANNELS, SOME])
def test_vertices_are_the_neutral_face_plus_weighted_shapes(channels: tuple[str, ...]) -> None:
    rig = random_rig(3, channels)
    weights = random_weights(rig, 1)[0]
    vertices = rig.vertices(weights)
    assert vertices.dtype == np.float32
    np.testing.assert_allclose(vertices, slow_vertices(rig, weights), atol=1e-7)
    np.testing.assert_array_equal(rig.vertices(np.zeros(len(channels), np.float32)), rig.neutral)


@pytest.mark.parametrize("channels", [ARKIT_CHANNELS, SOME])
def test_controls_are_the_distances_between_vertices(channels: tuple[str, ...]) -> None:
    rig = random_rig(5, channels)
    weights = random_weights(rig, 9)
    slow = slow_controls(rig, weights)
    np.testing.assert_allclose(rig.controls(weights), slow, rtol=1e-5, atol=1e-4)


def test_controls_of_a_whole_clip_on_the_shipped_character() -> None:
    rig = shipped_rig()
    weights = random_weights(rig, 202)
    controls = rig.controls(weights)
    assert controls.shape == (202, len(CONTROLS))
    assert controls.dtype == np.float32
    slow = slow_controls(rig, weights[::40])
    np.testing.assert_allclose(controls[::40], slow, rtol=1e-4, atol=1e-4)


@pytest.mark.parametrize("rig", [random_rig(1), shipped_rig()], ids=["random", "shipped"])
def test_jacobian_equals_finite_differences(rig: Rig) -> None:
    weights = np.float32(0.2) + np.float32(0.5) * random_weights(rig, 3)
    lengths, jacobian = rig.distances.jacobian(weights)
    slow = slow_signed_controls(rig, weights)
    np.testing.assert_allclose(lengths, slow, rtol=1e-4, atol=1e-4)
    least = rig.distances.least
    np.testing.assert_allclose(np.maximum(lengths, least), rig.controls(weights), rtol=1e-6)
    step = 1e-3
    for k in range(len(rig.channels)):
        more, less = weights.copy(), weights.copy()
        more[:, k] += step
        less[:, k] -= step
        slope = (slow_signed_controls(rig, more[:1]) - slow_signed_controls(rig, less[:1])) / (
            2 * step
        )
        np.testing.assert_allclose(jacobian[:1, :, k], slope, atol=0.02)


def test_lids_that_pass_each_other_are_shut() -> None:
    rig = shipped_rig()
    weights = np.zeros((2, 52), np.float32)
    weights[:, ARKIT_CHANNELS.index("eyeBlinkLeft")] = (0.9, 1.0)
    weights[1, ARKIT_CHANNELS.index("eyeSquintLeft")] = 0.6
    left = CONTROLS.index(next(c for c in CONTROLS if c.id == "left_eyelid"))
    assert 0 < rig.controls(weights)[0, left] < 1.5
    assert rig.controls(weights)[1, left] == 0
    assert rig.distances.signed(weights)[1, left] < -1


def test_jacobian_of_a_closed_distance_is_finite() -> None:
    rig = random_rig(2)
    rig.neutral[1] = rig.neutral[0]
    lengths, jacobian = rig.distances.jacobian(np.zeros((1, 52), np.float32))
    assert lengths[0, 0] == 0
    assert np.isfinite(jacobian).all()


def test_arkit_weights_reach_a_rig_with_other_channels_by_name() -> None:
    rig = random_rig(7, SOME)
    arkit = np.random.default_rng(0).random((6, 52)).astype(np.float32)
    mine = rig.from_arkit(arkit)
    for k, name in enumerate(SOME):
        expected = arkit[:, ARKIT_CHANNELS.index(name)] if name in ARKIT_CHANNELS else 0.0
        np.testing.assert_array_equal(mine[:, k], np.broadcast_to(expected, 6))
    np.testing.assert_array_equal(rig.from_arkit(arkit[2]), mine[2])
    np.testing.assert_allclose(rig.arkit_distances.measure(arkit), rig.controls(mine), rtol=1e-5)
