"""The width of the mouth follows its corners, and they it; nothing else follows."""

from __future__ import annotations

import numpy as np

from faceedit_app.core.regions import CONTROL_IDS, CONTROL_INDEX
from faceedit_app.editing.companions import follow

LOWER = CONTROL_IDS[:6]


def covariance() -> np.ndarray:
    random = np.random.default_rng(2)
    mixing = random.normal(size=(6, 6))
    mixing[1:4] += 2 * random.normal(size=6)  # width and corners move together
    return mixing @ mixing.T


def change_of(**millimetres: float) -> tuple[np.ndarray, np.ndarray]:
    change = np.zeros((3, 8))
    for name, amount in millimetres.items():
        change[1, CONTROL_INDEX[name]] = amount
    edited = [float(name in millimetres) for name in CONTROL_IDS]
    return change, np.tile(edited, (3, 1))


def test_width_follows_the_corners_by_what_is_most_probable() -> None:
    change, edited = change_of(left_corner=3.0, right_corner=2.0)
    result = follow(change, edited, LOWER, covariance())
    width = CONTROL_INDEX["mouth_width"]
    given = [0, 2, 3, 4, 5]
    # The mode of the Gaussian, found by a slow scan instead of by the formula.
    precision = np.linalg.inv(covariance() + 0.01 * np.diag([1, 0, 1, 1, 1, 1]))
    scan = np.linspace(-20, 20, 40001)
    point = np.tile(change[1, :6], (len(scan), 1))
    point[:, width] = scan
    best = scan[np.argmin(np.einsum("nc,cd,nd->n", point, precision, point))]
    assert abs(best) > 0.1
    np.testing.assert_allclose(result[1, width], best, atol=0.01)
    np.testing.assert_array_equal(result[1, given], change[1, given])
    np.testing.assert_array_equal(result[[0, 2]], 0)


def test_what_the_user_edited_follows_nothing() -> None:
    change, edited = change_of(left_corner=3.0, right_corner=2.0, mouth_width=-1.0)
    np.testing.assert_array_equal(follow(change, edited, LOWER, covariance()), change)


def test_controls_without_companions_leave_the_others_alone() -> None:
    for name in ("mouth_opening", "upper_lip", "lower_lip"):
        change, edited = change_of(**{name: 4.0})
        np.testing.assert_array_equal(follow(change, edited, LOWER, covariance()), change)
    change, edited = change_of(left_eyelid=-4.0)
    np.testing.assert_array_equal(follow(change, edited, CONTROL_IDS[6:], np.eye(2)), change)


def test_an_edit_of_the_width_at_another_time_leaves_a_smile_alone() -> None:
    change, hold = np.zeros((9, 8)), np.zeros((9, 8))
    corners = [CONTROL_INDEX["left_corner"], CONTROL_INDEX["right_corner"]]
    width = CONTROL_INDEX["mouth_width"]
    change[1:3, corners], hold[1:3, corners] = 3.0, 1.0
    alone = follow(change, hold, LOWER, covariance())
    change[6:8, width], hold[6:8, width] = -1.0, 1.0
    together = follow(change, hold, LOWER, covariance())
    np.testing.assert_array_equal(together[:4], alone[:4])
    assert (np.abs(alone[1:3, width]) > 0.1).all()


def test_following_fades_as_the_follower_is_asked_for_itself() -> None:
    change, hold = np.zeros((11, 8)), np.zeros((11, 8))
    corner, width = CONTROL_INDEX["left_corner"], CONTROL_INDEX["mouth_width"]
    change[:, corner], hold[:, corner] = 3.0, 1.0
    hold[:, width] = np.linspace(0, 1, 11)
    followed = follow(change, hold, LOWER, covariance())[:, width]
    np.testing.assert_allclose(np.diff(followed), followed[1] - followed[0])
    assert followed[-1] == 0
