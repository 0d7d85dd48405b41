"""Group the weights of a file that has an entry for each weight into frames."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Key = tuple[str, ...]
"""What the weights of one frame share: the texts of its times."""


class Repeated(ValueError):
    """An entry with a name that its frame already has.

    Args:
        entry: its index.
    """

    def __init__(self, entry: int):
        super().__init__(entry)
        self.entry = entry


def group(
    names: Sequence[str], keys: Sequence[Key]
) -> tuple[list[Key], list[str], NDArray[np.int64]]:
    """The frames of N weights.

    Entries with the same key are one frame; if the keys are empty, each frame ends where its
    names repeat. Frames are in the order of the file, or, if it is sorted by name, in that of
    their times.

    Returns:
        (T) the keys of the frames, (K) the names, and (T, K) the entry of each weight; -1 if the
        frame does not have it.

    Raises:
        Repeated: a frame has a name twice.
    """
    columns = {name: k for k, name in enumerate(dict.fromkeys(names))}
    if not any(keys):
        keys = _turns(names)
    frames = {key: t for t, key in enumerate(_in_order(keys))}
    entries = np.full((len(frames), len(columns)), -1, np.int64)
    for n, (name, key) in enumerate(zip(names, keys, strict=True)):
        place = frames[key], columns[name]
        if entries[place] >= 0:
            raise Repeated(n)
        entries[place] = n
    return list(frames), list(columns), entries


def _turns(names: Sequence[str]) -> list[Key]:
    """Per entry, the how manieth of its name it is."""
    seen: dict[str, int] = {}
    keys: list[Key] = []
    for name in names:
        seen[name] = seen.get(name, -1) + 1
        keys.append((str(seen[name]),))
    return keys


def _in_order(keys: Sequence[Key]) -> list[Key]:
    """Each key once; by its numbers if those of a frame do not stand together."""
    found = list(dict.fromkeys(keys))
    changes = 1 + sum(1 for key, before in zip(keys[1:], keys, strict=False) if key != before)
    if changes == len(found):
        return found
    try:
        return sorted(found, key=lambda key: [float(text) for text in key])
    except ValueError:
        return found
