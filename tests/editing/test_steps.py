"""The history: what is a step, what joins the step before it, and what Redo never loses."""

from __future__ import annotations

from collections.abc import Hashable

import pytest

from faceedit_app.editing.edits.settings import Settings
from faceedit_app.editing.steps import EditState, Steps


def state(percent: int) -> EditState:
    return EditState(settings=Settings(naturalness=percent / 100))


def percent(steps: Steps) -> int:
    return round(100 * steps.shown.settings.naturalness)


def drag(
    steps: Steps, *values: int, name: str = "Naturalness", merge: Hashable = None
) -> bool:  # whether it is kept
    for value in values:
        steps.preview = state(value)
    return steps.commit(name, merge)


def names(steps: Steps) -> list[str]:
    return [step.name for step in steps.done]


@pytest.fixture
def steps() -> Steps:
    steps = Steps()
    steps.begin_with(state(100))
    return steps


def test_a_gesture_is_one_step_however_often_it_previews(steps: Steps) -> None:
    assert drag(steps, 80, 60, 40)
    assert (percent(steps), names(steps)) == (40, ["Naturalness"])
    assert steps.undo()
    assert percent(steps) == 100
    assert not steps.undo()
    assert steps.redo()
    assert percent(steps) == 40
    assert not steps.redo()


def test_a_preview_is_shown_and_not_kept(steps: Steps) -> None:
    steps.preview = state(60)
    assert percent(steps) == 60
    assert steps.state == state(100)
    assert steps.cancel()
    assert percent(steps) == 100
    assert not steps.cancel()
    assert not steps.commit("nothing")
    assert names(steps) == []


def test_a_gesture_that_leads_back_is_no_step_and_costs_no_redo(steps: Steps) -> None:
    drag(steps, 70)
    steps.undo()
    assert not drag(steps, 60, 100)
    assert steps.preview is None
    assert names(steps) == []
    steps.redo()
    assert percent(steps) == 70


def test_a_step_forgets_what_was_undone(steps: Steps) -> None:
    drag(steps, 70)
    steps.undo()
    drag(steps, 60)
    assert not steps.redo()
    assert percent(steps) == 60


def test_ticks_with_one_key_are_one_step(steps: Steps) -> None:
    for value in (99, 98, 97):
        drag(steps, value, merge="slider")
    assert names(steps) == ["Naturalness"]
    steps.undo()
    assert percent(steps) == 100
    steps.redo()
    assert percent(steps) == 97


def test_a_step_has_the_name_of_the_last_tick(steps: Steps) -> None:
    drag(steps, 99, name="−1 %", merge="slider")
    drag(steps, 98, name="−2 %", merge="slider")
    assert names(steps) == ["−2 %"]


@pytest.mark.parametrize("between", ["another", "drag", "undo", "redo", "seal", "begin"])
def test_what_comes_between_ends_the_joining(steps: Steps, between: str) -> None:
    drag(steps, 90, merge="slider")
    if between == "another":
        drag(steps, 50, merge="other slider")
    elif between == "drag":
        drag(steps, 50)
    elif between in ("undo", "redo"):
        steps.undo()
        if between == "redo":
            steps.redo()
    elif between == "begin":
        steps.begin_with(state(30))
    else:
        steps.seal()
    assert not steps.extends("slider")
    before, count = steps.state, len(steps.done)
    drag(steps, 10, merge="slider")
    assert len(steps.done) == count + 1
    steps.undo()
    assert steps.state == before


def test_gestures_without_a_key_never_join(steps: Steps) -> None:
    drag(steps, 90)
    assert not steps.extends(None)
    drag(steps, 80)
    assert len(steps.done) == 2


def test_what_is_dropped_does_not_end_the_joining(steps: Steps) -> None:
    drag(steps, 90, merge="slider")
    steps.preview = state(10)
    steps.cancel()
    drag(steps, 90, merge="other")  # leads back to what is kept
    drag(steps, 80, merge="slider")
    assert len(steps.done) == 1


def test_ticks_that_lead_back_are_no_step_and_give_redo_back(steps: Steps) -> None:
    drag(steps, 70)
    drag(steps, 50)
    steps.undo()
    drag(steps, 69, merge="slider")
    assert not steps.undone
    assert drag(steps, 70, merge="slider")
    assert names(steps) == ["Naturalness"]
    assert not steps.extends("slider"), "the step before it is another gesture's"
    steps.redo()
    assert percent(steps) == 50
    steps.undo()
    steps.undo()
    assert percent(steps) == 100


def test_undo_and_redo_drop_what_is_previewed(steps: Steps) -> None:
    drag(steps, 70)
    steps.preview = state(10)
    steps.undo()
    assert (percent(steps), steps.preview) == (100, None)
    steps.preview = state(10)
    steps.redo()
    assert (percent(steps), steps.preview) == (70, None)
