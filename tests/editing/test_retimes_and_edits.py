"""Retimes with other edits: what acts on what, and what follows the face in time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.retimes import CUT, LIPS, MADE, PAUSE, STRETCH, clip_of
from support.sessions import session_by_networks, session_by_rig, switch
from support.speech import said

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_IDS, LIP_OPENING
from faceedit_app.editing.edits.clock import Clock
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.media import MediaFile, Placement
from faceedit_app.editing.edits.settings import Mode
from faceedit_app.editing.help import retime
from faceedit_app.editing.session import EditSession

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


@pytest.mark.parametrize(
    "erased",
    [
        Edit((LIP_OPENING,), Op.OFFSET, 3.2, 3.8, 0.05, 4.0),
        Edit(CONTROL_IDS, Op.FILL, 3.2, 3.8, 0.0),
        retime.moved(clip_of(), (3.4, 3.6), 0.1, pad=0.2),
    ],
    ids=lambda edit: str(edit.op),
)
def test_what_a_reset_has_taken_away_stays_away_when_a_retime_moves_it(erased: Edit) -> None:
    session, other = session_by_rig(clip_of()), session_by_rig(clip_of())
    session.add(erased)
    session.reset(2.9, 4.1)
    session.add(STRETCH)
    other.add(STRETCH)
    assert np.array_equal(session.weights, other.weights)
    assert session.edits[1].start < 2.5
    session.remove(2)
    assert np.array_equal(session.weights, clip_of().arkit_weights())
    assert session.edits[1].end == pytest.approx(4.1, abs=1e-5)


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


def made_at(session: EditSession) -> tuple[float, float]:
    (edit,) = (edit for edit in session.edits if edit.op is Op.SET)
    return edit.start, edit.end


def test_edits_above_it_move_with_what_they_were_made_on() -> None:
    session = session_by_rig(clip_of())
    session.add(MADE)
    session.add(STRETCH)
    clock = Clock(STRETCH)
    assert clock.moments(np.array(made_at(session))) == pytest.approx([3.2, 3.4], abs=1e-5)
    switch(session, 1, False)
    assert made_at(session) == pytest.approx((3.2, 3.4), abs=1e-5)
    switch(session, 1, True)
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


def test_a_neutral_rest_behind_edits_of_its_channels_follows_them() -> None:
    """Where it acts on the take, it moves with the take's content by itself."""
    scaled = Edit((), Op.SCALE, 3.0, 4.0, 0.1, 1.5, channels=("jawOpen",))
    rest = Edit((), Op.NEUTRAL, 3.0, 4.0, 0.1, channels=("jawOpen",), amounts=((0.05, 0.6),))
    session = session_by_rig(clip_of())
    for edit in (rest, scaled, rest, STRETCH):
        session.add(edit)
    first, channel, second, _ = session.edits
    assert first == rest
    assert (channel.start, channel.end) == (2.5, 4.5)
    assert second.span == channel.span
    session.remove(3)
    assert [(e.start, e.end) for e in session.edits] == [(3.0, 4.0)] * 3
