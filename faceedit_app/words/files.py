"""Words from and to files: TextGrid, SRT, WebVTT, JSON and plain text.

TextGrids (Praat, Montreal Forced Aligner, WebMAUS) and our JSON say when each word was said.
Subtitles say it for whole lines, plain text not at all; such lines are aligned to the sound, or
their words are spread over each line's time.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.errors import FileError
from faceedit_app.core.fields import FieldError, Fields, clean_text, read_document, to_text
from faceedit_app.words.aligning import Line
from faceedit_app.words.dictionary import phonemes_of, tokens
from faceedit_app.words.transcript import (
    MOST_WORDS,
    VERSION,
    Phoneme,
    Transcript,
    Word,
    check_order,
)

if TYPE_CHECKING:
    from praatio.data_classes.textgrid import Textgrid

READ_ENDINGS = (".textgrid", ".srt", ".vtt", ".json", ".txt")
WRITE_ENDINGS = (".TextGrid", ".srt", ".json")
_LARGEST = 16 * 2**20  # bytes; an hour of speech is 1 MB
_PAUSE = 0.4  # seconds between words that begin a new subtitle
_WIDEST = 42  # characters of a subtitle
_WORD_TIERS = ("words", "word", "ort", "ort-mau", "orthography", "tokens")
_PHONEME_TIERS = ("phones", "phone", "phonemes", "phoneme", "mau", "segments", "sounds")
_SILENCE = ("", "sil", "sp", "spn", "<p:>", "<eps>", "_", "#")


@dataclass(frozen=True)
class Imported:
    """What a file says.

    Attributes:
        lines: its text, with times if it has any.
        transcript: the words in time, if it says when each was said.
    """

    lines: tuple[Line, ...]
    transcript: Transcript | None = None


def read_words(path: Path) -> Imported:
    """Read the words of a file; its ending says what it is, plain text by default.

    Raises:
        FileError: it cannot be read, or holds no words.
    """
    readers = {
        ".textgrid": _read_textgrid,
        ".json": _read_json,
        ".srt": _read_subtitles,
        ".vtt": _read_subtitles,
    }
    content = _content(path)
    found = readers.get(path.suffix.lower(), _read_text)(path, content)
    if not any(tokens(line.text) for line in found.lines):
        raise FileError(path, "holds no words", "choose another file")
    return found


def write_words(path: Path, transcript: Transcript, seconds: float) -> None:
    """Write words as TextGrid, SRT or JSON, by the file's ending.

    Args:
        seconds: length of the sound, which a TextGrid needs.

    Raises:
        FileError: the ending is another, or the file cannot be written.
    """
    writers: dict[str, Callable[[Transcript, float], bytes]] = {
        ".textgrid": _textgrid,
        ".srt": _subtitles,
        ".json": _json,
    }
    writer = writers.get(path.suffix.lower())
    if writer is None:
        raise FileError(path, "has no ending for words", f"choose {', '.join(WRITE_ENDINGS)}")
    write_atomically(path, writer(transcript, seconds))


def as_tables(transcript: Transcript) -> dict[str, Any]:
    """Words and phonemes as two lists of `text`, `start`, `end`, for JSON."""
    return {
        "words": [{"text": w.text, "start": w.start, "end": w.end} for w in transcript.words],
        "phonemes": [
            {"text": p.symbol, "start": p.start, "end": p.end} for _, p in transcript.phonemes()
        ],
    }


def spread(lines: tuple[Line, ...], seconds: float) -> Transcript:
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


# --- reading -------------------------------------------------------------------------------------


def _content(path: Path) -> bytes:
    try:
        if not path.is_file():
            raise FileError(path, "is missing or not a file", "choose a file with the words")
        if path.stat().st_size > _LARGEST:
            raise FileError(path, "is larger than 16 MB", "choose a file with the words")
        return path.read_bytes()
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise FileError(path, f"cannot be read ({reason})", "check its permissions") from error


def _decoded(path: Path, content: bytes) -> str:
    """A text in UTF-8, UTF-16 with its mark, or, as old subtitles are, Windows-1252."""
    codes = ("utf-16",) if content[:2] in (b"\xff\xfe", b"\xfe\xff") else ("utf-8-sig", "cp1252")
    for code in codes:
        try:
            text = content.decode(code)
        except UnicodeDecodeError:
            continue
        if "\0" not in text:
            return text
    raise FileError(path, "is not text", "choose a TextGrid, SRT, VTT, JSON or TXT")


def _read_text(path: Path, content: bytes) -> Imported:
    return Imported((Line(clean_text(_decoded(path, content), _LARGEST)),))


def _read_subtitles(path: Path, content: bytes) -> Imported:
    from pysubs2 import SSAFile
    from pysubs2.exceptions import Pysubs2Error

    text = _decoded(path, content)
    try:
        events = SSAFile.from_string(text, format_=path.suffix.lower().lstrip("."))
    except (Pysubs2Error, ValueError, IndexError, OverflowError) as error:
        raise FileError(path, "is not a subtitle file", "choose another file") from error
    lines = [
        Line(clean_text(event.plaintext), event.start / 1000, event.end / 1000)
        for event in events
        if not event.is_comment and event.end > event.start and tokens(event.plaintext)
    ]
    return Imported(tuple(sorted(lines, key=lambda line: line.start or 0.0)))


def _read_json(path: Path, content: bytes) -> Imported:
    fields = read_document(path, "words file", VERSION)
    try:
        words = [_times(Fields(e, "words")) for e in fields.items("words", None, MOST_WORDS)]
        entries = fields.items("phonemes", [])
        phonemes = [_times(Fields(e, "phonemes")) for e in entries]
        transcript = _assembled(words, phonemes)
        check_order(transcript)
    except FieldError as error:
        raise FileError(path, f"is damaged: {error}", "correct it") from error
    return Imported((Line(transcript.text),), transcript)


def _times(fields: Fields) -> tuple[str, float, float]:
    return fields.text("text"), fields.number("start"), fields.number("end")


def _read_textgrid(path: Path, content: bytes) -> Imported:
    from praatio import textgrid
    from praatio.utilities import errors

    # Checked here first: the library would try encodings, and name its own lines.
    text = _decoded(path, content)
    try:
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder) / "words.TextGrid"
            copy.write_text(text, "utf-8")
            grid = textgrid.openTextgrid(str(copy), False, "silence", "rename")
    except (errors.PraatioException, ValueError, IndexError, KeyError, AttributeError) as error:
        raise FileError(path, "is not a TextGrid", "save it again from Praat") from error
    words = _tier(grid, _WORD_TIERS)
    phonemes = _tier(grid, _PHONEME_TIERS)
    if not words and not phonemes:
        names = ", ".join(str(name)[:40] for name in grid.tierNames)
        raise FileError(
            path, f"has no tier of words or phones, only: {names}", 'name them "words" and "phones"'
        )
    transcript = _assembled(words or phonemes, phonemes)
    try:
        check_order(transcript)
    except FieldError as error:
        raise FileError(path, f"is damaged: {error}", "correct it in Praat") from error
    return Imported((Line(transcript.text),), transcript)


def _tier(grid: Textgrid, names: tuple[str, ...]) -> list[tuple[str, float, float]]:
    """The intervals of the first tier with one of these names, also behind a speaker's name."""
    for tier in grid.tiers:
        name = re.split(r"\s+-\s+", str(tier.name).strip().lower())[-1]
        if name in names and hasattr(tier.entries[0] if tier.entries else None, "end"):
            return [
                (clean_text(entry.label.strip()), round(entry.start, 4), round(entry.end, 4))
                for entry in tier.entries
                if entry.label.strip().lower() not in _SILENCE
            ]
    return []


def _assembled(
    words: list[tuple[str, float, float]], phonemes: list[tuple[str, float, float]]
) -> Transcript:
    """Words with the phonemes that lie in them; those without any have the dictionary's."""
    made = []
    for text, start, end in words:
        inside = [
            Phoneme(symbol, max(a, start), min(b, end))
            for symbol, a, b in phonemes
            if start <= 0.5 * (a + b) <= end
        ]
        if not inside:
            guessed = spread((Line(text, start, end),), end).words
            inside = [p for word in guessed for p in word.phonemes] if len(guessed) == 1 else []
        made.append(Word(text, start, end, tuple(inside)))
    return Transcript(tuple(made))


# --- writing -------------------------------------------------------------------------------------


def _json(transcript: Transcript, _seconds: float) -> bytes:
    return (to_text({"version": VERSION} | as_tables(transcript), indent=2) + "\n").encode()


def _textgrid(transcript: Transcript, seconds: float) -> bytes:
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


def _subtitles(transcript: Transcript, _seconds: float) -> bytes:
    from pysubs2 import SSAEvent, SSAFile

    subtitles = SSAFile()
    line: list[Word] = []
    for word in transcript.words:
        width = sum(len(w.text) + 1 for w in line) + len(word.text)
        if line and (word.start - line[-1].end > _PAUSE or width > _WIDEST):
            subtitles.append(_event(SSAEvent, line))
            line = []
        line.append(word)
    if line:
        subtitles.append(_event(SSAEvent, line))
    return subtitles.to_string("srt").encode()


def _event(kind: Callable[..., Any], words: list[Word]) -> Any:
    text = " ".join(word.text for word in words)
    return kind(
        start=max(round(1000 * words[0].start), 0), end=round(1000 * words[-1].end), text=text
    )
