"""Curves that were not asked for: how the take moves them, and beyond it how others do."""

from __future__ import annotations

import numpy as np
import pytest

from faceedit_app.core.arrays import Doubles
from faceedit_app.editing.solving.expectation import FARTHEST, Expectation

SMALL, LARGE = 2.0, 10.0  # mm, what curves of the take move by


def known_curves(others: Doubles) -> Expectation:
    """Three curves, of which the second is the first less the third in the take.

    Args:
        others: (3, 3) mm², their covariance in other performances.
    """
    phase = np.linspace(0.0, 2.0 * np.pi, 5000, endpoint=False)
    first, third = SMALL * np.sin(phase) * 2**0.5, LARGE * np.cos(phase) * 2**0.5
    take = np.stack([first, first - third, third], axis=1)
    alone = np.array([False, False, True])
    return Expectation(take, others, np.arange(3), np.zeros(3, np.bool_), alone)


def test_a_curve_follows_as_in_the_take_and_beyond_it_as_in_others() -> None:
    down = np.array([[4.0, -4.0, 0.0], [-4.0, 4.0, 0.0], [0.0, 0.0, 4.0]])
    far = FARTHEST * SMALL
    change = np.zeros((3, 3))
    change[:, 0] = 0.5 * far, far, 2.0 * far
    followed = known_curves(down).fill(change, change != 0)[:, 1]
    assert followed[:2] == pytest.approx([0.5 * far, far], rel=0.1)
    assert followed[2] == pytest.approx(0.0, abs=0.1 * far)  # as far down with the others as up


def test_of_what_is_asked_together_no_part_is_answered_alone() -> None:
    far = 3.0 * FARTHEST * SMALL  # for the first, and near for the third
    change = np.array([[far, 0.0, far]])
    followed = known_curves(16.0 * np.eye(3)).fill(change, change != 0)[0, 1]
    assert followed == pytest.approx(0.0, abs=0.1 * far)


def test_a_curve_is_given_little_by_little() -> None:
    known = known_curves(16.0 * np.eye(3))
    change = np.repeat([[2.0, 3.0, 0.0]], 3, axis=0)
    firm = np.array([[1.0, 0.0, 0.0], [1.0, 0.5, 0.0], [1.0, 1.0, 0.0]])
    first, half, last = known.expected(change, firm)
    assert first[1] == pytest.approx(2.0, abs=0.2)  # it follows the first, as in the take
    assert last[1] == 3.0
    assert half == pytest.approx(0.5 * (first + last))


def test_a_curve_that_moves_alone_moves_no_other() -> None:
    change = np.array([[0.0, 0.0, LARGE], [SMALL, 0.0, LARGE]])
    alone, together = known_curves(16.0 * np.eye(3)).expected(change, (change != 0).astype(float))
    assert alone.tolist() == [0.0, 0.0, LARGE]
    assert together[1] < -0.5 * LARGE
