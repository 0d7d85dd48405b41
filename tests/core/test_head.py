"""A turning head: the directions of Live Link Face, and a body that stays."""

from __future__ import annotations

import numpy as np
import pytest
from support.faces import shipped_rig

from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.core.head import Head, turn


def moved(rotation: tuple[float, float, float]) -> tuple[float, float, float]:
    """Where a turn moves the middle of the upper lip, metres: to the left, up, to the front."""
    rig = shipped_rig()
    lip = rig.control_pairs[CONTROL_INDEX["mouth_opening"], 0]
    turned = Head(rig).turned(rig.neutral, np.array(rotation, np.float32))
    x, y, z = (turned - rig.neutral)[lip].tolist()
    return x, y, z


def test_positive_yaw_turns_to_the_persons_right() -> None:
    assert moved((0.3, 0.0, 0.0))[0] < -0.01  # +X is the character's left


def test_positive_pitch_looks_down() -> None:
    assert moved((0.0, 0.3, 0.0))[1] < -0.01


def test_positive_roll_tilts_to_the_persons_right() -> None:
    rig = shipped_rig()
    top = int(rig.neutral[:, 1].argmax())
    turned = Head(rig).turned(rig.neutral, np.array([0.0, 0.0, 0.3], np.float32))
    assert turned[top, 0] < rig.neutral[top, 0] - 0.01


def test_face_turns_rigidly_and_the_chest_stays() -> None:
    rig = shipped_rig()
    turned = Head(rig).turned(rig.neutral, np.array([0.4, 0.2, -0.1], np.float32))
    pairs = rig.control_pairs[rig.has_control]
    lengths = [
        np.linalg.norm(at[pairs[:, 0]] - at[pairs[:, 1]], axis=1) for at in (rig.neutral, turned)
    ]
    np.testing.assert_allclose(lengths[1], lengths[0], atol=1e-6)
    lowest = int(rig.neutral[:, 1].argmin())
    np.testing.assert_allclose(turned[lowest], rig.neutral[lowest], atol=1e-6)


@pytest.mark.parametrize("axis", range(3))
def test_turn_is_a_rotation(axis: int) -> None:
    matrix = turn(*np.eye(3)[axis] * 0.7)
    np.testing.assert_allclose(matrix @ matrix.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(matrix) == pytest.approx(1.0)
