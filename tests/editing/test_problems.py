"""What goes wrong in tracked faces is found, and the proposal mends it."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from support.faces import shipped_rig, talking_clip
from support.leaky import leaky_rig, speech
from support.places import SHARED
from support.sessions import demo_take, session_by_rig

from faceedit_app.characters.closure import SHUT, Openings
from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.clip import Clip, Gap
from faceedit_app.core.controls import CONTROL_INDEX, LIP_OPENING, MAIN_CONTROLS
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.help import problems
from faceedit_app.editing.help.habits import habits_of
from faceedit_app.editing.help.on_character import close_between
from faceedit_app.editing.help.problems import Kind, Problem, find_problems, problems_of
from faceedit_app.editing.opening import open_session


def still_clip(seconds: float = 6.0, rate: float = 60.0) -> Clip:
    """A face at rest."""
    times = np.arange(round(seconds * rate)) / rate
    weights = np.zeros((len(times), 52), np.float32)
    weights[:, ARKIT_INDEX["jawOpen"]] = 0.05
    return Clip(weights, ARKIT_CHANNELS, times, rate)


def find(clip: Clip, *edits: Edit) -> list[Problem]:
    weights = clip.arkit_weights()
    controls = shipped_rig().controls(shipped_rig().from_arkit(weights))
    return problems_of(clip, weights, controls, edits=edits)


def with_blink(clip: Clip, at: float, left: float, right: float, width: float = 0.06) -> Clip:
    """One more dip of the lids, of weights `left` and `right`."""
    weights = clip.weights.copy()
    shape = np.exp(-(((clip.times - at) / width) ** 2))
    for side, depth in (("Left", left), ("Right", right)):
        weights[:, ARKIT_INDEX[f"eyeBlink{side}"]] += (depth * shape).astype(np.float32)
    return replace(clip, weights=weights)


def test_demo_take_has_the_two_faults_that_were_built_in_and_no_other() -> None:
    session = session_by_rig(demo_take())
    blink, lips = find_problems(session)
    assert (blink.kind, lips.kind) == (Kind.BLINK, Kind.LIPS)
    assert blink.start == pytest.approx(4.62, abs=0.05)
    assert lips.start < 7.5 < lips.end
    assert blink.controls == ("left_eyelid", "right_eyelid")
    assert "63 %" in blink.message


@pytest.mark.parametrize("step", [1, 2])
@pytest.mark.parametrize("noise", [0.0, 0.002])
def test_the_same_is_found_at_30_frames_a_second_and_in_a_noisier_recording(
    step: int, noise: float
) -> None:
    clip = demo_take().clip
    weights = clip.arkit_weights()[::step]
    noisy = weights + np.random.default_rng(0).normal(0, noise, weights.shape)
    weights = np.maximum(noisy, 0).astype(np.float32)
    found = find(Clip(weights, ARKIT_CHANNELS, clip.times[::step], clip.rate / step))
    assert [problem.kind for problem in found] == [Kind.BLINK, Kind.LIPS]


def test_proposals_mend_the_demo_take_and_leave_the_rest_alone() -> None:
    session = session_by_rig(demo_take())
    problems = find_problems(session)
    session.preview(*(edit for problem in problems for edit in problem.fix))
    assert find_problems(session) == []
    lids = session.achieved[:, [CONTROL_INDEX["left_eyelid"], CONTROL_INDEX["right_eyelid"]]]
    near = (session.take.clip.times > 4.6) & (session.take.clip.times < 5.0)
    assert lids[near].min(axis=0).max() < 0.5
    session.cancel()
    assert len(find_problems(session)) == 2


def test_face_at_rest_has_no_problem() -> None:
    assert find(still_clip()) == []
    assert find(still_clip(0.05)) == []  # three frames


@pytest.mark.parametrize(
    ("left", "right", "open_lids"),
    [
        (1.0, 1.0, None),
        (0.5, 0.5, ("left_eyelid", "right_eyelid")),
        (1.0, 0.5, ("left_eyelid", "right_eyelid")),
        (0.1, 0.1, None),  # a flutter
        (0.95, 0.0, None),  # a wink
    ],
)
def test_blinks(left: float, right: float, open_lids: tuple[str, ...] | None) -> None:
    found = find(with_blink(still_clip(), 3.0, left, right))
    if open_lids is None:
        assert found == []
    else:
        (problem,) = found
        assert problem.start < 3.0 < problem.end
        assert problem.controls == open_lids
        (edit,) = problem.fix
        assert (edit.op, edit.value, edit.controls) == (Op.SET, 0.0, open_lids)
        assert edit.start == pytest.approx(3.0, abs=0.02)


def test_slow_look_down_is_no_blink() -> None:
    assert find(with_blink(still_clip(), 3.0, 0.5, 0.5, width=0.5)) == []


def test_blink_at_the_edge_of_the_take_is_seen() -> None:
    for at in (0.02, 5.95):
        assert [p.kind for p in find(with_blink(still_clip(), at, 0.5, 0.5))] == [Kind.BLINK]


def test_shaking_curve_is_found_and_steadied() -> None:
    clip = still_clip()
    weights = clip.weights.copy()
    noisy = (clip.times > 2) & (clip.times < 4)
    noise = np.random.default_rng(0).normal(0, 0.03, int(noisy.sum()))
    weights[noisy, ARKIT_INDEX["jawOpen"]] += (0.1 + noise).astype(np.float32)
    (problem,) = [p for p in find(replace(clip, weights=weights)) if p.kind is Kind.JITTER]
    assert "mouth_opening" in problem.controls
    assert problem.start == pytest.approx(2.0, abs=0.3)
    assert problem.end == pytest.approx(4.0, abs=0.3)
    (edit,) = problem.fix
    assert edit.op is Op.SMOOTH


def test_lost_frames_are_reported_and_those_close_together_as_one() -> None:
    clip = replace(still_clip(), gaps=(Gap(100, 1), Gap(104, 2), Gap(200, 1)))
    first, second = find(clip)
    assert (first.kind, first.fix) == (Kind.DROPPED, ())
    assert first.message == "3 frames are missing at 2 places, and the file has no row for them"
    assert second.message == "1 frame is missing, and the file has no row for it"
    assert first.start == pytest.approx(100 / 60, abs=1e-3)


@pytest.mark.parametrize("seconds", [0.4, 5.0], ids=["filled", "too long to fill"])
def test_a_gap_that_was_fixed_is_not_fixed_again(seconds: float) -> None:
    """Even if the jump remains: a second fix of the same range would do the same."""
    clip = still_clip()
    weights = clip.weights.copy()
    weights[101:, ARKIT_INDEX["jawOpen"]] = 0.5
    times = clip.times + np.where(np.arange(len(clip)) > 100, seconds, 0.0)
    broken = replace(clip, weights=weights, times=times, gaps=(Gap(100, round(60 * seconds)),))
    (problem,) = find(broken)
    assert "Mouth opening" in problem.message
    assert "mouth_opening" in problem.controls
    (edit,) = problem.fix
    assert find(broken, replace(edit, enabled=False))[0].fix == (edit,)
    assert not any(again.fix for again in find(broken, edit))
    assert bool(find(broken, edit)) == (edit.op is not Op.FILL)


def test_a_fill_answers_the_gaps_that_it_covers_and_no_others() -> None:
    clip = replace(still_clip(), gaps=(Gap(100, 1), Gap(200, 1)))
    fill = Edit(MAIN_CONTROLS, Op.FILL, 1.5, 2.0, 0.0)
    (left,) = find(clip, fill)
    assert left.start == pytest.approx(200 / 60, abs=1e-3)
    assert len(find(clip, replace(fill, controls=("mouth_opening",)))) == 2
    assert len(find(clip, replace(fill, end=100.5 / 60))) == 2


def test_gap_at_the_very_end_is_reported() -> None:
    clip = still_clip()
    assert len(find(replace(clip, gaps=(Gap(len(clip) - 1, 5),)))) == 1


def test_ten_minutes_are_searched_in_no_time() -> None:
    session = session_by_rig(talking_clip(36_000))
    began = time.process_time()
    find_problems(session)
    assert time.process_time() - began < 3.0  # of the processor; it takes 0.1


def opening_and_closing(gaps: list[float], pressing: float = 0.0) -> Clip:
    """Lips that open every second and close again, each time but for a weight of the jaw."""
    clip = still_clip(len(gaps) + 1.0)
    weights = clip.weights.copy()
    jaw = np.full(len(clip), 0.3)
    for second, gap in enumerate(gaps, start=1):
        shape = np.exp(-(((clip.times - second) / 0.06) ** 2))
        jaw -= (0.3 - gap) * shape
        for side in ("Left", "Right"):
            weights[:, ARKIT_INDEX[f"mouthPress{side}"]] += (pressing * shape).astype(np.float32)
    weights[:, ARKIT_INDEX["jawOpen"]] = jaw
    return replace(clip, weights=weights)


@pytest.mark.parametrize("pressing", [0.0, 0.3])
def test_a_closure_is_missed_if_the_takes_own_closures_close_further(pressing: float) -> None:
    """Also in a take of a tracker that does not record how lips press."""
    found = find(opening_and_closing([0.0, 0.0, 0.08, 0.0, 0.0], pressing))
    (lips,) = [problem for problem in found if problem.kind is Kind.LIPS]
    assert lips.time == pytest.approx(3.0, abs=0.02)


def test_an_edit_changes_what_is_said_about_no_other_time() -> None:
    """Even if it makes closures of its own, which press, and a mouth that is wide open."""
    session = session_by_rig(opening_and_closing([0.0, 0.08, 0.0, 0.08, 0.0, 0.08, 0.0]))
    usual = habits_of(session)
    before = find_problems(session)
    assert len(before) == 3
    pressed = ("mouthPressLeft", "mouthPressRight")
    session.add(
        Edit((), Op.OFFSET, 0.5, 3.5, 0.1, value=0.9, channels=pressed),
        Edit((LIP_OPENING,), Op.SCALE, 0.5, 3.5, 0.1, value=3.0),
    )
    assert habits_of(session) == usual
    after = find_problems(session)
    assert [p for p in after if p.start > 4.0] == [p for p in before if p.start > 4.0]
    session.add(Edit((LIP_OPENING,), Op.SCALE, 0.0, 8.0, 0.0, value=1.2))
    assert habits_of(session).wide > usual.wide, "an edit of the whole take belongs to it"


def test_the_worst_frame_and_its_value_are_reported_as_the_curve_shows_them() -> None:
    session = session_by_rig(demo_take())
    lips = next(p for p in find_problems(session) if p.kind is Kind.LIPS)
    frame = session.take.clip.frame_at(lips.time)
    value = float(session.achieved[frame, CONTROL_INDEX["mouth_opening"]])
    near = (session.take.clip.times >= lips.start) & (session.take.clip.times <= lips.end)
    assert value == session.achieved[near, CONTROL_INDEX["mouth_opening"]].min()
    assert f"{value:.1f} mm" == lips.amount
    assert lips.message.endswith(lips.amount)
    assert 0 < lips.severity < 1


LIVELINK = sorted((SHARED / "data" / "livelink").glob("*.csv"))


@pytest.mark.skipif(not LIVELINK, reason="no real takes here; FACEEDIT_SHARED names their folder")
def test_real_takes_show_lips_that_nearly_meet() -> None:
    sessions = [open_session(path, shipped_rig()) for path in LIVELINK]
    found = [find_problems(session) for session in sessions]
    with_lips = [any(p.kind is Kind.LIPS for p in problems) for problems in found]
    assert sum(with_lips) >= len(LIVELINK) / 2
    seconds = sum(session.take.clip.duration for session in sessions)
    count = sum(p.kind is Kind.LIPS for problems in found for p in problems)
    assert count < seconds / 10, "speech closes the lips once a second: few of them are missed"


def test_gaps_on_the_shown_character_are_found_and_the_proposals_close_them() -> None:
    session = session_by_rig(Clip(speech(), ARKIT_CHANNELS, np.arange(120) / 30.0, 30.0))
    assert Kind.CHARACTER not in {problem.kind for problem in find_problems(session)}
    session.use_character(leaky_rig())
    found = [problem for problem in find_problems(session) if problem.kind is Kind.CHARACTER]
    assert {problem.controls[0] for problem in found} >= {"mouth_opening"}
    ours = session.achieved.copy()
    session.add(*(edit for problem in found for edit in problem.fix))
    after = [problem for problem in find_problems(session) if problem.kind is Kind.CHARACTER]
    assert len(after) < len(found) / 4
    assert np.median(np.abs(session.achieved - ours)) < 0.1


def test_closing_on_the_character_makes_no_problem_of_another_kind() -> None:
    """Lips that come as near as 5 mm are drawn on to 3, where they would nearly meet."""
    session = session_by_rig(opening_and_closing([0.0, 0.1, 0.0, 0.12, 0.0]))
    assert find_problems(session) == []
    session.use_character(leaky_rig())
    session.add(close_between(0.0, 6.0))
    shown = Clip(session.weights, ARKIT_CHANNELS, session.take.clip.times, 60.0)
    assert [problem.kind for problem in find(shown)] == [Kind.LIPS]
    assert find_problems(session) == []


def test_curves_are_searched_twice_only_if_closing_has_changed_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    session = session_by_rig(opening_and_closing([0.0, 0.1, 0.0, 0.12, 0.0]))
    session.use_character(leaky_rig())
    searched: list[Clip] = []
    search = problems._of_curves

    def noted(clip: Clip, *rest: Any) -> list[Problem]:
        searched.append(clip)
        return search(clip, *rest)

    monkeypatch.setattr(problems, "_of_curves", noted)
    find_problems(session)
    assert len(searched) == 1
    session.add(close_between(0.0, 6.0))
    find_problems(session)
    assert len(searched) == 3


def test_beside_lips_that_closing_shuts_there_is_no_problem_that_it_has_made() -> None:
    """Ours was open there, and is drawn to where it counts as shut."""
    weights = np.zeros((90, len(ARKIT_CHANNELS)), np.float32)
    weights[:, ARKIT_INDEX["jawOpen"]] = 0.1
    session = session_by_rig(Clip(weights, ARKIT_CHANNELS, np.arange(90) / 30.0, 30.0))
    session.use_character(leaky_rig())
    assert Kind.CHARACTER not in {problem.kind for problem in find_problems(session)}
    session.add(close_between(0.0, 3.0))
    assert Openings.of(session.rig).measure(session.weights)[45, 0] < SHUT[0]
    assert Openings.of(session.shown_rig).measure(session.weights)[45, 0] > SHUT[0]
    assert Kind.CHARACTER not in {problem.kind for problem in find_problems(session)}
