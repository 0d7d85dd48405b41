"""Remarks about the names of channels in a file."""

from __future__ import annotations

from collections.abc import Sequence

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.names import canonical_channel, similar_channel, versions_of
from faceedit_app.formats.files import shown

_MOST_NAMES = 200  # that are compared with those of missing channels


def own_name_notes(name: str, channel: str) -> tuple[str, ...]:
    """The note about a name in a file that is none of the usual spellings of its channel."""
    if canonical_channel(name):
        return ()
    return (f'"{shown(name)}" and the like are read as {channel} and so on',)


def misspelled_notes(channels: Sequence[str], carried: Sequence[str]) -> tuple[str, ...]:
    """The note about columns whose names resemble those of channels that the file lacks.

    Args:
        channels: (K) that are read.
        carried: the names of other columns.
    """
    missing = [name for name in ARKIT_CHANNELS if name not in channels]
    others = [name for name in carried if canonical_channel(name) is None]
    found = ((name, similar_channel(name, missing)) for name in others[:_MOST_NAMES])
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
