"""Retime: a range of the take is played along another clock, and nothing else changes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.edits import pins
from support.retimes import ALL, CUT, PAUSE, STRETCH, clip_of, outside_of
from support.sessions import session_by_networks, session_by_rig
from support.takes import make_livelink_csv

from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX, LIP_OPENING
from faceedit_app.editing.edits.clock import Clock
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.help import retime

# --- the clock -------------------------------------------------------------------------------


@settings(deadline=None, derandomize=True)
@given(data=st.data(), strength=st.floats(0.01, 1.5))
def test_time_never_runs_backwards_and_ends_keep_theirs(
    data: st.DataObject, strength: float
) -> None:
    edit = Edit(CONTROL_IDS, Op.RETIME, 1.0, 3.0, 0.0, pins=data.draw(pins(1.0, 3.0)))
    clock, times = Clock(replace(edit, strength=strength)), np.linspace(0.0, 4.0, 1001)
    moments = clock.moments(times)
    assert (np.diff(moments) >= -1e-12).all()
    beyond = (times <= 1.0) | (times >= 3.0)
    assert np.array_equal(moments[beyond], times[beyond])


@pytest.mark.parametrize("edit", ALL)
def test_pins_are_met_and_the_clock_can_be_inverted(edit: Edit) -> None:
    clock = Clock(edit)
    if edit is STRETCH:
        was, now = np.array(edit.pins).T
        assert clock.moments(now) == pytest.approx(was)
    times = np.linspace(0.0, 8.0, 500)
    there = clock.moments(times)
    assert clock.moments(clock.shown(there)) == pytest.approx(there, abs=1e-6)


def test_speed_is_continuous_at_the_ends() -> None:
    moments = Clock(STRETCH).moments(np.arange(1.9, 6.1, 1e-3))
    speed = np.diff(moments) / 1e-3
    assert np.abs(np.diff(speed)).max() < 0.02


def test_half_strength_goes_half_the_way() -> None:
    clock = Clock(replace(STRETCH, strength=0.5))
    assert clock.moments(np.array([2.75, 4.25])) == pytest.approx([3.0, 4.0])


@pytest.mark.parametrize(
    "made",
    [
        lambda clip, span: retime.cut(clip, span),
        lambda clip, span: retime.stretched(clip, span, 0.8),
    ],
)
def test_a_selection_may_end_some_rounding_beyond_the_take(
    made: Callable[[Clip, tuple[float, float]], Edit],
) -> None:
    clip = clip_of(30.0)
    clip = replace(clip, times=clip.times - clip.times[-1] + 8.00005)  # at half of the last digit
    last = float(clip.times[-1])
    assert made(clip, (last - 0.5, last + 1e-12)).pins


# --- the result ------------------------------------------------------------------------------


@pytest.mark.parametrize("edit", ALL)
@pytest.mark.parametrize("rate", [24.0, 60.0])
def test_nothing_changes_outside_the_range(edit: Edit, rate: float) -> None:
    clip = clip_of(rate)
    session = session_by_networks(clip)
    session.add(edit)
    kept, before = outside_of(session, edit), clip.arkit_weights()
    assert np.array_equal(session.weights[kept], before[kept])
    assert session.rotations is not None
    assert clip.rotations is not None
    assert np.array_equal(session.rotations[kept], clip.rotations[kept])
    assert (session.weights[~kept] != before[~kept]).any(axis=1).mean() > 0.4
    assert (session.rotations[~kept] != clip.rotations[~kept]).any()


def test_undo_gives_the_bytes_of_the_file(tmp_path: Path) -> None:
    path = make_livelink_csv(tmp_path / "take.csv", 8.0)
    session = session_by_rig(path)
    for edit in ALL:
        session.add(edit)
        session.undo()
    session.export(tmp_path / "same.csv")
    assert (tmp_path / "same.csv").read_bytes() == path.read_bytes()


def test_redo_and_another_order_of_gestures_give_the_same_weights() -> None:
    session = session_by_networks(clip_of())
    session.add(STRETCH)
    once = session.weights.copy()
    session.undo()
    session.preview(replace(STRETCH, pins=((3.0, 2.7), (4.0, 4.2))))
    session.cancel()
    session.redo()
    assert np.array_equal(session.weights, once)


def test_what_was_shown_at_a_moment_is_shown_at_its_pin() -> None:
    clip = clip_of()
    session = session_by_rig(clip)
    session.add(STRETCH)
    for was, now in STRETCH.pins:
        there, here = clip.frame_at(was), clip.frame_at(now)
        assert session.weights[here] == pytest.approx(clip.arkit_weights()[there], abs=0.02)


@pytest.mark.parametrize("edit", ALL)
def test_the_face_does_not_jump(edit: Edit) -> None:
    clip = clip_of()
    session = session_by_rig(clip)
    session.add(edit)
    own = np.abs(np.diff(clip.arkit_weights().astype(np.float64), axis=0)).max()
    assert np.abs(np.diff(session.weights.astype(np.float64), axis=0)).max() < 2.1 * own


def test_a_pause_holds_the_face() -> None:
    session = session_by_rig(clip_of())
    session.add(PAUSE)
    times = session.take.clip.times
    held = session.weights[(times > 3.05) & (times < 3.45)]
    assert np.ptp(held, axis=0).max() < 0.01


def closing_clip(rate: float) -> Clip:
    """Lips that close for a frame at a time, at uneven places."""
    clip = clip_of(rate)
    weights = np.zeros_like(clip.weights)
    jaw, close = (clip.channels.index(name) for name in ("jawOpen", "mouthClose"))
    blink = clip.channels.index("eyeBlinkLeft")
    weights[:, jaw] = 0.4
    for frame in range(5, len(weights) - 5, 13):
        weights[frame, jaw] = 0.05
        weights[frame, close] = 0.05
        weights[frame + 3, blink] = 1.0
    return replace(clip, weights=weights)


@pytest.mark.parametrize("rate", [30.0, 60.0])
@pytest.mark.parametrize("factor", [0.5, 0.73, 1.0, 1.31])
def test_closures_and_blinks_of_one_frame_survive(rate: float, factor: float) -> None:
    session = session_by_rig(closing_clip(rate))
    clip = session.take.clip
    span = (3.0, 4.0)
    if factor == 1.0:
        edit = retime.moved(clip, span, 0.0071)
    else:
        edit = retime.stretched(clip, span, factor)
    session.add(edit)
    clock = Clock(edit)
    for name in (LIP_OPENING, "left_eyelid"):
        column = CONTROL_INDEX[name]
        tracked, now = session.tracked[:, column], session.achieved[:, column]
        inner = tracked[1:-1]
        shut = 1 + np.flatnonzero((inner < tracked[:-2] - 1) & (inner < tracked[2:] - 1))
        inside = shut[(clip.times[shut] > edit.start) & (clip.times[shut] < edit.end)]
        assert len(inside) > 1
        for frame in inside:
            shown = clock.shown(clip.times[[frame]])
            there = np.abs(clip.times - shown).argmin()
            assert now[there - 1 : there + 2].min() < tracked[frame] + 0.3


def test_shaking_becomes_smaller_not_slower_when_it_is_played_fast() -> None:
    clip = clip_of()
    weights = np.full_like(clip.weights, 0.2)
    weights[:, clip.channels.index("browInnerUp")] += 0.1 * (-1.0) ** np.arange(len(weights))
    session = session_by_rig(replace(clip, weights=weights))
    session.add(retime.stretched(clip, (3.0, 5.0), 0.5))
    rows = (clip.times > 3.3) & (clip.times < 3.7)
    column = session.take.clip.channels.index("browInnerUp")
    assert np.ptp(session.clip_weights()[rows, column]) < 0.1


def test_lips_stay_in_front_of_the_jaw() -> None:
    session = session_by_rig(closing_clip(60.0))
    session.add(STRETCH, CUT, PAUSE)
    names = session.take.clip.channels
    weights = session.clip_weights()
    close, jaw = (weights[:, names.index(name)] for name in ("mouthClose", "jawOpen"))
    assert (close <= jaw + 1e-5).all()


@settings(deadline=None, derandomize=True, max_examples=40)
@given(
    data=st.data(),
    rate=st.sampled_from([5.0, 24.0, 60.0]),
    lost=st.sets(st.integers(0, 60), max_size=30),
    strength=st.floats(0.05, 1.5),
)
def test_any_pins_on_any_take_show_what_the_take_can_do(
    data: st.DataObject, rate: float, lost: set[int], strength: float
) -> None:
    whole = clip_of(rate, 3.0)
    kept = [frame for frame in range(len(whole)) if frame not in lost] or [0]
    channels = data.draw(st.sets(st.sampled_from(whole.channels), min_size=1))
    columns = [i for i, name in enumerate(whole.channels) if name in channels]
    clip = Clip(
        whole.weights[kept][:, columns],
        tuple(whole.channels[i] for i in columns),
        whole.times[kept] - whole.times[kept[0]],
        rate,
    )
    start, end = sorted((data.draw(st.floats(0, 4)), data.draw(st.floats(0, 4))))
    edit = Edit(
        *(CONTROL_IDS, Op.RETIME, start, end, 0.0),
        pins=data.draw(pins(start, end)),
        strength=strength,
    )
    session = session_by_rig(clip)
    session.add(edit)
    before = clip.weights
    kept_rows = outside_of(session, edit)
    found = session.clip_weights()
    assert np.array_equal(found[kept_rows], before[kept_rows])
    assert (found >= before.min(axis=0) - 1e-5).all()
    assert (found <= before.max(axis=0) + 1e-5).all()
    session.undo()
    assert np.array_equal(session.clip_weights(), before)
