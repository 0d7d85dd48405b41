"""Heads that turn, and mouths that never shut."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from support.face_films import face_pictures, make_face_film, speaking, turning_pictures
from support.faces import shipped_rig
from support.tracker import needs_tracker

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.controls import CONTROL_INDEX, LIP_OPENING
from faceedit_app.tracking.tracker import Tracked, eye_rotations, track_film

pytestmark = needs_tracker

SPEAKING = speaking(24)
STILL = np.zeros((3, len(ARKIT_INDEX)), np.float32)


def opening(weights: NDArray[np.floating]) -> NDArray[np.float32]:
    measured = shipped_rig().arkit_distances.measure(weights.astype(np.float32))
    return measured[:, CONTROL_INDEX[LIP_OPENING]]


@pytest.fixture(scope="module")
def turned(tmp_path_factory: pytest.TempPathFactory) -> Tracked:
    """A face that speaks, and then is still while the head turns to either side."""
    faces = [(row, 0.0) for row in SPEAKING]
    for degrees in (0, 10, 20, 30, 20, 10, 0, -10, -20, -30):
        faces += [(row, np.radians(degrees)) for row in STILL]
    path = tmp_path_factory.mktemp("turned") / "turned.mp4"
    return track_film(make_face_film(path, turning_pictures(faces)), shipped_rig())


def still_part(tracked: Tracked) -> slice:
    return slice(len(SPEAKING), len(tracked.weights))


def test_lips_of_a_head_that_turns_stay_shut(turned: Tracked) -> None:
    rest = opening(STILL)[0]
    assert opening(turned.weights)[still_part(turned)].max() < rest + 1.0


def test_eyes_do_not_turn_with_the_head(turned: Tracked) -> None:
    yaw = eye_rotations(turned.weights)[still_part(turned)][:, [0, 3]]
    assert np.degrees(np.abs(yaw)).max() < 8.0


def test_cheeks_do_not_puff(turned: Tracked) -> None:
    assert not turned.weights[:, ARKIT_INDEX["cheekPuff"]].any()


def test_a_mouth_that_never_shuts_stays_open(tmp_path: Path) -> None:
    weights = SPEAKING.copy()
    weights[:, ARKIT_INDEX["jawOpen"]] += 0.25
    found = track_film(make_face_film(tmp_path / "ajar.mp4", face_pictures(weights)), shipped_rig())
    truth, shown = opening(weights), opening(found.weights)
    assert shown.min() > 3.0
    assert shown.max() < truth.max() + 2.0
    assert any("never touch" in note for note in found.notes)
