"""How typed text becomes words that can be pronounced."""

from __future__ import annotations

import pytest

from faceedit_app.core.errors import FaceEditError
from faceedit_app.words.dictionary import (
    is_foreign,
    phonemes_of,
    pronounce,
    spoken,
    suggestion,
    tokens,
    unknown_words,
)
from faceedit_app.words.numbers import in_words


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("Hello, world!", ["Hello", "world"]),
        ("“Don’t” – he said…", ["Don't", "he", "said"]),
        ("well-known either/or", ["well", "known", "either", "or"]),
        ("[laughs] yes (aside) no <i>now</i>", ["yes", "no", "now"]),
        ("… — !", []),
        ("(one [two) three] four (five 6% %", ["three", "four", "five", "6%"]),
        ("salt & soup & R&B", ["salt", "and", "soup", "and", "R&B"]),
        ("a < b, c > d", ["a", "b", "c", "d"]),
        ("well…fine under_score", ["well", "fine", "under", "score"]),
        ("$5, 50% (and 'tis 12:30)", ["$5", "50%"]),
        ("zero\u200bwidth\u00a0space\t#tag 😀", ["zerowidth", "space", "tag"]),
    ],
)
def test_text_becomes_words(text: str, words: list[str]) -> None:
    assert tokens(text) == words


@pytest.mark.parametrize("damage", ["[", "(<a", "a!", "!", "%", "a[("])
def test_what_is_never_closed_takes_no_time(damage: str) -> None:
    """With a search for the end at each place, this would take hours."""
    assert len(tokens(f"a{damage * 100_000}b".replace("!a", "!!"))) == 1


def test_unknown_words_are_listed_once() -> None:
    assert unknown_words("Zyx blue 8 zyx", {}) == ["zyx", "8"]
    assert unknown_words("Zyx blue 8 zyx", {"zyx": "zix", "8": "eight"}) == []
    assert phonemes_of("read(2)") is None  # the dictionary's own name for a way to say it
    with pytest.raises(FaceEditError, match=r"“zyx”, “8”"):
        pronounce(["zyx", "blue", "8"], {})


def test_a_spelling_lends_its_pronunciation() -> None:
    assert spoken("two") == "T UW"
    assert pronounce(["2"], {"2": "two"}) == {"2": "T UW"}
    for bad in ("", "zyxq", "!"):
        with pytest.raises(FaceEditError):
            spoken(bad)


def test_abbreviations_and_accents_are_known() -> None:
    assert unknown_words("Mr. Smith’s café, Zoë: U.S.A., 3 p.m. ‘tis", {}) == ["3"]
    assert pronounce(["café"], {}) == {"café": "K AH F EY"}


@pytest.mark.parametrize(
    ("number", "words"),
    [
        ("8", "eight"),
        ("1984", "nineteen eighty four"),
        ("1905", "nineteen oh five"),
        ("2000", "two thousand"),
        ("2024", "twenty twenty four"),
        ("1,984", "one thousand nine hundred eighty four"),
        ("3.14", "three point one four"),
        ("$5", "five dollars"),
        ("50%", "fifty percent"),
        ("22nd", "twenty second"),
        ("30th", "thirtieth"),
        ("12:05", "twelve oh five"),
        ("12a", ""),
        ("1" * 40, ""),
        ("zyx", ""),
    ],
)
def test_numbers_are_suggested_in_words(number: str, words: str) -> None:
    assert in_words(number) == words
    assert suggestion(number) == words
    assert not words or unknown_words(words, {}) == []


def test_a_message_names_a_few_words_and_the_remedy() -> None:
    with pytest.raises(FaceEditError, match="“1984”; give English words that sound like") as one:
        pronounce(["in", "1984"], {})
    assert '1984="nineteen eighty four"' in one.value.for_command
    many = [f"zyx{'q' * k}" for k in range(1, 30)]
    with pytest.raises(FaceEditError, match="and 21 more; for other languages") as caught:
        pronounce(many, {})
    assert len(str(caught.value)) < 300


def test_other_languages_are_noticed() -> None:
    for text in ("Привет", "你好世界", "Straße überqueren verboten, Fußgänger gegenüber"):
        assert is_foreign(text, unknown_words(text, {}))
    for text in ("zyx", "Read 8 books in 1984 and 1985", "a zyxgloop on the table"):
        assert not is_foreign(text, unknown_words(text, {}))
