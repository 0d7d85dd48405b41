"""Fixes are tried on a session of their own: those that would make another problem are known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import pytest
from support.sessions import demo_take, session_by_rig

from faceedit_app.core.controls import LIP_OPENING
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.help.problems import Kind, Problem, find_problems
from faceedit_app.editing.help.trying import is_worth, trial_of
from faceedit_app.editing.session import EditSession


@pytest.fixture
def session() -> EditSession:
    return session_by_rig(demo_take())


def shaking(start: float, end: float) -> Edit:
    """An edit that opens and shuts the mouth from frame to frame."""
    frames = range(round(60 * start), round(60 * end))
    points = tuple((frame / 60, 2.5 * (-1) ** frame) for frame in frames)
    return Edit((LIP_OPENING,), Op.ADD, start, end, 0.1, points=points)


def with_fix(problem: Problem, edit: Edit) -> Problem:
    """A problem whose fix does what it should, and something else."""
    return replace(problem, fix=(*problem.fix, edit))


def tried(session: EditSession, problems: Sequence[Problem]) -> dict[Problem, Problem]:
    return dict(trial_of(session, problems)())


def test_a_fix_that_makes_no_problem_is_not_blamed_for_that_of_another(
    session: EditSession,
) -> None:
    blink, lips = find_problems(session)
    assert tried(session, (blink, lips)) == {}
    harmful = with_fix(blink, shaking(5.2, 5.6))
    edits, shown = session.edits, session.weights.copy()
    brought = tried(session, (harmful, lips))
    assert list(brought) == [harmful]
    made = brought[harmful]
    assert made.kind is Kind.JITTER
    assert 5.0 < made.time < 5.8
    assert session.edits == edits
    assert (session.weights == shown).all(), "nothing is shown"


def test_of_two_fixes_at_one_place_the_right_one_is_blamed(session: EditSession) -> None:
    """Here nearness says nothing: each is tried without the other."""
    blink, lips = find_problems(session)
    harmless = replace(lips, fix=(Edit((LIP_OPENING,), Op.OFFSET, 5.1, 5.7, 0.2, 0.5),))
    for problems in ((with_fix(blink, shaking(5.2, 5.6)), harmless), (blink, harmless)):
        brought = tried(session, problems)
        assert list(brought) == list(problems[:1] if problems[0] is not blink else ())


def test_what_is_edited_already_is_part_of_the_trial(session: EditSession) -> None:
    session.add(shaking(5.2, 5.6))
    blink, *others = find_problems(session)
    assert blink.kind is Kind.BLINK
    assert Kind.JITTER in [problem.kind for problem in others]
    again = with_fix(blink, replace(shaking(5.2, 5.6), strength=0.1))
    assert again not in tried(session, (again, *others))


def test_a_trial_can_be_ended(session: EditSession) -> None:
    blink, lips = find_problems(session)
    harmful = with_fix(blink, shaking(5.2, 5.6))
    assert trial_of(session, (harmful, lips), lambda: False)() == {}


def test_a_fix_is_worth_a_far_smaller_problem(session: EditSession) -> None:
    blink, lips = find_problems(session)
    for severity, worth in ((0.1, True), (0.9, False)):
        made = replace(lips, severity=severity * blink.severity)
        assert is_worth(blink, made) is worth
