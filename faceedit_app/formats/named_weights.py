"""JSON with named weights, in any layout: what MediaPipe recorders, game engines and scripts write.

There is an entry for each frame or each weight (`json_entries.py`); or each channel has a list of
its own (`json_curves.py`); or there is a list of names, and the frames are lists of numbers in its
order. Times and the frame rate are looked for by name.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from faceedit_app.core.names import canonical_channel, naming_of
from faceedit_app.formats.json_beside import beside
from faceedit_app.formats.json_clocks import clock_of, value_at
from faceedit_app.formats.json_curves import curves, dicts, found_times
from faceedit_app.formats.json_entries import (
    DEEPEST,
    MOST_NAMES,
    TRIED,
    entry_frames,
    single_weights,
)
from faceedit_app.formats.json_rate import frame_rate
from faceedit_app.formats.json_take import JsonFrames, Naming, json_take
from faceedit_app.formats.json_text import (
    JsonText,
    NumberPlace,
    as_list,
    as_object,
    looks_like_json,
    read_json,
)
from faceedit_app.formats.take import Take
from faceedit_app.formats.time_columns import time_columns

FORMAT = "JSON with named weights"
_HEAD = 1 << 16
_TEXT = re.compile(rb'"((?:[^"\\]|\\.){1,80})"')
_NOT_TAKES = (b'"edits"', b'"bufferViews"', b'"openfacefx.track"')
_PARTS = {"jaw", "mouth", "eye", "brow", "cheek", "nose", "tongue", "left", "right"}
_MOST_NESTED = 30  # names below a part
_DECIMAL_COMMA = re.compile(rb'"-?\d+,\d+"')


def sniff(content: bytes) -> float:
    """How likely, 0..1, this is a recording of named weights."""
    if not looks_like_json(content) or any(text in content[:_HEAD] for text in _NOT_TAKES):
        return 0.0
    texts = _texts(content)
    return 0.3 if any(map(naming_of(texts), texts)) or _are_parts(texts) else 0.0


def _texts(content: bytes) -> list[str]:
    """The names and other texts at the beginning of a document."""
    found = (match[1].decode("utf-8", "replace") for match in _TEXT.finditer(content[:_HEAD]))
    return [text.replace('\\"', '"') for text in found]


def _are_parts(texts: Sequence[str]) -> bool:
    """Whether names of channels are nested in texts: a part of the face, then what it does."""
    for k, text in enumerate(texts):
        if text.lower() in _PARTS:
            following = texts[k + 1 : k + 1 + _MOST_NESTED]
            if any(canonical_channel(f"{text}_{one}") for one in following):
                return True
    return False


def read(path: Path, content: bytes, fps: float | None) -> Take:
    """Open a recording of named weights.

    Raises:
        RateNeeded: it has neither times nor a rate, and `fps` is None.
        FileError: it is damaged, or no weights are found.
    """
    return read_named(path, content, fps, FORMAT)


def read_named(
    path: Path,
    content: bytes,
    fps: float | None,
    form: str,
    naming: Naming | None = None,
) -> Take:
    """Open a recording of named weights as a take of this format.

    Args:
        naming: the channel that a name means, or None; by default ARKit's.

    Raises:
        RateNeeded, FileError: as for `read`.
    """
    text = read_json(path, content)
    naming = naming or naming_of(_texts(content))
    rate = frame_rate(text, text.document)
    layouts = (entry_frames, single_weights, curves, _matrix)
    frames = next((found for layout in layouts if (found := layout(text, naming, rate))), None)
    if frames is None:
        if _DECIMAL_COMMA.search(content):
            raise text.error("writes its numbers as text, with a comma", "write 0.25 for 0,25")
        remedy = "export it with the weights of every frame, or as CSV"
        raise text.error("has no frames with the weights of ARKit channels", remedy)
    if not frames.times:
        frames = replace(frames, times=found_times(text.document, len(frames.weights)))
    return json_take(text, form, frames, fps)


# --- names, and lists of numbers -----------------------------------------------------------------


def _matrix(text: JsonText, naming: Naming, rate: float | None) -> JsonFrames | None:
    document = text.document
    names = next((one for one in _all_names(document) if _are_names(one, naming)), None)
    if names is None:
        return None
    for entries in _all_rows(document, len(names)):
        rows = [_row(entry, len(names)) for entry in entries[:TRIED]]
        if any(rows):
            weights = [_row(entry, len(names)) for entry in entries]
            clock = next((found for entry in entries if (found := clock_of(entry))), ())
            times = [value_at(entry, clock) for entry in entries] if clock else []
            column = next(iter(time_columns(names)), None)
            if column is not None and not times:
                clock = (names[column],)
                times = [row[column] if row else None for row in weights]
            if None in times or not times:
                times = list(found_times(document, len(entries)))
            others = beside(entries, lambda key, value: bool(_row(value, len(names))))
            pairs = zip(entries, weights, strict=True)
            return JsonFrames(
                [*names, *others.turns],
                [[*row, *others.row(entry)] if row else [] for entry, row in pairs],
                times,
                clock[-1] if clock else "time",
                rate,
                naming,
                beside=others.keys,
            )
    return None


def _all_names(document: Any) -> Iterator[list[Any]]:
    """Lists that may be names, also as `{"jawOpen": 0, ...}` with their places."""
    yield from (row for row in as_list(document)[:1] if isinstance(row, list))  # rows of a table
    yield from _all_lists(document, 0)
    for entry in dicts(document, 0):
        for one in (entry, *map(as_object, entry.values())):
            places = list(one.values())
            if places and all(isinstance(place, NumberPlace) for place in places):
                yield list(one)


def _all_rows(document: Any, length: int) -> Iterator[list[Any]]:
    """Lists that may be the frames; of JSON Lines, those in all lines together."""
    if isinstance(document, list):
        lines = [entry for line in document for entry in _rows_in(line, length, 0)]
        if len(lines) > 1:
            yield lines
    for entries in _all_lists(document, 0):
        yield entries
        count = len(found_times(document, len(entries) // length)) if length else 0
        if count > 1 and len(entries) == count * length:
            yield [entries[k : k + length] for k in range(0, len(entries), length)]


def _rows_in(entry: Any, length: int, depth: int) -> Iterator[Any]:
    """The entries with the weights of a frame, wherever they are."""
    if _row(entry, length):
        yield entry
    elif depth <= DEEPEST:
        inner = entry.values() if isinstance(entry, dict) else as_list(entry)
        for one in inner:
            if isinstance(one, dict | list):
                yield from _rows_in(one, length, depth + 1)


def _all_lists(entry: Any, depth: int) -> Iterator[list[Any]]:
    for one in dicts(entry, depth):
        yield from (value for value in one.values() if isinstance(value, list))


def _are_names(entries: list[Any], naming: Naming) -> bool:
    """Whether a list holds the names of channels."""
    if not 0 < len(entries) <= MOST_NAMES or not all(isinstance(one, str) for one in entries):
        return False
    return any(map(naming, entries))


def _row(entry: Any, length: int) -> list[Any]:
    """The numbers of a frame: the entry, or a list in it; empty if it has no such list."""
    lists = [entry, *entry.values()] if isinstance(entry, dict) else [entry]
    for one in lists:
        numbers = as_list(one)
        if len(numbers) == length and all(n is None or isinstance(n, NumberPlace) for n in numbers):
            return numbers
    return []
