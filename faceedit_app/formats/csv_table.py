"""A CSV file as a table that keeps its bytes: lines with their ends, cells with their quotes.

Lines are split as by Python's csv module, except that cells of several lines are refused. Errors
name the line and a remedy.
"""

from __future__ import annotations

import re
from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import chain, islice
from pathlib import Path

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles
from faceedit_app.core.errors import FileError
from faceedit_app.core.names import canonical_channel
from faceedit_app.formats.files import BOM, CHOOSE_TAKE, REPAIR, check_text, shown
from faceedit_app.formats.lost_faces import (
    has_no_numbers,
    is_missing,
    is_time_unit,
    lost_rows,
    says_lost,
)
from faceedit_app.formats.numbers import is_number

HEAD = 1 << 20  # bytes; enough for a header and a row
_MOST_LINES = 6_000_000  # more than a day at 60 fps
_MOST_COLUMNS = 10_000
_LONGEST_LINE = 2 << 20  # bytes
_DELIMITERS = (b",", b";", b"\t")
_BAR = b"|"  # also stands in Maya's names
_MOST_SEARCHED = 1000  # lines among which the header is looked for
_PREAMBLE = 30  # lines that may stand before the header
_COMMENT = b"#"
_ERRORS = (b"#N/A", b"#VALUE!", b"#DIV/0!", b"#REF!")
_DECIMAL_COMMA = re.compile(rb"[ \"]*[+-]?\d*,\d+(?:[eE][+-]?\d+)?[ \"%]*")
_PERCENT = re.compile(rb"[ \"]*[+-]?\d*(?:[.,]\d+)? ?%[ \"]*")
_QUOTED = re.compile('"((?:[^"]|"")*)"(.*)', re.DOTALL)
_SPACED = re.compile(r'\s+"([^"]*)"(\s*)')

Cells = list[bytes]


@dataclass(frozen=True)
class TableRows:
    """The R rows of a table, T of which have a frame.

    Attributes:
        texts: (R) per row the texts of the text columns; "" if the row is too short.
        lost: (R,) whether the row has no frame, because the face was lost.
        numbers: (T, N) float64, finite.
        lines: (T) the index of the line of each frame.
        lost_lines: (R - T) the index of the line of each row that has no frame.
        units: what a row of units says of the columns that are read; empty if there is none.
    """

    texts: list[tuple[str, ...]]
    lost: Bools
    numbers: Doubles
    lines: list[int]
    lost_lines: tuple[int, ...] = ()
    units: dict[int, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Table:
    """A CSV file in memory.

    Attributes:
        path: the file, for messages.
        lines: all lines with their line ends; joined, they are the file.
        header: index of the header line.
        names: column names without quotes and spaces around them.
        delimiter: separates cells.
        mark: the first cell of every row, if any; lines without it are not rows.
        decimal: what stands between the units and the decimals of a number.
        percent: whether numbers have a percent sign.
        face: the column that numbers faces, and the one whose rows are read; None = all rows.
    """

    path: Path
    lines: tuple[bytes, ...]
    header: int
    names: tuple[str, ...]
    delimiter: bytes
    mark: bytes | None = None
    decimal: bytes = b"."
    percent: bool = False
    face: tuple[int, str] | None = None

    def error(self, problem: str, remedy: str, line: int | None = None) -> FileError:
        """An error about this file, at the line with this index."""
        return FileError(self.path, problem, remedy, None if line is None else line + 1)

    def cells(self, line: int) -> Cells:
        """The cells of a line with quotes and spaces; joined by the delimiter, they are the line.

        Raises:
            FileError: a cell continues on the next line.
        """
        cells = split_line(self.lines[line].rstrip(b"\r\n"), self.delimiter)
        if cells is None:
            raise self.error("a quoted cell does not end on its line", REPAIR, line)
        return cells

    def rows(self) -> Iterator[tuple[int, Cells]]:
        """The line index and the cells of each row; blank lines and comments are skipped."""
        for line in range(self.header + 1, len(self.lines)):
            if not self.mark and _is_comment(self.lines[line]):
                continue
            cells = self.cells(line)
            is_row = cells[0] == self.mark if self.mark else any(map(bytes.strip, cells))
            if is_row and self._has_face(cells):
                yield line, cells

    def _has_face(self, cells: Cells) -> bool:
        """Whether a row is one of the face that is read."""
        if self.face is None:
            return True
        column, face = self.face
        return column < len(cells) and plain_text(cells[column]) == face

    def read(
        self,
        text_columns: Sequence[int],
        number_columns: Sequence[int],
        flag: int | None = None,
    ) -> TableRows:
        """Read some columns of all rows.

        A row without numbers, with -1 in place of all, or whose flag says so has lost the face: it
        stays in the file but is not a frame (`lost_faces.py`). A first row of units is not a row.

        Args:
            text_columns: columns to read as texts.
            number_columns: columns to read as numbers; columns without any are all NaN.
            flag: the column that says whether a row has a face, if any.

        Raises:
            FileError: there is no row, a row is too short or too long, a cell is not a number,
                or only some of a row's numbers are missing.
        """
        texts: list[tuple[str, ...]] = []
        lines: list[int] = []
        flagged: list[bool] = []
        flat = array("d")
        units: dict[int, str] = {}
        head = self.cells(self.header) if self.header >= 0 else [b""]
        head[0] = head[0].removeprefix(BOM)
        nothing, width = array("d", [np.nan]) * len(number_columns), len(self.names)
        for line, cells in self.rows():
            if cells[0] == head[0] and cells == head:  # repeated, as on each page of a print
                continue
            if not texts and _is_units(cells, text_columns, number_columns):
                units = {k: plain_text(cells[k]) for k in (*number_columns, *text_columns)}
                continue
            if len(cells) == width or self._fits(line, cells, number_columns, flag):
                flat.extend(self._numbers(line, cells, number_columns))
            else:
                flat.extend(nothing)
                cells += [b""] * (width - len(cells))
            flagged.append(self._says_lost(cells, flag))
            texts.append(tuple([self.text(cells[k]) for k in text_columns]))
            lines.append(line)
        if not texts:
            raise self.error("has a header but no frames", "export the take again", self.header)
        numbers = np.frombuffer(flat, np.float64).reshape(len(lines), len(number_columns))
        lost = lost_rows(numbers, np.array(flagged))
        self._check(numbers, lost, number_columns, lines)
        frames = np.flatnonzero(~lost)
        kept = [lines[i] for i in frames]
        without = tuple(lines[i] for i in np.flatnonzero(lost))
        return TableRows(texts, lost, numbers[frames], kept, without, units)

    def text(self, cell: bytes) -> str:
        """A cell's text, with a point in a number."""
        if self.decimal != b"." and _DECIMAL_COMMA.fullmatch(cell):
            cell = cell.replace(self.decimal, b".")
        return plain_text(cell)

    def _numbers(self, line: int, cells: Cells, columns: Sequence[int]) -> list[float]:
        if b"_" not in self.lines[line]:  # Python reads 1_0 as 10: check more closely
            try:
                return [float(cells[k]) for k in columns]
            except ValueError:
                pass
        if has_no_numbers([plain_text(cells[k]) for k in columns]):
            return [np.nan] * len(columns)
        return [self.number(line, k, cells[k]) for k in columns]

    def _fits(self, line: int, cells: Cells, columns: Sequence[int], flag: int | None) -> bool:
        """Whether a row of unusual length has numbers; raises unless its kind is known."""
        wanted = len(self.names)
        if len(cells) > wanted:
            if not any(cell.strip() for cell in cells[wanted:]):
                return True
            raise self.error(
                f"has {len(cells)} cells where the header has {wanted} columns",
                "remove the surplus cells or delete the line",
                line,
            )
        empty = all(is_missing(plain_text(cells[k])) for k in columns if k < len(cells))
        if empty and (flag is None or self._says_lost(cells, flag)):
            return False
        last = all(not self.lines[i].strip() for i in range(line + 1, len(self.lines)))
        what = "the last row is cut off" if last else "the row is too short"
        raise self.error(
            f"{what}: {len(cells)} of {wanted} cells",
            "delete this line or copy the file from the device again",
            line,
        )

    def _says_lost(self, cells: Cells, flag: int | None) -> bool:
        """Whether a row's flag says that the face was lost."""
        if flag is None or flag >= len(cells):
            return False
        return says_lost(self.names[flag], plain_text(cells[flag]))

    def number(self, line: int, column: int, cell: bytes) -> float:
        """The number in a cell; NaN if it is missing. Raises FileError if it is something else."""
        text = self.text(cell)
        if is_missing(text):
            return np.nan
        if self.percent:
            text = text.removesuffix("%").rstrip()
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
        """Raise for the first number (R, N) that is infinite, or missing in a row with a face."""
        largest = float(np.finfo(np.float32).max)
        empty = np.all(np.isnan(numbers), axis=0)
        missing = np.isnan(numbers) & ~empty & ~lost[:, None]
        wrong = np.argwhere(missing | ((np.abs(numbers) > largest) & ~lost[:, None]))
        if len(wrong):
            row, k = int(wrong[0, 0]), columns[int(wrong[0, 1])]
            text = shown(plain_text(self.cells(lines[row])[k]))
            what = f'holds "{text}", not a finite number' if text else "is empty"
            more = f" (there are {len(wrong) - 1} more like it)" if len(wrong) > 1 else ""
            problem = f'column "{shown(self.names[k])}" {what}{more}'
            raise self.error(problem, REPAIR, lines[row])


def read_table(path: Path, content: bytes) -> Table:
    """Read a CSV file: UTF-8 or ASCII, any line ends, commas, semicolons or tabs.

    Raises:
        FileError: it is empty or not text.
    """
    check_text(path, content)
    if content.count(b"\n") + content.count(b"\r") > 2 * _MOST_LINES:  # each may end with two
        raise FileError(path, f"has over {_MOST_LINES:,} lines", "split the take into shorter ones")
    lines = tuple(content.splitlines(keepends=True))
    longest = max(lines, key=len)
    if len(longest) > _LONGEST_LINE:
        place = lines.index(longest) + 1
        raise FileError(path, "has a line of over 2 MB", CHOOSE_TAKE, place)
    header = _header([line.removeprefix(BOM) for line in lines[:_MOST_SEARCHED]])
    text = lines[header].removeprefix(BOM).rstrip(b"\r\n")
    if _separators(text) > _MOST_COLUMNS:
        raise FileError(path, f"has over {_MOST_COLUMNS:,} columns", CHOOSE_TAKE, header + 1)
    delimiter, cells = split_header(text)
    if cells is None:
        raise FileError(path, "a quoted cell does not end on its line", REPAIR, header + 1)
    names = tuple(plain_text(cell) for cell in cells)
    cells = _first_cells(lines, header, delimiter)
    percent = any(map(_PERCENT.fullmatch, cells))
    return Table(path, lines, header, names, delimiter, decimal=_decimal(cells), percent=percent)


def first_rows(content: bytes) -> tuple[tuple[str, ...], Cells]:
    """The column names and the first row's cells, if the content is read as CSV."""
    lines = content[:HEAD].removeprefix(BOM).splitlines()
    place = _header(lines)
    header = lines[place] if lines else b""
    row = next((line for line in lines[place + 1 :] if line.strip()), b"")
    delimiter, cells = split_header(header)
    if b"\0" in header or cells is None:
        return (), []
    return tuple(plain_text(cell) for cell in cells), split_line(row, delimiter) or []


def _header(lines: Sequence[bytes]) -> int:
    """The index of the header: the first line with a channel and no number, or else the first.

    Comments, a title and Excel's `sep=;` may stand before it.
    """
    filled = (i for i, line in enumerate(lines) if line.strip())
    first = next(filled, 0)
    for place in islice(chain([first], filled), _PREAMBLE):
        line = lines[place].rstrip(b"\r\n") if place < len(lines) else b""
        if _separators(line) > _MOST_COLUMNS:
            continue
        texts = [plain_text(cell) for cell in split_header(line)[1] or ()]
        if any(map(canonical_channel, texts)) and not any(map(is_number, texts)):
            return place
    return first


def _separators(line: bytes) -> int:
    return sum(map(line.count, _DELIMITERS))


def _first_cells(lines: Sequence[bytes], header: int, delimiter: bytes) -> Cells:
    """The cells of the first rows."""
    rows = (line.rstrip(b"\r\n") for line in lines[header + 1 : header + 1 + _PREAMBLE])
    return [cell for row in rows for cell in split_line(row, delimiter) or ()]


def _decimal(cells: Cells) -> bytes:
    """What stands before the decimals of the numbers in some cells."""
    commas = sum(1 for cell in cells if _DECIMAL_COMMA.fullmatch(cell))
    return b"," if commas > sum(1 for cell in cells if b"." in cell) else b"."


def _is_comment(line: bytes) -> bool:
    """Whether a line is a comment; a spreadsheet's errors also begin with `#`."""
    text = line.lstrip()
    return text.startswith(_COMMENT) and not text.startswith(_ERRORS)


def _is_units(cells: Cells, texts: Sequence[int], numbers: Sequence[int]) -> bool:
    """Whether a row holds units or ranges, such as `s` and `[0-1]`, instead of a frame.

    A weight without a unit may be `-`, as in a row that lost the face, or 1, if a time has one.
    """
    if max([*texts, *numbers]) >= len(cells):
        return False
    shown = [plain_text(cells[k]) for k in numbers]
    if any(is_time_unit(plain_text(cells[k])) for k in texts):
        return not any(is_number(one) and one != "1" for one in shown)
    if any(map(is_number, shown)):
        return False
    if any(text and is_missing(text) for text in shown):
        return False
    digits = any(character.isdigit() for k in texts for character in plain_text(cells[k]))
    return not digits and any(cells[k].strip() for k in [*texts, *numbers])


def split_header(text: bytes) -> tuple[bytes, Cells | None]:
    """The delimiter and the cells of a header; `|` separates them only if nothing else does."""
    split = {delimiter: split_line(text, delimiter) for delimiter in (*_DELIMITERS, _BAR)}
    delimiter = max(_DELIMITERS, key=lambda one: len(split[one] or ()))
    delimiter = _BAR if len(split[delimiter] or ()) == 1 else delimiter
    return delimiter, split[delimiter]


def split_line(text: bytes, delimiter: bytes) -> Cells | None:
    """The cells of a line with their quotes, as Python's csv module finds them.

    A cell that begins with a quote ends at the next single quote; two quotes stand for one.
    Elsewhere quotes have no meaning.

    Returns:
        The cells, or None if the last one continues on the next line.
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
    """A cell's text as Python's csv module reads it, without the spaces around it.

    One pair of quotes after a space also counts as quotes, as some tools write them.
    """
    text = cell.decode("utf-8", "replace")
    quoted = (_QUOTED.fullmatch(text) or _SPACED.fullmatch(text)) if '"' in text else None
    if quoted is None:
        return text.strip()
    return (quoted[1].replace('""', '"') + quoted[2]).strip()
