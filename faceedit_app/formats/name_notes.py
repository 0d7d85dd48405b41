"""Remarks about the names of channels in a file, and about columns without a name or a number."""

from __future__ import annotations

from collections.abc import Sequence

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.names import canonical_channel, similar_channel, versions_of
from faceedit_app.formats.csv_table import Table, TableRows
from faceedit_app.formats.files import shown
from faceedit_app.formats.numbers import is_number

_MOST_NAMES = 200  # that are compared with those of missing channels


def own_name_notes(name: str, channel: str) -> tuple[str, ...]:
    """The note about a name in a file that is none of the usual spellings of its channel."""
    if canonical_channel(name):
        return ()
    return (f'"{shown(name)}" and the like are read as {channel} and so on',)


def empty_notes(found: Sequence[str], filled: Sequence[str]) -> tuple[str, ...]:
    """The note about channels without a number in any row.

    Args:
        found: all channels.
        filled: those that have numbers.
    """
    empty = [channel for channel in found if channel not in filled]
    if not empty or not filled:
        return ()
    return (f"no row has a number for {', '.join(empty)}: carried",)


def nameless_notes(table: Table, rows: TableRows, columns: Sequence[int]) -> tuple[str, ...]:
    """The note about columns of numbers without a name; one alone may be the number of the row.

    Args:
        columns: those without a name.
    """
    first = table.cells(rows.lines[0]) if rows.lines else []
    filled = [k for k in columns if k < len(first) and is_number(table.text(first[k]))]
    if len(filled) < 2:
        return ()
    return (f"{len(filled)} columns of numbers have no name: carried",)


def misspelled_notes(channels: Sequence[str], carried: Sequence[str]) -> tuple[str, ...]:
    """The note about columns whose names resemble or extend those of channels that are missing.

    Args:
        channels: (K) that are read.
        carried: the names of other columns.
    """
    missing = [name for name in ARKIT_CHANNELS if name not in channels]
    others = [name for name in carried if canonical_channel(name) is None]
    longer = {name: one for by in versions_of(others).values() for name, one in by.items()}
    found = (
        (name, longer[name] if longer.get(name) in missing else similar_channel(name, missing))
        for name in others[:_MOST_NAMES]
    )
    likely = [f'"{shown(name)}" ({meant})' for name, meant in found if meant is not None]
    if not likely:
        return ()
    more = f" and {len(likely) - 3} more" if len(likely) > 3 else ""
    listed = ", ".join(likely[:3])
    return (f"carried, although a channel may be meant: {listed}{more}",)


def version_notes(
    channels: Sequence[str], own: Sequence[str], carried: Sequence[str]
) -> tuple[str, ...]:
    """The note about columns that have other values of channels, such as raw ones.

    Args:
        channels: (K) that are read.
        own: (K) their names in the file; empty = the same.
        carried: the names of other columns.
    """
    named = dict(zip(channels, own or channels, strict=True))
    found = (by.items() for by in versions_of(carried).values())
    others = [(name, named[channel]) for by in found for name, channel in by if channel in named]
    if len(others) < 2:
        return ()
    name, read = map(shown, others[0])
    return (f'"{name}" and {len(others) - 1} more are carried: "{read}" and the like are read',)
