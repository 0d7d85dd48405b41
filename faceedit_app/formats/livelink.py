"""Live Link Face CSV: what Epic's iPhone application, and tools that imitate it, record.

Each row is a timecode, the number of values that follow, the ARKit blendshapes, and whatever else
(head and eye rotations, emotions). Where the face was lost the row ends after a count of 0.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from faceedit_app.core.clip import Clip
from faceedit_app.formats.csv_source import CsvSource, find_channels
from faceedit_app.formats.csv_table import Cells, Rows, Table, plain_text, read_table, shown
from faceedit_app.formats.take import Take
from faceedit_app.formats.timecode import BadTimecode, Timing, derive_timing
from faceedit_app.formats.timing import counted, find_gaps, gap_notes

FORMAT = "Live Link Face CSV"
TIMECODE = "timecode"
_COUNT = "blendshapecount"


def read_livelink(path: Path | str) -> Take:
    """Open a Live Link Face CSV.

    Raises:
        FileError: it is none, or damaged.
    """
    return livelink_take(read_table(path))


def livelink_take(table: Table) -> Take:
    """The take in a table whose times are timecodes; see `read_livelink`."""
    columns = find_channels(table)
    lower = [name.lower() for name in table.names]
    if TIMECODE not in lower:
        raise table.error('has no column "Timecode"', "export it again with times", table.header)
    timecode = lower.index(TIMECODE)
    count = lower.index(_COUNT) if _COUNT in lower else None
    texts = (timecode,) if count is None else (timecode, count)

    def is_untracked(cells: Cells) -> bool:
        if count is None or timecode >= len(cells) or count >= len(cells):
            return False
        # Spreadsheets fill such rows up with empty cells.
        values = sum(1 for cell in cells if plain_text(cell))
        return values == 2 and _whole(plain_text(cells[count])) == "0"

    rows = table.read(texts, columns.indices, is_untracked)
    if not rows.lines:
        raise table.error("no row has a tracked face", "record the take again")
    timing = _timing(table, rows)
    frames = np.flatnonzero(rows.tracked)
    times = timing.times[frames] - timing.times[frames[0]]
    gaps = find_gaps(times, timing.rate)
    clip = Clip(
        weights=rows.numbers.astype(np.float32),
        channels=columns.channels,
        times=times,
        rate=timing.rate,
        gaps=gaps,
        timecodes=tuple(rows.texts[i][0] for i in frames),
    )
    carried = tuple(table.names[k] or "(unnamed)" for k in columns.others if k not in texts)
    notes = (
        *timing.notes,
        *gap_notes(gaps),
        *_untracked_notes(rows),
        *(() if count is None else _count_notes(table, rows, count)),
    )
    source = CsvSource(table, tuple(rows.lines), columns.indices)
    return Take(table.path, FORMAT, clip, carried, notes, source)


def _timing(table: Table, rows: Rows) -> Timing:
    try:
        return derive_timing([texts[0] for texts in rows.texts])
    except BadTimecode as bad:
        raise table.error(
            f'"{shown(bad.text)}" is not a timecode (HH:MM:SS:FF)',
            "correct it or delete the line",
            rows.number_of_line[bad.row] - 1,
        ) from None


def _untracked_notes(rows: Rows) -> tuple[str, ...]:
    lost = ~rows.tracked
    if not lost.any():
        return ()
    places = int((lost & ~np.concatenate([[False], lost[:-1]])).sum())
    what, where = counted(int(lost.sum()), "row"), counted(places, "place")
    return (f"the face was lost in {what} at {where}: no frames there, the rows are kept",)


def _count_notes(table: Table, rows: Rows, count: int) -> tuple[str, ...]:
    values = len(table.names) - 2
    said = {_whole(texts[1]) for texts, full in zip(rows.texts, rows.tracked, strict=True) if full}
    wrong = [shown(text) for text in sorted(said - {str(values)})]
    if not wrong:
        return ()
    return (f"{table.names[count]} says {', '.join(wrong[:3])}, the header has {values} values",)


def _whole(text: str) -> str:
    """A count, which some tools write as `61.0`."""
    return text.removesuffix(".0")
