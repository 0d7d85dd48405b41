"""How words are pronounced: the dictionary that comes with pocketsphinx (CMUdict, US English)."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path

from faceedit_app.core.errors import FaceEditError
from faceedit_app.words.numbers import in_words

LANGUAGE = "English"  # what is aligned without help; other languages are imported
_BEFORE = re.compile(r"(?:(?![$£€]\d)[\W_])*")
_OPENING = re.compile(r"\[|\(|</?\w")
_CLOSING = {"[": "]", "(": ")", "<": ">"}
_AND = re.compile(r"\s&\s")  # is spoken
_BETWEEN = re.compile(r"[\s/–—…_-]+|\.{2,}")
_APOSTROPHES = str.maketrans({"’": "'", "‘": "'", "ʼ": "'"})
_INVISIBLE = ("Cf", "Cc")  # categories of characters: joiners, marks of direction
_FOREIGN = 0.5  # share of unknown words, above which a text is in another language
_FEW = 4  # words, of which the share says nothing
_MOST_NAMED = 8  # unknown words in one message


def tokens(text: str) -> list[str]:
    """The words of a text as they are typed, without punctuation around them.

    Dashes and slashes part words, an & between words is one, and brackets with directions, such as
    `[laughs]`, are left out.
    """
    text = _AND.sub(" and ", _without_directions(text.translate(_APOSTROPHES)))
    if not text.isascii():
        text = "".join(c for c in text if c.isspace() or unicodedata.category(c) not in _INVISIBLE)
    return [word for part in _BETWEEN.split(text) if (word := _bare(part))]


def _without_directions(text: str) -> str:
    """A text with a space for each bracket that is closed.

    One regular expression would look for the end of each bracket that is not closed: for hours, in
    a damaged file.
    """
    last = {opening: text.rfind(closing) for opening, closing in _CLOSING.items()}
    parts, at = [], 0
    for bracket in _OPENING.finditer(text):
        opening = bracket[0][0]
        if at <= bracket.start() and bracket.end() <= last[opening]:
            parts.append(text[at : bracket.start()])
            at = text.index(_CLOSING[opening], bracket.end()) + 1
    return " ".join([*parts, text[at:]])


def _bare(part: str) -> str:
    """A word without the punctuation around it."""
    before = _BEFORE.match(part)
    first, end = before.end() if before else 0, len(part)
    while end > first and _is_outside(part, end - 1):
        end -= 1
    return part[first:end]


def _is_outside(part: str, at: int) -> bool:
    """Whether a character is punctuation where a word ends."""
    if part[at] == "%":
        return at == 0 or not part[at - 1].isdecimal()
    return not part[at].isalnum()


@cache
def _entries() -> Mapping[str, str]:
    """ARPABET phonemes of each word; other ways to say one are entries such as `read(2)`."""
    from pocketsphinx import get_model_path

    lines = Path(get_model_path("en-us/cmudict-en-us.dict")).read_text("utf-8").splitlines()
    return dict(line.split(" ", 1) for line in lines if " " in line)


def pronunciations(word: str) -> Mapping[str, str]:
    """All entries of a word in lower case, the usual one first; none if it is unknown."""
    known = _entries()
    found: dict[str, str] = {}
    entry = word
    while entry in known:
        found[entry] = known[entry]
        entry = f"{word}({len(found) + 1})"
    return found


def phonemes_of(word: str) -> str | None:
    """ARPABET phonemes of a word in lower case, separated by spaces; None if it is unknown.

    Abbreviations are known without their last point, and words without their accents.
    """
    if "(" in word:  # another way to say a word, or no word
        return None
    known = _entries()
    plain = word
    if not word.isascii():
        letters = unicodedata.normalize("NFD", word)
        plain = "".join(c for c in letters if not unicodedata.combining(c))
    forms = (word, f"{word}.", f"'{word}", f"{word}'", plain)
    return next((known[form] for form in forms if form in known), None)


def unknown_words(text: str, sounds_like: Mapping[str, str]) -> list[str]:
    """The words of a text that cannot be pronounced, each once, in lower case."""
    lower = dict.fromkeys(word.lower() for word in tokens(text))
    return [word for word in lower if word not in sounds_like and phonemes_of(word) is None]


def is_foreign(text: str, unknown: Iterable[str]) -> bool:
    """Whether a text seems to be in another language, by the words of it that are unknown."""
    lower, unknown = [word.lower() for word in tokens(text)], set(unknown)
    strange = sum(word in unknown and not in_words(word) for word in lower)
    letters = any("LATIN" not in unicodedata.name(c, "") for w in unknown for c in w if c.isalpha())
    return letters or (len(lower) >= _FEW and strange > _FOREIGN * len(lower))


def suggestion(word: str) -> str:
    """What an unknown word may sound like, in English words; "" if there is no telling."""
    if number := in_words(word):
        return number
    letters = re.split(r"[.&]", word)
    if len(letters) > 1 and all(len(letter) <= 2 for letter in letters):
        return " ".join("".join(letters))
    return ""


def spoken(spelling: str) -> str:
    """The phonemes of a spelling that sounds like a word, such as "zix gloop".

    Raises:
        FaceEditError: a part of it is not in the dictionary either.
    """
    parts = [word.lower() for word in tokens(spelling)]
    if not parts:
        raise FaceEditError("“Sounds like” needs English words, such as “two” for 2")
    found = []
    for part in parts:
        phonemes = phonemes_of(part)
        if phonemes is None:
            raise FaceEditError(f"“{part}” is not in the dictionary; spell it with English words")
        found.append(phonemes)
    return " ".join(found)


def pronounce(words: Iterable[str], sounds_like: Mapping[str, str]) -> dict[str, str]:
    """The phonemes of words in lower case.

    Raises:
        FaceEditError: some are unknown; the text lists them.
    """
    found: dict[str, str] = {}
    unknown: dict[str, None] = {}
    for word in words:
        phonemes = spoken(sounds_like[word]) if word in sounds_like else phonemes_of(word)
        if phonemes is None:
            unknown[word] = None
        else:
            found[word] = phonemes
    if unknown:
        names = ", ".join(f"“{word[:40]}”" for word in list(unknown)[:_MOST_NAMED])
        if len(unknown) > _MOST_NAMED:
            names += f" and {len(unknown) - _MOST_NAMED} more"
        first = next(iter(unknown))
        spelling = suggestion(first) or "key ow"
        what, give = f"Not in the dictionary: {names};", "give English words"
        if is_foreign(" ".join(found) + " " + " ".join(unknown), unknown):
            other = "for other languages, open a file with the times of the words"
            raise FaceEditError(f"{what} {other}")
        raise FaceEditError(
            f"{what} {give} that sound like them",
            for_command=f'{what} {give}, such as --sounds-like {first[:40]}="{spelling}"',
        )
    return found
