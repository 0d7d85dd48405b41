"""Dates and clock times with digits alone (`20240305142258500`), or with zeros left out."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import datetime

import numpy as np

_DATE = re.compile(
    r"((?:19[7-9]|20\d)\d)(\d\d)(\d\d)[T _-]?([01]\d|2[0-3])([0-5]\d)([0-5]\d)[._-]?(\d{0,9})",
    re.ASCII,
)
# A point, or milliseconds or finer without one; the hour may lack its zero.
_CLOCK = re.compile(r"(\d|[01]\d|2[0-3])([0-5]\d)([0-5]\d)(?:\.(\d{1,9})|(\d{3}|\d{6}|\d{9}))")
_FRACTION = re.compile(r"(.*\d[.,])(0|[1-9]\d{0,8})(\D*|[+-]\d\d:?\d\d)", re.ASCII)
_PARTS = {3: "milliseconds", 6: "microseconds", 9: "nanoseconds"}  # by their digits
_LONGEST_STEP = 30.0  # seconds; less than the 40 that such digits jump by from 59 to 00


def dates_of(cells: Sequence[str]) -> list[str] | None:
    """The dates that T texts of digits are, in ISO 8601; None if one is no date since 1970."""
    found = []
    for text in cells:
        match = _DATE.fullmatch(text)
        if match is None:
            return None
        year, month, day, hour, minute, second, part = match.groups()
        date = f"{year}-{month}-{day}T{hour}:{minute}:{second}.{part or 0}"
        try:
            datetime.fromisoformat(date)
        except ValueError:
            return None
        found.append(date)
    return found


def clocks_of(cells: Sequence[str]) -> list[str] | None:
    """The clock times that T texts of digits (`142258.500`, `142258500`) are; None if not.

    Within a minute, they are numbers as well as clock times. So they are clock times only if all of
    them can be, and if the numbers jump from 59 s to 00 s where the clock does not.
    """
    found, seconds, minutes = [], [], set()
    for text in cells:
        match = _CLOCK.fullmatch(text)
        if match is None:
            return None
        hour, minute, second, part, rest = match.groups()
        found.append(f"{hour}:{minute}:{second}.{part or rest}")
        minutes.add(60 * int(hour) + int(minute))
        seconds.append(
            60 * (60 * int(hour) + int(minute)) + int(second) + float(f"0.{part or rest}")
        )
    steps = np.diff(np.array(seconds))
    runs_on = bool(np.all((steps >= 0) & (steps < _LONGEST_STEP)))
    return found if len(minutes) > 1 and runs_on else None


def with_zeros(cells: Sequence[str]) -> tuple[list[str], str] | None:
    """T texts with the zeros that a program left out after the point, and what they count.

    It wrote 80 and 120 milliseconds as `.80` and `.120`. None if the texts cannot be such.
    """
    matches = [_FRACTION.fullmatch(text) for text in cells]
    found = [match for match in matches if match]
    widths = {len(match[2]) for match in found}
    if len(found) < len(cells) or len(widths) < 2 or max(widths) not in _PARTS:
        return None
    most = max(widths)
    return [f"{match[1]}{match[2]:0>{most}}{match[3]}" for match in found], _PARTS[most]
