"""Deformation transfer: shapes keep what they do when a head is turned, larger or of other form."""

from __future__ import annotations

import numpy as np
import pytest
from support.heads import EYE, Head, small_head

from faceedit_app.characters.transfer import Transfer
from faceedit_app.core.arrays import Bools, Doubles


@pytest.fixture(scope="module")
def head() -> Head:
    return small_head()


def still(head: Head) -> Bools:
    moved = np.abs(np.stack(list(head.targets.values()))).max(axis=(0, 2))
    return np.asarray(moved < 1e-4)


def test_the_same_head_gets_the_same_shapes(head: Head) -> None:
    transfer = Transfer(head.vertices, head.vertices, head.faces, still(head))
    for channel in ("jawOpen", "eyeBlinkLeft", "mouthPucker"):
        np.testing.assert_allclose(
            transfer(head.targets[channel]), head.targets[channel], atol=1e-6
        )


def test_what_does_not_move_stays(head: Head) -> None:
    transfer = Transfer(head.vertices, 1.2 * head.vertices, head.faces, still(head))
    np.testing.assert_allclose(transfer(np.zeros_like(head.vertices)), 0, atol=1e-6)
    np.testing.assert_array_equal(transfer(head.targets["jawOpen"])[still(head)], 0)


def _apart(head: Head, vertices: Doubles, moves: Doubles, *names: str) -> float:
    """Mm from one point to another in a pose."""
    one, other = (
        int(np.linalg.norm(head.vertices - head.points[name], axis=1).argmin()) for name in names
    )
    posed = vertices + moves
    return float(np.linalg.norm(posed[one] - posed[other]))


@pytest.mark.parametrize("size", [0.7, 1.4])
def test_on_a_larger_head_shapes_are_larger(head: Head, size: float) -> None:
    """Copied displacements are those of the wrong head."""
    target, moves = size * head.vertices, head.targets["jawOpen"]
    found = Transfer(head.vertices, target, head.faces, still(head))(moves)
    lips = "inner_upper_lip", "inner_lower_lip"
    own = _apart(head, target, size * moves, *lips)
    transferred, copied = (abs(_apart(head, target, m, *lips) - own) for m in (found, moves))
    assert transferred < 0.6 * copied


def test_larger_eyes_close_farther_than_with_a_copy_of_the_shape(head: Head) -> None:
    x, y = head.vertices[:, 0], head.vertices[:, 1]
    near = np.exp(-((np.abs(x) - EYE) ** 2 + y**2) / (2 * 20.0**2))
    target = head.vertices.copy()
    target[:, 1] += 0.8 * y * near
    moves = head.targets["eyeBlinkLeft"]
    found = Transfer(head.vertices, target, head.faces, still(head))(moves)
    lids = "left_lower_lid", "left_upper_lid"
    assert _apart(head, target, found, *lids) < _apart(head, target, moves, *lids) - 0.5
