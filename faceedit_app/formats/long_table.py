"""CSV with a line for each weight: `time,channel,value`, as data frames and data bases have it.

The columns are found by what is in them: one with the names of channels, one with numbers, and any
with times. All weights with the same times are one frame.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arrays import Bools, Doubles
from faceedit_app.core.names import canonical_channel
from faceedit_app.formats.csv_source import bare
from faceedit_app.formats.csv_table import (
    Cells,
    Table,
    plain_text,
    read_table,
    split_line,
)
from faceedit_app.formats.files import BOM, LONGEST_NAME, REPAIR, shown
from faceedit_app.formats.json_take import Naming
from faceedit_app.formats.json_text import looks_like_json
from faceedit_app.formats.long_form import Key, Repeated, group
from faceedit_app.formats.number_spans import SpanSource
from faceedit_app.formats.numbers import is_number
from faceedit_app.formats.several_faces import clock_columns, face_in_lines
from faceedit_app.formats.stated_rate import rate_in_table, settled
from faceedit_app.formats.table_ends import percent_before, without_nameless_end
from faceedit_app.formats.take import Recording, Take, finish_take
from faceedit_app.formats.time_columns import RowTimes, read_times
from faceedit_app.formats.timing import NoTimes
from faceedit_app.formats.weights import PERCENT

FORMAT = "CSV with a line for each weight"
_HEAD = 1 << 16
_SAMPLE = 200  # lines
_FEWEST_LINES, _MOST = 5, 0.6  # lines of a table, and the share of them that name a channel
_VALUES = {
    *("value", "values", "weight", "weights", "score", "val", "v", "w", "amount", "intensity"),
    *("wert", "valeur", "valor", "valore"),
}
_DELIMITERS = (b",", b";", b"\t", b"|")
_NUMERIC = re.compile(rb'[ "]*[+-]?\.?\d')  # how numbers and times begin
_LETTER = re.compile(rb"[A-Za-z\x80-\xff]")  # also a byte of one that is not ASCII


@dataclass(frozen=True)
class LongLayout:
    """Where a table has what.

    Attributes:
        name: the column with the names of channels.
        value: the column with their weights.
        clocks: columns with times, the most reliable first.
    """

    name: int
    value: int
    clocks: tuple[int, ...]


def sniff(content: bytes) -> float:
    """How likely, 0..1, this is a table with a line for each weight."""
    if looks_like_json(content) or b"\0" in content[:_HEAD]:
        return 0.0
    lines = [line for line in content[:_HEAD].removeprefix(BOM).splitlines() if line.strip()]
    return 0.6 if any(_is_long(lines, delimiter) for delimiter in _DELIMITERS) else 0.0


def _is_long(lines: Sequence[bytes], delimiter: bytes) -> bool:
    """Whether lines have a column of names, each of which comes again, or a column of values."""
    column = _name_column(lines, delimiter)
    if column is None:
        return False
    rows = [split_line(line, delimiter) or [] for line in lines[:_SAMPLE]]
    names = [row[column] for row in rows[1:] if column < len(row)]
    head = {plain_text(cell).lower() for cell in rows[0]}
    return len(set(names)) < len(names) or not head.isdisjoint(_VALUES)


def read(path: Path, content: bytes, fps: float | None) -> Take:
    """Open a table with a line for each weight.

    Raises:
        RateNeeded: its times are unusable, and `fps` is None.
        FileError: it is damaged, or has the weights of two faces.
    """
    return long_take(_with_header(read_table(path, content)), fps)


def _name_column(
    lines: Sequence[bytes], delimiter: bytes, naming: Naming = canonical_channel
) -> int | None:
    """The column in which most lines name a channel."""
    rows = [split_line(line, delimiter) or [] for line in lines[1:_SAMPLE]]
    if len(rows) < _FEWEST_LINES:
        return None
    width = max(map(len, rows))
    if width < 2:
        return None
    columns = ([row[k] for row in rows if k < len(row)] for k in range(min(width, 50)))
    counts = [_count_named(cells, naming) for cells in columns]
    best = int(np.argmax(counts))
    return best if counts[best] >= _MOST * len(rows) else None


def _count_named(cells: Cells, naming: Naming) -> int:
    """How many cells name a channel; most columns are numbers, which is quick to tell."""
    if _LETTER.search(b" ".join(cells)) is None:
        return 0
    return sum(naming(plain_text(cell)) is not None for cell in cells)


def _with_header(table: Table) -> Table:
    """The table with the line before the first weight as its header."""
    delimiter = max(_DELIMITERS, key=lambda one: _name_column(table.lines, one) is not None)
    rows = [
        split_line(line.removeprefix(BOM).rstrip(b"\r\n"), delimiter) or []
        for line in table.lines[:_SAMPLE]
    ]
    names_channel = (any(canonical_channel(plain_text(c)) for c in cells) for cells in rows)
    first = next((line for line, is_named in enumerate(names_channel) if is_named), None)
    if first is None:
        return table
    # Weights with other names, such as MediaPipe's `_neutral`, may come before those of channels.
    while first and any(map(_NUMERIC.match, rows[first - 1])):
        first -= 1
    if first == 0:
        what = "has a line for each weight, and no line with the names of its columns"
        raise table.error(what, 'write one at the top, such as "time,channel,value"', 0)
    names = tuple(map(plain_text, rows[first - 1]))
    return without_nameless_end(replace(table, header=first - 1, names=names, delimiter=delimiter))


def _layout(table: Table, rows: Sequence[Cells], naming: Naming) -> LongLayout:
    name = _name_column(
        [b"", *(table.delimiter.join(row) for row in rows)], table.delimiter, naming
    )
    if name is None:
        raise table.error("holds no ARKit channel such as jawOpen", "choose another take")
    numbers = [k for k in range(len(table.names)) if k != name and _holds_numbers(table, rows, k)]
    called = [k for k in numbers if table.names[k].strip().lower() in _VALUES]
    clocks = [k for k in clock_columns(table.names) if k != name]
    free = called or [k for k in numbers if k not in clocks]
    if not free:
        raise table.error(
            "has a line for each weight, and no column of weights",
            'call the column "value"',
            max(table.header, 0),
        )
    return LongLayout(name, free[-1], tuple(k for k in clocks if k != free[-1]))


def _holds_numbers(table: Table, rows: Sequence[Cells], column: int) -> bool:
    """Whether most cells of a column are numbers."""
    numbers = sum(column < len(row) and is_number(table.text(row[column])) for row in rows)
    return numbers >= _MOST * len(rows)


def long_take(table: Table, fps: float | None, naming: Naming = canonical_channel) -> Take:
    """Make the take of a table with a line for each weight.

    Raises:
        RateNeeded, FileError: as for `read`.
    """
    lines, rows = _lines_and_rows(table)
    _check_lengths(table, lines, rows, len(table.names))
    layout = _layout(table, rows[:_SAMPLE], naming)
    _check_lengths(table, lines, rows, layout.name + 1)  # names may stand beyond the header
    names = [plain_text(row[layout.name]) for row in rows]
    layout = _without_counters(table, rows, layout)
    table, faces = _one_face(table, layout, lines, names, naming)
    if faces:
        lines, rows = _lines_and_rows(table)
        names = [plain_text(row[layout.name]) for row in rows]
    keys: list[Key] = [tuple(table.text(row[k]) for k in layout.clocks) for row in rows]
    try:
        frames, found, entries = group(names, keys)
    except Repeated as repeated:
        line = lines[repeated.entry]
        what = f'gives "{shown(names[repeated.entry])}" twice at the same time'
        raise table.error(what, "keep the lines of one face", line) from None
    columns = _columns(table, found, naming)
    places = entries[:, list(columns.values())]
    values = _values(table, rows, lines, layout, places)
    filled = ~np.all(np.isnan(values), axis=0)
    places, values = places[:, filled], values[:, filled]
    channels = tuple(name for name, there in zip(columns, filled, strict=True) if there)
    lost = np.all(np.isnan(values), axis=1)
    _check(table, channels, values, lost, lines, entries)
    kept = np.flatnonzero(~lost)
    places = places[kept]
    first = [lines[int(n)] for n in places.min(axis=1)] if len(kept) else []
    if any(keys):
        clocks, titles = layout.clocks, table
        texts = [[frames[t][k] for t in kept] for k in range(len(clocks))]
    else:
        clocks, titles = _named_times(found, entries[kept]), replace(table, names=tuple(found))
        texts = [[table.text(rows[n][layout.value]) for n in entries[kept, k]] for k in clocks]
    times = read_times(titles, clocks, texts, first)
    stated = rate_in_table(table, lambda column: [table.text(row[column]) for row in rows])
    recording = Recording(
        path=table.path,
        format=FORMAT,
        channels=channels,
        values=values[kept],
        timing=settled(times.timing, stated, kept) if len(kept) else NoTimes("has no frames"),
        lost=lost,
        timecodes=_timecodes(clocks, times, texts),
        carried=tuple(shown(name, LONGEST_NAME) for name in found if naming(name) is None),
        unread=faces,
        scale=PERCENT if percent_before(table) and np.abs(values).max(initial=0.0) > 1 else None,
    )
    spans = _spans(table, lines, layout.value, places)
    source = partial(SpanSource, b"".join(table.lines), spans, decimal=table.decimal)
    return finish_take(
        recording,
        fps,
        lambda scale: source(scale=scale),
        lambda frame, k: lines[int(places[frame, k])] + 1,
    )


def _lines_and_rows(table: Table) -> tuple[list[int], list[Cells]]:
    """The indices of the lines of the rows, and their cells."""
    found = list(table.rows())
    return [line for line, _ in found], [cells for _, cells in found]


def _check_lengths(table: Table, lines: Sequence[int], rows: Sequence[Cells], cells: int) -> None:
    """Refuse a row with fewer cells."""
    for line, row in zip(lines, rows, strict=True):
        if len(row) < cells:
            what = f"the row is too short: {len(row)} of {cells} cells"
            raise table.error(what, "delete this line or copy the file again", line)


def _without_counters(table: Table, rows: Sequence[Cells], layout: LongLayout) -> LongLayout:
    """The layout without columns that number the lines or the channels, not the frames."""
    names = [row[layout.name] for row in rows]
    kept = []
    for k in layout.clocks:
        texts = [table.text(row[k]) for row in rows]
        of_names = len(set(zip(names, texts, strict=True))) == len(set(names)) == len(set(texts))
        if len(set(texts)) < len(rows) and not (of_names and len(set(names)) > 1):
            kept.append(k)
    return replace(layout, clocks=tuple(kept))


def _one_face(
    table: Table,
    layout: LongLayout,
    lines: Sequence[int],
    names: Sequence[str],
    naming: Naming,
) -> tuple[Table, tuple[str, ...]]:
    """The table without the lines of other faces than the first, with a note about them."""
    channel = next(filter(naming, names))
    places = [line for line, name in zip(lines, names, strict=True) if name == channel]
    return face_in_lines(table, layout.clocks, places)


def _named_times(names: Sequence[str], entries: NDArray[np.int64]) -> tuple[int, ...]:
    """Those of K names that stand for times, as where a table was made long with all its columns.

    Args:
        entries: (T, K) the entry of each name in each frame; -1 if the frame does not have it.
    """
    return tuple(k for k in clock_columns(names) if (entries[:, k] >= 0).all())


def _timecodes(
    clocks: Sequence[int], times: RowTimes, texts: Sequence[Sequence[str]]
) -> tuple[str, ...] | None:
    if times.kind != "timecode" or times.column is None:
        return None
    return tuple(texts[clocks.index(times.column)])


def _columns(table: Table, names: Sequence[str], naming: Naming) -> dict[str, int]:
    """The place of each channel among the names."""
    found: dict[str, int] = {}
    for k, name in enumerate(names):
        channel = naming(name)
        if channel in found:
            what = f'calls the channel "{channel}" both "{names[found[channel]]}" and "{name}"'
            raise table.error(what, "keep one of them")
        if channel is not None:
            found[channel] = k
    return found


def _values(
    table: Table,
    rows: Sequence[Cells],
    lines: Sequence[int],
    layout: LongLayout,
    places: NDArray[np.int64],
) -> Doubles:
    """(T, K) the weights at some entries; NaN where there is none."""
    flat = [
        np.nan if n < 0 else table.number(lines[n], layout.value, rows[n][layout.value])
        for n in places.ravel().tolist()
    ]
    return np.array(flat, np.float64).reshape(places.shape)


def _check(
    table: Table,
    channels: Sequence[str],
    values: Doubles,
    lost: Bools,
    lines: Sequence[int],
    entries: NDArray[np.int64],
) -> None:
    missing = np.argwhere(np.isnan(values) & ~lost[:, None])
    if len(missing):
        frame, k = missing[0].tolist()
        line = lines[int(entries[frame].max())]
        what = f"a frame has no {channels[k]}, which other frames have"
        raise table.error(what, "write a line for each weight, also if it is 0", line)
    infinite = np.argwhere(np.isinf(values))
    if len(infinite):
        frame, k = infinite[0].tolist()
        what = f"{channels[k]} is not a finite number"
        raise table.error(what, REPAIR, lines[int(entries[frame].max())])


def _spans(
    table: Table,
    lines: Sequence[int],
    column: int,
    places: NDArray[np.int64],
) -> NDArray[np.int64]:
    """(T, K, 2) where the weights are in the file."""
    starts = np.concatenate([[0], np.cumsum([len(line) for line in table.lines])])
    spans = []
    for n in places.ravel().tolist():
        cells = table.cells(lines[n])
        before = sum(len(cell) + 1 for cell in cells[:column])
        number = bare(cells[column])
        start = int(starts[lines[n]]) + before + cells[column].index(number)
        spans.append((start, start + len(number)))
    return np.array(spans, np.int64).reshape(*places.shape, 2)
