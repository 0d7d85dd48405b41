"""JSON with named weights, in any layout: what MediaPipe recorders, game engines and scripts write.

The frames are the first list of objects whose entries have ARKit names somewhere inside, as
`{"jawOpen": 0.1, ...}` or as `[{"name": "jawOpen", "score": 0.1}, ...]`; or each channel has a list
of its own, `{"time": [...], "jawOpen": [...]}`; or there is a list of names, and the frames are
lists of numbers in its order. Times and the frame rate are looked for by name.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

from faceedit_app.core.names import canonical_channel
from faceedit_app.formats.json_take import JsonFrames, Naming, frame_rate, json_take
from faceedit_app.formats.json_text import (
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
_DEEPEST = 5
_MOST_NAMES = 10_000  # of a frame, or of the lists of a document
_TRIED = 50  # entries of a list that are looked at for weights, since the first may have no face
_NAMES = ("name", "categoryName", "category_name", "displayName", "shape", "blendshape", "key")
_NUMBERS = ("score", "value", "weight", "val")
_SERIES = ("values", "weights", "scores", "data")

Weights = Mapping[str, Any]
"""Numbers by name, as places in the document or None."""


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
    layouts = (_frames, _columns, _matrix)
    frames = next(
        (found for layout in layouts if (found := layout(text.document, naming, rate))), None
    )
    if frames is None:
        raise text.error("has no frames with the weights of ARKit channels", "export it again")
    return json_take(text, form, frames, fps)


# --- a list with an entry per frame --------------------------------------------------------------


def _frames(document: Any, naming: Naming, rate: float | None) -> JsonFrames | None:
    found = next((e for e in _lists(document, 0) if _have_weights(e, naming)), None)
    if found is None:
        return None
    weights = [_weights(entry, naming) for entry in found]
    clock = _clock(next(entry for entry, row in zip(found, weights, strict=True) if row))
    named = dict.fromkeys(name for row in weights for name in row)
    names = [name for name in named if not clock or name != clock[-1]]
    times = [_at(entry, clock) for entry in found] if clock else []
    return JsonFrames(
        names,
        [[row.get(name) for name in names] if row else [] for row in weights],
        times if None not in times else (),
        clock[-1] if clock else "time",
        rate,
        naming,
    )


def _lists(entry: Any, depth: int) -> Iterator[Sequence[Any]]:
    """Lists that may be the frames, the outermost first."""
    if depth > _DEEPEST:
        return
    if isinstance(entry, list):
        yield entry
    elif isinstance(entry, dict):
        if len(entry) > 1 and all(name.strip().isdigit() for name in entry):
            yield list(entry.values())
        for inner in islice(entry.values(), _MOST_NAMES):
            yield from _lists(inner, depth + 1)


def _have_weights(entries: Sequence[Any], naming: Naming) -> bool:
    """Whether entries are frames: each may have weights, rather than be one weight."""
    tried = entries[:_TRIED]
    if any(_named_number(as_object(entry)) for entry in tried):
        return False
    return any(_weights(entry, naming) for entry in tried)


def _weights(entry: Any, naming: Naming, depth: int = 0) -> Weights:
    """The weights of a frame, wherever they are in it; empty if there are none."""
    if depth > _DEEPEST or (isinstance(entry, dict | list) and len(entry) > _MOST_NAMES):
        return {}
    if isinstance(entry, dict):
        numbers = {n: v for n, v in entry.items() if v is None or isinstance(v, Place)}
        if any(naming(name) for name in numbers):
            return numbers
        inner: Iterator[Any] = iter(entry.values())
    else:
        inner = islice(as_list(entry), _TRIED)
        pairs = [_named_number(as_object(one)) for one in as_list(entry)]
        named = {pair[0]: pair[1] for pair in pairs if pair is not None}
        if any(map(naming, named)):
            return named
    return next((found for one in inner if (found := _weights(one, naming, depth + 1))), {})


def _named_number(entry: Mapping[str, Any]) -> tuple[str, Any] | None:
    """The name and the number of `{"name": "jawOpen", "score": 0.1}`."""
    names = (entry[key] for key in _NAMES if isinstance(entry.get(key), str) and entry[key])
    name, number = next(names, None), next((key for key in _NUMBERS if key in entry), None)
    if name is None or number is None:
        return None
    value = entry[number]
    return (name, value) if value is None or isinstance(value, Place) else None


def _clock(frame: Any) -> tuple[str, ...]:
    """Where a frame's time is: its key, below another one if need be; empty if there is none."""
    entry = as_object(frame)
    keys = list(entry)
    for k in time_columns([key or "-" for key in keys]):
        if isinstance(entry[keys[k]], Place | str):
            return (keys[k],)
    for key, value in entry.items():
        below = _clock(value) if isinstance(value, dict) else ()
        if below:
            return (key, *below)
    return ()


def _at(entry: Any, keys: Sequence[str]) -> Any:
    for key in keys:
        entry = as_object(entry).get(key)
    return entry


# --- a list per channel --------------------------------------------------------------------------


def _columns(document: Any, naming: Naming, rate: float | None) -> JsonFrames | None:
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
    if depth > _DEEPEST:
        return
    if isinstance(entry, dict):
        yield entry
    inner = entry.values() if isinstance(entry, dict) else as_list(entry)
    for one in islice(inner, _TRIED):
        if isinstance(one, dict | list):
            yield from _dicts(one, depth + 1)


def _objects(entry: Any, depth: int) -> Iterator[Mapping[str, list[Any]]]:
    """Objects of lists by name, the outermost first."""
    if depth > _DEEPEST:
        return
    yield _series(entry)
    inner = entry.values() if isinstance(entry, dict) else as_list(entry)
    for one in islice(inner, _MOST_NAMES if isinstance(entry, dict) else _TRIED):
        if isinstance(one, dict | list):
            yield from _objects(one, depth + 1)


def _series(entry: Any) -> dict[str, list[Any]]:
    """The lists of an object, or of `[{"name": "jawOpen", "values": [...]}, ...]`, by name."""
    if isinstance(entry, dict):
        items = islice(entry.items(), _MOST_NAMES)
        return {name: value for name, value in items if isinstance(value, list)}
    found = {}
    for one in map(as_object, as_list(entry)[:_MOST_NAMES]):
        name = next((one[key] for key in _NAMES if isinstance(one.get(key), str)), None)
        series = next((one[key] for key in _SERIES if isinstance(one.get(key), list)), None)
        if name is not None and series is not None:
            found[name] = series
    return found


# --- names, and lists of numbers -----------------------------------------------------------------


def _matrix(document: Any, naming: Naming, rate: float | None) -> JsonFrames | None:
    names = next((one for one in _all_lists(document, 0) if _are_names(one, naming)), None)
    if names is None:
        return None
    for entries in _all_lists(document, 0):
        rows = [_row(entry, len(names)) for entry in entries[:_TRIED]]
        if any(rows):
            weights = [_row(entry, len(names)) for entry in entries]
            clock = next((found for entry in entries if (found := _clock(entry))), ())
            times = [_at(entry, clock) for entry in entries] if clock else []
            if None in times or not times:
                times = list(_found_times(document, len(entries)))
            return JsonFrames(names, weights, times, clock[-1] if clock else "time", rate, naming)
    return None


def _all_lists(entry: Any, depth: int) -> Iterator[list[Any]]:
    for one in _dicts(entry, depth):
        yield from (value for value in one.values() if isinstance(value, list))


def _are_names(entries: list[Any], naming: Naming) -> bool:
    """Whether a list holds the names of channels."""
    if not 0 < len(entries) <= _MOST_NAMES or not all(isinstance(one, str) for one in entries):
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
