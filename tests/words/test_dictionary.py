"""How typed text becomes words that can be pronounced."""

from __future__ import annotations

import pytest

from faceedit_app.core.errors import FaceEditError
from faceedit_app.words.dictionary import pronounce, spoken, tokens, unknown_words


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("Hello, world!", ["Hello", "world"]),
        ("“Don’t” – he said…", ["Don't", "he", "said"]),
        ("well-known either/or", ["well", "known", "either", "or"]),
        ("[laughs] yes (aside) no <i>now</i>", ["yes", "no", "now"]),
        ("… — !", []),
    ],
)
def test_text_becomes_words(text: str, words: list[str]) -> None:
    assert tokens(text) == words


def test_unknown_words_are_listed_once() -> None:
    assert unknown_words("Zyx blue 8 zyx", {}) == ["zyx", "8"]
    assert unknown_words("Zyx blue 8 zyx", {"zyx": "zix", "8": "eight"}) == []
    with pytest.raises(FaceEditError, match=r"“zyx”, “8”"):
        pronounce(["zyx", "blue", "8"], {})


def test_a_spelling_lends_its_pronunciation() -> None:
    assert spoken("two") == "T UW"
    assert pronounce(["2"], {"2": "two"}) == {"2": "T UW"}
    for bad in ("", "zyxq", "!"):
        with pytest.raises(FaceEditError):
            spoken(bad)
