"""What was said in a take, and when: words and their phonemes."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from faceedit_app.core.arrays import Times
from faceedit_app.core.fields import FieldError, Fields

VERSION = 1
SHORTEST = 0.01  # seconds; no edge can be dragged closer to the next one
MOST_WORDS = 20_000
_MOST_PHONEMES = 60  # of one word
_SAME = 1e-6  # seconds; edges closer than this are one edge


@dataclass(frozen=True)
class Phoneme:
    """One speech sound.

    Attributes:
        symbol: as the dictionary (ARPABET, such as `AH`) or the imported file spells it.
        start, end: seconds of the take.
    """

    symbol: str
    start: float
    end: float


@dataclass(frozen=True)
class Word:
    """One word.

    Attributes:
        text: as the user typed it, without punctuation around it.
        start, end: seconds of the take.
        phonemes: in order; empty if only the word's times are known.
    """

    text: str
    start: float
    end: float
    phonemes: tuple[Phoneme, ...] = ()


@dataclass(frozen=True)
class Transcript:
    """The words of a take, in order of time; they do not overlap.

    Attributes:
        words: see `Word`.
        sounds_like: (word, spelling) for words that are not in the dictionary.
        noise: signal-to-noise ratio of the sound that they were aligned with, dB; None = unknown.
    """

    words: tuple[Word, ...]
    sounds_like: tuple[tuple[str, str], ...] = ()
    noise: float | None = None

    @property
    def text(self) -> str:
        """All words, with spaces."""
        return " ".join(word.text for word in self.words)

    @cached_property
    def edges(self) -> tuple[float, ...]:
        """The times of all edges of words and phonemes, in order, each once."""
        times = [time for word in self.words for time in (word.start, word.end)]
        times += [time for _, p in self.phonemes() for time in (p.start, p.end)]
        times.sort()
        return tuple(time for i, time in enumerate(times) if not i or time - times[i - 1] > _SAME)

    def phonemes(self) -> Iterator[tuple[Word, Phoneme]]:
        """Each phoneme with its word, in order of time."""
        for word in self.words:
            for phoneme in word.phonemes:
                yield word, phoneme

    def shifted(self, seconds: float) -> Transcript:
        """All of it, moved in time."""
        if not seconds:
            return self
        return replace(self, words=tuple(_shifted(word, seconds) for word in self.words))

    def at_times(self, at: Callable[[Times], Times]) -> Transcript:
        """With its edges at other times; what becomes too short is left out.

        Args:
            at: gives the new times (N,) for old ones, in the same order.
        """
        old = np.array(self.edges, np.float64)
        to: dict[float, float] = dict(zip(self.edges, at(old).round(4).tolist(), strict=True))

        def moved(time: float) -> float:
            nearest = bisect_left(self.edges, time - _SAME)
            return to[self.edges[nearest]]

        words = []
        for word in self.words:
            parts = [Phoneme(p.symbol, moved(p.start), moved(p.end)) for p in word.phonemes]
            kept = tuple(part for part in parts if part.end - part.start >= SHORTEST)
            start, end = moved(word.start), moved(word.end)
            if end - start >= SHORTEST:
                words.append(Word(word.text, start, end, kept))
        return replace(self, words=tuple(words))

    def with_edge(self, edge: float, to: float) -> Transcript:
        """With an edge moved, no farther than to the next one on either side.

        What meets at the edge, such as the end of one phoneme and the start of the next, moves
        together.

        Args:
            edge: one of `edges`.
            to: where it should be, seconds.
        """
        low = max((t for t in self.edges if t < edge - _SAME), default=-1e6)
        high = min((t for t in self.edges if t > edge + _SAME), default=1e6)
        to = round(min(max(to, low + SHORTEST), high - SHORTEST), 4)

        def at(time: float) -> float:
            return to if abs(time - edge) <= _SAME else time

        words = tuple(
            Word(
                word.text,
                at(word.start),
                at(word.end),
                tuple(Phoneme(p.symbol, at(p.start), at(p.end)) for p in word.phonemes),
            )
            for word in self.words
        )
        return replace(self, words=words)

    def joined(self, other: Transcript) -> Transcript:
        """With the words of another one in place of those in its time range."""
        if not other.words:
            return self
        start, end = other.words[0].start, other.words[-1].end
        kept = [word for word in self.words if word.end <= start or word.start >= end]
        words = sorted([*kept, *other.words], key=lambda word: word.start)
        spellings = dict(self.sounds_like) | dict(other.sounds_like)
        return Transcript(tuple(words), tuple(spellings.items()), other.noise)


def _shifted(word: Word, seconds: float) -> Word:
    def moved(time: float) -> float:
        return round(time + seconds, 4)

    phonemes = tuple(Phoneme(p.symbol, moved(p.start), moved(p.end)) for p in word.phonemes)
    return Word(word.text, moved(word.start), moved(word.end), phonemes)


# --- as JSON -------------------------------------------------------------------------------------


def to_json(transcript: Transcript | None) -> dict[str, Any] | None:
    """As JSON values, for projects and journals."""
    if transcript is None:
        return None
    measured = {} if transcript.noise is None else {"noise_db": transcript.noise}
    return {
        "version": VERSION,
        **measured,
        "sounds_like": [list(pair) for pair in transcript.sounds_like],
        "words": [
            {
                "text": word.text,
                "start": word.start,
                "end": word.end,
                "phonemes": [
                    {"text": p.symbol, "start": p.start, "end": p.end} for p in word.phonemes
                ],
            }
            for word in transcript.words
        ],
    }


def transcript_from(fields: Fields | None) -> Transcript | None:
    """Read what `to_json` returned.

    Raises:
        FieldError: it is damaged, or newer than this FaceEdit.
    """
    if fields is None:
        return None
    if fields.whole("version") != VERSION:
        raise FieldError("its words were written by a newer FaceEdit; update FaceEdit")
    spellings = []
    for pair in fields.items("sounds_like", []):
        if not (isinstance(pair, list) and len(pair) == 2):
            raise FieldError('"sounds_like" is not a list of pairs')
        spelling = Fields({"sounds_like": pair}).texts("sounds_like", 2)
        spellings.append((spelling[0], spelling[1]))
    words = tuple(
        _word(Fields(entry, "words")) for entry in fields.items("words", None, MOST_WORDS)
    )
    transcript = Transcript(words, tuple(spellings), fields.number_or_none("noise_db"))
    fields.finish()
    check_order(transcript)
    return transcript


def _word(fields: Fields) -> Word:
    entries = fields.items("phonemes", [], _MOST_PHONEMES)
    phonemes = tuple(_phoneme(Fields(entry, "phonemes")) for entry in entries)
    word = Word(fields.text("text"), fields.number("start"), fields.number("end"), phonemes)
    fields.finish()
    return word


def _phoneme(fields: Fields) -> Phoneme:
    phoneme = Phoneme(fields.text("text"), fields.number("start"), fields.number("end"))
    fields.finish()
    return phoneme


def check_order(transcript: Transcript) -> None:
    """Check that no word or phoneme ends before it begins, or overlaps the next one.

    Raises:
        FieldError: one does; the text names it.
    """
    for word in transcript.words:
        _check((word.start, word.end), f"the word {word.text!r}")
        inside = [word.start, *(t for p in word.phonemes for t in (p.start, p.end)), word.end]
        if any(b < a - _SAME for a, b in pairwise(inside)):
            raise FieldError(f"the phonemes of the word {word.text!r} are not in order of time")
    for one, other in pairwise(transcript.words):
        _check((one.end, other.start), f"the words {one.text!r} and {other.text!r}")


def _check(times: tuple[float, float], what: str) -> None:
    if times[1] < times[0] - _SAME:
        raise FieldError(f"{what[:80]} at {times[0]:.3f} s: not in order of time")
