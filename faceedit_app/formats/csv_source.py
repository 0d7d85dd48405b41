"""The weights of a clip in a CSV table, and how they are written back.

The file is kept as lines. Exporting splits only the lines in which a weight changed, replaces those
cells, and joins them again, so everything else (line ends, spaces, quotes, other columns, lines
without a tracked face) survives by construction.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice

import numpy as np

from faceedit_app.core.arkit import ROTATION_INDEX
from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.names import canonical_channel
from faceedit_app.formats.csv_table import Table
from faceedit_app.formats.files import CHOOSE_TAKE
from faceedit_app.formats.lost_faces import LEAST_SURE
from faceedit_app.formats.numbers import (
    NumberFormat,
    as_written,
    detect_format,
    kept_text,
    shortest,
)
from faceedit_app.formats.rotations import DEGREES, in_degrees

_FORMAT_SAMPLE = 200  # rows from which the number format is learned


@dataclass(frozen=True)
class Columns:
    """Which columns of a table hold channels.

    Attributes:
        channels: ARKit names in the table's order.
        indices: their columns.
    """

    channels: tuple[str, ...]
    indices: tuple[int, ...]

    def without(self, empty: Sequence[bool]) -> Columns:
        """The columns for which `empty` (K,) is False."""
        kept = [k for k, gone in enumerate(empty) if not gone]
        return Columns(tuple(self.channels[k] for k in kept), tuple(self.indices[k] for k in kept))


def find_channels(table: Table, naming: Callable[[str], str | None] = canonical_channel) -> Columns:
    """Find the channels by name, in any order.

    Args:
        naming: the channel that a column's name means, or None.

    Raises:
        FileError: there is no channel, or one has two columns.
    """
    found: dict[str, int] = {}
    for k, name in enumerate(table.names):
        channel = naming(name)
        if channel is None:
            continue
        if channel in found:
            problem = f'the channel "{channel}" has two columns ({found[channel] + 1} and {k + 1})'
            raise table.error(problem, "rename or remove one of them", table.header)
        found[channel] = k
    if not found:
        raise table.error("holds no ARKit channel such as jawOpen", CHOOSE_TAKE, table.header)
    return Columns(tuple(found), tuple(found.values()))


@dataclass(frozen=True)
class CsvSource:
    """A table, and where a clip's weights are in it (`take.Source`).

    Attributes:
        table: the file.
        lines: (T) indices of the lines with the clip's frames.
        columns: (K) the columns of its channels.
        scale: the value of a full blendshape in the file.
        turns: the columns of the rotations that it has, by their names.
        degrees: the names of the rotations that the file has in degrees, not radians.
        lost: (L) indices of the lines without a face.
        flag: the column that says whether a row has a face, if any.
        confidence: the column of the tracker's confidence, if any.
        seconds: the column of the times, if they are seconds.
        clock: the column of the times, if they are timecodes.
        ticks: the column of the times, if they are in another unit, and how many make a second.
        formats: how the numbers of some columns are written, once that is known.
    """

    table: Table
    lines: Sequence[int]
    columns: Sequence[int]
    scale: float = 1.0
    turns: Mapping[str, int] = field(default_factory=dict)
    degrees: frozenset[str] = frozenset()
    lost: Sequence[int] = ()
    flag: int | None = None
    confidence: int | None = None
    seconds: int | None = None
    clock: int | None = None
    ticks: tuple[int, float] | None = None
    formats: dict[tuple[int, ...], NumberFormat] = field(
        default_factory=dict, repr=False, compare=False
    )

    def encode(self, tracked: Floats, edited: Floats) -> bytes:
        """The whole file; see `take.Source.encode`."""
        return b"".join(self._lines(self.columns, self.scale, tracked, edited))

    def rotated(self, tracked: Floats, edited: Floats) -> CsvSource:
        """The source with other rotations; see `take.RotatingSource.rotated`."""
        now = self
        for unit in (1.0, DEGREES):
            names = [name for name in self.turns if self.turn_unit(name) == unit]
            which, columns = [ROTATION_INDEX[n] for n in names], [self.turns[n] for n in names]
            lines = tuple(now._lines(columns, unit, tracked[:, which], edited[:, which]))
            now = replace(now, table=replace(self.table, lines=lines))
        return now

    def turn_unit(self, name: str) -> float:
        """What the file has for a radian of one of its rotations."""
        return DEGREES if name in self.degrees else 1.0

    def as_sure(self, tracked: Floats, edited: Floats) -> CsvSource:
        """The source with other confidence; see `take.SureSource.as_sure`."""
        if self.confidence is None:
            return self
        # 0 would mean a row without a face.
        new = np.where(edited == tracked, tracked, np.maximum(edited, LEAST_SURE))
        lines = tuple(self._lines((self.confidence,), 1.0, tracked[:, None], new[:, None]))
        return replace(self, table=replace(self.table, lines=lines))

    def _lines(
        self, columns: Sequence[int], scale: float, tracked: Floats, edited: Floats
    ) -> list[bytes]:
        """The lines of the file with changed numbers in some columns."""
        # By value: 0 and -0 are the same weight, so their text stays.
        changed = tracked != edited
        touched = np.flatnonzero(changed.any(axis=1))
        out = list(self.table.lines)
        if len(touched):
            write = self.writer(columns, scale)
            for row, numbers in zip(touched.tolist(), in_unit(edited[touched], scale), strict=True):
                line = self.lines[row]
                cells = self.table.cells(line)
                for k in np.flatnonzero(changed[row]).tolist():
                    column = columns[k]
                    number = write(float(numbers[k]))
                    number = kept_text(bare(cells[column]), number, self.table.decimal)
                    cells[column] = _replaced(cells[column], number)
                text = self.table.delimiter.join(cells)
                old = self.table.lines[line]
                out[line] = text + old[len(old.rstrip(b"\r\n")) :]
        return out

    def with_faces(self, weights: Floats) -> CsvSource:
        """The file with weights in rows that lost the face.

        Cells that such a row lacks, such as the head's rotations, are those of the frame before.
        Its confidence is 0.

        Args:
            weights: (L, K) for those of `lost` that lie between frames; a row of NaN stays as it
                is.
        """
        write = self.writer(self.columns, self.scale)
        out, frames = list(self.table.lines), np.array(self.lines)
        between = [line for line in self.lost if self.lines[0] < line < self.lines[-1]]
        for line, row in zip(between, shortest(weights), strict=True):
            if not np.isfinite(row).all():
                continue
            before = self.lines[int(np.searchsorted(frames, line)) - 1]
            cells, own = self.table.cells(before), self.table.cells(line)
            for k, cell in enumerate(own[: len(cells)]):
                if cell.strip() and k != self.flag:
                    cells[k] = cell
            if self.confidence not in (None, self.flag):
                cells[self.confidence] = b"0"
            for column, weight in zip(self.columns, row.tolist(), strict=True):
                text = self.table.cells(before)[column]
                cells[column] = _replaced(text, write(weight * self.scale))
            old = self.table.lines[line]
            out[line] = self.table.delimiter.join(cells) + old[len(old.rstrip(b"\r\n")) :]
        return replace(self, table=replace(self.table, lines=tuple(out)))

    def as_written(self, weights: Floats) -> Doubles:
        """See `take.RoundingSource.as_written`."""
        return as_written(weights, self.scale, self._form(self.columns, self.scale))

    def _form(self, columns: Sequence[int], scale: float) -> NumberFormat:
        """How the numbers of some columns are written."""
        known = tuple(columns)
        if known not in self.formats:
            self.formats[known] = detect_format(self._sample(columns), scale)
        return self.formats[known]

    def texts(self, column: int) -> list[str]:
        """(T) the texts of the frames in a column."""
        cells = (self.table.cells(line) for line in self.lines)
        return [self.table.text(row[column]) for row in cells]

    def writer(self, columns: Sequence[int], scale: float) -> Callable[[float], bytes]:
        """What writes a number as the file writes those in some columns.

        Args:
            scale: the value of a full blendshape or of a radian, 1 for other numbers.
        """
        write, decimal = self._form(columns, scale).write, self.table.decimal
        return lambda number: write(number).replace(b".", decimal)

    def _sample(self, columns: Sequence[int]) -> Iterator[bytes]:
        stride = max(1, len(self.lines) // _FORMAT_SAMPLE)
        for line in islice(self.lines, 0, None, stride):
            cells = self.table.cells(line)
            for column in columns:
                yield bare(cells[column]).replace(self.table.decimal, b".")


def in_unit(values: Floats, scale: float) -> Doubles:
    """Numbers as a file has them, where `scale` stands for 1: a full blendshape, or a radian."""
    return in_degrees(values) if scale == DEGREES else shortest(values) * scale


def _replaced(cell: bytes, number: bytes) -> bytes:
    """The cell with another number, in its own quotes and spaces."""
    return cell.replace(bare(cell), number, 1)


def bare(cell: bytes) -> bytes:
    """A cell without the quotes, spaces and percent sign around its number."""
    return cell.strip().strip(b'"').strip().rstrip(b"%").rstrip()
