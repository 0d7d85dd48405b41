"""Live Link Face CSV, recorded by Epic's iPhone application and tools that imitate it.

Each row has a timecode, the number of values that follow, the ARKit blendshapes, and other values
(head and eye rotations, emotions). If the face was lost, the row ends after a count of 0. A take
that was tracked in a film has one more column, which is not counted: the tracker's confidence.
Unreal's importer takes any column as a property, and wants a number in each.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.arrays import Floats, Times
from faceedit_app.core.clip import Clip
from faceedit_app.core.names import canonical_channel
from faceedit_app.formats.csv_table import HEAD, first_rows, plain_text, read_table
from faceedit_app.formats.csv_take import csv_take
from faceedit_app.formats.json_text import looks_like_json
from faceedit_app.formats.take import Take
from faceedit_app.formats.timecode import (
    is_clock,
    is_timecode,
    start_of_day,
    write_timecode,
)
from faceedit_app.formats.timecode_readings import DEFAULT_BASE
from faceedit_app.formats.timecode_style import style_of

FORMAT = "Live Link Face CSV"
# The application writes right before left in two places.
_SWAPPED = {"jawLeft": "jawRight", "mouthLeft": "mouthRight"}
_SWAPPED |= {right: left for left, right in _SWAPPED.items()}
_ORDER = [_SWAPPED.get(name, name) for name in ARKIT_CHANNELS]
_PLACES = [ARKIT_INDEX[name] for name in _ORDER]
_ROTATIONS = [
    part + axis for part in ("Head", "LeftEye", "RightEye") for axis in ("Yaw", "Pitch", "Roll")
]


def sniff(content: bytes) -> float:
    """How likely, 0..1, this is a Live Link Face CSV.

    The column name alone is not enough: Audio2Face calls its seconds `timeCode`.
    """
    if looks_like_json(content) or b"timecode" not in content[:HEAD].lower():  # quick to tell
        return 0.0
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
    """A clip as the application writes it: all 52 shapes, 9 rotations (or 0), timecodes.

    The timecode begins at the clip's, if it has one, else at 0. Lost frames are left out, as the
    application does.
    """
    still = np.zeros((len(clip), len(_ROTATIONS)), np.float32)
    return write_with(clip, still if clip.rotations is None else clip.rotations)


def write_with(clip: Clip, rotations: Floats, lost: Times | None = None) -> bytes:
    """A clip with rotations, and with rows for the frames in which the face was lost.

    Args:
        clip: as for `write`; with its confidence, if it has one.
        rotations: (T, 9) radians: yaw, pitch and roll of the head, the left and the right eye.
        lost: (L,) times of lost frames, seconds on the clip's clock.
    """
    begin = start_of_day(clip.timecodes) if clip.timecodes else 0.0
    times = _told_apart(begin + clip.times + _measured(clip.times))
    frames = zip(times.tolist(), clip.arkit_weights(), rotations, strict=True)
    lines = [(time, frame_line(time, row, turns)) for time, row, turns in frames]
    header = header_line()
    if clip.confidence is not None:
        header = f"{header[:-1]},Confidence\n"
        lines = [
            (time, f"{line[:-1]},{sure:.3f}\n")
            for (time, line), sure in zip(lines, clip.confidence.tolist(), strict=True)
        ]
    for time in [] if lost is None else (begin + lost).tolist():
        lines.append((time, f"{write_timecode(time, DEFAULT_BASE)},0\n"))
    return "".join([header, *(line for _, line in sorted(lines))]).encode()


def _told_apart(times: Times) -> Times:
    """(T,) the times, which other readers must not take for something else than a timecode.

    At 59.94 fps, the thousandths of a frame grow by one a row. From 0 on they would be read as the
    frame's number, which other tools write there; a thousandth more in the second row prevents it.
    """
    texts = [write_timecode(time, DEFAULT_BASE) for time in times.tolist()]
    if len(times) < 2 or style_of(texts) is not None:
        return times
    told = times.copy()
    told[1] += 1e-3 / DEFAULT_BASE
    return told


def _measured(times: Times) -> Times:
    """(T,) seconds to add to times that are uneven, but whole frames of the timecode.

    They would be read as those of a clock that was rounded to frames, and be made even. A
    thousandth of a frame in every second row says that they were measured.
    """
    frames = np.diff(times) * DEFAULT_BASE
    if not len(frames) or not np.allclose(frames, np.round(frames), rtol=0, atol=1e-3):
        return np.zeros(len(times))
    steps = frames / np.median(frames)
    is_even = np.allclose(steps, np.round(steps), rtol=0, atol=1e-2)
    thousandth = 0.0 if is_even else 1e-3 / DEFAULT_BASE
    return np.where(np.arange(len(times)) % 2 == 1, thousandth, 0.0)


def header_line() -> str:
    """The first line, with its end."""
    names = [name[0].upper() + name[1:] for name in _ORDER]
    return ",".join(["Timecode", "BlendshapeCount", *names, *_ROTATIONS]) + "\n"


def frame_line(second: float, weights: Floats, rotations: Floats | None = None) -> str:
    """The line of a frame, with its end.

    Args:
        second: of the day.
        weights: (52,) in ARKit order.
        rotations: (9,) yaw, pitch and roll of the head, the left and the right eye, in radians;
            None = 0.
    """
    turns = np.zeros(len(_ROTATIONS)) if rotations is None else rotations
    cells = [*weights[_PLACES].tolist(), *turns.tolist()]
    numbers = ",".join(f"{value:.10f}" for value in cells)
    return f"{write_timecode(second, DEFAULT_BASE)},{len(cells)},{numbers}\n"
