"""CSV with ARKit channels, with any time columns, spelling of names and scale."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from faceedit_app.core.arrays import Floats
from faceedit_app.core.clip import Clip
from faceedit_app.core.names import canonical_channel
from faceedit_app.formats.csv_source import Columns, CsvSource, find_channels
from faceedit_app.formats.csv_table import Rows, Table, first_rows, read_table
from faceedit_app.formats.files import LONGEST_NAME, shown
from faceedit_app.formats.foreign import is_transposed
from faceedit_app.formats.json_text import looks_like_json
from faceedit_app.formats.take import LostRows, Recording, Take, finish_take
from faceedit_app.formats.time_columns import TRACKED, RowTimes, read_times, time_columns
from faceedit_app.formats.timing import NoTimes

_COUNTS = ("blendshapecount", "numproperties")
CONFIDENCE = "confidence"
# Live Link Face's rotations, which an export at another rate must not lose.
ROTATIONS = tuple(
    part + axis for part in ("head", "lefteye", "righteye") for axis in ("yaw", "pitch", "roll")
)
_NAMES = {
    "timecode": "CSV with timecodes",
    "clock": "CSV with times",
    "date": "CSV with times",
    "number": "CSV with times",
    "seconds": "CSV with times in seconds",
    "frames": "CSV with frame numbers",
    "": "CSV without times",
}


def sniff(content: bytes) -> float:
    """How likely, 0..1, this is a CSV file with ARKit channels."""
    if looks_like_json(content) or content.startswith(b"#usda") or is_transposed(content):
        return 0.0
    return 0.5 if any(map(canonical_channel, first_rows(content)[0])) else 0.0


def read(path: Path, content: bytes, fps: float | None) -> Take:
    """Open a CSV with ARKit channels.

    Raises:
        RateNeeded: its times are unusable, and `fps` is None.
        FileError: it has no channels, or is damaged.
    """
    return csv_take(read_table(path, content), fps)


def write(clip: Clip) -> bytes:
    """A clip as a plain CSV: seconds in `time_s`, its channels under ARKit's names; confidence."""
    lines = [",".join(["time_s", *clip.channels])]
    for time, row in zip(clip.times.tolist(), clip.weights.tolist(), strict=True):
        lines.append(",".join([f"{time:.6f}", *(f"{value:.6f}" for value in row)]))
    if clip.confidence is not None:
        # A confidence of 0 would mean that the face was lost.
        cells = (f"{max(v, 1e-3):.3f}" if v > 0 else "" for v in clip.confidence.tolist())
        sure = [CONFIDENCE, *cells]
        lines = [f"{line},{cell}" for line, cell in zip(lines, sure, strict=True)]
    return ("\n".join(lines) + "\n").encode()


@dataclass(frozen=True)
class _Places:
    """Where a table has the columns that are no channels; None, or nothing, if it has none.

    Attributes:
        clocks: columns of times.
        turns: those of `ROTATIONS`, in that order.
        count: what says whether a row has a face.
        said: `count`, if it is the number of blendshapes.
        confidence: how sure the tracker was.
    """

    clocks: list[int]
    turns: list[int]
    count: int | None
    said: int | None
    confidence: int | None

    @classmethod
    def of(cls, table: Table, channels: Columns) -> _Places:
        """Find them by their names."""
        lower = [column.lower() for column in table.names]
        letters = [re.sub(r"[\W_]", "", name) for name in lower]
        count = next((letters.index(n) for n in (*_COUNTS, *TRACKED) if n in letters), None)
        turns = [lower.index(name) for name in ROTATIONS if name in lower]
        return cls(
            clocks=[k for k in time_columns(table.names) if k not in channels.indices],
            turns=turns if len(turns) == len(ROTATIONS) else [],
            count=count,
            said=count if count is not None and letters[count] in _COUNTS else None,
            confidence=letters.index(CONFIDENCE) if CONFIDENCE in letters else None,
        )

    @property
    def texts(self) -> list[int]:
        """The columns that are read as texts, in the order in which they are read."""
        last = [place for place in (self.confidence, self.count) if place is not None]
        return [*self.clocks, *self.turns, *last]


def csv_take(
    table: Table,
    fps: float | None,
    name: str = "",
    naming: Callable[[str], str | None] = canonical_channel,
) -> Take:
    """Make the take of a table.

    Args:
        fps: the frame rate, if the user gave one.
        name: the format's name; "" = named after the kind of its times.
        naming: the channel that a column's name means, or None.

    Raises:
        RateNeeded: its times are unusable, and `fps` is None.
        FileError: it has no channels, or is damaged.
    """
    found = find_channels(table, naming)
    places = _Places.of(table, found)
    rows = table.read(places.texts, found.indices, places.count)
    empty = np.all(np.isnan(rows.numbers), axis=0)
    columns = found.without(empty.tolist())
    times = _times(table, places.clocks, rows)
    used = {times.column, places.said, *columns.indices}
    carried = [name for k, name in enumerate(table.names) if k not in used]
    recording = Recording(
        path=table.path,
        format=name or _NAMES[times.kind],
        channels=columns.channels,
        values=rows.numbers[:, ~empty],
        timing=times.timing,
        lost=rows.lost,
        timecodes=_timecodes(places.clocks, rows, times),
        carried=tuple(shown(name, LONGEST_NAME) or "(unnamed)" for name in carried),
        notes=(*_empty_notes(found, columns), *_count_notes(table, rows, places.said)),
        rotations=_rotations(rows, len(places.clocks)) if places.turns else None,
        confidence=None
        if places.confidence is None
        else _confidence(rows, len(places.clocks) + len(places.turns)),
    )
    source = partial(
        CsvSource,
        table,
        tuple(rows.lines),
        columns.indices,
        turns=tuple(places.turns),
        lost=rows.lost_lines,
        count=places.count,
        confidence=places.confidence,
    )
    take = finish_take(recording, fps, source, lambda frame, _: rows.lines[frame] + 1)
    if not rows.lost_lines:
        return take
    return replace(take, lost_rows=LostRows(_positions(rows)))


def _positions(rows: Rows) -> tuple[float, ...]:
    """Where the rows `lost_lines` lie, in frames: evenly between the frames around them."""
    lost, before = np.array(rows.lost_lines), np.searchsorted(rows.lines, rows.lost_lines) - 1
    counts = np.bincount(before)
    place = np.arange(len(lost)) - np.searchsorted(before, before)
    return tuple((before + (place + 1) / (counts[before] + 1)).tolist())


def _times(table: Table, clocks: list[int], rows: Rows) -> RowTimes:
    frames = np.flatnonzero(~rows.lost).tolist()
    cells = [[rows.texts[row][k] for row in frames] for k in range(len(clocks))]
    if not frames:
        return RowTimes(NoTimes("has no row with a tracked face"))
    return read_times(table, clocks, cells, rows.lines)


def _timecodes(clocks: list[int], rows: Rows, times: RowTimes) -> tuple[str, ...] | None:
    if times.kind != "timecode" or times.column is None:
        return None
    place = clocks.index(times.column)
    return tuple(rows.texts[row][place] for row in np.flatnonzero(~rows.lost).tolist())


def _rotations(rows: Rows, start: int) -> Floats | None:
    """(T, 9) of the text columns from `start`; None if a cell is not a number."""
    frames = np.flatnonzero(~rows.lost).tolist()
    try:
        cells = [rows.texts[row][start : start + len(ROTATIONS)] for row in frames]
        found = np.array(cells, np.float64).astype(np.float32)
    except ValueError:
        return None
    return found if np.isfinite(found).all() else None


def _confidence(rows: Rows, place: int) -> Floats | None:
    """(T,) of a text column; None if it holds something else than numbers from 0 to 1."""
    frames = np.flatnonzero(~rows.lost).tolist()
    try:
        found = np.array([float(rows.texts[row][place] or 0) for row in frames], np.float64)
    except ValueError:
        return None
    return found.astype(np.float32) if ((found >= 0.0) & (found <= 1.0)).all() else None


def _empty_notes(found: Columns, filled: Columns) -> tuple[str, ...]:
    empty = [channel for channel in found.channels if channel not in filled.channels]
    if not empty or not filled.channels:
        return ()
    return (f"no row has a number for {', '.join(empty)}: carried",)


def _count_notes(table: Table, rows: Rows, count: int | None) -> tuple[str, ...]:
    if count is None:
        return ()
    # The tracker's confidence stands after what is counted.
    values = len(table.names) - 2 - (table.names[-1].lower() == CONFIDENCE)
    frames = np.flatnonzero(~rows.lost).tolist()
    said = {rows.texts[row][-1].removesuffix(".0") for row in frames}
    wrong = [shown(text) for text in sorted(said - {str(values)})]
    if not wrong:
        return ()
    return (f"{table.names[count]} says {', '.join(wrong[:3])}, the header has {values} values",)
