"""The rotations of head and eyes in a CSV table, and what it says about their unit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from faceedit_app.formats.csv_table import Table, TableRows
from faceedit_app.formats.rotations import Turned, read_rotations, unit_in_lines, unit_named
from faceedit_app.formats.table_ends import lines_before


def turned_in(
    table: Table, turns: Mapping[str, int], cells: Sequence[Sequence[str]], rows: TableRows
) -> Turned:
    """The rotations of a table's T frames; none if a cell is not a number.

    Their unit may stand in a row of units, or in a line before the header.

    Args:
        turns: the N columns of rotations by their names, in the order of `ROTATIONS`.
        cells: (N, T) the texts in these columns.
    """
    try:
        values = np.array(cells, np.float64).T
    except ValueError:
        return Turned()
    own = [table.names[column] for column in turns.values()]
    stated = unit_in_lines(lines_before(table))
    said = [unit_named(rows.units.get(column, "")) or stated for column in turns.values()]
    return read_rotations(values, tuple(turns), own, lambda row, _: rows.lines[row] + 1, said)
