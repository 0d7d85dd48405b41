"""Open any take, whatever its format, and export it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from faceedit_app.core.arrays import Floats
from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.errors import FileError
from faceedit_app.formats import livelink, plain_csv
from faceedit_app.formats.csv_source import find_channels
from faceedit_app.formats.csv_table import Table, plain_text, read_table
from faceedit_app.formats.take import Take


def open_take(path: Path | str) -> Take:
    """Open a recorded performance; the format is told by the content, not by the name.

    Raises:
        FileError: it is no take, or a damaged one.
    """
    table = read_table(path)
    find_channels(table)  # first, so that a foreign CSV is told that and not about its times
    return livelink.livelink_take(table) if _has_timecode(table) else plain_csv.plain_take(table)


def write_take(path: Path | str, take: Take, weights: Floats) -> None:
    """Export a take with other weights (T, K), in the format of its source.

    The file is replaced as a whole, so exporting over the source itself is safe.

    Raises:
        FileError: the file cannot be written, or a weight is not a finite number.
    """
    if weights.shape != take.clip.weights.shape:
        raise ValueError(f"weights {weights.shape} for a clip {take.clip.weights.shape}")
    wrong = np.argwhere(~np.isfinite(weights))
    if len(wrong):
        frame, channel = int(wrong[0, 0]), take.clip.channels[int(wrong[0, 1])]
        raise FileError(
            path,
            f"was not written: {channel} at frame {frame} is not a number",
            "undo the last edit and export again",
        )
    write_atomically(path, take.source.encode(take.clip.weights, weights.astype(np.float32)))


def _has_timecode(table: Table) -> bool:
    """Audio2Face calls its seconds `timeCode`, so the name alone does not tell."""
    lower = [name.lower() for name in table.names]
    if livelink.TIMECODE not in lower:
        return False
    cells, column = table.first_row(), lower.index(livelink.TIMECODE)
    try:
        float(plain_text(cells[column]) if column < len(cells) else "")
    except ValueError:
        return True
    return False
