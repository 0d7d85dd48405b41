"""A CSV file as a table that keeps its bytes: lines with their ends, cells with their quotes.

Lines are split as Python's csv module splits them, but for cells that go on over several lines,
which are refused. What is wrong with a file is said with its line and a remedy, before anything is
made of it.
"""

from __future__ import annotations

import re
from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles
from faceedit_app.core.errors import FileError
from faceedit_app.formats.files import BOM, REPAIR, check_text, shown

_HEAD = 1 << 20  # bytes that hold a header and a row
_DELIMITERS = (b",", b";", b"\t")
# What programs write where they have no number.
_MISSING = {"", "nan", "-nan", "+nan", "na", "n/a", "#n/a", "null", "none", "-nan(ind)", "nan(ind)"}

Cells = list[bytes]


@dataclass(frozen=True)
class Rows:
    """What was read of a table's R rows, T of which have a frame.

    Attributes:
        texts: (R) per row the cells of the text columns, as texts; "" where the row ends before.
        lost: (R,) whether the row has no frame although the file is complete.
        numbers: (T, N) float64, finite.
        lines: (T) per row with a frame the index of its line.
    """

    texts: list[tuple[str, ...]]
    lost: Bools
    numbers: Doubles
    lines: list[int]


@dataclass(frozen=True)
class Table:
    """A CSV file in memory.

    Attributes:
        path: where it was read from, for messages.
        lines: all lines with their line ends; joined they are the file.
        header: index of the header line.
        names: column names without quotes and spaces around them.
        delimiter: what separates cells.
        mark: what the first cell of a row must be, if anything; other lines are no rows.
    """

    path: Path
    lines: tuple[bytes, ...]
    header: int
    names: tuple[str, ...]
    delimiter: bytes
    mark: bytes | None = None

    def error(self, problem: str, remedy: str, line: int | None = None) -> FileError:
        """A complaint about this file, at a line by its index."""
        return FileError(self.path, problem, remedy, None if line is None else line + 1)

    def cells(self, line: int) -> Cells:
        """The cells of a line as they stand in the file; joined by the delimiter they are it.

        Raises:
            FileError: a cell goes on in the next line.
        """
        cells = split_line(self.lines[line].rstrip(b"\r\n"), self.delimiter)
        if cells is None:
            raise self.error("a quoted cell does not end on its line", REPAIR, line)
        return cells

    def rows(self) -> Iterator[tuple[int, Cells]]:
        """Index and cells of each row; lines without content are none."""
        for line in range(self.header + 1, len(self.lines)):
            cells = self.cells(line)
            is_row = cells[0] == self.mark if self.mark else any(map(bytes.strip, cells))
            if is_row:
                yield line, cells

    def read(
        self,
        text_columns: Sequence[int],
        number_columns: Sequence[int],
        count: int | None = None,
    ) -> Rows:
        """Read some columns of all rows.

        A row without numbers, or with a count of 0, is lost: it is kept in the file and is no
        frame.

        Args:
            text_columns: columns to read as texts.
            number_columns: columns to read as numbers; those that hold none are NaN throughout.
            count: the column that says how many values a row has, if any.

        Raises:
            FileError: there is no row, a row is too short or too long, a cell is no number, or
                only some of a row's numbers are missing.
        """
        texts: list[tuple[str, ...]] = []
        lines: list[int] = []
        zero: list[bool] = []
        flat = array("d")
        nothing, width = array("d", [np.nan]) * len(number_columns), len(self.names)
        for line, cells in self.rows():
            if len(cells) == width or self._fits(line, cells, number_columns, count):
                flat.extend(self._numbers(line, cells, number_columns))
            else:
                flat.extend(nothing)
                cells += [b""] * (width - len(cells))
            zero.append(count is not None and _is_zero(cells[count]))
            texts.append(tuple([plain_text(cells[k]) for k in text_columns]))
            lines.append(line)
        if not texts:
            raise self.error("has a header but no frames", "export the take again", self.header)
        numbers = np.frombuffer(flat, np.float64).reshape(len(lines), len(number_columns))
        lost = _lost(numbers, np.array(zero))
        self._check(numbers, lost, number_columns, lines)
        frames = np.flatnonzero(~lost)
        return Rows(texts, lost, numbers[frames], [lines[i] for i in frames])

    def _numbers(self, line: int, cells: Cells, columns: Sequence[int]) -> list[float]:
        if b"_" not in self.lines[line]:  # Python reads 1_0 as 10: look closer
            try:
                return [float(cells[k]) for k in columns]
            except ValueError:
                pass
        return [self._number(line, k, cells[k]) for k in columns]

    def _fits(self, line: int, cells: Cells, columns: Sequence[int], count: int | None) -> bool:
        """Whether a row of unusual length has numbers; complains unless it is a known kind."""
        wanted = len(self.names)
        if len(cells) > wanted:
            if not any(cell.strip() for cell in cells[wanted:]):
                return True
            raise self.error(
                f"has {len(cells)} cells where the header has {wanted} columns",
                "remove the surplus cells or delete the line",
                line,
            )
        empty = all(_is_missing(cells[k]) for k in columns if k < len(cells))
        if empty and (count is None or (count < len(cells) and _is_zero(cells[count]))):
            return False
        last = all(not self.lines[i].strip() for i in range(line + 1, len(self.lines)))
        what = "the last row is cut off" if last else "the row is too short"
        raise self.error(
            f"{what}: {len(cells)} of {wanted} cells",
            "delete this line or copy the file from the device again",
            line,
        )

    def _number(self, line: int, column: int, cell: bytes) -> float:
        text = plain_text(cell)
        if text.lower() in _MISSING:
            return np.nan
        try:
            if "_" in text:
                raise ValueError(text)
            return float(text)
        except ValueError:
            what = f'column "{shown(self.names[column])}" holds "{shown(text)}", not a number'
            remedy = "write decimals with a point" if "," in text else REPAIR
            raise self.error(what, remedy, line) from None

    def _check(
        self, numbers: Doubles, lost: Bools, columns: Sequence[int], lines: list[int]
    ) -> None:
        """Complain of the first number (R, N) that is infinite, or missing although not lost."""
        largest = float(np.finfo(np.float32).max)
        empty = np.all(np.isnan(numbers), axis=0)
        missing = np.isnan(numbers) & ~empty & ~lost[:, None]
        wrong = np.argwhere(missing | (np.abs(numbers) > largest))
        if len(wrong):
            row, k = int(wrong[0, 0]), columns[int(wrong[0, 1])]
            text = shown(plain_text(self.cells(lines[row])[k]))
            what = f'holds "{text}", not a finite number' if text else "is empty"
            more = f" (there are {len(wrong) - 1} more like it)" if len(wrong) > 1 else ""
            problem = f'column "{shown(self.names[k])}" {what}{more}'
            raise self.error(problem, REPAIR, lines[row])


def read_table(path: Path, content: bytes) -> Table:
    """A CSV file: UTF-8 or ASCII, any line ends, separated by commas, semicolons or tabs.

    Raises:
        FileError: it is empty or no text.
    """
    check_text(path, content)
    lines = tuple(content.splitlines(keepends=True))
    header = next(i for i, line in enumerate(lines) if line.removeprefix(BOM).strip())
    text = lines[header].removeprefix(BOM).rstrip(b"\r\n")
    delimiter, cells = split_header(text)
    if cells is None:
        raise FileError(path, "a quoted cell does not end on its line", REPAIR, header + 1)
    return Table(path, lines, header, tuple(plain_text(cell) for cell in cells), delimiter)


def first_rows(content: bytes) -> tuple[tuple[str, ...], Cells]:
    """The column names that a file would have as a CSV, and the cells of its first row."""
    lines = (line for line in content[:_HEAD].removeprefix(BOM).splitlines() if line.strip())
    header, row = next(lines, b""), next(lines, b"")
    delimiter, cells = split_header(header)
    if b"\0" in header or cells is None:
        return (), []
    return tuple(plain_text(cell) for cell in cells), split_line(row, delimiter) or []


def split_header(text: bytes) -> tuple[bytes, Cells | None]:
    """The delimiter of a file, from its header, and the header's cells."""
    split = {delimiter: split_line(text, delimiter) for delimiter in _DELIMITERS}
    delimiter = max(split, key=lambda one: len(split[one] or ()))
    return delimiter, split[delimiter]


def split_line(text: bytes, delimiter: bytes) -> Cells | None:
    """The cells of a line with their quotes, as Python's csv module finds them.

    A cell that begins with a quote goes on to the next single quote; two stand for one. Elsewhere
    quotes mean nothing.

    Returns:
        The cells, or None if the last one would go on in the next line.
    """
    if b'"' not in text:
        return text.split(delimiter)
    cells, start = [], 0
    pattern = _cell(delimiter)
    while True:
        match = pattern.match(text, start)
        if match is None:
            return None
        cells.append(match[0])
        if match.end() == len(text):
            return cells
        start = match.end() + 1


@cache
def _cell(delimiter: bytes) -> re.Pattern[bytes]:
    d = re.escape(delimiter)
    return re.compile(b'(?:"(?:[^"]|"")*"(?!")[^%b]*|(?!")[^%b]*)(?=%b|\\Z)' % (d, d, d), re.DOTALL)


def plain_text(cell: bytes) -> str:
    """A cell's text without the quotes and spaces around it."""
    return cell.decode("utf-8", "replace").strip().strip('"').strip()


def _lost(numbers: Doubles, zero: Bools) -> Bools:
    """(R,) which rows have no frame: they have no number (R, N), or a count of 0."""
    if zero.all() and np.nan_to_num(numbers).any():  # the count is never filled in
        zero = np.zeros_like(zero)
    lost: Bools = np.all(np.isnan(numbers), axis=1) | zero
    return lost


def _is_missing(cell: bytes) -> bool:
    return plain_text(cell).lower() in _MISSING


def _is_zero(cell: bytes) -> bool:
    """Whether a count is 0, which some tools write as `0.0`."""
    return cell.strip(b' "') in (b"0", b"0.0")
