"""CSV with ARKit channels, with any time columns, spelling of names and scale."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from faceedit_app.core.arkit import ROTATION_INDEX
from faceedit_app.core.arrays import Floats, Times
from faceedit_app.core.clip import Clip
from faceedit_app.core.errors import FileError
from faceedit_app.core.names import naming_of
from faceedit_app.formats.csv_source import Columns, CsvSource, find_channels
from faceedit_app.formats.csv_table import Table, TableRows, first_rows, read_table
from faceedit_app.formats.csv_turns import turned_in
from faceedit_app.formats.faceless import lost_places, told_times
from faceedit_app.formats.files import LONGEST_NAME, shown
from faceedit_app.formats.json_text import looks_like_json
from faceedit_app.formats.lost_faces import (
    CONFIDENCE,
    confidence_cells,
    confidence_of,
    count_without_footer,
    flag_column,
    is_count,
    letters,
)
from faceedit_app.formats.name_notes import empty_notes, nameless_notes, own_name_notes
from faceedit_app.formats.numbers import is_number
from faceedit_app.formats.rates import nominal_rate
from faceedit_app.formats.rotations import Turned, found_rotations
from faceedit_app.formats.several_faces import (
    check_each_once,
    clock_columns,
    likely_face,
    named_face,
)
from faceedit_app.formats.stated_rate import rate_column, rate_in_table, settled
from faceedit_app.formats.table_ends import percent_before, without_nameless_end
from faceedit_app.formats.take import LostRows, Recording, Take, finish_take
from faceedit_app.formats.time_columns import RowTimes, read_times
from faceedit_app.formats.time_names import counts_steps
from faceedit_app.formats.timecode import is_timecode
from faceedit_app.formats.timecode_readings import OWN_BASE_NOTES
from faceedit_app.formats.timing import NoTimes, of_pictures
from faceedit_app.formats.weights import PERCENT

_TICKS = (1e3, 1e6, 1e7, 1e9)  # of a second, in units that files use
_ROUNDED = 0.02  # relative error of a few of them
_FEWEST_TIMES = 8  # that run forward in a column whose name does not say that it has times
_PERCENT = re.compile(r"[\[(]?(?:%|percent|pct|0\s*(?:-|\.\.|to)\s*100)[\])]?", re.IGNORECASE)
_NAMES = {
    "timecode": "CSV with timecodes",
    "clock": "CSV with times",
    "date": "CSV with times",
    "number": "CSV with times",
    "seconds": "CSV with times in seconds",
    "frames": "CSV with frame numbers",
    "": "CSV without times",
}


def sniff(content: bytes) -> float:
    """How likely, 0..1, this is a CSV file with ARKit channels."""
    if looks_like_json(content) or content.startswith(b"#usda"):
        return 0.0
    names = first_rows(content)[0]
    return 0.5 if any(map(naming_of(names), names)) else 0.0


def read(path: Path, content: bytes, fps: float | None) -> Take:
    """Open a CSV with ARKit channels.

    Raises:
        RateNeeded: its times are unusable, and `fps` is None.
        FileError: it has no channels, or is damaged.
    """
    return csv_take(read_table(path, content), fps)


def write(clip: Clip) -> bytes:
    """A clip as a plain CSV: seconds in `time_s`, its channels under ARKit's names.

    Rotations, in radians, and confidence follow if it has them.
    """
    names, values = clip.channels, clip.weights
    if clip.rotations is not None:
        turns = clip.rotations[:, [ROTATION_INDEX[name] for name in clip.rotation_names]]
        names, values = (*names, *clip.rotation_names), np.concatenate([values, turns], axis=1)
    lines = [",".join(["time_s", *names])]
    for time, row in zip(clip.times.tolist(), values.tolist(), strict=True):
        lines.append(",".join([f"{time:.6f}", *(f"{value:.6f}" for value in row)]))
    if clip.confidence is not None:
        sure = [CONFIDENCE, *confidence_cells(clip.confidence)]
        lines = [f"{line},{cell}" for line, cell in zip(lines, sure, strict=True)]
    return ("\n".join(lines) + "\n").encode()


@dataclass(frozen=True)
class _Places:
    """Where a table has the columns that are no channels; None, or nothing, if it has none.

    Attributes:
        clocks: columns of times.
        first: the first column, if its name says nothing.
        turns: those of rotations, by `arkit.ROTATIONS`' names, in that order.
        flag: what says whether a row has a face.
        said: `flag`, if it is the number of blendshapes.
        confidence: how sure the tracker was.
        rate: the frame rate.
    """

    clocks: list[int]
    first: int | None
    turns: dict[str, int]
    flag: int | None
    said: int | None
    confidence: int | None
    rate: int | None

    @classmethod
    def of(cls, table: Table, channels: Columns) -> _Places:
        """Find them by their names."""
        lower = [column.lower() for column in table.names]
        bare = [letters(name) for name in lower]
        flag = flag_column(table.names)
        turns = found_rotations(table.names)
        clocks = [k for k in clock_columns(table.names) if k not in channels.indices]
        rate = rate_column(table.names)
        known = {*channels.indices, *clocks, *turns.values(), flag, rate}
        return cls(
            clocks=clocks,
            first=0 if 0 not in known else None,
            turns=turns,
            flag=flag,
            said=flag if flag is not None and is_count(table.names[flag]) else None,
            confidence=bare.index(CONFIDENCE) if CONFIDENCE in bare else None,
            rate=rate,
        )

    @property
    def texts(self) -> list[int]:
        """The columns that are read as texts, in the order in which they are read."""
        last = (self.first, self.rate, self.confidence, self.flag)
        return [*self.clocks, *self.turns.values(), *(place for place in last if place is not None)]

    def others(self, table: Table, channels: Columns) -> list[int]:
        """The columns that are none of these and no channels."""
        known = {*self.clocks, *self.turns.values(), self.rate, self.confidence, self.flag}
        return [k for k in range(len(table.names)) if k not in known and k not in channels.indices]

    def read(self, table: Table, channels: Columns) -> TableRows:
        """The rows of a table, without those at the end that are none."""
        rows = table.read(self.texts, channels.indices, self.flag)
        count = count_without_footer(rows.texts, rows.lost)
        lost = rows.lost[:count]
        lines = rows.lost_lines[: int(lost.sum())]
        return replace(rows, texts=rows.texts[:count], lost=lost, lost_lines=lines)

    def cells(self, rows: TableRows, column: int) -> list[str]:
        """The texts of the frames in one of these columns."""
        place = self.texts.index(column)
        return [rows.texts[row][place] for row in np.flatnonzero(~rows.lost).tolist()]


def csv_take(
    table: Table,
    fps: float | None,
    name: str = "",
    naming: Callable[[str], str | None] | None = None,
) -> Take:
    """Make the take of a table.

    Args:
        fps: the frame rate, if the user gave one.
        name: the format's name; "" = named after the kind of its times.
        naming: the channel that a column's name means, or None; by default ARKit's.

    Raises:
        RateNeeded: its times are unusable, and `fps` is None.
        FileError: it has no channels, or is damaged.
    """
    table = without_nameless_end(table)
    found = find_channels(table, naming or naming_of(table.names))
    table, faces = named_face(table)
    places = _Places.of(table, found)
    rows = places.read(table, found)
    if table.face is None:
        others = places.others(table, found)
        table, faces = likely_face(table, places.clocks, others, rows)
        rows = rows if table.face is None else places.read(table, found)
    empty = np.all(np.isnan(rows.numbers), axis=0)
    columns = found.without(empty.tolist())
    times = _times(table, places, rows)
    used = {times.column, places.said, *columns.indices}
    carried = {k: name for k, name in enumerate(table.names) if k not in used}
    frames = np.flatnonzero(~rows.lost)
    timing = times.timing
    if places.confidence is not None and times.kind in ("timecode", "seconds"):  # tracked in a film
        timing = of_pictures(timing, frames, OWN_BASE_NOTES)
    stated = rate_in_table(table, partial(places.cells, rows))
    scale, scale_notes = _scale(table, columns, rows)
    turned = _rotations(table, places, rows)
    recording = Recording(
        path=table.path,
        format=name or _NAMES[times.kind],
        channels=columns.channels,
        values=rows.numbers[:, ~empty],
        timing=settled(timing, stated, frames, times.kind == "timecode"),
        lost=rows.lost,
        told=_told(table, places, rows, times),
        timecodes=_timecodes(places, rows, times),
        carried=tuple(shown(name, LONGEST_NAME) or "(unnamed)" for name in carried.values()),
        own=tuple(table.names[k] for k in columns.indices),
        unread=faces,
        notes=(
            *(() if naming else own_name_notes(table.names[found.indices[0]], found.channels[0])),
            *empty_notes(found.channels, columns.channels),
            *nameless_notes(table, rows, [k for k, name in carried.items() if not name]),
            *scale_notes,
            *turned.notes,
            *_count_notes(table, places, rows),
        ),
        rotations=turned.rotations,
        rotation_names=tuple(places.turns),
        confidence=_confidence(places, rows),
        scale=scale,
    )
    source = partial(_source(table, columns, places, rows, times), degrees=turned.degrees)
    take = finish_take(recording, fps, source, lambda frame, _: rows.lines[frame] + 1)
    lost = _lost_rows(places, rows, times, recording.told)
    return replace(take, lost_rows=lost) if lost.positions else take


def _source(
    table: Table, columns: Columns, places: _Places, rows: TableRows, times: RowTimes
) -> Callable[..., CsvSource]:
    """What writes the table again, once scale and rotations are known."""
    steps = times.column is not None and counts_steps(table.names[times.column])
    return partial(
        CsvSource,
        table,
        tuple(rows.lines),
        columns.indices,
        turns=places.turns,
        lost=rows.lost_lines,
        flag=places.flag,
        confidence=places.confidence,
        seconds=times.column if times.kind == "seconds" and not steps else None,
        clock=times.column if times.kind == "timecode" else None,
        ticks=_ticks(places, rows, times),
    )


def _lost_rows(places: _Places, rows: TableRows, times: RowTimes, told: Times | None) -> LostRows:
    """The rows without a face that lie between frames."""
    where, last = lost_places(rows.lost, told), len(rows.lines) - 1
    between = (where > 0) & (where < last)
    positions = tuple(where[between].tolist())
    if times.kind != "timecode" or times.column is None:
        return LostRows(positions)
    column = places.texts.index(times.column)
    there = np.flatnonzero(rows.lost)[between].tolist()
    texts = (rows.texts[row][column] for row in there)
    return LostRows(positions, tuple(text if is_timecode(text) else "" for text in texts))


def _told(table: Table, places: _Places, rows: TableRows, times: RowTimes) -> Times | None:
    """(R,) seconds of all rows on a clock of their own, if some of them have no face."""
    if times.column is None or times.part is not None or not rows.lost.any():
        return None
    place = places.texts.index(times.column)
    return told_times([texts[place] for texts in rows.texts], table.names[times.column])


def _times(table: Table, places: _Places, rows: TableRows) -> RowTimes:
    if rows.lost.all():
        return RowTimes(NoTimes("has no row with a tracked face"))
    cells = [places.cells(rows, column) for column in places.clocks]
    found = read_times(table, places.clocks, cells, rows.lines)
    if isinstance(found.timing, NoTimes):
        for moments in cells:
            check_each_once(table, moments, rows)
    if places.first is None or not isinstance(found.timing, NoTimes) or found.kind == "frames":
        return found
    return _guessed_times(table, places.first, places.cells(rows, places.first), rows) or found


def _guessed_times(table: Table, column: int, cells: list[str], rows: TableRows) -> RowTimes | None:
    """The times in a column of any name, if it runs forward in every row."""
    try:
        found = read_times(table, [column], [cells], rows.lines)
    except FileError:
        return None
    timing = found.timing
    if len(set(cells)) < max(len(cells), _FEWEST_TIMES):
        return None
    if isinstance(timing, NoTimes):
        return found if found.kind == "frames" else None
    if found.kind == "number" and nominal_rate(timing.rate, 0.0) is None:
        return None  # a unit that no name and no rate confirm
    note = f'the first column, "{shown(table.names[column])}", is read as times'
    return replace(found, timing=replace(timing, notes=(note, *timing.notes)))


def _says_percent(table: Table, columns: Columns, rows: TableRows) -> bool:
    """Whether the names of the channels, or a row of units, say that the weights are percent."""
    said = [unit for k in columns.indices if (unit := rows.units.get(k))]
    if not said:  # the end of each name
        said = [re.split(r"[\s_]+|(?=[\[(])", table.names[k])[-1] for k in columns.indices]
    return bool(said) and all(map(_PERCENT.fullmatch, said))


def _scale(table: Table, columns: Columns, rows: TableRows) -> tuple[float | None, tuple[str, ...]]:
    """The value of a full blendshape if the file says it, and a note if it cannot be right."""
    if table.percent:
        return PERCENT, ()
    commented = percent_before(table)
    if not commented and not _says_percent(table, columns, rows):
        return None, ()
    if np.nanmax(np.abs(rows.numbers), initial=0.0) > 1:
        return PERCENT, ()
    said = "a line before the header says" if commented else "the names say"
    return None, (f"{said} percent, but the weights run from 0 to 1: read as such",)


def _timecodes(places: _Places, rows: TableRows, times: RowTimes) -> tuple[str, ...] | None:
    if times.kind != "timecode" or times.column is None:
        return None
    return tuple(places.cells(rows, times.column))


def _ticks(places: _Places, rows: TableRows, times: RowTimes) -> tuple[int, float] | None:
    """The column of times in another unit, and how many of these make a second."""
    if times.kind != "number" or times.column is None or isinstance(times.timing, NoTimes):
        return None
    cells = places.cells(rows, times.column)
    if not is_number(cells[0]) or not is_number(cells[-1]):  # with a unit
        return None
    measured = (float(cells[-1]) - float(cells[0])) / float(times.timing.times[-1])
    fits = (ticks for ticks in _TICKS if abs(measured / ticks - 1) < _ROUNDED)
    ticks = next(fits, None)
    return None if ticks is None else (times.column, ticks)


def _rotations(table: Table, places: _Places, rows: TableRows) -> Turned:
    cells = [places.cells(rows, column) for column in places.turns.values()]
    return turned_in(table, places.turns, cells, rows)


def _confidence(places: _Places, rows: TableRows) -> Floats | None:
    """(T,) how sure the tracker was; None if the column holds other than numbers from 0 to 1."""
    if places.confidence is None:
        return None
    try:
        cells = places.cells(rows, places.confidence)
        found = np.array([float(cell or 0) for cell in cells], np.float64)
    except ValueError:
        return None
    return confidence_of(found)


def _count_notes(table: Table, places: _Places, rows: TableRows) -> tuple[str, ...]:
    if places.said is None:
        return ()
    # The tracker's confidence stands after what is counted.
    values = len(table.names) - 2 - (table.names[-1].lower() == CONFIDENCE)
    values -= table.face is not None and table.face[0] < places.said  # nor is whose they are
    said = {text.removesuffix(".0") for text in places.cells(rows, places.said)}
    wrong = [shown(text) for text in sorted(said - {str(values)})]
    if not wrong:
        return ()
    return (
        f"{table.names[places.said]} says {', '.join(wrong[:3])}, the header has {values} values",
    )
