"""What a file says about the words of a take, and what its readers have in common."""

from __future__ import annotations

import codecs
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from faceedit_app.core.errors import FileError
from faceedit_app.core.fields import FieldError, clean_text
from faceedit_app.words.aligning import TextLine
from faceedit_app.words.dictionary import phonemes_of, tokens
from faceedit_app.words.speech_sounds import sampa_as_ipa
from faceedit_app.words.transcript import Phoneme, Transcript, Word, check_order

TimedText = tuple[str, float, float]  # text or symbol, start and end in seconds

_MARKS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF32_LE: "utf-32",  # before UTF-16, whose mark begins it
    codecs.BOM_UTF32_BE: "utf-32",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}
_LATEST = 1e6  # seconds
_WESTERN = 0.3  # share of letters that are not ASCII, above which text is no Western European one


@dataclass(frozen=True)
class Imported:
    """What a file says.

    Attributes:
        lines: its text, with times if it has any.
        transcript: the words in time, if it says when each was said.
    """

    lines: tuple[TextLine, ...]
    transcript: Transcript | None = None


def decoded(path: Path, content: bytes) -> str:
    """The text of a file, with line ends of one kind.

    It is in UTF-8, UTF-16 or UTF-32, or in Windows-1252, as old subtitles are. Other old encodings
    cannot be told from each other, and would give wrong letters.

    Raises:
        FileError: it is not text, or in another encoding.
    """
    code = next((code for mark, code in _MARKS.items() if content.startswith(mark)), "")
    if not code and b"\0" in content:
        code = _without_mark(content)
    for one in (code,) if code else ("utf-8", "cp1252"):
        try:
            text = content.decode(one)
        except UnicodeDecodeError:
            continue
        if "\0" in text:
            break
        if one == "cp1252" and not _is_western(text):
            raise FileError(path, "is in an unknown encoding", "save it again as UTF-8")
        return text.replace("\r\n", "\n").replace("\r", "\n")
    raise FileError(path, "is not text", "choose a TextGrid, SRT, VTT, JSON or TXT")


def _without_mark(content: bytes) -> str:
    """The encoding of text in UTF-16 without its mark: most of every second byte is 0."""
    for zeros, code in ((1, "utf-16-le"), (0, "utf-16-be")):
        if content[zeros::2].count(0) > 0.5 * len(content[zeros::2]):
            return code
    return "utf-8"


def _is_western(text: str) -> bool:
    letters = [c for c in text if c.isalpha() or ord(c) > 127]
    return sum(ord(c) > 127 for c in letters) <= _WESTERN * len(letters)


def spread(lines: Sequence[TextLine], seconds: float) -> Transcript:
    """Words spread evenly over the time of their lines, for subtitles without a sound.

    Args:
        seconds: the time of a line without times.
    """
    words: list[Word] = []
    for line in lines:
        start = max(line.start or 0.0, words[-1].end if words else 0.0)
        end = max(seconds if line.end is None else line.end, start + 0.01)
        texts = tokens(line.text)
        sounds = [(phonemes_of(text.lower()) or "").split() for text in texts]
        shares = [max(len(some), 1) for some in sounds]
        step = (end - start) / max(sum(shares), 1)
        at = start
        for text, some, share in zip(texts, sounds, shares, strict=True):
            edges = [round(at + i * step, 4) for i in range(share + 1)]
            phonemes = tuple(Phoneme(s, edges[i], edges[i + 1]) for i, s in enumerate(some))
            words.append(Word(clean_text(text), edges[0], edges[-1], phonemes))
            at += share * step
    return Transcript(tuple(words))


def with_times(path: Path, words: Sequence[TimedText], phonemes: Sequence[TimedText]) -> Imported:
    """Words with the phonemes that lie in them; those without any have the dictionary's.

    If there are no words, each phoneme is one.

    Raises:
        FileError: some overlap, or are not in order.
    """
    if not all(abs(time) < _LATEST for part in (*words, *phonemes) for time in part[1:]):
        raise FileError(path, "is damaged: a time is not a number of seconds", "correct it")
    ipa = sampa_as_ipa({symbol for symbol, _, _ in phonemes})
    phonemes = [(ipa.get(symbol, symbol), start, end) for symbol, start, end in phonemes]
    made = []
    for text, start, end in words or phonemes:
        inside = [
            Phoneme(symbol, max(a, start), min(b, end))
            for symbol, a, b in phonemes
            if start <= 0.5 * (a + b) <= end
        ]
        if not inside:
            guessed = spread((TextLine(text, start, end),), end).words
            inside = [p for word in guessed for p in word.phonemes] if len(guessed) == 1 else []
        made.append(Word(text, start, end, tuple(inside)))
    transcript = Transcript(tuple(made))
    try:
        check_order(transcript)
    except FieldError as error:
        raise FileError(path, f"is damaged: {error}", "correct it") from error
    return Imported((TextLine(transcript.text),), transcript)
