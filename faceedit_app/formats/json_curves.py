"""JSON with a list for each channel: of weights, or of keys with a time and a weight.

`{"time": [...], "jawOpen": [...]}`, `[{"name": "jawOpen", "values": [...]}, ...]`, or
`{"jawOpen": [[0.0, 0.1], ...]}` and `{"jawOpen": [{"time": 0.0, "value": 0.1}, ...]}`. Keys are
frames if all channels that move have them at the same times.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any

from faceedit_app.formats.files import shown
from faceedit_app.formats.json_entries import (
    DEEPEST,
    MOST_NAMES,
    NAMES,
    NUMBERS,
    TRIED,
    is_text,
    letters,
)
from faceedit_app.formats.json_take import JsonFrames, Naming
from faceedit_app.formats.json_text import JsonText, NumberPlace, as_list, as_object
from faceedit_app.formats.rotations import rotation_named
from faceedit_app.formats.time_columns import time_columns

_SERIES = ("values", "weights", "scores", "data", "keys", "keyframes", "keyframepoints", "samples")
_STILL = 2  # keys of a curve that does not move


@dataclass(frozen=True)
class Keys:
    """The keys of a channel.

    Attributes:
        times: as places in the document.
        weights: as places, or None.
        clock: what the document calls the times.
    """

    times: Sequence[NumberPlace]
    weights: Sequence[Any]
    clock: str


def curves(text: JsonText, naming: Naming, rate: float | None) -> JsonFrames | None:
    """The frames of a list for each channel.

    Raises:
        FileError: channels have keys at different times.
    """
    document = text.document
    found = next((one for one in _objects(document, 0) if any(map(naming, one))), None)
    if found is None:
        return None
    channels = {name: series for name, series in found.items() if naming(name)}
    keyed = {name: keys for name, series in channels.items() if (keys := _keys(series))}
    others = tuple(name for name in found if name not in channels and not time_columns([name]))
    if len(keyed) == len(channels):
        return replace(_keyed(text, keyed, naming, rate), beside=others)
    length = max(map(len, channels.values()))
    clocks = {**_series(as_object(document)), **found}
    names = list(clocks)
    ranked = [names[k] for k in time_columns([name or "-" for name in names])]
    clock = next((name for name in ranked if len(clocks[name]) == length), None)
    turns = {
        name: found[name]
        for name in others
        if rotation_named(name) and len(found[name]) == length and _are_numbers(found[name])
    }
    rows = [list(row) for row in zip(*channels.values(), *turns.values(), strict=False)]
    if any(len(series) != length for series in channels.values()):
        rows.append([None])  # reported as a row of the wrong length
    times = clocks[clock] if clock else found_times(document, length)
    beside = tuple(name for name in others if name not in turns and name != clock)
    names = [*channels, *turns]
    return JsonFrames(names, rows, times, clock or "time", rate, naming, beside=beside)


def _are_numbers(series: Sequence[Any]) -> bool:
    return all(isinstance(entry, NumberPlace) for entry in series)


def found_times(document: Any, length: int) -> Sequence[Any]:
    """The first list of times of this length, such as those of a track's keys."""
    for entry in dicts(document, 0):
        names = list(entry)
        for k in time_columns([name or "-" for name in names]):
            times = as_list(entry[names[k]])
            if times and len(times) == length and isinstance(times[0], NumberPlace | str):
                return times
    return ()


def dicts(entry: Any, depth: int) -> Iterator[Mapping[str, Any]]:
    """The objects of a document, the outermost first."""
    if depth > DEEPEST:
        return
    if isinstance(entry, dict):
        yield entry
    inner = entry.values() if isinstance(entry, dict) else as_list(entry)
    for one in islice(inner, TRIED):
        if isinstance(one, dict | list):
            yield from dicts(one, depth + 1)


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
        return {name: series for name, value in items if (series := _list_of(value))}
    found = {}
    for one in map(as_object, as_list(entry)[:MOST_NAMES]):
        name = next((one[k] for k in one if letters(k) in NAMES and is_text(one[k])), None)
        series = _list_in(one)
        if name is not None and series:
            found[name] = series
    return found


def _list_of(value: Any) -> list[Any]:
    """The list that a value is, or has in it as its values or keys."""
    return as_list(value) or _list_in(as_object(value))


def _list_in(entry: Mapping[str, Any]) -> list[Any]:
    named = {letters(key): key for key in entry}
    lists = (as_list(entry[named[key]]) for key in _SERIES if key in named)
    return next((values for values in lists if values), [])


def _keys(series: Sequence[Any]) -> Keys | None:
    """The keys of a list of pairs `[time, weight]` or objects; None if it is something else."""
    first = series[0]
    if isinstance(first, list):
        pairs = [entry for entry in series if isinstance(entry, list) and len(entry) == 2]
        times, weights, clock = [p[0] for p in pairs], [p[1] for p in pairs], "time"
    elif isinstance(first, dict):
        number = next((key for key in first if letters(key) in NUMBERS), "")
        clock = next((key for key in _clocks(first) if key != number), "")
        times = [as_object(entry).get(clock) for entry in series]
        weights = [as_object(entry).get(number) for entry in series]
    else:
        return None
    kept = [time for time in times if isinstance(time, NumberPlace)]
    return Keys(kept, weights, clock) if len(kept) == len(series) else None


def _clocks(entry: Mapping[str, Any]) -> Iterator[str]:
    names = list(entry)
    yield from (names[k] for k in time_columns([name or "-" for name in names]))


def _keyed(
    text: JsonText, keyed: Mapping[str, Keys], naming: Naming, rate: float | None
) -> JsonFrames:
    """The frames of channels with keys; those of curves that do not move are left out."""
    longest = max(keyed, key=lambda name: len(keyed[name].times))
    moments = {name: text.values[list(map(int, k.times))].tolist() for name, k in keyed.items()}
    same = {name: keys for name, keys in keyed.items() if moments[name] == moments[longest]}
    other = next((n for n, k in keyed.items() if n not in same and len(k.times) > _STILL), None)
    if other is not None:
        what = f"has keys at other times for {shown(other)} than for {shown(longest)}"
        raise text.error(what, "export it with a key for every frame, or as CSV")
    rows = [list(row) for row in zip(*(keys.weights for keys in same.values()), strict=True)]
    left = len(keyed) - len(same)
    note = f"{left} of {len(keyed)} channels have no key in most frames: carried"
    return JsonFrames(
        list(same),
        rows,
        keyed[longest].times,
        keyed[longest].clock,
        rate,
        naming,
        (note,) if left else (),
    )
