"""The most probable change within bounds is found exactly."""

from __future__ import annotations

import numpy as np
import pytest
from support.chance import seeds

from faceedit_app.core.arrays import Doubles
from faceedit_app.editing.solving import within_bounds
from faceedit_app.editing.solving.within_bounds import Squares

FRAMES, CONTROLS, WEIGHTS = 40, 5, 12


def random_frames(seed: int) -> Squares:
    """Frames that ask for a little more of this or that each time."""
    chance = np.random.default_rng(seed)
    root = chance.normal(size=(WEIGHTS, WEIGHTS)) / 3
    slopes = chance.normal(size=(CONTROLS, WEIGHTS)) * chance.choice([0.3, 5.0, 30.0], WEIGHTS)
    steps = 0.02 * chance.normal(size=(FRAMES, CONTROLS)).cumsum(axis=0)
    here = chance.random(WEIGHTS) * chance.integers(0, 2, WEIGHTS)
    return Squares.of(
        root @ root.T + 5 * np.eye(WEIGHTS),
        np.broadcast_to(slopes, (FRAMES, CONTROLS, WEIGHTS)),
        chance.normal(size=CONTROLS) + steps,
        np.full((FRAMES, CONTROLS), 0.05**2),
        (np.tile(-here, (FRAMES, 1)), np.tile(1 - here, (FRAMES, 1))),
    )


def lacks(squares: Squares, change: Doubles) -> float:
    """How far the worst weight could still move towards a smaller sum."""
    pull = squares.slope - (squares.curvature @ change[:, :, None])[:, :, 0]
    step = pull / np.diagonal(squares.curvature, axis1=1, axis2=2)
    better = np.clip(change + step, squares.lower, squares.upper)
    return float(np.abs(better - change).max())


@pytest.mark.parametrize("seed", seeds(6))
@pytest.mark.parametrize("together", [within_bounds._TOGETHER, 0])
def test_no_weight_could_bring_it_nearer(
    seed: int, together: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(within_bounds, "_TOGETHER", together)
    squares = random_frames(seed)
    change = squares.least()
    assert lacks(squares, change) < 1e-6
    assert (change >= squares.lower).all()
    assert (change <= squares.upper).all()
    assert lacks(squares, np.zeros_like(change)) > 1e-2
