"""Notice that a table goes on with the rows of a second take.

A timecode may jump back within a take, where a recorder was reset: its rows follow one another.
A second take is known by times that begin again as the first ones did, or by a header within the
table, after which the times do not go on. A header alone may also stand on each page of a print.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from faceedit_app.core.arrays import Times
from faceedit_app.core.errors import FileError
from faceedit_app.formats.csv_table import Table
from faceedit_app.formats.files import BOM, shown
from faceedit_app.formats.timecode import parse_timecodes
from faceedit_app.formats.timecode_readings import BASES
from faceedit_app.formats.timing import Timing

_ALIKE = 8  # rows that begin like the first ones
_PAUSE = 10.0  # seconds; after a header, a longer one is no lost face
_HOUR = 3600.0
_REMEDY = "move its rows to a file of their own"


def begun_again(table: Table, cells: Sequence[str], row: int, lines: Sequence[int]) -> FileError:
    """The error about a row whose time is the first row's.

    Args:
        cells: (T) the texts of the times.
        lines: (T) indices of the rows' lines.
    """
    problem = f"the times begin again at {shown(cells[row])}: a second take follows"
    return table.error(problem, _REMEDY, lines[row])


def after_header(table: Table, lines: Sequence[int]) -> list[int]:
    """The rows before which the header is repeated."""
    if table.header < 0:
        return []
    head = table.lines[table.header].removeprefix(BOM).rstrip()
    begin = table.header + 1
    headers = [k for k, line in enumerate(table.lines[begin:], begin) if line.rstrip() == head]
    rows = sorted(set(np.searchsorted(lines, headers).tolist()))
    return [row for row in rows if 0 < row < len(lines)]


def not_gone_on(table: Table, cells: Sequence[str], row: int, lines: Sequence[int]) -> FileError:
    """The error about a row that comes after a header, but not after the row before it."""
    if cells[row] == cells[0]:
        return begun_again(table, cells, row, lines)
    times = f"do not go on from {shown(cells[row - 1])} to {shown(cells[row])}"
    problem = f"the header is repeated, and the times {times}: a second take follows"
    return table.error(problem, _REMEDY, lines[row])


def check_one_take(
    table: Table, cells: Sequence[str], lines: Sequence[int], kind: str, timing: Timing
) -> None:
    """Check that no second take follows the first one, if their times can be read as one take's.

    Args:
        cells: (T) the texts of the times.
        lines: (T) indices of the rows' lines.
        kind: `time_columns.RowTimes.kind`.
        timing: what was made of the times.

    Raises:
        FileError: one does; the message names its first line.
    """
    again = _again(cells) if kind == "timecode" else []
    if again:
        raise begun_again(table, cells, again[0], lines)
    rows = after_header(table, lines)
    if not rows:
        return
    steps: Times = np.diff(timing.times)
    clock = np.diff(parse_timecodes(cells).clock) if kind == "timecode" else steps
    for row in rows:
        missing = steps[row - 1] - (lines[row] - lines[row - 1]) / timing.rate
        if missing > _PAUSE or not 0 <= clock[row - 1] < _HOUR:
            raise not_gone_on(table, cells, row, lines)


def check_numbers(table: Table, cells: Sequence[str], lines: Sequence[int]) -> None:
    """As `check_one_take`, for numbers of frames that do not run forward.

    Numbers that begin again each second are of one take.
    """
    again = _again(cells)
    if again and (len(again) == 1 or again[0] not in BASES):
        raise begun_again(table, cells, again[0], lines)


def _again(cells: Sequence[str]) -> list[int]:
    """The rows from which on the texts are those of the first rows."""
    found = []
    for row in range(1, len(cells)):
        if cells[row] == cells[0] != cells[row - 1]:
            count = min(_ALIKE, row, len(cells) - row)
            if count > 1 and list(cells[row : row + count]) == list(cells[:count]):
                found.append(row)
    return found
