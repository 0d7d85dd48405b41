"""Matching another sound: its phonemes are found in the take's, and the take meets them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.sessions import session_by_rig
from support.speech import mumbling_clip, said

from faceedit_app.core.errors import FaceEditError
from faceedit_app.editing.edits.clock import clock_of
from faceedit_app.editing.edits.edit import Op
from faceedit_app.editing.edits.media import MediaFile
from faceedit_app.editing.help.dubbing import keep, match
from faceedit_app.words.transcript import Phoneme, Transcript, Word

WORDS = (("map", "M AE P"), ("boom", "B UW M"), ("fish", "F IH SH"), ("away", "AH W EY"))
OURS = said(*WORDS, start=0.6, each=0.12)
CLIP = mumbling_clip(OURS, 4.0)


def edges(transcript: Transcript) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return np.array([(p.start, p.end) for _, p in transcript.phonemes()]).ravel()


@pytest.mark.parametrize("each", [0.1, 0.12, 0.15])
def test_phonemes_meet_those_of_the_other_sound(each: float) -> None:
    theirs = said(*WORDS, start=3.0, each=each)
    found = match(CLIP, OURS, theirs)
    assert (found.matched, found.total) == (12, 12)
    assert found.unmatched == found.limited == ()
    shown = clock_of(found.edit).shown(edges(OURS))
    assert shown == pytest.approx(edges(theirs) + found.offset, abs=0.003)
    assert found.words.words[0].start == pytest.approx(3.0 + found.offset, abs=1e-3)


def test_the_sound_can_be_placed_by_hand() -> None:
    found = match(CLIP, OURS, said(*WORDS, start=1.0, each=0.12), offset=-0.3)
    assert found.offset == -0.3
    assert clock_of(found.edit).shown(edges(OURS)) == pytest.approx(edges(OURS) + 0.1, abs=0.003)


def test_words_that_only_one_side_has_are_left_out_and_said() -> None:
    theirs = said(WORDS[0], WORDS[1], ("zoo", "Z IY"), WORDS[3], start=0.7)
    found = match(CLIP, OURS, theirs, offset=0.0)
    assert found.unmatched == ("fish",)
    assert found.matched == 9
    assert "not found: fish" in found.message
    clock = clock_of(found.edit)
    mine = [p for w, p in OURS.phonemes() if w.text == "boom"]
    other = [p for w, p in theirs.phonemes() if w.text == "boom"]
    shown = clock.shown(np.array([p.start for p in mine]))
    assert shown == pytest.approx([p.start for p in other], abs=0.003)


def test_speeds_are_limited_and_it_says_where() -> None:
    slow = said(WORDS[0], start=0.6, each=0.5)
    rest = said(*WORDS[1:], start=2.1, each=0.12)
    theirs = Transcript((*slow.words, *rest.words))
    found = match(CLIP, OURS, theirs, offset=0.0)
    assert found.limited
    assert "too far apart" in found.message
    pins = np.array([(found.edit.start,) * 2, *found.edit.pins, (found.edit.end,) * 2])
    was, now = np.diff(pins, axis=0).T
    assert (now >= was / 2 - 1e-3).all()
    assert (now <= was * 2 + 1e-3).all()


def test_words_without_phonemes_match_by_their_text() -> None:
    def bare(transcript: Transcript) -> Transcript:
        return Transcript(tuple(replace(word, phonemes=()) for word in transcript.words))

    found = match(CLIP, bare(OURS), bare(said(*WORDS, start=0.8)))
    assert found.matched == 4


def test_stress_and_like_sounds_match() -> None:
    theirs = said(("map", "B AE1 P"), *WORDS[1:], start=0.8)
    assert match(CLIP, OURS, theirs).matched == 12


def test_another_text_is_refused_in_one_line() -> None:
    theirs = said(("sky", "S K AY"), ("green", "G R IY N"), ("it", "IH T"))
    with pytest.raises(FaceEditError, match="check that it says the same words"):
        match(CLIP, OURS, theirs)
    with pytest.raises(FaceEditError, match="within the take"):
        match(CLIP, OURS, said(*WORDS), offset=100.0)
    many = Transcript((Word("m", 0.0, 9.0, tuple(Phoneme("M", 0.0, 0.1) for _ in range(12_001))),))
    with pytest.raises(FaceEditError, match="a shorter take"):
        match(CLIP, many, OURS)


def test_it_is_one_step_with_the_words_and_the_sound() -> None:
    session = session_by_rig(CLIP)
    session.say(OURS)
    found = match(CLIP, OURS, said(*WORDS, start=1.0))
    keep(session, found, sound=MediaFile(Path("/there/dub.wav")))
    assert [edit.op for edit in session.edits] == [Op.RETIME]
    assert session.words == found.words
    assert session.state.media is not None
    assert session.state.media.sound == MediaFile(Path("/there/dub.wav"), found.offset)
    assert session.undo_name == "Match another sound"
    session.undo()
    assert (session.edits, session.words, session.state.media) == ((), OURS, None)
