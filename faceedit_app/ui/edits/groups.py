"""Edits that were made together, as a paste makes one for each curve: one row of the list."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from faceedit_app.editing.edits.edit import Edit

Key = tuple[str, float, float]  # name, start and end


def key_of(edit: Edit) -> Key:
    """What the edits of a group have in common."""
    return edit.name, edit.start, edit.end


def groups_of(edits: Sequence[Edit]) -> list[range]:
    """The rows of each group: neighbours with the same name and range; most have one row.

    Edits that nobody named are never grouped.
    """
    found, row = [], 0
    for key, run in groupby(edits, key_of):
        count = len(list(run))
        if key[0]:
            found.append(range(row, row + count))
        else:
            found.extend(range(one, one + 1) for one in range(row, row + count))
        row += count
    return found
