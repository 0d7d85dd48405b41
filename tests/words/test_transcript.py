"""Words and phonemes: their edges can be moved, and they survive being saved."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from support.speech import said

from faceedit_app.core.fields import FieldError, Fields
from faceedit_app.words.speech_sounds import Lips, lips_of, spelled
from faceedit_app.words.transcript import Transcript, to_json, transcript_from

WORDS = said(("blue", "B L UW"), ("map", "M AE P"))


def test_an_edge_moves_all_that_meets_there() -> None:
    moved = WORDS.with_edge(0.76, 0.8)
    blue, map_ = moved.words
    assert blue.end == blue.phonemes[-1].end == map_.start == map_.phonemes[0].start == 0.8
    assert moved.with_edge(0.8, 0.76) == WORDS


def test_an_edge_stops_before_the_next_one() -> None:
    assert WORDS.with_edge(0.52, 9.0).words[0].phonemes[0].end == pytest.approx(0.63)
    assert WORDS.with_edge(0.52, -9.0).words[0].phonemes[0].end == pytest.approx(0.41)


def test_all_words_move_together() -> None:
    assert WORDS.shifted(1.5).shifted(-1.5) == WORDS
    assert WORDS.shifted(1.5).words[0].start == pytest.approx(1.9)


def test_words_of_a_part_replace_those_that_were_there() -> None:
    other = said(("pool", "P UW L"), start=0.8)
    joined = WORDS.joined(other)
    assert joined.text == "blue pool"
    assert WORDS.joined(Transcript(())) == WORDS


def test_words_survive_being_saved() -> None:
    words = replace(WORDS, sounds_like=(("map", "mapp"),), noise=12.5)
    assert transcript_from(Fields(to_json(words))) == words
    assert transcript_from(None) is None
    assert to_json(None) is None


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"version": 2}, "newer"),
        ({"version": True}, "whole number"),
        ({"words": 3}, "not a list"),
        ({"words": [{"text": "a", "start": 2.0, "end": 1.0}]}, "order of time"),
        ({"words": [{"text": "a", "start": 0.0, "end": 1.0, "colour": 1}]}, "unknown field"),
        ({"sounds_like": [["a"]]}, "list of pairs"),
        ({"sounds_like": "ab"}, "not a list"),
    ],
    ids=str,
)
def test_damaged_words_are_refused(change: dict[str, Any], says: str) -> None:
    with pytest.raises(FieldError, match=says):
        transcript_from(Fields({**(to_json(WORDS) or {}), **change}))


@pytest.mark.parametrize(
    ("symbol", "lips"),
    [
        ("B", Lips.CLOSE),
        ("M", Lips.CLOSE),
        ("pʰ", Lips.CLOSE),
        ("m̩", Lips.CLOSE),
        ("F", Lips.TEETH),
        ("UW1", Lips.PUCKER),
        ("uː", Lips.PUCKER),
        ("tʃ", Lips.PROTRUDE),
        ("dZ", Lips.PROTRUDE),  # SAMPA, as the next one
        ("u:", Lips.PUCKER),
        ("AH0", None),
        ("s", None),
        ("", None),
    ],
)
def test_phonemes_say_what_the_lips_do(symbol: str, lips: Lips | None) -> None:
    assert lips_of(symbol) is lips


@pytest.mark.parametrize(
    ("symbol", "shown"),
    [("IH1", "ih"), ("tʃ", "tʃ"), ("ma55", "ma"), ("3", "3")],  # 3 is a vowel in SAMPA
)
def test_phonemes_are_shown_without_their_stress(symbol: str, shown: str) -> None:
    assert spelled(symbol) == shown
