"""Rows are split as by Python's csv module, or the file is refused."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from faceedit_app.core.errors import FileError
from faceedit_app.formats.csv_table import plain_text, read_table
from faceedit_app.formats.opening import open_take

TEXTS = st.text(alphabet='"",,,;\t\n\r a01.e-\'', min_size=1, max_size=40)


def bare(cell: str) -> str:
    """A cell without quotes and spaces around it."""
    return cell.strip(' \t"')


def number(text: str) -> float | None:
    """The number that a text is, or None."""
    try:
        return float(text)
    except ValueError:
        return None


@given(TEXTS)
@example('"a","b"\n"1""2",3\n')
@example('a,"b,c"\n"1"2,3\n')
@example('a,b\n 1 ,"2"\n')
@example('a,b\n""1"",2\n')
@example('"a\nb",c\n1,2\n')
@example('a,b\r1,"2\r3"\r')
def test_cells_are_those_of_pythons_csv_module_or_the_file_is_refused(text: str) -> None:
    try:
        table = read_table(Path("take.csv"), text.encode())
        delimiter = table.delimiter.decode()
        cells = [table.cells(table.header), *(row for _, row in table.rows())]
    except FileError:
        return
    ours = [[plain_text(cell) for cell in row] for row in cells]
    theirs = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter)
    for our_row, row in zip(
        (row for row in ours if any(map(bare, row))),
        (row for row in theirs if any(map(bare, row))),
        strict=True,
    ):
        assert [*map(bare, our_row)] == [*map(bare, row)]
        for our_cell, cell in zip(our_row, row, strict=True):
            # Quotes after a space count as quotes, too.
            if number(our_cell) is not None:
                assert number(our_cell) in (number(cell), number(plain_text(cell.encode())))


@pytest.mark.parametrize("cell", ['"0.5""', '"0""5"', '0"5', '"0.5"x', '""0.5""'])
def test_a_number_with_stray_quotes_is_refused(cell: str, tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    path.write_text(f"time_s,jawOpen,note\n0,0.1,a\n0.033,{cell},b\n0.066,0.2,c\n")
    with pytest.raises(FileError, match="line 3"):
        open_take(path)
