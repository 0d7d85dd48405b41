"""CSV without timecodes: times in seconds, or frame numbers, beside ARKit names.

Our own clips and NVIDIA Audio2Face give seconds. Speech-to-face tools that imitate Live Link Face
number their frames instead (`0.0`, `1.0`, ...), under the heading "Timecode", and leave the rate
to be known.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from faceedit_app.core.arrays import Times
from faceedit_app.core.clip import Clip
from faceedit_app.formats.csv_source import CsvSource, find_channels
from faceedit_app.formats.csv_table import Rows, Table, read_table
from faceedit_app.formats.take import Take
from faceedit_app.formats.timing import (
    DEFAULT_RATE,
    find_gaps,
    format_rate,
    gap_notes,
    nominal_rate,
    typical_step,
)

FORMAT = "CSV with times in seconds"
NUMBERED_FORMAT = "CSV with frame numbers"
TIME_NAMES = ("time_s", "seconds", "time", "timecode", "frame")
_NAMES_OF_SECONDS = ("time_s", "seconds")
_SLOWEST, _FASTEST = 1.0, 2000.0  # frames per second; beyond, the times are in another unit


def read_plain_csv(path: Path | str) -> Take:
    """Open a CSV with times in seconds or frame numbers.

    Raises:
        FileError: it is none, or damaged.
    """
    return plain_take(read_table(path))


def plain_take(table: Table) -> Take:
    """The take in a table whose times are plain numbers; see `read_plain_csv`."""
    columns = find_channels(table)
    lower = [name.lower() for name in table.names]
    time = next((lower.index(name) for name in TIME_NAMES if name in lower), None)
    if time is None:
        raise table.error(
            "has no column with times", 'add a column "time_s" in seconds', table.header
        )
    rows = table.read((), (time, *columns.indices))
    seconds, name, note = _in_seconds(rows.numbers[:, 0], table.names[time])
    rate, notes = _rate(table, rows, seconds)
    times = seconds - seconds[0]
    gaps = find_gaps(times, rate)
    clip = Clip(
        weights=rows.numbers[:, 1:].astype(np.float32),
        channels=columns.channels,
        times=times,
        rate=rate,
        gaps=gaps,
    )
    carried = tuple(table.names[k] or "(unnamed)" for k in columns.others if k != time)
    source = CsvSource(table, tuple(rows.lines), columns.indices)
    return Take(table.path, name, clip, carried, (*note, *notes, *gap_notes(gaps)), source)


def _in_seconds(values: Times, column: str) -> tuple[Times, str, tuple[str, ...]]:
    """Times in seconds, the name of the format, and a remark where the rate is a guess."""
    whole = len(values) > 1 and np.array_equal(values, np.round(values))
    one_by_one = whole and float(np.median(np.diff(values))) == 1.0
    if not one_by_one or column.lower() in _NAMES_OF_SECONDS:
        return values, FORMAT, ()
    note = f"{column} counts frames: {format_rate(DEFAULT_RATE)} is assumed"
    return values / DEFAULT_RATE, NUMBERED_FORMAT, (note,)


def _check_increasing(table: Table, rows: Rows) -> None:
    given = rows.numbers[:, 0]
    steps = np.diff(given)
    if steps.min() <= 0:
        row = int(np.argmax(steps <= 0)) + 1
        raise table.error(
            f"the time {given[row]:g} does not come after {given[row - 1]:g}",
            "sort the rows by time and remove repeated ones",
            rows.lines[row],
        )


def _rate(table: Table, rows: Rows, seconds: Times) -> tuple[float, tuple[str, ...]]:
    if len(seconds) == 1:
        return DEFAULT_RATE, (f"a single frame: {format_rate(DEFAULT_RATE)} is assumed",)
    _check_increasing(table, rows)
    steps = np.diff(seconds)
    step = typical_step(steps)
    if not 1 / _FASTEST <= step < 1 / _SLOWEST:
        raise table.error(
            f"times step by {step:g}, which cannot be seconds",
            "give the times in seconds",
            rows.lines[1],
        )
    measured = 1 / step
    rate = nominal_rate(measured, _resolution(seconds) / (step * len(steps)))
    if rate is not None:
        return rate, ()
    return measured, (f"{format_rate(measured)} is not a usual frame rate",)


def _resolution(seconds: Times) -> float:
    """How finely the times are given, in seconds."""
    for decimals in range(9):
        scaled = seconds * 10.0**decimals
        if np.allclose(scaled, np.round(scaled), rtol=0, atol=1e-4):
            return 10.0**-decimals
    return 0.0
