"""From a typed time to the row or the moment it means."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from faceedit_app.core.arrays import Indices, Times
from faceedit_app.formats.timecode import BadTimecode, derive_base, parse_timecodes
from faceedit_app.formats.timing import counted, format_time
from faceedit_app.ui.state.time_display import Unit
from faceedit_app.ui.state.timed_rows import TimedRows, whole_timecode

_DAY = 24 * 3600
_SECONDS = re.compile(r"(?:(?:(\d+):)?(\d+):)?(\d+(?:[.,]\d*)?|[.,]\d+)\s*s?", re.ASCII)
_APART = re.compile(r"\s*[–—-]\s*|\s+to\s+|\s+(?!s\b)")  # between two times
_FRAME = re.compile(r"(?:frame\s*)?(\d+)", re.ASCII | re.IGNORECASE)
_PAST = re.compile(r"(.*?)\s*\+\s*(\d+)", re.ASCII)  # rows without a face, after a frame


def typed_row(rows: TimedRows, text: str, unit: Unit, now: int) -> int:
    """The row that a text means; see `typed_moment`."""
    return rows.at(typed_moment(rows, text, unit, now))


def typed_moment(rows: TimedRows, text: str, unit: Unit, now: int) -> float:
    """The seconds that a text means, in the unit in which times are shown.

    They need not be those of a row.

    Args:
        rows: those of the open take.
        text: what was typed; it may contain what is shown after the time, such as the length.
        unit: how to read it. A take without timecode uses seconds instead.
        now: the playhead's row; a timecode may leave out the hours and minutes it shares.

    Raises:
        ValueError: what is wrong with the text, in one line for the user.
    """
    text = text.partition("/")[0].strip()
    if unit is Unit.SECONDS or (unit is Unit.TIMECODE and rows.timecodes is None):
        ends = f"The take ends at {format_time(rows.clip.duration)}"
        return _at(rows, typed_seconds(text), ends)
    past = _PAST.fullmatch(text)
    text = past[1] if past is not None else text
    if unit is Unit.FRAMES:
        moment = float(rows.clip.times[_by_number(rows, text)])
    else:
        moment = _by_timecode(rows, text, now)
    return moment if past is None else float(rows.times[_past(rows, moment, int(past[2]))])


def typed_range(rows: TimedRows, text: str, unit: Unit, now: int) -> tuple[float, float]:
    """The seconds that a text such as `1.2 – 3` means; one time means this moment.

    Seconds and frame numbers beyond the take mean its ends. Of two timecodes, the second may leave
    out what it shares with the first.

    Args:
        rows, unit, now: as for `typed_moment`.

    Raises:
        ValueError: what is wrong with the text, in one line for the user.
    """
    parts = [part for part in _APART.split(text.strip().removeprefix("frames ")) if part]
    if not 1 <= len(parts) <= 2:
        raise ValueError("Type a start and an end, such as 1.2 – 3")
    times: list[float] = []
    for part in parts:
        if unit is Unit.SECONDS or (unit is Unit.TIMECODE and rows.timecodes is None):
            times.append(min(typed_seconds(part), rows.clip.duration))
            continue
        if unit is Unit.FRAMES and part.isdecimal():
            part = str(min(max(int(part), 1), len(rows.clip)))
        now = typed_row(rows, part, unit, now)
        times.append(float(rows.times[now]))
    return min(times), max(times)


def _by_number(rows: TimedRows, text: str) -> int:
    """The frame of a number."""
    match, count = _FRAME.fullmatch(text), len(rows.clip)
    if match is None:
        raise ValueError(f"Type a frame number, 1 to {count}")
    number = int(match[1])
    if not 1 <= number <= count:
        raise ValueError(f"The take has frames 1 to {count}")
    return number - 1


def _past(rows: TimedRows, seconds: float, count: int) -> int:
    """The row that is `count` rows without a face after the frame at a time."""
    frame = rows.clip.frame_at(seconds)
    first = rows.of_frame(frame)
    there = rows.of_frame(frame + 1) - first - 1
    if count > there:
        what = f"{counted(there, 'row')} without a face" if there else "no row without a face"
        raise ValueError(f"After frame {frame + 1} there {'are' if there > 1 else 'is'} {what}")
    return first + count


def typed_seconds(text: str) -> float:
    """The seconds that a text such as `4.5` or `1:04.5` means.

    Raises:
        ValueError: it means none, in one line for the user.
    """
    match = _SECONDS.fullmatch(text)
    if match is None:
        raise ValueError("Type seconds, such as 4.5, or minutes and seconds, such as 1:04.5")
    hours, minutes = int(match[1] or 0), int(match[2] or 0)
    return 3600 * hours + 60 * minutes + float(match[3].replace(",", "."))


@dataclass(frozen=True, eq=False)
class _Codes:
    """The timecodes of rows, as numbers.

    Attributes:
        rows: (N,) the rows that have one.
        clock: (N,) seconds since midnight of the first day.
        last: (N,) the field after the seconds.
        places: (N,) frames since midnight, if no number is left out.
        base: frames that the timecode counts in a second.
    """

    rows: Indices
    clock: Times
    last: Times
    places: Times
    base: int


@lru_cache(maxsize=1)  # each key that is typed asks again, and an hour has 200,000 timecodes
def _codes(timecodes: tuple[str, ...]) -> _Codes:
    there = [row for row, text in enumerate(timecodes) if text]
    stamps = parse_timecodes([timecodes[row] for row in there])
    base = derive_base(stamps)[0]
    places = stamps.clock * base + stamps.frames
    return _Codes(np.array(there), stamps.clock, stamps.last, places, base)


def _by_timecode(rows: TimedRows, text: str, now: int) -> float:
    timecodes = rows.timecodes
    assert timecodes is not None
    at = timecodes[now] or rows.timecode(now).partition("+")[0]
    typed, there = re.split("[:;]", text), re.split("[:;]", at)
    # "12:05" is the second and the frame: the rest is as at the playhead.
    whole = there[: max(4 - len(typed), 0)] + typed if 2 <= len(typed) <= 4 else []
    try:
        meant = parse_timecodes([":".join(whole)])
    except BadTimecode:
        raise ValueError(f"Type a timecode, such as {whole_timecode(at)}") from None
    if text in timecodes:
        return float(rows.times[timecodes.index(text)])
    codes, clock = _codes(timecodes), float(meant.clock[0])
    if clock < codes.clock[0] - _DAY / 2:  # past midnight
        clock += _DAY
    # What is shown leaves out thousandths of a frame, which may be almost a whole one.
    # Where several rows share what is shown, as with more of them than the timecode counts, the
    # one at the playhead stays.
    same = codes.rows[(codes.clock == clock) & (codes.last == meant.last[0])]
    if len(same):
        return float(rows.times[now if now in same else same[0]])
    seconds = _between(rows, codes, clock * codes.base + float(meant.frames[0]))
    ends = (whole_timecode(timecodes[row]) for row in (0, -1))
    return _at(rows, seconds, f"The take has timecodes {' to '.join(ends)}")


def _between(rows: TimedRows, codes: _Codes, place: float) -> float:
    """The seconds of a timecode that no row has: so many frames after the row before it.

    A number that drop-frame leaves out means the next one that exists.
    """
    order = np.argsort(codes.places, kind="stable")  # they may jump back
    before = int(np.searchsorted(codes.places[order], place)) - 1
    row = int(codes.rows[order[max(before, 0)]])
    seconds = float(rows.times[row]) + (place - codes.places[order[max(before, 0)]]) / codes.base
    after = row + 1
    is_between = before >= 0 and after < len(rows)
    return float(min(seconds, rows.times[after]) if is_between else seconds)


def _at(rows: TimedRows, seconds: float, otherwise: str) -> float:
    """The seconds, if the take has them; else a ValueError that says what it has."""
    # A timecode without its thousandths may lie before the first frame that has it.
    slack = 1.0 / rows.clip.rate
    if not -slack <= seconds <= rows.clip.duration + slack:
        raise ValueError(otherwise)
    return seconds
