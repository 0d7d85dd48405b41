"""Words from and to TextGrids: Praat, the Montreal Forced Aligner, WebMAUS."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from faceedit_app.core.errors import FileError
from faceedit_app.core.fields import clean_text
from faceedit_app.words.aligning import TextLine
from faceedit_app.words.dictionary import tokens
from faceedit_app.words.imported import Imported, TimedText, decoded, with_times
from faceedit_app.words.transcript import Transcript

if TYPE_CHECKING:
    from praatio.data_classes.textgrid import Textgrid

_WORD_TIERS = ("words", "word", "ort", "ort-mau", "orthography", "tokens")
_PHONEME_TIERS = ("phones", "phone", "phonemes", "phoneme", "mau", "segments", "sounds")
_SILENCE = ("", "sil", "sp", "spn", "<p:>", "<eps>", "_", "#", "<sil>", "silence")
# What the library raises at a damaged file, such as at times of hundreds of digits.
_OF_THE_LIBRARY = (ArithmeticError, AttributeError, LookupError, RecursionError, ValueError)
_NAMES = 'name them "words" and "phones"'
_INTERVALS = "mark in Praat where each word begins and ends"


def read(path: Path, content: bytes) -> Imported:
    """The words of a TextGrid, long or short; intervals of several words are lines.

    Raises:
        FileError: it is damaged, holds no words, or those of several speakers.
    """
    grid = _grid(path, decoded(path, content))
    tiers = [tier for tier in grid.tiers if tier.tierType == "IntervalTier"]
    words, phonemes = (_named(path, tiers, names) for names in (_WORD_TIERS, _PHONEME_TIERS))
    if words is None and phonemes is None:
        if len(tiers) != 1:
            if not tiers:
                raise FileError(path, "has no intervals, only points", _INTERVALS)
            names = ", ".join(str(tier.name)[:40] for tier in tiers)
            raise FileError(path, f"has no tier of words or phones, only: {names}", _NAMES)
        words = tiers[0]
    said, sounds = _intervals(words), _intervals(phonemes)
    if not said and not sounds:
        raise FileError(path, "holds no words", "choose another file")
    if not sounds and any(len(tokens(text)) > 1 for text, _, _ in said):
        return Imported(tuple(TextLine(text, start, end) for text, start, end in said))
    return with_times(path, said, sounds)


def _grid(path: Path, text: str) -> Textgrid:
    from praatio import textgrid
    from praatio.utilities import errors

    # Decoded first: the library would try encodings, and name its own lines.
    try:
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder) / "words.TextGrid"
            copy.write_text(text, "utf-8")
            return textgrid.openTextgrid(str(copy), False, "silence", "rename")
    except errors.TextgridStateError as error:
        problem = f"is damaged: {' '.join(str(error).split())[:160]}"
        raise FileError(path, problem, "correct it in Praat") from error
    except (errors.PraatioException, *_OF_THE_LIBRARY) as error:
        raise FileError(path, "is not a TextGrid", "save it again from Praat") from error


def _named(path: Path, tiers: Sequence[Any], names: tuple[str, ...]) -> Any | None:
    """The tier with one of these names, also behind a speaker's name."""
    found: dict[str, Any] = {}
    for tier in tiers:
        *speaker, name = re.split(r"\s+-\s+", str(tier.name).strip())
        if name.lower() in names and (not found or _intervals(tier)):
            found.setdefault(" - ".join(speaker), tier)
    said = {speaker: tier for speaker, tier in found.items() if _intervals(tier)}
    if len(said) > 1:
        who = ", ".join(speaker[:30] or "(unnamed)" for speaker in said)
        raise FileError(path, f"has the words of several speakers: {who}", "keep one of them")
    return next(iter(said.values() or found.values()), None)


def _intervals(tier: Any | None) -> list[TimedText]:
    """The intervals of a tier that hold something."""
    return [
        (clean_text(entry.label.strip()), round(entry.start, 4), round(entry.end, 4))
        for entry in (tier.entries if tier is not None else ())
        if entry.label.strip().lower() not in _SILENCE
    ]


def content(transcript: Transcript, seconds: float) -> bytes:
    """A long TextGrid with the tiers `words` and `phones`.

    Args:
        seconds: length of the sound.
    """
    from praatio.data_classes.interval_tier import IntervalTier
    from praatio.data_classes.textgrid import Textgrid as Grid

    words = [(w.start, w.end, w.text) for w in transcript.words if w.end > max(w.start, 0)]
    phonemes = [(p.start, p.end, p.symbol) for _, p in transcript.phonemes() if p.end > p.start]
    last = max([seconds, *(end for _, end, _ in words)])
    grid = Grid()
    for name, entries in (("words", words), ("phones", phonemes)):
        inside = [(max(start, 0.0), end, text) for start, end, text in entries if end > 0]
        grid.addTier(IntervalTier(name, inside, 0.0, last))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "words.TextGrid"
        grid.save(str(path), "long_textgrid", includeBlankSpaces=True)
        return path.read_bytes()
