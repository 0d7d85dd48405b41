"""Words from and to subtitles: SRT and WebVTT; their lines have times, their words do not."""

from __future__ import annotations

import html
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from faceedit_app.core.errors import FileError
from faceedit_app.core.fields import clean_text
from faceedit_app.words.aligning import TextLine
from faceedit_app.words.dictionary import tokens
from faceedit_app.words.imported import Imported, decoded
from faceedit_app.words.transcript import Transcript, Word

ARROW = "-->"  # between the times of a line
_PAUSE = 0.4  # seconds between words that begin a new subtitle
_WIDEST = 42  # characters of a subtitle
_SPEAKER = re.compile(r"^-?\s*[A-Z][A-Z0-9 .'-]{1,30}:\s+(?=.*[a-z])")  # BOB: before what he says
_MARK = "WEBVTT"  # left out by some programs, which then leave out the hours as well
_HOURS = re.compile(r"\d:\d\d:\d\d[,.:]\d+\s*" + ARROW)
_BLOCKS = re.compile(r"^(?:NOTE|STYLE|REGION)\b.*?(?=\n\n|\Z)", re.MULTILINE | re.DOTALL)
_TAGS = re.compile(r"<[^<>\n]*>")  # also times of single words


def read(path: Path, content: bytes) -> Imported:
    """The lines of subtitles, by time, without the names of speakers in capitals before them.

    What a line repeats of the one before it is left out.

    Raises:
        FileError: it is not subtitles.
    """
    from pysubs2 import SSAFile
    from pysubs2.exceptions import Pysubs2Error

    text = decoded(path, content)
    is_srt = not text.lstrip().startswith(_MARK) and _HOURS.search(text) is not None
    form = "srt" if is_srt else "vtt"
    if form == "vtt":
        text = _TAGS.sub("", _BLOCKS.sub("", text))
    try:
        events = SSAFile.from_string(text, format_=form)
    except (Pysubs2Error, ValueError, IndexError, OverflowError) as error:
        raise FileError(path, "is not a subtitle file", "choose another file") from error
    lines: list[TextLine] = []
    shown: list[str] = []
    for event in sorted(events, key=lambda event: event.start):
        plain = html.unescape(event.plaintext) if form == "vtt" else event.plaintext
        rows = [row.strip() for row in plain.split("\n") if row.strip()]
        new = rows[_repeated(shown, rows) :]
        shown = rows or shown
        said = clean_text("\n".join(_SPEAKER.sub("", row) for row in new))
        if not event.is_comment and event.end > event.start and tokens(said):
            lines.append(TextLine(said, event.start / 1000, event.end / 1000))
    return Imported(tuple(lines))


def _repeated(before: list[str], rows: list[str]) -> int:
    """How many rows are the last ones of the subtitle before, as in captions that roll up."""
    longest = min(len(before), len(rows))
    return next((n for n in range(longest, 0, -1) if before[-n:] == rows[:n]), 0)


def content(transcript: Transcript, _seconds: float) -> bytes:
    """An SRT, whose subtitles break at pauses."""
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
