"""Pose, person and weights from landmarks that are computed, without networks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from support.face_films import speaking
from support.faces import shipped_rig

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.tracking.face_model import FaceModel
from faceedit_app.tracking.fit import FitSettings, fit_weights
from faceedit_app.tracking.person import find_person
from faceedit_app.tracking.pose import fit_poses
from faceedit_app.tracking.tracker import eye_rotations

Doubles = NDArray[np.float64]
MIDDLE = np.array([320.0, -240.0])
SCALE = 1.6  # pixels per mm


@pytest.fixture(scope="module")
def model() -> FaceModel:
    return FaceModel.of(shipped_rig())


def seen_from(
    model: FaceModel, weights: Doubles, turns: Rotation, noise: float = 0.0, seed: int = 1
) -> Doubles:
    """(T, n, 3) pixels of landmarks with weights (T, 52), from far away."""
    shape = model.rest + np.einsum("tk,knx->tnx", weights, model.moves)
    turned = SCALE * np.einsum("tij,tnj->tni", turns.as_matrix(), shape)
    turned[..., :2] += MIDDLE
    random = np.random.default_rng(seed)
    noisy: Doubles = turned + noise * random.normal(size=turned.shape)
    return noisy


def turning(frames: int, degrees: float) -> Rotation:
    swing = degrees * np.sin(np.linspace(0.0, 2 * np.pi, frames))
    return Rotation.from_euler("YXZ", np.stack([swing, 0.4 * swing, 0.2 * swing], 1), degrees=True)


def opening(weights: Doubles) -> Doubles:
    measured = shipped_rig().arkit_distances.measure(weights.astype(np.float32))
    return measured[:, CONTROL_INDEX["mouth_opening"]].astype(np.float64)


def test_the_pose_of_a_head_is_found_exactly(model: FaceModel) -> None:
    turns = turning(12, 35.0)
    poses = fit_poses(seen_from(model, np.zeros((12, 52)), turns), model.rest, model.steady)
    apart = Rotation.from_matrix(poses.turns) * turns.inv()
    assert np.degrees(apart.magnitude()).max() < 0.01
    np.testing.assert_allclose(poses.scales, SCALE, rtol=1e-6)


def test_yaw_and_pitch_have_live_links_signs(model: FaceModel) -> None:
    """A head turned to its left has a negative yaw, one that looks down a positive pitch."""
    turns = Rotation.from_euler("YXZ", [[20.0, 0.0, 0.0], [0.0, 15.0, 0.0]], degrees=True)
    poses = fit_poses(seen_from(model, np.zeros((2, 52)), turns), model.rest, model.steady)
    np.testing.assert_allclose(np.degrees(poses.angles[0]), [-20.0, 0.0, 0.0], atol=0.01)
    np.testing.assert_allclose(np.degrees(poses.angles[1]), [0.0, 15.0, 0.0], atol=0.01)
    looks = np.zeros((1, 52))
    looks[0, [ARKIT_INDEX["eyeLookOutLeft"], ARKIT_INDEX["eyeLookInRight"]]] = 1.0
    assert (eye_rotations(looks)[0, [0, 3]] < 0).all()


@pytest.mark.parametrize("degrees", [0.0, 25.0])
def test_the_mouth_opens_as_far_as_it_did(model: FaceModel, degrees: float) -> None:
    weights = speaking().astype(np.float64)
    seen = seen_from(model, weights, turning(len(weights), degrees))
    good = np.ones(len(weights), bool)
    person = find_person(model, seen, good, MIDDLE)
    times = np.arange(len(weights)) / 25.0
    fit = fit_weights(model, person, seen, times, np.ones(len(weights)))
    away = np.abs(opening(fit.weights) - opening(weights))
    assert np.median(away) < 1.0
    assert fit.weights.min() >= 0.0
    assert fit.weights.max() <= 1.0
    close, jaw = ARKIT_INDEX["mouthClose"], ARKIT_INDEX["jawOpen"]
    assert (fit.weights[:, close] <= fit.weights[:, jaw]).all()


@pytest.mark.parametrize("least", [0.0, 0.25], ids=["seldom shut", "never shut"])
def test_lips_that_rest_apart_are_as_far_apart_as_they_were(model: FaceModel, least: float) -> None:
    """The calm pictures show an open mouth: that is no neutral face."""
    weights = np.zeros((60, 52))
    jaw = ARKIT_INDEX["jawOpen"]
    weights[:, jaw] = 0.06 + 0.2 * np.sin(np.linspace(0.0, 2 * np.pi, 60)) ** 8
    weights[5::20, jaw] = 0.0
    weights[:, jaw] += least
    seen = seen_from(model, weights, turning(60, 0.0))
    person = find_person(model, seen, np.ones(60, bool), MIDDLE)
    assert person.is_ajar == (least > 0.0)
    fit = fit_weights(model, person, seen, np.arange(60) / 25.0, np.ones(60))
    assert np.median(np.abs(opening(fit.weights) - opening(weights))) < 0.7


def test_shut_lips_are_shut_whatever_the_depth_between_them(model: FaceModel) -> None:
    """A film shows no depth: rolled lips must not stand in for shut ones."""
    weights = np.zeros((60, 52))
    jaw, close, roll = (ARKIT_INDEX[c] for c in ("jawOpen", "mouthClose", "mouthRollLower"))
    neutral = seen_from(model, weights, turning(60, 0.0))
    person = find_person(model, neutral, np.ones(60, bool), MIDDLE)
    weights[:, jaw] = 0.3
    weights[20:40, close], weights[20:40, roll] = 0.3, 0.2
    seen = seen_from(model, weights, turning(60, 0.0), noise=0.4)
    fit = fit_weights(model, person, seen, np.arange(60) / 25.0, np.ones(60))
    rest = float(opening(np.zeros((1, 52)))[0])
    assert np.abs(opening(fit.weights)[21:39] - rest).max() < 0.5
    assert opening(fit.weights)[[10, 50]].min() > rest + 5.0


def test_time_takes_away_shaking_and_keeps_a_blink(model: FaceModel) -> None:
    weights = speaking(60).astype(np.float64)
    weights[:, ARKIT_INDEX["jawOpen"]] = 0.0
    seen = seen_from(model, weights, turning(60, 0.0), noise=0.6)
    person = find_person(model, seen, np.ones(60, bool), MIDDLE)
    times, trust = np.arange(60) / 25.0, np.ones(60)
    rig = shipped_rig()

    def curves(settings: FitSettings) -> NDArray[np.float32]:
        fit = fit_weights(model, person, seen, times, trust, settings)
        return rig.arkit_distances.measure(fit.weights.astype(np.float32))

    settings = FitSettings()
    each, full = curves(replace(settings, smoothness=0.0)), curves(settings)
    lips, lid = CONTROL_INDEX["mouth_opening"], CONTROL_INDEX["left_eyelid"]
    assert np.diff(full[:, lips], n=2).std() < 0.8 * np.diff(each[:, lips], n=2).std()
    assert abs(int(full[:, lid].argmin()) - 29) <= 1
    assert full[:, lid].min() < 1.5


def test_long_films_are_fitted_in_blocks_without_a_seam(
    model: FaceModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    weights = np.tile(speaking(), (2, 1)).astype(np.float64)
    seen = seen_from(model, weights, turning(len(weights), 0.0))
    person = find_person(model, seen, np.ones(len(weights), bool), MIDDLE)
    times, trust = np.arange(len(weights)) / 25.0, np.ones(len(weights))
    whole = fit_weights(model, person, seen, times, trust)
    monkeypatch.setattr("faceedit_app.tracking.fit._BLOCK", 33)
    monkeypatch.setattr("faceedit_app.tracking.fit._MARGIN", 12)
    parts = fit_weights(model, person, seen, times, trust)
    assert parts.weights.shape == whole.weights.shape
    assert np.abs(opening(parts.weights) - opening(whole.weights)).max() < 0.2
