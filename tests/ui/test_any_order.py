"""Any sequence of what a user can do: undo all and redo all of it gives the same bytes."""

from __future__ import annotations

import random

import pytest
from support.chance import TIMES
from support.windows import Bench

from faceedit_app.core.resources import shipped
from faceedit_app.lab.attacks.hands import dialogs_cancelled
from faceedit_app.lab.attacks.monkey import Monkey
from faceedit_app.ui.start.window import MainWindow

STEPS = 60 * TIMES


def exported(window: MainWindow) -> bytes:
    """What the take would be as a file; the window does not notice."""
    session = window.document.session
    assert session is not None
    session.live.work(None)
    return session.clip_weights().tobytes()


@pytest.mark.timeout(400)
@pytest.mark.parametrize("seed", [1, 2])
def test_undo_all_and_redo_all(bench: Bench, seed: int) -> None:
    window = bench.editing(shipped("assets/demo_take.csv") if seed == 1 else None)
    session = window.document.session
    assert session is not None
    untouched = exported(window)
    monkey = Monkey(window, random.Random(seed))
    with dialogs_cancelled() as refused:
        for _ in range(STEPS):
            monkey.act()
    assert not refused
    window.workspace.end_gestures()
    while session.can_redo:  # the last of them may have been an undo
        window.actions_["redo"].trigger()
    reached, steps = exported(window), 0
    state = session.state
    while session.can_undo:
        window.actions_["undo"].trigger()
        steps += 1
        assert steps <= 2 * STEPS
    assert session.edits == ()
    assert exported(window) == untouched
    while session.can_redo:
        window.actions_["redo"].trigger()
    assert steps > 0
    assert exported(window) != untouched or not state.edits
    while session.can_redo:
        window.actions_["redo"].trigger()
    assert session.state == state
    assert exported(window) == reached
