"""Where frames in JSON have their times."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from faceedit_app.formats.json_text import JsonText, NumberPlace, as_object
from faceedit_app.formats.time_columns import time_columns
from faceedit_app.formats.time_names import UNIT_ALONE, is_scale, rank


def clock_keys(entry: Mapping[str, Any]) -> list[str]:
    """The keys of an object that may hold times, the most reliable first."""
    keys = list(entry)
    found = (keys[k] for k in time_columns([key or "-" for key in keys]))
    return [key for key in found if isinstance(entry[key], NumberPlace | str)]


def clock_of(frame: Any) -> tuple[str, ...]:
    """Where a frame's time is: its key, below another one if need be; empty if there is none."""
    return next(_clocks(frame), ())


def _clocks(frame: Any) -> Iterator[tuple[str, ...]]:
    """Where a frame's times may be, the most reliable first."""
    entry = as_object(frame)
    yield from ((key,) for key in clock_keys(entry))
    for key, value in entry.items():
        if isinstance(value, dict):
            yield from ((key, *below) for below in _clocks(value))


def running_clocks(text: JsonText, frames: Sequence[Any]) -> list[tuple[str, ...]]:
    """Where the times of frames are: the first place that is not the same in all of them.

    What else may tell or complete them follows. The place is empty if there is none.
    """
    found = list(_clocks(frames[0]))
    tried = (frames[0], frames[len(frames) // 2], frames[-1])
    times = [keys for keys in found if not is_scale(keys[-1])]
    running = (
        keys for keys in times if len({text_of(text, value_at(frame, keys)) for frame in tried}) > 1
    )
    clock = next(running, next(iter(times), ()))
    others = (keys for keys in found if rank(keys[-1]) <= UNIT_ALONE or is_scale(keys[-1]))
    return [clock, *(keys for keys in others if keys != clock)]


def value_at(entry: Any, keys: Sequence[str]) -> Any:
    """What is below these keys of an entry."""
    for key in keys:
        entry = as_object(entry).get(key)
    return entry


def text_of(text: JsonText, value: Any) -> str:
    """A number or a text of a document, to compare it with others."""
    number = text.number(value)
    return str(value if number is None else number)
