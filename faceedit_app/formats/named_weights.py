"""JSON with named weights, in any layout: what MediaPipe recorders, game engines and scripts write.

There is an entry for each frame or each weight (`json_entries.py`); or each channel has a list of
its own, `{"time": [...], "jawOpen": [...]}`; or there is a list of names, and the frames are lists
of numbers in its order. Times and the frame rate are looked for by name.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

from faceedit_app.core.names import canonical_channel
from faceedit_app.formats.json_entries import (
    DEEPEST,
    MOST_NAMES,
    NAMES,
    TRIED,
    clock_of,
    entry_frames,
    is_text,
    letters,
    single_weights,
    value_at,
)
from faceedit_app.formats.json_take import JsonFrames, Naming, frame_rate, json_take
from faceedit_app.formats.json_text import (
    JsonText,
    Place,
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
_DECIMAL_COMMA = re.compile(rb'"-?\d+,\d+"')
_SERIES = ("values", "weights", "scores", "data")


def sniff(content: bytes) -> float:
    """How likely, 0..1, this is a recording of named weights."""
    if not looks_like_json(content) or any(text in content[:_HEAD] for text in _NOT_TAKES):
        return 0.0
    texts = (match[1].decode("utf-8", "replace") for match in _TEXT.finditer(content[:_HEAD]))
    return 0.3 if any(map(canonical_channel, texts)) else 0.0


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
    naming: Naming = canonical_channel,
) -> Take:
    """Open a recording of named weights as a take of this format.

    Args:
        naming: the channel that a name means, or None.

    Raises:
        RateNeeded, FileError: as for `read`.
    """
    text = read_json(path, content)
    rate = frame_rate(text, text.document)
    layouts = (entry_frames, single_weights, _columns, _matrix)
    frames = next((found for layout in layouts if (found := layout(text, naming, rate))), None)
    if frames is None:
        if _DECIMAL_COMMA.search(content):
            raise text.error("writes its numbers as text, with a comma", "write 0.25 for 0,25")
        remedy = "export it with the weights of every frame, or as CSV"
        raise text.error("has no frames with the weights of ARKit channels", remedy)
    return json_take(text, form, frames, fps)


# --- a list per channel --------------------------------------------------------------------------


def _columns(text: JsonText, naming: Naming, rate: float | None) -> JsonFrames | None:
    document = text.document
    found = next((one for one in _objects(document, 0) if any(map(naming, one))), None)
    if found is None:
        return None
    channels = {name: series for name, series in found.items() if naming(name)}
    length = max(map(len, channels.values()))
    clocks = {**_series(as_object(document)), **found}
    names = list(clocks)
    ranked = [names[k] for k in time_columns([name or "-" for name in names])]
    clock = next((name for name in ranked if len(clocks[name]) == length), None)
    rows = [list(row) for row in zip(*channels.values(), strict=False)]
    if any(len(series) != length for series in channels.values()):
        rows.append([None])  # reported as a row of the wrong length
    times = clocks[clock] if clock else _found_times(document, length)
    return JsonFrames(list(channels), rows, times, clock or "time", rate, naming)


def _found_times(document: Any, length: int) -> Sequence[Any]:
    """The first list of times of this length, such as those of a track's keys."""
    for entry in _dicts(document, 0):
        names = list(entry)
        for k in time_columns([name or "-" for name in names]):
            times = as_list(entry[names[k]])
            if len(times) == length:
                return times
    return ()


def _dicts(entry: Any, depth: int) -> Iterator[Mapping[str, Any]]:
    """The objects of a document, the outermost first."""
    if depth > DEEPEST:
        return
    if isinstance(entry, dict):
        yield entry
    inner = entry.values() if isinstance(entry, dict) else as_list(entry)
    for one in islice(inner, TRIED):
        if isinstance(one, dict | list):
            yield from _dicts(one, depth + 1)


def _objects(entry: Any, depth: int) -> Iterator[Mapping[str, list[Any]]]:
    """Objects of lists by name, the outermost first."""
    if depth > DEEPEST:
        return
    yield _series(entry)
    inner = entry.values() if isinstance(entry, dict) else as_list(entry)
    for one in islice(inner, MOST_NAMES if isinstance(entry, dict) else TRIED):
        if isinstance(one, dict | list):
            yield from _objects(one, depth + 1)


def _series(entry: Any) -> dict[str, list[Any]]:
    """The lists of an object, or of `[{"name": "jawOpen", "values": [...]}, ...]`, by name."""
    if isinstance(entry, dict):
        items = islice(entry.items(), MOST_NAMES)
        return {name: series for name, value in items if (series := as_list(value))}
    found = {}
    for one in map(as_object, as_list(entry)[:MOST_NAMES]):
        name = next((one[k] for k in one if letters(k) in NAMES and is_text(one[k])), None)
        series = next((values for key in _SERIES if (values := as_list(one.get(key)))), [])
        if name is not None and series:
            found[name] = series
    return found


# --- names, and lists of numbers -----------------------------------------------------------------


def _matrix(text: JsonText, naming: Naming, rate: float | None) -> JsonFrames | None:
    document = text.document
    names = next((one for one in _all_lists(document, 0) if _are_names(one, naming)), None)
    if names is None:
        return None
    for entries in _all_lists(document, 0):
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
                times = list(_found_times(document, len(entries)))
            return JsonFrames(names, weights, times, clock[-1] if clock else "time", rate, naming)
    return None


def _all_lists(entry: Any, depth: int) -> Iterator[list[Any]]:
    for one in _dicts(entry, depth):
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
        if len(numbers) == length and all(n is None or isinstance(n, Place) for n in numbers):
            return numbers
    return []
