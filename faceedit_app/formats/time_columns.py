"""Find the column with the times of a table's rows, and its unit.

A column in real time is preferred to one with frame numbers. Kind and unit follow from the whole
column; its name only decides what is tried first.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from datetime import datetime

import numpy as np

from faceedit_app.core.errors import FileError
from faceedit_app.formats.clocks import FrameClock, believed
from faceedit_app.formats.csv_table import Table
from faceedit_app.formats.digit_times import clocks_of, dates_of, with_zeros
from faceedit_app.formats.files import REPAIR, shown
from faceedit_app.formats.second_take import (
    after_header,
    begun_again,
    check_numbers,
    check_one_take,
    not_gone_on,
)
from faceedit_app.formats.time_names import (
    NAMED_TIMES,
    NO_TIMES,
    UNIT_ALONE,
    counts_steps,
    is_scale,
    names_frames,
    rank,
)
from faceedit_app.formats.time_numbers import number_times
from faceedit_app.formats.time_parts import joined_parts
from faceedit_app.formats.timecode import (
    BadTimecode,
    clock_times,
    derive_timing,
    is_clock,
    is_timecode,
)
from faceedit_app.formats.timing import BadRow, NoTimes, Timing, set_back, time_rows

_NUMBER = re.compile(r"([+-]?\d*\.?\d+(?:[eE][+-]?\d+)?)\s*(s|sec|ms|msec|us|ns)", re.ASCII)
_NUMBERED = re.compile(r"(?:.*\D)?(\d{1,9})(?:\.[A-Za-z]{2,4})?", re.ASCII)
_UNIVERSAL = re.compile(r"\s*(?:UTC|GMT)$", re.IGNORECASE)
# Day, month and year in any order, then a clock time: only the clock counts.
_LOCAL = re.compile(
    r"\d{1,4}[./-]\d{1,2}[./-]\d{1,4}[ ,T]+(?P<hour>\d{1,2})(?P<rest>:\d\d:\d\d(?:[.,]\d{1,9})?)"
    r"(?: ?(?P<half>[ap])\.?m\.?)?",
    re.IGNORECASE | re.ASCII,
)
_SAMPLE = 200


@dataclass(frozen=True)
class RowTimes:
    """The times of a table's frames.

    Attributes:
        timing: the times, or why there are none.
        column: the column of the times, if any.
        kind: `timecode`, `clock`, `date`, `seconds`, `number` (in another unit),
            `frames`, or "".
        part: the column with the other part of the times, if they are in two.
    """

    timing: Timing | NoTimes
    column: int | None = None
    kind: str = ""
    part: int | None = None

    @property
    def has_numbers(self) -> bool:
        """Whether they are frame numbers."""
        return isinstance(self.timing, NoTimes) and self.timing.numbers is not None


def time_columns(names: Sequence[str]) -> list[int]:
    """Columns that may hold times, the most reliable first."""
    ranked = [(rank(name), k) for k, name in enumerate(names)]
    return [k for place, k in sorted(ranked) if place < NO_TIMES]


def read_times(
    table: Table, columns: Sequence[int], texts: Sequence[Sequence[str]], lines: Sequence[int]
) -> RowTimes:
    """Read the times of a table's frames.

    Args:
        columns: C candidates, see `time_columns`.
        texts: (C) per candidate its T texts.
        lines: (T) indices of the frames' lines, for messages.

    Raises:
        FileError: a row of the column is damaged.
    """
    names = [table.names[column] for column in columns]
    joined = joined_parts(names, texts)
    parts = {part for part, _ in joined.values()}
    useless: RowTimes | None = None
    clocks: list[RowTimes] = []
    for k, (column, name) in enumerate(zip(columns, names, strict=True)):
        if k in parts or is_scale(name) or (clocks and rank(name) > UNIT_ALONE):
            continue
        part, cells = joined.get(k, (None, texts[k]))
        try:
            found = _column_times(table, column, cells, lines)
        except FileError:
            if clocks:
                continue
            raise
        if found is not None and part is not None:
            found = replace(found, kind="number", part=columns[part])
        if found is not None and isinstance(found.timing, Timing):
            clocks.append(found)
        elif found is not None and (useless is None or found.has_numbers):
            useless = found
    if clocks:
        return _believed(table, clocks)
    return useless or RowTimes(NoTimes("has no column with times"))


def _believed(table: Table, found: Sequence[RowTimes]) -> RowTimes:
    """One of the columns that have times, with a note if another one says something else."""
    clocks = [
        FrameClock(table.names[one.column], one.kind, one.timing)
        for one in found
        if one.column is not None and isinstance(one.timing, Timing)
    ]
    best, notes = believed(clocks)
    timing = clocks[best].timing
    return replace(found[best], timing=replace(timing, notes=(*notes, *timing.notes)))


def _column_times(
    table: Table, column: int, cells: Sequence[str], lines: Sequence[int]
) -> RowTimes | None:
    """The times in a column, or why they are none; None if it does not look like times."""
    name = table.names[column]
    kind = _kind(cells, name)
    if kind is None:
        if rank(name) > NAMED_TIMES or not any(map(str.strip, cells)):
            return None
        where = f'in "{shown(name)}" of a form that is not known'
        return RowTimes(NoTimes(f'has times {where}, such as "{shown(cells[0])}"'))
    try:
        kind, timing = _read(kind, cells, name)
    except NoTimes as none:
        if none.numbers is None:
            check_numbers(table, cells, lines)
        return RowTimes(none, column, "frames" if none.numbers is not None else kind)
    except BadTimecode as bad:
        what = {"timecode": "a timecode (HH:MM:SS:FF)", "number": "a finite number"}
        raise table.error(
            f'column "{shown(name)}" holds "{shown(bad.text)}", '
            f"which is not {what.get(kind, 'a time like those in other rows')}",
            REPAIR,
            lines[bad.row],
        ) from None
    except BadRow as bad:
        raise _out_of_order(table, cells, bad.row, lines) from None
    check_one_take(table, cells, lines, kind, timing)
    return RowTimes(timing, column, kind)


def text_times(cells: Sequence[str], name: str = "time") -> Timing:
    """The times of rows that are texts: dates, timecodes, clock times, or numbers.

    Args:
        name: the file's name for them, which may contain a unit.

    Raises:
        BadTimecode: a text is none of them, or of another kind than most.
        NoTimes, BadRow: see `timing.time_rows`.
    """
    kind = _kind(cells, name)
    if kind is None:
        raise BadTimecode(0, cells[0])
    return _read(kind, cells, name)[1]


def _read(kind: str, cells: Sequence[str], name: str) -> tuple[str, Timing]:
    """The kind and the times of a column; those that only zeros put in order get them."""
    try:
        return _READERS[kind](cells, name)
    except (NoTimes, BadRow) as wrong:
        padded = with_zeros(cells)
        if padded is None or (isinstance(wrong, NoTimes) and wrong.numbers is not None):
            raise
        try:
            kind, timing = _READERS[kind](padded[0], name)
        except (NoTimes, BadRow, BadTimecode):
            raise wrong from None
        note = f"the digits after the point are {padded[1]} without zeros before them"
        return kind, replace(timing, notes=(note, *timing.notes))


def _out_of_order(table: Table, cells: Sequence[str], row: int, lines: Sequence[int]) -> FileError:
    if cells[row] == cells[0] and row + 1 < len(cells):
        return begun_again(table, cells, row, lines)
    if row in after_header(table, lines):
        return not_gone_on(table, cells, row, lines)
    return table.error(
        f"the time {shown(cells[row])} does not come after {shown(cells[row - 1])}",
        "sort the rows by time and remove repeated ones",
        lines[row],
    )


# --- kinds of columns ----------------------------------------------------------------------------


def _is_number(text: str) -> bool:
    return _number(text) is not None


def _number(text: str) -> float | None:
    """The number that a text is, with or without a unit of time."""
    match = _NUMBER.fullmatch(text)
    try:
        return None if "_" in text else float(match[1] if match else text)
    except ValueError:
        return None


def _is_date(text: str) -> bool:
    return _moment(text) is not None


def _moment(text: str) -> datetime | None:
    """The date and time of a text in ISO 8601, also with the name of universal time after it."""
    try:
        return datetime.fromisoformat(_UNIVERSAL.sub("Z", text))
    except ValueError:
        return None


def _is_local(text: str) -> bool:
    return _LOCAL.fullmatch(text) is not None


def _read_local(cells: Sequence[str], name: str) -> tuple[str, Timing]:
    return "date", clock_times([_clock(row, text) for row, text in enumerate(cells)])


def _clock(row: int, text: str) -> str:
    """The clock time, on 24 hours, of a date in a country's own order."""
    match = _LOCAL.fullmatch(text)
    if match is None:
        raise BadTimecode(row, text)
    hour = int(match["hour"])
    if match["half"]:
        hour = hour % 12 + (12 if match["half"].lower() == "p" else 0)
    return f"{hour:02d}{match['rest']}"


_KINDS: dict[str, Callable[[str], bool]] = {
    "timecode": is_timecode,
    "clock": is_clock,
    "number": _is_number,
    "date": _is_date,
    "local": _is_local,
}


def _kind(cells: Sequence[str], name: str = "") -> str | None:
    """The kind of most cells of a column, if it is a time or a number."""
    if dates_of(cells):
        return "digits"
    sample = cells[:: max(1, len(cells) // _SAMPLE)]
    for kind, fits in _KINDS.items():
        if sum(map(fits, sample)) * 2 >= len(sample):
            return kind
    return "numbered" if names_frames(name) and all(map(_NUMBERED.fullmatch, cells)) else None


def _read_numbered(cells: Sequence[str], name: str) -> tuple[str, Timing]:
    """Frames by the numbers in their names, such as `frame_0012.png`."""
    matches = map(_NUMBERED.fullmatch, cells)
    return number_times(np.array([float(m[1]) for m in matches if m], np.float64), name)


def _read_dates(cells: Sequence[str], name: str) -> tuple[str, Timing]:
    return "date", date_times(cells)


def date_times(cells: Sequence[str]) -> Timing:
    """The times of rows with dates and times in ISO 8601.

    Raises:
        BadTimecode: a text is not one.
        NoTimes, BadRow: see `timing.time_rows`.
    """
    seconds = np.empty(len(cells))
    first: datetime | None = None
    for row, text in enumerate(cells):
        try:
            moment = _moment(text)
            if moment is None:
                raise BadTimecode(row, text)
            first = first or moment
            seconds[row] = (moment - first).total_seconds()
        except TypeError:  # without the time zone that others have
            raise BadTimecode(row, text) from None
    local = first is not None and first.tzinfo is None
    seconds, notes = set_back(seconds) if local else (seconds, ())
    timing = time_rows(seconds)
    return Timing(timing.times, timing.rate, notes + timing.notes)


def _read_numbers(cells: Sequence[str], name: str) -> tuple[str, Timing]:
    if rank(name) == NAMED_TIMES and (clocks := clocks_of(cells)):
        timing = clock_times(clocks)
        note = f"{shown(name)} is read as hours, minutes and seconds"
        return "clock", replace(timing, notes=(note, *timing.notes))
    values = np.empty(len(cells))
    for row, text in enumerate(cells):
        number = _number(text)
        if number is None or not np.isfinite(number):
            raise BadTimecode(row, text)
        values[row] = number
    if counts_steps(name) and np.all(values[1:] > 0):
        values = np.cumsum(values)
    unit = _NUMBER.fullmatch(cells[0])
    return number_times(values, f"{name} {unit[2]}" if unit else name)


_READERS: dict[str, Callable[[Sequence[str], str], tuple[str, Timing]]] = {
    "timecode": lambda cells, name: ("timecode", derive_timing(cells)),
    "clock": lambda cells, name: ("clock", clock_times(cells)),
    "number": _read_numbers,
    "date": _read_dates,
    "digits": lambda cells, name: _read_dates(dates_of(cells) or cells, name),
    "local": _read_local,
    "numbered": _read_numbered,
}
