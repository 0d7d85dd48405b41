"""Live Link Face CSV, recorded by Epic's iPhone application and tools that imitate it.

Each row has a timecode, the number of values that follow, the ARKit blendshapes, and other values
(head and eye rotations, emotions). If the face was lost, the row ends after a count of 0.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.arrays import Doubles, Times
from faceedit_app.core.clip import Clip
from faceedit_app.core.names import canonical_channel
from faceedit_app.formats.csv_table import first_rows, plain_text, read_table
from faceedit_app.formats.csv_take import csv_take
from faceedit_app.formats.take import Take
from faceedit_app.formats.timecode import (
    is_clock,
    is_timecode,
    start_of_day,
    write_timecode,
)
from faceedit_app.formats.timecode_readings import DEFAULT_BASE

FORMAT = "Live Link Face CSV"
# The application writes right before left in two places.
_SWAPPED = {"jawLeft": "jawRight", "mouthLeft": "mouthRight"}
_SWAPPED |= {right: left for left, right in _SWAPPED.items()}
_ORDER = [_SWAPPED.get(name, name) for name in ARKIT_CHANNELS]
_ROTATIONS = [
    part + axis for part in ("Head", "LeftEye", "RightEye") for axis in ("Yaw", "Pitch", "Roll")
]


def sniff(content: bytes) -> float:
    """How likely, 0..1, this is a Live Link Face CSV.

    The column name alone is not enough: Audio2Face calls its seconds `timeCode`.
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
        RateNeeded: its timecodes are unusable, and `fps` is None.
        FileError: it has no channels, or is damaged.
    """
    return csv_take(read_table(path, content), fps, FORMAT)


def write(clip: Clip) -> bytes:
    """A clip as the application writes it: all 52 shapes, 9 rotations of 0, timecodes.

    The timecode begins at the clip's, if it has one, else at 0. Lost frames are left out, as the
    application does.
    """
    return write_with(clip, np.zeros((len(clip), len(_ROTATIONS))))


def write_with(clip: Clip, rotations: Doubles, lost: Times | None = None) -> bytes:
    """A clip with rotations, and with rows for the frames in which the face was lost.

    Args:
        clip: as for `write`.
        rotations: (T, 9) radians: yaw, pitch and roll of the head, the left and the right eye.
        lost: (L,) times of lost frames, seconds on the clip's clock.
    """
    names = [name[0].upper() + name[1:] for name in _ORDER]
    header = ",".join(["Timecode", "BlendshapeCount", *names, *_ROTATIONS])
    count = len(names) + len(_ROTATIONS)
    weights = clip.arkit_weights()[:, [ARKIT_INDEX[name] for name in _ORDER]]
    begin = start_of_day(clip.timecodes) if clip.timecodes else 0.0
    rows = []
    for time, values in zip(
        clip.times.tolist(), np.concatenate([weights, rotations], axis=1).tolist(), strict=True
    ):
        rows.append((time, ",".join([str(count), *(f"{value:.10f}" for value in values)])))
    rows += [(time, "0") for time in ([] if lost is None else lost.tolist())]
    lines = [f"{write_timecode(begin + time, DEFAULT_BASE)},{row}" for time, row in sorted(rows)]
    return ("\n".join([header, *lines]) + "\n").encode()
