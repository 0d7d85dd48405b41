"""Words say what lips should do: closures that stay open are found, and fixed in one step."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.leaky import leaky_rig
from support.sessions import session_by_networks, session_by_rig, shipped_engine
from support.speech import mumbling_clip, said

from faceedit_app.core.controls import CONTROL_INDEX, CONTROLS
from faceedit_app.editing.edits.edit import Op
from faceedit_app.editing.edits.media import MediaFile, Placement
from faceedit_app.editing.help.articulation import articulate
from faceedit_app.editing.help.problems import Kind, find_problems
from faceedit_app.editing.help.sound_presets import sound_presets
from faceedit_app.editing.help.spoken import (
    NEAR,
    closing_edits,
    closures_of,
    dip_at,
    shaping_edits,
)
from faceedit_app.editing.session import EditSession
from faceedit_app.words.speech_sounds import Lips
from faceedit_app.words.transcript import Phoneme

WORDS = said(("bob", "B AA B"), ("sees", "S IY Z"), ("map", "M AE P"))
CLIP = mumbling_clip(WORDS)
OPENING, WIDTH = CONTROL_INDEX["mouth_opening"], CONTROL_INDEX["mouth_width"]


@pytest.fixture
def session() -> EditSession:
    """A take whose lips stay open at its four closures."""
    session = session_by_rig(CLIP)
    session.say(WORDS)
    return session


def test_every_m_b_and_p_that_stays_open_is_found(session: EditSession) -> None:
    found = closures_of(session)
    assert [c.phoneme.symbol for c in found] == ["B", "B", "M", "P"]
    assert all(c.is_open for c in found)
    for closure in found:
        middle = 0.5 * (closure.phoneme.start + closure.phoneme.end)
        assert closure.time == pytest.approx(middle, abs=0.02)
    assert found[2].message == f"The m of “map” is open by {found[2].gap:.1f} mm"


def test_without_words_there_are_no_closures() -> None:
    session = session_by_rig(CLIP)
    assert closures_of(session) == []
    assert closing_edits(session) == shaping_edits(session) == ()


def test_all_closures_are_fixed_in_one_step_and_nothing_else_moves() -> None:
    session = session_by_networks(CLIP, shipped_engine())
    session.say(WORDS)
    before = session.achieved.copy()
    edits = closing_edits(session)
    assert len(edits) == 4
    session.add(*edits, name="4 closures")
    assert max(closure.gap for closure in closures_of(session)) <= 0.5
    times = session.take.clip.times
    middles = np.array([0.5 * (edit.start + edit.end) for edit in edits])
    far = np.abs(times[:, None] - middles).min(axis=1) > NEAR
    assert np.abs(session.achieved - before)[far].max() <= 0.3
    assert closing_edits(session) == ()
    session.undo()
    assert session.edits == ()
    np.testing.assert_array_equal(session.achieved, before)


def test_a_selection_limits_the_fix(session: EditSession) -> None:
    (edit,) = closing_edits(session, (0.35, 0.55))
    assert edit.name == "Close lips: b of bob"
    assert closing_edits(session, (0.55, 0.6)) == ()


def test_closures_are_problems_with_their_fix(session: EditSession) -> None:
    lips = [problem for problem in find_problems(session) if problem.kind is Kind.LIPS]
    assert len(lips) == 4
    assert lips[3].message.startswith("The p of “map” is open by")
    assert lips[3].about == "p of “map”"
    session.add(*(edit for problem in lips for edit in problem.fix))
    assert not [problem for problem in find_problems(session) if problem.kind is Kind.LIPS]


def kinds_of(session: EditSession) -> set[Kind]:
    return {problem.kind for problem in find_problems(session)}


def test_closures_in_quick_succession_are_not_taken_for_shaking() -> None:
    words = said(("bob", "B AA B"), ("maple", "M EY P AH L"), ("bob", "B AA B"), each=0.09)
    session = session_by_rig(mumbling_clip(words, rate=25.0))
    session.say(words)
    session.add(*closing_edits(session))
    assert kinds_of(session) == set()
    session.say(None)
    assert Kind.JITTER in kinds_of(session)  # where nobody knows that lips should meet


def test_a_mouth_that_shakes_while_it_speaks_is_found() -> None:
    clip = mumbling_clip(WORDS)
    noise = np.random.default_rng(0).normal(0.0, 0.03, (len(clip), 1))
    session = session_by_rig(replace(clip, weights=np.maximum(clip.weights + noise, 0.0)))
    session.say(WORDS)
    assert Kind.JITTER in kinds_of(session)


def test_closures_are_measured_and_fixed_on_the_character_that_is_shown(
    session: EditSession,
) -> None:
    ours = [closure.gap for closure in closures_of(session)]
    session.use_character(leaky_rig())
    theirs = [closure.gap for closure in closures_of(session)]
    assert np.abs(np.subtract(ours, theirs)).max() > 0.05
    session.add(*closing_edits(session))
    assert max(closure.gap for closure in closures_of(session)) <= 0.5


def test_a_dip_beside_the_phoneme_is_found_if_it_is_near() -> None:
    times = np.arange(100) / 50
    curve = 5.0 - 4.0 * np.exp(-(((times - 1.0) / 0.03) ** 2))
    assert dip_at(times, curve, Phoneme("B", 1.06, 1.12)) == 50
    assert dip_at(times, curve, Phoneme("B", 0.9, 0.95)) == 50
    frame = dip_at(times, curve, Phoneme("B", 1.3, 1.4))
    assert frame is not None
    assert 1.3 <= times[frame] <= 1.4
    assert dip_at(times, curve, Phoneme("B", 5.0, 5.1)) is None


def test_shapes_are_asked_for_as_far_as_they_fall_short() -> None:
    words = said(("foo", "F UW"), ("she", "SH IY"))  # its jaw narrows the mouth enough for sh
    session = session_by_rig(mumbling_clip(words))
    session.say(words)
    edits = {edit.name: edit for edit in shaping_edits(session)}
    assert list(edits) == ["Lip to teeth: f of foo", "Round the lips: uw of foo"]
    pucker = edits["Round the lips: uw of foo"]
    width = session.achieved[:, WIDTH].copy()
    session.add(*edits.values())
    at = session.take.clip.frame_at(0.5 * (pucker.start + pucker.end))
    assert session.achieved[at, WIDTH] < width[at] - 1.0
    assert len(shaping_edits(session)) < len(edits)


def test_shipped_sounds_cover_what_lips_do() -> None:
    assert {preset.lips for preset in sound_presets()} == set(Lips) - {Lips.CLOSE}


@pytest.mark.parametrize("amount", [1.0, -1.0])
def test_clear_speech_moves_more_and_closures_stay(session: EditSession, amount: float) -> None:
    session.add(*closing_edits(session))
    before = session.achieved.copy()
    edits = articulate(session, WORDS, (0.0, 3.0), amount)
    assert all(edit.op is Op.ADD for edit in edits)
    session.add(*edits, name="Say it clearly")
    grown = session.achieved[:, OPENING].max() - before[:, OPENING].max()
    assert grown * amount > 1.0
    assert max(closure.gap for closure in closures_of(session)) <= 0.5
    others = [CONTROL_INDEX[c.id] for c in CONTROLS if c.region != "lower"]
    np.testing.assert_allclose(session.achieved[:, others], before[:, others], atol=0.05)


def test_mumbling_keeps_closures_that_follow_each_other() -> None:
    words = said(("bob", "B AA B"), ("maple", "M EY P AH L"), ("bob", "B AA B"), each=0.09)
    session = session_by_networks(mumbling_clip(words, rate=25.0), shipped_engine())
    session.say(words)
    session.add(*closing_edits(session))
    session.add(*articulate(session, words, (0.0, 3.0), -1.0))
    assert max(closure.gap for closure in closures_of(session)) <= 0.3


def test_clear_speech_stays_in_its_range(session: EditSession) -> None:
    before = session.weights.copy()
    session.add(*articulate(session, WORDS, (0.5, 0.9), 1.0))
    times = session.take.clip.times
    outside = (times < 0.5 - 0.4) | (times > 0.9 + 0.4)
    np.testing.assert_array_equal(session.weights[outside], before[outside])
    assert articulate(session, WORDS, (9.0, 9.5), 1.0) == ()
    assert articulate(session, WORDS, (0.0, 3.0), 0.0) == ()


# --- words are kept ------------------------------------------------------------------------------


def test_words_move_with_their_sound_and_undo_takes_both_back(session: EditSession) -> None:
    sound = MediaFile(Path("/voice.wav"), 0.0)
    session.say(WORDS, Placement(sound))
    session.place(Placement(replace(sound, offset=0.5)))
    assert session.words == WORDS.shifted(0.5)
    session.preview_media(Placement(replace(sound, offset=1.0)))
    assert session.words == WORDS.shifted(1.0)
    session.cancel()
    session.place(Placement(MediaFile(Path("/other.wav"), 3.0)))
    assert session.words == WORDS.shifted(0.5)
    session.undo()
    session.undo()
    assert session.words == WORDS


def test_an_edge_is_dragged_as_one_step(session: EditSession) -> None:
    steps = session.undo_name
    session.preview_words(WORDS.with_edge(0.52, 0.5))
    session.preview_words(WORDS.with_edge(0.52, 0.48))
    session.commit("Move edge of a word")
    assert session.words == WORDS.with_edge(0.52, 0.48)
    session.undo()
    assert session.words == WORDS
    assert session.undo_name == steps


def test_an_export_does_not_save_the_words(session: EditSession, tmp_path: Path) -> None:
    session.mark_saved()
    session.say(WORDS.shifted(0.1))
    session.save_edits(tmp_path / "edits.json")
    assert not session.is_saved
    session.mark_saved()
    assert session.is_saved
