"""Dates and clock times that are written as digits alone, such as `20240305142258500`."""

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
