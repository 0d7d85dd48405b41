"""What stands before a table's header, and at its end without a column."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from faceedit_app.formats.csv_table import Table
from faceedit_app.formats.weights import says_percent

_LONGEST = 400  # characters of a line of text


def without_nameless_end(table: Table) -> Table:
    """The table without names that are empty, at the end of its header, and have no cells below.

    A comma at the end of the header alone makes one.
    """
    named = len(table.names)
    while named and not table.names[named - 1]:
        named -= 1
    if named == len(table.names):
        return table
    longest = max((len(cells) for _, cells in table.rows()), default=0)
    return replace(table, names=table.names[: max(named, longest)])


def lines_before(table: Table) -> Iterator[str]:
    """The lines before a table's header, such as comments, as text."""
    return (line.decode("utf-8", "replace") for line in table.lines[: max(table.header, 0)])


def percent_before(table: Table) -> bool:
    """Whether a comment, or another line before the header, says that the weights are percent."""
    return any(says_percent(line) for line in lines_before(table) if len(line) <= _LONGEST)
