"""Live Link Face CSV: what Epic's iPhone application, and tools that imitate it, record.

Each row is a timecode, the number of values that follow, the ARKit blendshapes, and whatever else
(head and eye rotations, emotions). Where the face was lost the row ends after a count of 0.
"""

from __future__ import annotations

from pathlib import Path

from faceedit_app.core.names import canonical_channel
from faceedit_app.formats.csv_table import first_rows, plain_text, read_table
from faceedit_app.formats.csv_take import csv_take
from faceedit_app.formats.take import Take
from faceedit_app.formats.timecode import is_clock, is_timecode

FORMAT = "Live Link Face CSV"


def sniff(content: bytes) -> float:
    """How sure it is that this is a Live Link Face CSV.

    Audio2Face calls its seconds `timeCode`, so that the name alone does not tell.
    """
    names, cells = first_rows(content)
    lower = [name.lower() for name in names]
    if "timecode" not in lower or not any(map(canonical_channel, names)):
        return 0.0
    place = lower.index("timecode")
    text = plain_text(cells[place]) if place < len(cells) else ""
    return 0.9 if is_timecode(text) or is_clock(text) else 0.0


def read(path: Path, content: bytes, fps: float | None) -> Take:
    """Open a Live Link Face CSV.

    Raises:
        RateNeeded: its timecodes are of no use, and there is no `fps`.
        FileError: it has no channels, or is damaged.
    """
    return csv_take(read_table(path, content), fps, FORMAT)
