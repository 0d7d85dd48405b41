"""CSV with a line for each channel and a column for each frame.

The first cell of a line is its name. Times are in a line of their own or, as numbers, in the line
of titles; other lines, such as the rotation of the head, are carried.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.names import canonical_channel, naming_of
from faceedit_app.formats.csv_source import bare
from faceedit_app.formats.csv_table import Table, plain_text, read_table, split_line
from faceedit_app.formats.files import BOM, LONGEST_NAME, REPAIR, shown
from faceedit_app.formats.json_text import looks_like_json
from faceedit_app.formats.lost_faces import lost_rows
from faceedit_app.formats.number_spans import SpanSource
from faceedit_app.formats.numbers import is_number
from faceedit_app.formats.stated_rate import rate_in_lines, settled
from faceedit_app.formats.take import Recording, Take, finish_take
from faceedit_app.formats.time_columns import text_times, time_columns
from faceedit_app.formats.timecode import BadTimecode
from faceedit_app.formats.timing import BadRow, NoTimes, Timing

FORMAT = "CSV with a line for each channel"
_HEAD = 1 << 20
_DELIMITERS = (b"\t", b";", b",", b"|")
_LINES = 100  # that are looked at
_FEWEST_LINES, _FEWEST_FRAMES = 3, 5
_MOST = 0.9  # share of the lines whose channels differ; a table may have one twice by mistake


def sniff(content: bytes) -> float:
    """How likely, 0..1, this is a table with a line for each channel."""
    if looks_like_json(content) or b"\0" in content[:_HEAD]:
        return 0.0
    lines = [line for line in content[:_HEAD].removeprefix(BOM).splitlines() if line.strip()]
    delimiter = _delimiter(lines)
    rows = [split_line(line, delimiter) or [] for line in lines[:_LINES]]
    heads = [plain_text(row[0]) for row in rows if len(row) > _FEWEST_FRAMES]
    naming = naming_of(heads)
    channels = [name for name in map(naming, heads) if name]
    return 0.65 if len(set(channels)) >= max(_FEWEST_LINES, _MOST * len(channels)) else 0.0


def read(path: Path, content: bytes, fps: float | None) -> Take:
    """Open a table with a line for each channel.

    Raises:
        RateNeeded: it has no times, and `fps` is None.
        FileError: it is damaged.
    """
    table = _table(path, content)
    names = {line: plain_text(cells[0]) for line, cells in table.rows()}
    naming = naming_of(names.values())
    places: dict[str, int] = {}
    for line, name in names.items():
        channel = naming(name)
        if channel in places:
            first = places[channel] + 1
            problem = f'the channel "{channel}" has two lines ({first} and {line + 1})'
            raise table.error(problem, "remove one of them", line)
        if channel is not None:
            places[channel] = line
    values = _values(table, list(places.values()))
    lost = lost_rows(values, np.zeros(len(values), bool))
    missing = np.argwhere(~np.isfinite(values) & ~lost[:, None])
    if len(missing):
        frame, k = missing[0].tolist()
        problem = f"has no number for frame {frame + 1}, for which other channels have one"
        raise table.error(problem, REPAIR, list(places.values())[k])
    kept = np.flatnonzero(~lost)
    spans = np.stack([_spans(table, line) for line in places.values()], axis=1)[kept]
    clock = _clock(table, names, places)
    timing = _timing(table, clock, kept, len(values)) if len(kept) else NoTimes("has no frames")
    before = (line.decode("utf-8", "replace") for line in table.lines[: min(names)])
    others = [n for line, n in names.items() if line != clock and line not in places.values()]
    recording = Recording(
        path=path,
        format=FORMAT,
        channels=tuple(places),
        values=values[kept],
        timing=settled(timing, rate_in_lines(before), kept),
        lost=lost,
        carried=tuple(shown(name, LONGEST_NAME) for name in others if name),
        own=tuple(names[line] for line in places.values()),
    )
    source = partial(SpanSource, b"".join(table.lines), spans, decimal=table.decimal)
    lines = list(places.values())
    return finish_take(
        recording, fps, lambda scale: source(scale=scale), lambda frame, k: lines[k] + 1
    )


def _table(path: Path, content: bytes) -> Table:
    """The table, of which all lines are rows."""
    table = read_table(path, content)
    delimiter = _delimiter([line for line in table.lines if line.strip()])
    whole = Table(path, table.lines, -1, (), delimiter)
    cells = [cell for _, row in whole.rows() for cell in row[1:]]
    commas = sum(1 for cell in cells if b"," in cell) > sum(1 for cell in cells if b"." in cell)
    return Table(path, table.lines, -1, (), delimiter, decimal=b"," if commas else b".")


def _delimiter(lines: Sequence[bytes]) -> bytes:
    """What separates the cells; commas may also be decimal ones."""
    sample = lines[:_LINES]
    counts = {one: sum(1 for line in sample if one in line) for one in _DELIMITERS}
    return max(_DELIMITERS, key=lambda one: counts[one])


def _values(table: Table, lines: list[int]) -> Doubles:
    """(R, K) the numbers of lines; NaN if missing."""
    rows = []
    for line in lines:
        cells = table.cells(line)
        named = Table(
            table.path,
            table.lines,
            -1,
            tuple(f"frame {k}" for k in range(len(cells))),
            table.delimiter,
            decimal=table.decimal,
        )
        rows.append([named.number(line, k, cell) for k, cell in enumerate(cells) if k])
        if len(rows[-1]) != len(rows[0]):
            problem = f"has {len(rows[-1])} numbers where other lines have {len(rows[0])}"
            raise table.error(problem, "copy the file again", line)
    return np.array(rows, np.float64).T


def _spans(table: Table, line: int) -> NDArray[np.int64]:
    """(R, 2) where the numbers of a line are in the file."""
    place = sum(map(len, table.lines[:line]))
    spans = []
    for cell in table.cells(line):
        number = bare(cell)
        start = place + cell.index(number)
        spans.append((start, start + len(number)))
        place += len(cell) + 1
    return np.array(spans[1:], np.int64).reshape(-1, 2)


def _clock(table: Table, names: dict[int, str], places: dict[str, int]) -> int | None:
    """The line with the times: one that is called so, or the first one if it has numbers."""
    others = [line for line in names if line not in places.values()]
    for k in time_columns([names[line] or "-" for line in others]):
        return others[k]
    first = min(names)
    cells = table.cells(first)[1:]
    numbers = sum(1 for cell in cells if is_number(table.text(cell)))
    if first not in others or canonical_channel(names[first]):  # a channel that is carried
        return None
    return first if numbers == len(cells) else None


def _timing(
    table: Table, clock: int | None, kept: NDArray[np.intp], frames: int
) -> Timing | NoTimes:
    if clock is None:
        return NoTimes("has no line with times")
    cells = table.cells(clock)
    name = plain_text(cells[0])
    if not time_columns([name or "-"]):
        name = "frame"  # the line of titles
    texts = [table.text(cell) for cell in cells[1:]]
    if len(texts) != frames:
        problem = f"has {len(texts)} times for {frames} frames"
        raise table.error(problem, "copy the file again", clock)
    try:
        return text_times([texts[k] for k in kept.tolist()], name)
    except NoTimes as none:
        return none
    except (BadTimecode, BadRow) as bad:
        problem = f"the time {shown(texts[int(kept[bad.row])])} is not the next one"
        raise table.error(problem, "sort the frames by time", clock) from None
