"""A CSV file as a table that keeps its bytes: lines with their ends, cells with their quotes.

What is wrong with a file is told with its line and a remedy, before anything is made of it.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arrays import Times
from faceedit_app.core.errors import FileError

_BOM = b"\xef\xbb\xbf"
_LARGEST_FILE = 1 << 30  # an hour at 60 fps is 160 MB
_LONGEST_SHOWN = 40
CHOOSE_TAKE = "choose a Live Link Face CSV or another CSV with ARKit channels"
_REPAIR = "correct the cell or delete the line"

Cells = list[bytes]


def read_bytes(path: Path) -> bytes:
    """The content of a file.

    Raises:
        FileError: it is missing, a folder, not readable or too large.
    """
    try:
        if path.is_dir():
            raise FileError(path, "is a folder", "choose a CSV file inside it")
        if not path.exists():
            raise FileError(path, "does not exist", "check the name and the folder")
        if not path.is_file():
            raise FileError(path, "is not a regular file", CHOOSE_TAKE)
        if path.stat().st_size > _LARGEST_FILE:
            raise FileError(path, "is larger than 1 GB", "split the take into shorter ones")
        return path.read_bytes()
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise FileError(
            path, f"cannot be read ({reason})", "check the file's permissions and its name"
        ) from error


@dataclass(frozen=True)
class Rows:
    """What was read of a table's R rows, T of which have numbers.

    Attributes:
        texts: (R) per row the cells of the text columns, as texts.
        tracked: (R,) whether the row has numbers.
        numbers: (T, N) float64.
        lines: (T) per row with numbers the index of its line.
        number_of_line: (R) 1-based line number per row, for messages.
    """

    texts: list[tuple[str, ...]]
    tracked: NDArray[np.bool_]
    numbers: Times
    lines: list[int]
    number_of_line: list[int]


@dataclass(frozen=True)
class Table:
    """A CSV file in memory.

    Attributes:
        path: where it was read from, for messages.
        lines: all lines with their line ends; joined they are the file.
        header: index of the header line.
        names: column names without quotes and spaces around them.
        delimiter: what separates cells.
    """

    path: Path
    lines: tuple[bytes, ...]
    header: int
    names: tuple[str, ...]
    delimiter: bytes

    def error(self, problem: str, remedy: str, line: int | None = None) -> FileError:
        """A complaint about this file, at a line by its index."""
        return FileError(self.path, problem, remedy, None if line is None else line + 1)

    def cells(self, line: int) -> Cells:
        """The cells of a line as they stand in the file; joined by the delimiter they are it."""
        return _split(self.lines[line].rstrip(b"\r\n"), self.delimiter)

    def first_row(self) -> Cells:
        """The cells of the first row.

        Raises:
            FileError: there is none.
        """
        for line in range(self.header + 1, len(self.lines)):
            cells = self.cells(line)
            if not _is_blank(cells):
                return cells
        raise self.error("has a header but no frames", "export the take again", self.header)

    def read(
        self,
        text_columns: Sequence[int],
        number_columns: Sequence[int],
        is_untracked: Callable[[Cells], bool] = lambda cells: False,
    ) -> Rows:
        """Read some columns of all rows; lines without content are no rows.

        Args:
            text_columns: columns to read as texts.
            number_columns: columns to read as numbers.
            is_untracked: whether a row that lacks numbers is complete as it is.

        Raises:
            FileError: a row too short or too long, or a cell that is no finite number.
        """
        texts: list[tuple[str, ...]] = []
        tracked: list[bool] = []
        lines: list[int] = []
        all_lines: list[int] = []
        flat = array("d")
        for line, cells in self._rows():
            full = len(cells) == len(self.names) or self._fits(line, cells, is_untracked)
            if full:
                try:
                    if b"_" in self.lines[line]:  # Python reads 1_0 as 10: look closer
                        raise ValueError
                    flat.extend([float(cells[k]) for k in number_columns])
                except ValueError:
                    full = not is_untracked(cells)
                    if full:
                        flat.extend([self._number(line, k, cells[k]) for k in number_columns])
            if full:
                lines.append(line)
            texts.append(tuple(plain_text(cells[k]) for k in text_columns))
            tracked.append(full)
            all_lines.append(line + 1)
        if not texts:
            self.first_row()
        numbers = np.frombuffer(flat, np.float64).reshape(len(lines), len(number_columns))
        self._check_finite(numbers, number_columns, lines)
        return Rows(texts, np.array(tracked, bool), numbers, lines, all_lines)

    def _rows(self) -> Iterator[tuple[int, Cells]]:
        for line in range(self.header + 1, len(self.lines)):
            cells = self.cells(line)
            if not _is_blank(cells):
                yield line, cells

    def _fits(self, line: int, cells: Cells, is_untracked: Callable[[Cells], bool]) -> bool:
        """Whether a row of unusual length has numbers; complains unless it is a known kind."""
        wanted = len(self.names)
        if len(cells) > wanted:
            if _is_blank(cells[wanted:]):
                return True
            raise self.error(
                f"has {len(cells)} cells where the header has {wanted} columns",
                "remove the surplus cells or delete the line",
                line,
            )
        if is_untracked(cells):
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
        try:
            if "_" in text:
                raise ValueError(text)
            return float(text)
        except ValueError:
            what = f'holds "{shown(text)}", not a number' if text else "is empty"
            remedy = "write decimals with a point" if "," in text else _REPAIR
            raise self.error(f'column "{shown(self.names[column])}" {what}', remedy, line) from None

    def _check_finite(self, numbers: Times, columns: Sequence[int], lines: list[int]) -> None:
        largest = float(np.finfo(np.float32).max)
        wrong = np.argwhere(~(np.abs(numbers) <= largest))  # also true for NaN
        if len(wrong):
            row, k = int(wrong[0, 0]), columns[int(wrong[0, 1])]
            text = shown(plain_text(self.cells(lines[row])[k]))
            problem = f'column "{shown(self.names[k])}" holds "{text}", not a finite number'
            raise self.error(problem, _REPAIR, lines[row])


def read_table(path: Path | str) -> Table:
    """Read a CSV file: UTF-8 or ASCII, any line ends, separated by commas, semicolons or tabs.

    Raises:
        FileError: it cannot be read, or is empty or no text.
    """
    path = Path(path)
    content = read_bytes(path)
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise FileError(path, "is UTF-16 text", "save it as UTF-8")
    nul = content.find(b"\0")
    if content[:4] == b"\x89PNG" or 0 <= nul < 1024:
        raise FileError(path, "is not a CSV file but binary data", CHOOSE_TAKE)
    lines = tuple(content.splitlines(keepends=True))
    if nul >= 0:
        line = content.count(b"\n", 0, nul) + 1
        raise FileError(path, "is damaged (zero bytes)", "copy it from the device again", line)
    header = next((i for i, line in enumerate(lines) if line.removeprefix(_BOM).strip()), None)
    if header is None:
        raise FileError(path, "is empty", CHOOSE_TAKE)
    text = lines[header].removeprefix(_BOM)
    delimiter = max((b",", b";", b"\t"), key=text.count)
    names = tuple(plain_text(cell) for cell in _split(text.rstrip(b"\r\n"), delimiter))
    return Table(path, lines, header, names, delimiter)


def plain_text(cell: bytes) -> str:
    """A cell's text without the quotes and spaces around it."""
    return cell.decode("utf-8", "replace").strip().strip('"').strip()


def shown(text: str) -> str:
    """A text from a file as it can stand in a message: short and on one line."""
    text = "".join(c if c.isprintable() else "?" for c in text[:_LONGEST_SHOWN])
    return text if len(text) < _LONGEST_SHOWN else text[:-1] + "…"


def _split(text: bytes, delimiter: bytes) -> Cells:
    cells = text.split(delimiter)
    if b'"' not in text:
        return cells
    # A delimiter inside quotes separates nothing: join what was split there.
    groups: list[list[bytes]] = []
    inside = False
    for cell in cells:
        if inside:
            groups[-1].append(cell)
        else:
            groups.append([cell])
        inside ^= cell.count(b'"') % 2 == 1
    return [delimiter.join(group) for group in groups]


def _is_blank(cells: Cells) -> bool:
    return not any(cell.strip() for cell in cells)
