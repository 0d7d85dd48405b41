"""What speech recognisers write as JSON: Whisper, Gentle, Deepgram, Amazon and others.

They agree on little but that somewhere in the file there is a list of texts with a beginning and an
end. Their times are rough, so the texts become lines, whose words are aligned to the sound.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from faceedit_app.core.fields import clean_text
from faceedit_app.words.aligning import TextLine
from faceedit_app.words.dictionary import tokens

_TEXTS = ("text", "word", "transcript", "punctuated_word", "label", "value", "content")
_STARTS = ("start", "begin", "start_time", "startTime", "from")
_ENDS = ("end", "end_time", "endTime", "to")
_BOTH = "timestamp"  # a pair
_INSIDE = "timestamps"  # an object of whisper.cpp, with clock times
_CHOICES = "alternatives"  # a list of Amazon, the likeliest text first
_CLOCK = re.compile(r"(\d+):(\d\d):(\d\d)[.,](\d{3})")
_SLOWEST = 50.0  # seconds for a word; where most take longer, times are in milliseconds
_DEEPEST = 8
_PAUSE = 0.4  # seconds between words that begin a new line
_LONGEST = 10.0  # seconds of a line that is made of words


def lines_of(document: Any) -> tuple[TextLine, ...]:
    """The lines of a document, by time; none if it holds no texts with times."""
    found = _in_seconds(max(_lists(document, 0), key=_weight, default=[]))
    lines: list[TextLine] = []
    for line in sorted(found, key=lambda line: line.start or 0.0):
        last = lines[-1] if lines else None
        if last is not None and _continues(last, line):
            lines[-1] = TextLine(f"{last.text} {line.text}", last.start, line.end)
        else:
            lines.append(line)
    return tuple(lines)


def _in_seconds(lines: list[TextLine]) -> list[TextLine]:
    """Lines whose times may be in milliseconds, as AssemblyAI writes them."""
    spans = [
        (line.text, line.start, line.end)
        for line in lines
        if line.start is not None and line.end is not None
    ]
    each = sorted((end - start) / len(tokens(text)) for text, start, end in spans)
    if not each or each[len(each) // 2] < _SLOWEST:
        return lines
    return [TextLine(text, start / 1000.0, end / 1000.0) for text, start, end in spans]


def _weight(lines: list[TextLine]) -> tuple[int, int]:
    """Most words first; of two with the same, the one with longer lines."""
    return sum(len(tokens(line.text)) for line in lines), -len(lines)


def _lists(value: Any, depth: int) -> Iterator[list[TextLine]]:
    """The lists in a document whose entries are texts with times."""
    inner = list(value.values()) if isinstance(value, dict) else value
    if depth > _DEEPEST or not isinstance(inner, list):
        return
    if isinstance(value, list):
        lines = [line for entry in value if (line := _line(entry)) is not None]
        if lines:
            yield lines
    for entry in inner:
        yield from _lists(entry, depth + 1)


def _line(entry: Any) -> TextLine | None:
    if not isinstance(entry, dict):
        return None
    choices = entry.get(_CHOICES)
    likeliest = choices[0] if isinstance(choices, list) and choices else entry
    text = clean_text((_text(entry) or _text(likeliest)).strip())
    timed = entry[_INSIDE] if isinstance(entry.get(_INSIDE), dict) else entry
    start, end = (_seconds(timed, names) for names in (_STARTS, _ENDS))
    if isinstance(pair := entry.get(_BOTH), list) and len(pair) == 2:
        start, end = (_number(value) for value in pair)
    if start is None or end is None or not 0.0 <= start < end < 1e6 or not tokens(text):
        return None
    return TextLine(text, start, end)


def _text(entry: Any) -> str:
    names = _TEXTS if isinstance(entry, dict) else ()
    return next((entry[name] for name in names if isinstance(entry.get(name), str)), "")


def _seconds(entry: dict[str, Any], names: tuple[str, ...]) -> float | None:
    return next((_number(entry[name]) for name in names if name in entry), None)


def _number(value: Any) -> float | None:
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        return None
    try:
        if isinstance(value, str) and (clock := _CLOCK.fullmatch(value[:40])):
            hours, minutes, seconds, thousandths = map(int, clock.groups())
            return 3600.0 * hours + 60.0 * minutes + seconds + thousandths / 1000.0
        return float(value[:40].removesuffix("s") if isinstance(value, str) else value)
    except (ValueError, OverflowError):
        return None


def _continues(last: TextLine, line: TextLine) -> bool:
    """Whether a word belongs to the line before it."""
    assert last.start is not None
    assert last.end is not None
    assert line.start is not None
    assert line.end is not None
    short = len(tokens(line.text)) == 1 and line.end - last.start <= _LONGEST
    return short and line.start - last.end <= _PAUSE
