"""Notice that a table or a list of frames holds several faces, and choose one of them.

A column tells the faces apart: by its name, or because its few labels differ within each time.
Without one, each time still comes several times, and the values jump between the faces and go on
from each time to the next. Times also come twice where a timecode counts fewer frames than there
are; there, each row goes on from the one before it.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles
from faceedit_app.formats.csv_table import Table, TableRows, plain_text
from faceedit_app.formats.files import shown
from faceedit_app.formats.lost_faces import letters
from faceedit_app.formats.numbers import is_number
from faceedit_app.formats.time_columns import time_columns
from faceedit_app.formats.weights import scale_of

REMEDY = 'keep the rows of one face, or number the faces in a column "face_id"'
# Names that surely mean faces, and those that mean them if labels differ within each time.
_SURE = ("faceid", "faceindex", "faceidx", "facenumber", "face", "person", "personid", "subjectid")
_LIKELY = (
    *("id", "name", "subject", "subjectname", "facename", "personname", "personindex", "people"),
    *("track", "trackid", "trackingid", "tracker", "trackerid", "target", "targetid", "instance"),
    *("actor", "actorid", "actorname", "performer", "performerid", "character", "charactername"),
    *("user", "userid", "username", "player", "playerid", "speaker", "speakerid", "participant"),
    *("head", "headid", "identity", "personidentity", "bodyid", "source", "device", "devicename"),
)
_MOST_FACES = 8  # at one time; a clock that counts seconds has more rows in each
_ROWS_A_FACE = 4  # at least, on average: what has more labels numbers something else
_SHARE = 0.9  # of the times with several rows
_FEWEST = 5  # times that several faces follow
_SAMPLE = 500  # times that are compared
_FARTHER = 2.0  # how much farther faces are from one another than from themselves
_APART = 0.02  # full blendshapes by which faces differ at least
_SWITCHES = ("true", "false", "yes", "no")


@dataclass(frozen=True)
class _Rows:
    """The rows of a table that are as long as is needed.

    Attributes:
        table: the table.
        cells: their cells.
        moments: per column of times, their texts.
    """

    table: Table
    cells: Sequence[Sequence[bytes]]
    moments: Sequence[Sequence[str]]

    @classmethod
    def of(cls, table: Table, clocks: Sequence[int]) -> _Rows:
        width = len(table.names)
        cells = [row for _, row in table.rows() if len(row) >= width]
        return cls(table, cells, [[plain_text(row[k]) for row in cells] for k in clocks])

    def labels(self, column: int) -> list[str]:
        """The texts in a column."""
        return [plain_text(row[column]) for row in self.cells]


def named_face(table: Table) -> tuple[Table, tuple[str, ...]]:
    """The table without the rows of other faces than the first, with a note about them.

    Its column is known by its name. A tracker may also number a face that it has found again; then
    no time comes twice, and the numbers do not alternate.
    """
    clocks = clock_columns(table.names)[:1]
    for column, name in enumerate(table.names):
        is_sure = names_faces(name)
        if column in clocks or not (is_sure or letters(name) in _LIKELY):
            continue
        needed = max([column, *clocks])
        rows = [cells for _, cells in table.rows() if len(cells) > needed]
        labels = [plain_text(cells[column]) for cells in rows]
        repeats = bool(clocks) and len({cells[clocks[0]] for cells in rows}) < len(rows)
        if take_turns(labels) or (is_sure and repeats and _are_few(labels)):
            return _with_face(table, column, labels)
    return table, ()


def face_in_lines(
    table: Table, clocks: Sequence[int], lines: Sequence[int]
) -> tuple[Table, tuple[str, ...]]:
    """As `named_face` and `likely_face`, for a table with a line for each weight.

    Args:
        clocks: columns with times.
        lines: (R) the indices of the lines of one channel. They are rows as in other tables.
    """
    head = table.lines[table.header]
    rows = replace(table, header=0, lines=(head, *(table.lines[line] for line in lines)))
    one, notes = named_face(rows)
    if one.face is None:
        cells = [table.cells(line) for line in lines]
        texts = [tuple(table.text(row[k]) for k in clocks) for row in cells]
        others = [k for k in range(len(table.names)) if k not in clocks]
        found = TableRows(texts, np.zeros(len(lines), bool), np.empty((len(lines), 0)), [*lines])
        one, notes = likely_face(rows, clocks, others, found)
    return replace(table, face=one.face), notes


def check_each_once(table: Table, moments: Sequence[str], rows: TableRows) -> None:
    """Refuse a table that has each row several times, with the same time and the same weights.

    Args:
        moments: (T) the times of the frames.
    """
    values, repeats = rows.numbers, [one == other for one, other in pairwise(moments)]
    starts = np.flatnonzero([True, *(not same for same in repeats)])
    sizes = np.diff(np.append(starts, len(moments)))
    if len(starts) < _FEWEST or sizes[0] < 2 or np.ptp(sizes) or not np.ptp(values, axis=0).any():
        return
    if np.array_equal(values, values[np.repeat(starts, sizes)], equal_nan=True):
        often = "twice" if sizes[0] == 2 else f"{sizes[0]} times"
        problem = f"has each row {often}, with the same time and weights"
        raise table.error(problem, "keep one of each", rows.lines[1])


def take_turns(labels: Sequence[str]) -> bool:
    """Whether a few labels alternate from row to row."""
    changes = sum(one != other for one, other in pairwise(labels))
    return _are_few(labels) and 2 * changes >= len(labels)


def likely_face(
    table: Table, clocks: Sequence[int], others: Sequence[int], rows: TableRows
) -> tuple[Table, tuple[str, ...]]:
    """As `named_face`, by what is in a table that has been read.

    Args:
        clocks: columns with times; their texts are the first in `rows.texts`.
        others: columns that may tell faces apart.

    Raises:
        FileError: each time comes several times, for several faces, and no column says whose.
    """
    moments = [[texts[k] for texts in rows.texts] for k in range(len(clocks))]
    repeating = [k for k, found in enumerate(moments) if len(set(found)) < len(found)]
    if not repeating:
        return table, ()
    frames = np.flatnonzero(~rows.lost).tolist()
    jumping = [k for k in repeating if faces_in([moments[k][n] for n in frames], rows.numbers)]
    kept = _Rows.of(table, [clocks[k] for k in repeating])
    for column in others:
        labels = kept.labels(column)
        if (jumping or _may_be_faces(table.names[column], labels)) and any(
            _tell_apart(labels, found) for found in kept.moments
        ):
            return _with_face(table, column, labels)
    if not jumping:
        return table, ()
    texts = [moments[jumping[0]][n] for n in frames]
    row = next(k for k in range(1, len(texts)) if texts[k] == texts[k - 1])
    count = faces_in(texts, rows.numbers)
    problem = f"the time {shown(texts[row])} comes again, as each does, for one of {count} faces"
    raise table.error(problem, REMEDY, rows.lines[row])


def faces_in(moments: Sequence[Hashable], values: Doubles) -> int:
    """How many faces take turns in rows whose times come several times; 0 if one goes on.

    Args:
        moments: (T) the times.
        values: (T, K) the weights, finite or NaN.
    """
    if len(moments) < 2 * _FEWEST or not values.size:
        return 0
    same = np.array([one == other for one, other in pairwise(moments)])
    starts = np.flatnonzero(np.concatenate([[True], ~same]))
    sizes = np.diff(np.append(starts, len(moments)))
    several = sizes[(sizes > 1) & (sizes <= _MOST_FACES)]
    if 2 * len(several) < len(sizes):
        return 0
    count = int(np.bincount(several).argmax())
    alike: Bools = sizes == count
    pairs = np.flatnonzero(alike[1:] & alike[:-1])
    if len(pairs) < _FEWEST:
        return 0
    pairs = pairs[:: len(pairs) // _SAMPLE + 1]
    turn = np.arange(count)
    now, then = (values[starts[some][:, None] + turn] for some in (pairs, pairs + 1))
    apart = np.nan_to_num(np.abs(np.diff(now, axis=1)))
    # A tracker may list its faces in another order the next time.
    moved = [
        np.nan_to_num(np.abs(np.roll(then, shift, axis=1) - now)).mean(axis=(1, 2))
        for shift in range(count)
    ]
    farther = float(apart.mean()) > _FARTHER * float(np.min(moved, axis=0).mean())
    differ = float(np.median(apart.max(axis=(1, 2)))) > _APART * scale_of(values)
    return count if farther and differ else 0


def _with_face(table: Table, column: int, labels: Sequence[str]) -> tuple[Table, tuple[str, ...]]:
    """The table with only the rows of the first face, and the note."""
    name, first = shown(table.names[column]), next(filter(None, labels), "")
    note = f"has rows of {len(set(labels))} faces: those with {shown(first)} as {name} are read"
    return replace(table, face=(column, first)), (note,)


def clock_columns(names: Sequence[str]) -> list[int]:
    """Columns that may hold times, the most reliable first; not `face_index`, which has faces."""
    return [k for k in time_columns(names) if not names_faces(names[k])]


def names_faces(name: str) -> bool:
    """Whether a name surely means the number of a face."""
    return letters(name) in _SURE


def _are_few(labels: Sequence[str]) -> bool:
    """Whether labels are several, but not so many that they number something else."""
    return 2 <= len(set(labels)) <= max(2, len(labels) // _ROWS_A_FACE)


def _may_be_faces(name: str, labels: Sequence[str]) -> bool:
    """Whether a column holds faces by its name, or names by its texts."""
    if letters(name) in _LIKELY:
        return True
    found = {label.lower() for label in labels}
    return found.isdisjoint(("", *_SWITCHES)) and not any(map(is_number, found))


def _tell_apart(labels: Sequence[str], moments: Sequence[str]) -> bool:
    """Whether labels differ within each time that comes several times."""
    if not _are_few(labels):
        return False
    groups: dict[str, list[str]] = {}
    for label, moment in zip(labels, moments, strict=True):
        groups.setdefault(moment, []).append(label)
    several = [group for group in groups.values() if len(group) > 1]
    apart = sum(len(set(group)) == len(group) for group in several)
    return bool(several) and apart >= _SHARE * len(several)
