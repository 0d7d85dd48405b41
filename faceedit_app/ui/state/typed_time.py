"""From a typed time to the frame or the moment it means."""

from __future__ import annotations

import re
from functools import lru_cache

from faceedit_app.core.clip import Clip
from faceedit_app.formats.timecode import derive_base, parse_timecodes, time_of_day
from faceedit_app.formats.timing import format_time
from faceedit_app.ui.state.time_display import Unit, whole_timecode

_DAY = 24 * 3600.0
_SECONDS = re.compile(r"(?:(?:(\d+):)?(\d+):)?(\d+(?:[.,]\d*)?|[.,]\d+)\s*s?", re.ASCII)
_APART = re.compile(r"\s*[–—-]\s*|\s+to\s+|\s+(?!s\b)")  # between two times
_FRAME = re.compile(r"(?:frame\s*)?(\d+)", re.ASCII | re.IGNORECASE)


def typed_frame(clip: Clip, text: str, unit: Unit, now: int) -> int:
    """The frame that a text means; see `typed_moment`."""
    return clip.frame_at(typed_moment(clip, text, unit, now))


def typed_moment(clip: Clip, text: str, unit: Unit, now: int) -> float:
    """The seconds that a text means, in the unit in which times are shown.

    They need not be those of a frame: in a gap, a filled one may be nearer than any of the clip.

    Args:
        clip: the open take.
        text: what was typed; it may contain what is shown after the time, such as the length.
        unit: how to read it. A take without timecode uses seconds instead.
        now: the playhead's frame; a timecode may leave out the hours and minutes it shares.

    Raises:
        ValueError: what is wrong with the text, in one line for the user.
    """
    text = text.partition("/")[0].strip()
    if unit is Unit.FRAMES:
        return float(clip.times[_by_number(clip, text)])
    if unit is Unit.TIMECODE and clip.timecodes:
        return _by_timecode(clip, clip.timecodes, text, now)
    return _at(clip, typed_seconds(text), f"The take ends at {format_time(clip.duration)}")


def typed_range(clip: Clip, text: str, unit: Unit, now: int) -> tuple[float, float]:
    """The seconds that a text such as `1.2 – 3` means; one time means this moment.

    Seconds and frame numbers beyond the take mean its ends. Of two timecodes, the second may leave
    out what it shares with the first.

    Args:
        clip, unit, now: as for `typed_frame`.

    Raises:
        ValueError: what is wrong with the text, in one line for the user.
    """
    parts = [part for part in _APART.split(text.strip().removeprefix("frames ")) if part]
    if not 1 <= len(parts) <= 2:
        raise ValueError("Type a start and an end, such as 1.2 – 3")
    times: list[float] = []
    for part in parts:
        if unit is Unit.SECONDS or (unit is Unit.TIMECODE and not clip.timecodes):
            times.append(min(typed_seconds(part), clip.duration))
            continue
        if unit is Unit.FRAMES and part.isdecimal():
            part = str(min(max(int(part), 1), len(clip)))
        now = typed_frame(clip, part, unit, now)
        times.append(float(clip.times[now]))
    return min(times), max(times)


def _by_number(clip: Clip, text: str) -> int:
    match = _FRAME.fullmatch(text)
    if match is None:
        raise ValueError(f"Type a frame number, 1 to {len(clip)}")
    number = int(match[1])
    if not 1 <= number <= len(clip):
        raise ValueError(f"The take has frames 1 to {len(clip)}")
    return number - 1


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


def _by_timecode(clip: Clip, timecodes: tuple[str, ...], text: str, now: int) -> float:
    base, at = _base(timecodes), timecodes[now]
    typed, there = re.split("[:;]", text), re.split("[:;]", at)
    drop = ";" if ";" in at else ":"
    # "12:05" is the second and the frame: the rest is as at the playhead.
    whole = there[: max(4 - len(typed), 0)] + typed if 2 <= len(typed) <= 4 else []
    begins = time_of_day(timecodes[0], base)
    meant = time_of_day(":".join(whole[:3]) + drop + whole[3], base) if whole else None
    if meant is None or begins is None:
        raise ValueError(f"Type a timecode, such as {whole_timecode(at)}")
    if text in timecodes:
        return float(clip.times[timecodes.index(text)])
    seconds = meant - begins
    if seconds < -_DAY / 2:  # past midnight
        seconds += _DAY
    ends = f"{whole_timecode(timecodes[0])} to {whole_timecode(timecodes[-1])}"
    frame = clip.frame_at(_at(clip, seconds, f"The take has timecodes {ends}"))
    # What is shown leaves out thousandths of a frame, which may be almost a whole one.
    # Where several frames share what is shown, as with more of them than the timecode counts, the
    # one at the playhead stays.
    around = now, *range(max(frame - 1, 0), min(frame + 2, len(clip)))
    same = _fields(":".join(whole))
    return next((float(clip.times[f]) for f in around if _fields(timecodes[f]) == same), seconds)


@lru_cache(maxsize=1)  # each key that is typed asks again, and an hour has 200,000 timecodes
def _base(timecodes: tuple[str, ...]) -> int:
    return derive_base(parse_timecodes(timecodes))[0]


def _fields(timecode: str) -> list[int]:
    """Hours, minutes, seconds and frame."""
    return [int(field) for field in re.split("[:;]", whole_timecode(timecode))]


def _at(clip: Clip, seconds: float, otherwise: str) -> float:
    """The seconds, if the take has them; else a ValueError that says what it has."""
    # A timecode without its thousandths may lie before the first frame that has it.
    slack = 1.0 / clip.rate
    if not -slack <= seconds <= clip.duration + slack:
        raise ValueError(otherwise)
    return seconds
