"""The take in a JSON document: frames of named weights, in any layout."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arkit import ROTATION_INDEX, ROTATIONS
from faceedit_app.core.arrays import Doubles, Indices
from faceedit_app.core.names import canonical_channel
from faceedit_app.formats.clocks import FrameClock, believed
from faceedit_app.formats.digit_times import dates_of
from faceedit_app.formats.files import LONGEST_NAME, shown
from faceedit_app.formats.json_beside import stated_units
from faceedit_app.formats.json_rate import likely_rate
from faceedit_app.formats.json_text import JsonSource, JsonText, NumberPlace, Places, as_list
from faceedit_app.formats.lost_faces import CONFIDENCE, confidence_of, lost_rows
from faceedit_app.formats.rotations import found_rotations, read_rotations
from faceedit_app.formats.several_faces import faces_in
from faceedit_app.formats.stated_rate import by_frame_numbers
from faceedit_app.formats.take import Recording, Take, finish_take
from faceedit_app.formats.time_columns import text_times
from faceedit_app.formats.time_names import is_scale
from faceedit_app.formats.time_numbers import number_times
from faceedit_app.formats.time_parts import joined_parts
from faceedit_app.formats.timecode import BadTimecode
from faceedit_app.formats.timing import (
    DEFAULT_RATE,
    FASTEST,
    SLOWEST,
    BadRow,
    NoTimes,
    Timing,
    format_rate,
    single_row,
)

HEAD = frozenset(name for name in ROTATIONS if name.startswith("head"))
Naming = Callable[[str], str | None]
"""The channel that a name in a file means, or None."""

_LEAST_DATE = 19700101000000.0  # that is written as digits alone


@dataclass(frozen=True)
class JsonFrames:
    """The R frames of a document.

    Attributes:
        names: the N names of weights.
        weights: (R) per frame a list of N numbers, or anything else if the face was lost.
        times: (R) the time of each frame, a number or a date; empty if there are none.
        time_name: the document's name for them.
        rate: frames per second, instead of times.
        naming: the channel that a name means.
        others: other clocks, or parts of the first: their names and (R) times.
        notes: what is unusual about them.
        unread: as `Take.unread`.
        sure: (R) how sure the tracker was of each frame, numbers; empty if the file does not say.
        beside: the keys of what else the frames have.
    """

    names: Sequence[Any]
    weights: Sequence[Any]
    times: Sequence[Any] = ()
    time_name: str = "time"
    rate: float | None = None
    naming: Naming = canonical_channel
    notes: tuple[str, ...] = ()
    unread: tuple[str, ...] = ()
    sure: Sequence[Any] = ()
    others: Sequence[tuple[str, Sequence[Any]]] = ()
    beside: tuple[str, ...] = ()


def json_take(text: JsonText, name: str, frames: JsonFrames, fps: float | None) -> Take:
    """Make the take of a document.

    Args:
        name: of the format.
        fps: the frame rate, if the user gave one.

    Raises:
        RateNeeded: its times are unusable, and `fps` is None.
        FileError: it has no channels or frames, or is damaged.
    """
    columns = _channels(text, frames)
    places = _places(text, frames, list(columns.values()))
    values = text.look_up(places)
    filled = ~np.all(np.isnan(values), axis=0)
    channels = tuple(channel for channel, is_there in zip(columns, filled, strict=True) if is_there)
    missing = np.isnan(values[:, filled])
    lost = lost_rows(values[:, filled], np.zeros(len(values), bool))
    incomplete = np.argwhere(missing & ~lost[:, None])
    if len(incomplete):
        row, k = incomplete[0]
        problem = f"frame {row + 1} has no {channels[k]}, which other frames have"
        raise text.error(problem, "write all weights in every frame, also if they are 0")
    kept = np.flatnonzero(~lost)
    places = np.ascontiguousarray(places[np.ix_(kept, filled)])
    sure_places = _sure_places(text, frames, kept)
    _check_one_face(text, frames, kept, values[np.ix_(kept, filled)])
    turned = found_rotations(frames.names)
    turn_places = _places(text, frames, list(turned.values()))[kept]
    units = stated_units(text) if turned else {}
    found = read_rotations(
        text.look_up(turn_places),
        tuple(turned),
        [str(frames.names[k]) for k in turned.values()],
        lambda frame, k: text.line(int(turn_places[frame, k])),
        [units.get("head" if name in HEAD else "eye", units.get("")) for name in turned],
    )
    used = {columns[channel] for channel in channels}
    recording = Recording(
        path=text.path,
        format=name,
        channels=channels,
        values=values[np.ix_(kept, filled)],
        timing=_timing(text, frames, kept) if len(kept) else NoTimes("has no frames"),
        lost=lost,
        carried=(
            *(
                shown(str(n), LONGEST_NAME)
                for k, n in enumerate(frames.names)
                if k not in used and n != frames.time_name
            ),
            *(shown(key, LONGEST_NAME) for key in frames.beside),
            *(() if sure_places is None else (CONFIDENCE,)),
        ),
        own=tuple(str(frames.names[columns[channel]]) for channel in channels),
        notes=(*frames.notes, *found.notes),
        unread=frames.unread,
        rotations=found.rotations,
        rotation_names=tuple(turned),
        confidence=None if sure_places is None else confidence_of(text.look_up(sure_places)),
    )
    source = partial(
        JsonSource,
        text,
        places,
        sure_places=sure_places,
        turn_places=None if found.rotations is None else _all_turns(turn_places, tuple(turned)),
        degrees=found.degrees,
    )
    return finish_take(recording, fps, source, lambda frame, k: text.line(int(places[frame, k])))


def _channels(text: JsonText, frames: JsonFrames) -> dict[str, int]:
    found: dict[str, int] = {}
    for k, name in enumerate(frames.names):
        channel = frames.naming(name) if isinstance(name, str) else None
        if channel in found:
            raise text.error(f'names the channel "{channel}" twice', "remove one of them")
        if channel is not None:
            found[channel] = k
    if not found:
        raise text.error("holds no ARKit channel such as jawOpen", "choose another take")
    return found


def _places(text: JsonText, frames: JsonFrames, columns: list[int]) -> NDArray[np.int64]:
    """(R, K) the places of the channels' weights."""
    places = np.full((len(frames.weights), len(columns)), -1, np.int64)
    for row, entries in enumerate(frames.weights):
        weights = as_list(entries)
        if not weights:
            continue
        if len(weights) != len(frames.names):
            problem = f"frame {row + 1} has {len(weights)} weights, there are {len(frames.names)}"
            first = next((int(entry) for entry in weights if isinstance(entry, NumberPlace)), -1)
            raise text.error(f"{problem} names", place=first)
        places[row] = text.places(weights)[columns]
    return places


def _sure_places(text: JsonText, frames: JsonFrames, kept: Indices) -> Places | None:
    """(T,) the places of the frames' confidence, if each has one."""
    if len(frames.sure) != len(frames.weights):
        return None
    entries = [frames.sure[row] for row in kept.tolist()]
    return text.places(entries) if all(isinstance(one, NumberPlace) for one in entries) else None


def _check_one_face(text: JsonText, frames: JsonFrames, kept: Indices, values: Doubles) -> None:
    """Refuse frames of several faces, each of which has the time of another."""
    times = [frames.times[row] for row in kept.tolist()] if frames.times else []
    numbers = [text.number(entry) for entry in times]
    moments = [str(t) if n is None else n for t, n in zip(times, numbers, strict=True)]
    count = faces_in(moments, values)
    if count:
        row = next(k for k in range(1, len(moments)) if moments[k] == moments[k - 1])
        place = int(times[row]) if isinstance(times[row], NumberPlace) else -1
        problem = f"frames {kept[row]} and {kept[row] + 1} have the same time, of {count} faces"
        raise text.error(problem, 'keep one face, or number them in a field "face_id"', place)


def _all_turns(places: Places, names: Sequence[str]) -> Places:
    """(T, 9) the places of all rotations, of those (T, N) of some names; -1 for the others."""
    out = np.full((len(places), len(ROTATIONS)), -1, np.int64)
    out[:, [ROTATION_INDEX[name] for name in names]] = places
    return out


def _timing(text: JsonText, frames: JsonFrames, kept: Indices) -> Timing | NoTimes:
    times = [frames.times[row] for row in kept] if frames.times else []
    others = [(name, [entries[row] for row in kept]) for name, entries in frames.others]
    try:
        if times and (found := _clocks_of(text, [(frames.time_name, times), *others])):
            best, notes = believed(found)
            timing = found[best].timing
            return replace(timing, notes=(*notes, *timing.notes))
    except NoTimes as none:
        if frames.rate is None:
            likely = likely_rate(text, none.rate)
            return NoTimes(none.problem, likely, none.numbers, none.step)
        if none.numbers is not None and SLOWEST <= frames.rate <= FASTEST:
            if none.step == 1:
                return none.timing_at(frames.rate, kept)
            says = f"the file says {format_rate(frames.rate)}"
            return by_frame_numbers(none, frames.rate, says, kept)
    except BadTimecode as bad:
        raise text.error(f'holds "{shown(bad.text)}" in place of a time') from None
    except BadRow as bad:
        frame = int(kept[bad.row]) + 1
        entry = times[bad.row]
        place = int(entry) if isinstance(entry, NumberPlace) else -1
        problem = f"the time of frame {frame} does not come after that of the frame before it"
        raise text.error(problem, "sort the frames by time", place) from None
    if frames.rate is None:
        return NoTimes("has neither times nor a frame rate", likely_rate(text))
    if not SLOWEST <= frames.rate <= FASTEST:
        return NoTimes(f"gives {frames.rate:g} as its frame rate", DEFAULT_RATE)
    if len(kept) == 1:
        return single_row()
    return Timing((kept - kept[0]) / frames.rate, frames.rate)


def _clocks_of(text: JsonText, named: Sequence[tuple[str, Sequence[Any]]]) -> list[FrameClock]:
    """The clocks of frames; empty if the first is none.

    Args:
        named: the names of clocks and (T) their times; some may be parts of others.

    Raises:
        NoTimes, BadRow, BadTimecode: those of the first are impossible.
    """
    names = [name for name, _ in named]
    joined = joined_parts(names, [[_digits(text, one) for one in times] for _, times in named])
    parts = {part for part, _ in joined.values()}
    found: list[FrameClock] = []
    for k, (name, times) in enumerate(named):
        if k in parts or is_scale(name):
            continue
        try:
            if k in joined:
                kind, timing = number_times(np.array(joined[k][1], np.float64), f"{name} s")
            else:
                kind, timing = _clock_times(text, times, name)
        except (NoTimes, BadTimecode, BadRow):
            if k == 0:
                raise
        else:
            found.append(FrameClock(name, kind, timing))
    return found


def _digits(text: JsonText, entry: Any) -> str:
    """A number without an exponent; "" if it is none."""
    number = text.number(entry)
    return "" if number is None else np.format_float_positional(number, trim="-")


def _clock_times(text: JsonText, times: Sequence[Any], name: str) -> tuple[str, Timing]:
    """The kind (`FrameClock.kind`) and the times of numbers, or of dates and the like."""
    numbers = [text.number(entry) for entry in times]
    if None not in numbers:
        values = np.array(numbers, np.float64)
        if values.min() > _LEAST_DATE:  # more digits than a float keeps
            digits = [text.written(one) for one in times if isinstance(one, NumberPlace)]
            if dates := dates_of(digits):
                return "date", text_times(dates)
        return number_times(values, name)
    texts = [entry for entry in times if isinstance(entry, str)]
    if len(texts) < len(times):
        raise NoTimes("has neither times nor a frame rate")
    return "date", text_times(texts)
