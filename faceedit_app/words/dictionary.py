"""How words are pronounced: the dictionary that comes with pocketsphinx (CMUdict, US English)."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path

from faceedit_app.core.errors import FaceEditError

LANGUAGE = "English"  # what is aligned without help; other languages are imported
_OUTSIDE = re.compile(r"^[^\w]+|[^\w]+$")
_APOSTROPHES = str.maketrans({"’": "'", "‘": "'", "ʼ": "'"})


def tokens(text: str) -> list[str]:
    """The words of a text as they are typed, without punctuation around them.

    Dashes and slashes part words; brackets with directions, such as `[laughs]`, are left out.
    """
    text = re.sub(r"[\[<(][^\])>]*[\])>]", " ", text.translate(_APOSTROPHES))
    parts = re.split(r"[\s/–—-]+", text)
    return [word for part in parts if (word := _OUTSIDE.sub("", part))]


@cache
def pronunciations() -> Mapping[str, str]:
    """ARPABET phonemes of each word, separated by spaces; the usual pronunciation only."""
    from pocketsphinx import get_model_path

    lines = Path(get_model_path("en-us/cmudict-en-us.dict")).read_text("utf-8").splitlines()
    return dict(line.split(" ", 1) for line in lines if "(" not in line and " " in line)


def unknown_words(text: str, sounds_like: Mapping[str, str]) -> list[str]:
    """The words of a text that cannot be pronounced, each once, in lower case."""
    known = pronunciations()
    lower = dict.fromkeys(word.lower() for word in tokens(text))
    return [word for word in lower if word not in known and word not in sounds_like]


def spoken(spelling: str) -> str:
    """The phonemes of a spelling that sounds like a word, such as "zix gloop".

    Raises:
        FaceEditError: a part of it is not in the dictionary either.
    """
    known = pronunciations()
    parts = [word.lower() for word in tokens(spelling)]
    if not parts:
        raise FaceEditError("“Sounds like” needs English words, such as “two” for 2")
    for part in parts:
        if part not in known:
            raise FaceEditError(f"“{part}” is not in the dictionary; spell it with English words")
    return " ".join(known[part] for part in parts)


def pronounce(words: Iterable[str], sounds_like: Mapping[str, str]) -> dict[str, str]:
    """The phonemes of words in lower case.

    Raises:
        FaceEditError: some are unknown; the text lists them.
    """
    known = pronunciations()
    found: dict[str, str] = {}
    unknown: dict[str, None] = {}
    for word in words:
        if word in sounds_like:
            found[word] = spoken(sounds_like[word])
        elif word in known:
            found[word] = known[word]
        else:
            unknown[word] = None
    if unknown:
        names = ", ".join(f"“{word}”" for word in unknown)
        remedy = f'give English words, such as --sounds-like {next(iter(unknown))}="key ow"'
        raise FaceEditError(f"Not in the dictionary: {names}; {remedy}")
    return found
