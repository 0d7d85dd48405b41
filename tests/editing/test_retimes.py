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
from support.sessions import demo_take, session_by_networks, session_by_rig
from support.speech import said
from support.takes import make_livelink_csv

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX, LIP_OPENING
from faceedit_app.core.errors import FaceEditError
from faceedit_app.editing.edits.clock import Clock
from faceedit_app.editing.edits.describe import describe
from faceedit_app.editing.edits.edit import Edit, Op, from_json, to_json
from faceedit_app.editing.edits.media import MediaFile, Placement
from faceedit_app.editing.edits.retiming import retimed
from faceedit_app.editing.edits.settings import Mode
from faceedit_app.editing.help import retime
from faceedit_app.editing.help.presets import save_preset
from faceedit_app.editing.session import EditSession

LIPS = CONTROL_INDEX[LIP_OPENING]
STRETCH = Edit(CONTROL_IDS, Op.RETIME, 2.0, 6.0, 0.0, pins=((3.0, 2.5), (4.0, 4.5)))
CUT = Edit(CONTROL_IDS, Op.RETIME, 2.9, 5.0, 0.0, pins=((3.0, 3.0), (3.5, 3.0)))
PAUSE = Edit(CONTROL_IDS, Op.RETIME, 2.9, 5.0, 0.0, pins=((3.0, 3.0), (3.0, 3.5)))
ALL = (STRETCH, CUT, PAUSE)


def clip_of(rate: float = 60.0, seconds: float = 8.0) -> Clip:
    """A talking mouth and blinking eyes, with a turning head."""
    take = demo_take().clip
    times = np.arange(round(rate * seconds)) / rate
    at = np.minimum(np.round(times * take.rate).astype(int), len(take) - 1)
    assert take.rotations is not None
    rotations, weights = take.rotations[at], take.weights[at]
    return replace(take, weights=weights, times=times, rate=rate, rotations=rotations, timecodes=())


def outside(session: EditSession, edit: Edit) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    times = session.take.clip.times
    return np.asarray((times <= edit.start) | (times >= edit.end))


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


# --- the result ------------------------------------------------------------------------------


@pytest.mark.parametrize("edit", ALL)
@pytest.mark.parametrize("rate", [24.0, 60.0])
def test_nothing_changes_outside_the_range(edit: Edit, rate: float) -> None:
    clip = clip_of(rate)
    session = session_by_networks(clip)
    session.add(edit)
    kept, before = outside(session, edit), clip.arkit_weights()
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


# --- with other edits -------------------------------------------------------------------------


def test_curves_act_on_the_retimed_take() -> None:
    session = session_by_networks(clip_of())
    session.add(STRETCH)
    before = session.achieved[:, LIPS].copy()
    session.add(Edit((LIP_OPENING,), Op.OFFSET, 4.0, 4.3, 0.1, 2.0))
    rows = (session.take.clip.times > 4.0) & (session.take.clip.times < 4.3)
    assert session.asked[rows, LIPS] == pytest.approx(before[rows] + 2.0, abs=0.01)


def test_edits_of_channels_and_rotations_act_on_it_too() -> None:
    session = session_by_rig(clip_of())
    session.add(STRETCH)
    assert session.rotations is not None
    weights, turns = session.weights.copy(), session.rotations.copy()
    session.add(Edit((), Op.OFFSET, 2.5, 5.0, 0.0, 10.0, channels=("headYaw",)))
    rows = (session.take.clip.times > 2.5) & (session.take.clip.times < 5.0)
    assert session.rotations[rows, 0] == pytest.approx(turns[rows, 0] + np.radians(10), abs=1e-4)
    assert np.array_equal(session.rotations[:, 1:], turns[:, 1:])
    assert np.array_equal(session.weights, weights)


def test_curves_that_nobody_asked_for_go_where_channels_take_them() -> None:
    session = session_by_rig(clip_of())
    session.add(STRETCH)
    session.add(Edit((), Op.OFFSET, 2.5, 5.0, 0.0, 0.3, channels=("jawOpen",)))
    rows = (session.take.clip.times > 2.6) & (session.take.clip.times < 4.9)
    assert np.array_equal(session.asked[rows], session.achieved[rows])


@pytest.mark.parametrize("session_on", [session_by_rig, session_by_networks])
def test_resynthesis_starts_from_the_retimed_take(
    session_on: Callable[[Clip], EditSession],
) -> None:
    clip = clip_of()
    session = session_on(clip)
    session.configure(replace(session.settings, mode=Mode.RESYNTHESIZE))
    session.add(Edit((LIP_OPENING,), Op.OFFSET, 6.5, 6.6, 0.0, 1.0))
    plain = session.weights.copy()
    dimple = ARKIT_INDEX["mouthDimpleLeft"]
    session.add(STRETCH)
    there, here = clip.frame_at(3.0), clip.frame_at(2.5)
    assert session.weights[here, dimple] == pytest.approx(plain[there, dimple], abs=0.02)


def test_a_reset_after_it_takes_it_away_to_the_bit() -> None:
    clip = clip_of()
    session = session_by_rig(clip)
    session.add(STRETCH)
    session.reset(0.0, 8.0)
    assert np.array_equal(session.weights, clip.arkit_weights())
    assert session.rotations is not None
    assert clip.rotations is not None
    assert np.array_equal(session.rotations, clip.rotations)


def test_a_reset_before_it_leaves_it() -> None:
    session, other = session_by_rig(clip_of()), session_by_rig(clip_of())
    session.add(STRETCH)
    other.reset(0.0, 8.0)
    other.add(STRETCH)
    assert np.array_equal(session.weights, other.weights)


def test_retimes_follow_each_other_in_the_order_of_the_list() -> None:
    clip = clip_of()
    session = session_by_rig(clip)
    session.add(STRETCH)
    there = clip.frame_at(4.25)
    before = session.weights[there].copy()
    session.add(retime.moved(clip, (4.0, 4.5), 0.1))
    assert session.weights[clip.frame_at(4.35)] == pytest.approx(before, abs=0.02)


@pytest.mark.parametrize("edit", [STRETCH, PAUSE])
def test_a_part_of_a_long_take_is_as_the_whole(edit: Edit) -> None:
    """Across the borders of chunks, and with a fill and a retime on top of each other."""
    long = clip_of(seconds=9.9)
    clip = replace(
        long,
        weights=np.concatenate([long.weights] * 4),
        times=np.arange(4 * len(long)) / long.rate,
        rotations=None,
    )
    at = 8.32 - 0.5 * (edit.start + edit.end)  # the first border
    edits = (
        edit.shifted(at),
        Edit(CONTROL_IDS, Op.FILL, 9.0, 9.8, 0.0),
        retime.moved(clip, (8.0, 9.5), 0.2),
    )
    whole = session_by_networks(clip)
    whole.put(edits)
    part = session_by_networks(clip)
    part.live.patience = 0.0
    part.put(edits)
    part.live.work()
    assert np.array_equal(whole.weights, part.weights)
    jump = np.abs(np.diff(whole.weights.astype(np.float64), axis=0)).max()
    own = np.abs(np.diff(clip.arkit_weights()[: len(long)].astype(np.float64), axis=0)).max()
    assert jump < 2.5 * own


# --- edits that were made before it -----------------------------------------------------------


MADE = Edit((LIP_OPENING,), Op.SET, 3.2, 3.4, 0.1, 1.0)


def made_at(session: EditSession) -> tuple[float, float]:
    (edit,) = (edit for edit in session.edits if edit.op is Op.SET)
    return edit.start, edit.end


def test_edits_above_it_move_with_what_they_were_made_on() -> None:
    session = session_by_rig(clip_of())
    session.add(MADE)
    session.add(STRETCH)
    clock = Clock(STRETCH)
    assert clock.moments(np.array(made_at(session))) == pytest.approx([3.2, 3.4], abs=1e-5)
    session.set_enabled(1, False)
    assert made_at(session) == pytest.approx((3.2, 3.4), abs=1e-5)
    session.set_enabled(1, True)
    session.remove(1)
    assert session.edits == (pytest.approx(MADE),) or made_at(session) == pytest.approx(
        (3.2, 3.4), abs=1e-5
    )


def test_they_follow_while_it_is_dragged_and_stay_when_it_is_cancelled() -> None:
    session = session_by_rig(clip_of())
    session.add(MADE)
    for shift in (0.05, 0.1, 0.15):
        session.preview(retime.moved(session.take.clip, (3.0, 3.6), shift))
    session.cancel()
    assert session.edits == (MADE,)
    session.preview(retime.moved(session.take.clip, (3.0, 3.6), 0.15))
    session.commit()
    assert made_at(session) == pytest.approx((3.35, 3.55), abs=0.03)
    session.undo()
    assert session.edits == (MADE,)


def test_edits_below_it_stay() -> None:
    session = session_by_rig(clip_of())
    session.add(STRETCH)
    session.add(MADE)
    session.replace_edit(0, replace(STRETCH, pins=((3.0, 2.8), (4.0, 4.4))))
    session.remove(0)
    assert session.edits == (MADE,)


def test_an_edit_whose_time_is_cut_is_switched_off() -> None:
    session = session_by_rig(clip_of())
    session.add(MADE)
    session.add(CUT)
    assert session.edits == (replace(MADE, enabled=False), CUT)


def test_other_changes_of_the_list_move_nothing() -> None:
    session = session_by_rig(clip_of())
    session.put((STRETCH, MADE))
    session.move(0, 1)
    assert session.edits == (MADE, STRETCH)
    session.rename(1, "Slower")
    assert session.edits[0] == MADE


@pytest.mark.parametrize("has_sound", [False, True])
def test_words_follow_the_face_if_there_is_no_sound_that_says_them(has_sound: bool) -> None:
    session = session_by_rig(clip_of())
    sound = MediaFile(Path("a.wav")) if has_sound else None
    words = said(("map", "M AE P"), ("boom", "B UW M"), start=3.0)
    session.say(words, Placement(sound))
    session.preview(retime.moved(session.take.clip, (2.9, 3.8), 0.1))
    session.preview(retime.moved(session.take.clip, (2.9, 3.8), 0.2))
    session.commit()
    found = session.words
    assert found is not None
    assert found.words[0].start == pytest.approx(3.0 if has_sound else 3.2, abs=0.02)
    assert [len(word.phonemes) for word in found.words] == [3, 3]
    session.remove(0)
    assert session.words is not None
    assert session.words.edges == pytest.approx(words.edges, abs=2e-4)
    session.undo()
    assert session.words == found
    if not has_sound:
        session.put([retime.cut(session.take.clip, (3.0, 3.37))])
        assert session.words is not None
        assert session.words.text == "boom"


# --- by hand ----------------------------------------------------------------------------------


def speeds(edit: Edit) -> Doubles:
    pinned = np.array([(edit.start, edit.start), *edit.pins, (edit.end, edit.end)])
    was, now = np.diff(pinned, axis=0).T
    rates: Doubles = was[(now > 0) & (was > 0)] / now[(now > 0) & (was > 0)]
    return rates


@settings(deadline=None, derandomize=True, max_examples=200)
@given(
    start=st.floats(0, 7.5),
    length=st.floats(0, 3),
    goal=st.tuples(st.floats(-3, 12), st.floats(-3, 12)),
)
def test_a_drag_never_plays_too_slow_or_too_fast(
    start: float, length: float, goal: tuple[float, float]
) -> None:
    clip = clip_of()
    span = start, min(start + length, float(clip.times[-1]))
    to = retime.nearest(clip, span, goal)
    edit = retime.retime(clip, span, to)
    assert clip.times[0] - 1e-4 <= edit.start <= edit.end <= clip.times[-1] + 1e-4
    rates = speeds(edit)
    assert rates.size == 0 or 0.45 < rates.min() <= rates.max() < 2.2


def test_names_say_what_was_done() -> None:
    clip = clip_of()
    assert describe(retime.stretched(clip, (1.2, 1.85), 1.3)) == "Stretch to 130 %"
    assert describe(retime.moved(clip, (3.0, 4.0), -0.12)) == "Move in time −0.12 s"
    assert describe(retime.moved(clip, (3.0, 3.0), 0.12)) == "Move in time +0.12 s"
    assert describe(retime.cut(clip, (3.0, 3.5))) == "Cut 0.50 s"
    assert describe(retime.pause(clip, 3.0, 0.4)) == "Insert 0.40 s"
    assert describe(replace(STRETCH, pins=((3.0, 2.5), (4.0, 4.5), (5.0, 5.2)))) == "Retime"
    assert describe(replace(STRETCH, name="Slower")) == "Slower"


@pytest.mark.parametrize("at", [0.0, 3.0, 7.9])
def test_pauses_and_cuts_use_the_side_that_has_room(at: float) -> None:
    clip = clip_of()
    end = float(clip.times[-1])
    pause = retime.pause(clip, at, 0.5)
    assert 0 <= pause.start <= pause.end <= end + 1e-4
    cut = retime.cut(clip, (at, min(at + 0.4, end)))
    assert 0 <= cut.start <= cut.end <= end + 1e-4


CLIP = clip_of()


def test_a_face_that_soon_stands_still_makes_up_for_it_there() -> None:
    clip = clip_of()
    weights = clip.weights.copy()
    weights[(clip.times > 4.0) & (clip.times < 4.6)] = weights[clip.frame_at(4.0)]
    clip = replace(clip, weights=weights)
    pause = retime.pause(clip, 3.2, 0.3)
    assert pause.pins[-1][0] == pytest.approx(4.0, abs=0.04)
    assert pause.end == pytest.approx(4.6, abs=0.04)
    clock = Clock(pause)
    between = np.linspace(3.6, 3.9, 10)
    assert clock.shown(between) == pytest.approx(between + 0.3, abs=0.05)
    cut = retime.cut(clip, (3.2, 3.5))
    assert cut.end == pytest.approx(4.6, abs=0.04)
    assert Clock(cut).shown(between) == pytest.approx(between - 0.3, abs=0.05)
    assert describe(pause) == "Insert 0.30 s"
    assert describe(cut) == "Cut 0.30 s"
    far = retime.pause(clip, 0.5, 0.1)
    assert far.end < 1.5


IMPOSSIBLE: tuple[Callable[[], Edit], ...] = (
    lambda: retime.stretched(CLIP, (0.0, 7.98), 1.5),
    lambda: retime.stretched(CLIP, (3.0, 4.0), 3.0),
    lambda: retime.moved(CLIP, (3.0, 4.0), 9.0),
    lambda: retime.moved(CLIP, (20.0, 21.0), 0.1),
    lambda: retime.cut(CLIP, (1.0, 7.5)),
    lambda: retime.cut(CLIP, (3.0, 3.0)),
    lambda: retime.pause(CLIP, 4.0, 8.0),
    lambda: retime.pause(CLIP, 4.0, 0.0),
    lambda: retime.by_pins(CLIP, []),
    lambda: retime.by_pins(CLIP, [(3.0, 3.5), (3.2, 3.4)]),
    lambda: retime.by_pins(CLIP, [(3.0, 30.0)]),
    lambda: retime.by_pins(CLIP, [(3.0, 3.5)], 3.2, 4.0),
)


@pytest.mark.parametrize("do", IMPOSSIBLE)
def test_what_cannot_be_is_one_line(do: Callable[[], Edit]) -> None:
    with pytest.raises(FaceEditError) as caught:
        do()
    assert "\n" not in str(caught.value)


# --- files ------------------------------------------------------------------------------------


def test_json_keeps_the_pins() -> None:
    for edit in ALL:
        assert from_json(to_json(edit)) == edit


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"pins": [[4.0, 3.0], [3.0, 3.5]]}, "cross"),
        ({"pins": [[1.0, 3.0]]}, "outside its range"),
        ({"falloff": 0.2}, "no falloff"),
        ({"op": "fill"}, "no pins"),
        ({"control": None, "channels": ["jawOpen"]}, "no retime"),
    ],
)
def test_damaged_pins_are_refused(change: dict[str, object], complaint: str) -> None:
    entry = to_json(STRETCH) | change
    if "channels" in entry:
        entry = {name: value for name, value in entry.items() if not name.startswith("control")}
    with pytest.raises(ValueError, match=complaint):
        from_json(entry)


def test_another_range_scales_the_pins() -> None:
    scaled = STRETCH.stretched(2.0, 4.0)
    assert scaled.pins == ((2.5, 2.25), (3.0, 3.25))
    assert STRETCH.stretched(3.0, 3.0).effect is None
    assert STRETCH.shifted(1.0).pins == ((4.0, 3.5), (5.0, 5.5))
    assert retimed(STRETCH, 0.5).pins == ((1.5, 1.25), (2.0, 2.25))


def test_by_its_handles_a_range_changes_around_the_pins() -> None:
    wider = retime.reshaped(STRETCH, 1.8, 6.0, 0.0, 0.5)
    assert (wider.start, wider.end, wider.pins) == (1.8, 6.5, STRETCH.pins)
    tight = retime.reshaped(STRETCH, 2.9, 4.6, 0.0, 0.0)
    assert (tight.start, tight.end) == (2.0, 5.0)
    assert 0.49 < speeds(tight).min() <= speeds(tight).max() < 2.01
    moved = retime.reshaped(STRETCH, 2.5, 6.5, 0.0, 0.0)
    assert moved == STRETCH.shifted(0.5)
    other = Edit((LIP_OPENING,), Op.OFFSET, 1.0, 2.0, 0.2, 3.0)
    assert retime.reshaped(other, 1.0, 3.0, 0.1, 0.3) == replace(
        other, end=3.0, falloff=0.1, falloff_out=0.3
    )


def test_a_preset_takes_whole_retimes_only(tmp_path: Path) -> None:
    kept = save_preset("Slower", [STRETCH, MADE], 1.0, 7.0, tmp_path)
    assert [edit.op for edit in kept.edits] == [Op.RETIME, Op.SET]
    cut_off = save_preset("Lips", [STRETCH, MADE], 3.0, 3.5, tmp_path)
    assert [edit.op for edit in cut_off.edits] == [Op.SET]
