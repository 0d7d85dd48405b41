"""Words from and to files: TextGrid, SRT, WebVTT, JSON and plain text.

TextGrids (Praat, Montreal Forced Aligner, WebMAUS) and our JSON say when each word was said.
Subtitles and the JSON of speech recognisers say it for whole lines, plain text not at all; such
lines are aligned to the sound, or their words are spread over each line's time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from faceedit_app.core.atomic import write_keeping
from faceedit_app.core.errors import FileError, reason_of
from faceedit_app.core.fields import FieldError, Fields, clean_text, parse, read_document, to_text
from faceedit_app.words import subtitles, textgrids
from faceedit_app.words.aligning import TextLine
from faceedit_app.words.dictionary import tokens
from faceedit_app.words.imported import Imported, TimedText, decoded, with_times
from faceedit_app.words.transcript import MOST_WORDS, VERSION, Transcript
from faceedit_app.words.transcriptions import lines_of

READ_ENDINGS = (".textgrid", ".srt", ".vtt", ".json", ".txt")
WRITE_ENDINGS = (".TextGrid", ".srt", ".json")
_LARGEST = 16 * 2**20  # bytes; an hour of speech is 1 MB
_RTF = r"{\rtf"
_ASS = "[Script Info]"


def read_words(path: Path) -> Imported:
    """Read the words of a file; its ending says what it is, plain text by default.

    Raises:
        FileError: it cannot be read, or holds no words.
    """
    readers = {
        ".textgrid": textgrids.read,
        ".json": _read_json,
        ".srt": subtitles.read,
        ".vtt": subtitles.read,
    }
    content = _content(path)
    found = readers.get(path.suffix.lower(), _read_text)(path, content)
    if not any(tokens(line.text) for line in found.lines):
        raise FileError(path, "holds no words", "choose another file")
    return found


def is_words(path: Path) -> bool:
    """Whether a file holds words, by its ending."""
    try:
        read_words(path)
    except FileError:
        return False
    return True


def write_words(path: Path, transcript: Transcript, seconds: float) -> Path | None:
    """Write words as TextGrid, SRT or JSON, by the file's ending.

    Args:
        seconds: length of the sound, which a TextGrid needs.

    Returns:
        The copy that was kept of a file that held no words; None if there was none.

    Raises:
        FileError: the ending is another, or the file cannot be written.
    """
    content = writer_for(path)(transcript, seconds)
    return write_keeping(path, content, is_words)


def writer_for(path: Path) -> Callable[[Transcript, float], bytes]:
    """What makes a file's content of words and the length of their sound, by the file's ending.

    Raises:
        FileError: it is not an ending for words.
    """
    writers: dict[str, Callable[[Transcript, float], bytes]] = {
        ".textgrid": textgrids.content,
        ".srt": subtitles.content,
        ".json": _json,
    }
    writer = writers.get(path.suffix.lower())
    if writer is None:
        raise FileError(path, "has no ending for words", f"choose {', '.join(WRITE_ENDINGS)}")
    return writer


def as_tables(transcript: Transcript) -> dict[str, Any]:
    """Words and phonemes as two lists of `text`, `start`, `end`, for JSON."""
    return {
        "words": [{"text": w.text, "start": w.start, "end": w.end} for w in transcript.words],
        "phonemes": [
            {"text": p.symbol, "start": p.start, "end": p.end} for _, p in transcript.phonemes()
        ],
    }


# --- reading -------------------------------------------------------------------------------------


def _content(path: Path) -> bytes:
    try:
        if not path.is_file():
            raise FileError(path, "is missing or not a file", "choose a file with the words")
        if path.stat().st_size > _LARGEST:
            raise FileError(path, "is larger than 16 MB", "choose a file with the words")
        return path.read_bytes()
    except OSError as error:
        reason = reason_of(error)
        raise FileError(path, f"cannot be read ({reason})", "check its permissions") from error


def _read_text(path: Path, content: bytes) -> Imported:
    text = decoded(path, content)
    if subtitles.ARROW in text:
        return subtitles.read(path, content)
    if text.lstrip().startswith(_ASS):
        raise FileError(path, "holds subtitles in the format ASS", "save them as SRT")
    if text.startswith(_RTF):
        raise FileError(path, "is rich text", "save it as plain text")
    return Imported((TextLine(clean_text(text, _LARGEST)),))


def _read_json(path: Path, content: bytes) -> Imported:
    document = _parsed(path, content)
    is_printed = isinstance(document, dict) and document.keys() >= {"words", "phonemes"}
    if document is not None and not is_printed:
        return Imported(_lines(path, document))
    try:
        fields = Fields(document) if is_printed else read_document(path, "words file", VERSION)
        words = [_times(Fields(e, "words")) for e in fields.items("words", None, MOST_WORDS)]
        phonemes = [_times(Fields(e, "phonemes")) for e in fields.items("phonemes", [])]
        start = fields.number("sound_start", 0.0)
    except FieldError as error:
        raise FileError(path, f"is damaged: {error}", "correct it") from error
    found = with_times(path, words, phonemes)
    return (
        found
        if found.transcript is None
        else replace(found, transcript=found.transcript.shifted(-start))
    )


def _parsed(path: Path, content: bytes) -> Any | None:
    """A document of another program, or what `faceedit words --json` prints; None for others."""
    try:
        document = parse(decoded(path, content))
    except (ValueError, FieldError, FileError):
        return None
    return None if isinstance(document, dict) and "version" in document else document


def _lines(path: Path, document: Any) -> tuple[TextLine, ...]:
    """The lines of another program's JSON."""
    lines = lines_of(document)
    if not lines:
        raise FileError(path, "holds no texts with times that FaceEdit knows", "save it as SRT")
    return lines


def _times(fields: Fields) -> TimedText:
    return fields.text("text"), fields.number("start"), fields.number("end")


def _json(transcript: Transcript, _seconds: float) -> bytes:
    return (to_text({"version": VERSION} | as_tables(transcript), indent=2) + "\n").encode()
