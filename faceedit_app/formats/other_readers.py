"""Whether other programs read a CSV as they read what FaceEdit writes.

They are stricter than FaceEdit: they know one separator, one spelling of the names, one scale and
one meaning of the times. A take in another dialect is therefore written again for them.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS, ROTATION_INDEX
from faceedit_app.core.arrays import Doubles, Floats, Times
from faceedit_app.core.clip import Clip
from faceedit_app.core.names import canonical_channel
from faceedit_app.formats.files import BOM
from faceedit_app.formats.rotations import found_rotations

SECONDS = "time_s"  # the column of a plain CSV that scripts look for
SIXTIETHS = 60  # the base that Unreal's importer assumes
_OFF = 1e-4  # full blendshapes
_LATE = 1e-3  # seconds
_TURNED = 1e-3  # radians
_FRAME = 1.25 / SIXTIETHS  # seconds by which whole frames of a timecode may be off
_DAY = 86_400
_NUMBER = re.compile(r" *[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)? *", re.ASCII)
_TIMECODE = re.compile(r"(\d{1,2}):(\d{1,2}):(\d{1,2}):(\d{1,2}(?:\.\d+)?)", re.ASCII)


def is_plain_livelink(content: bytes, clip: Clip) -> bool:
    """Whether Unreal's importer finds a clip in a CSV.

    It wants `Timecode` and `BlendShapeCount` first, commas, no quotes, a number in every cell of
    every row, and frames that are sixtieths of a second. At a shorter row, as those of lost frames
    are, it stops. Names may be in any case.
    """
    rows = None if b'"' in content else _rows(content)
    if rows is None or len(rows) != len(clip) + 1:
        return False
    header = [name.lower() for name in rows[0]]
    times = _sixtieths([row[0] for row in rows[1:]])
    names = [name.lower() for name in ARKIT_CHANNELS]
    if header[:2] != ["timecode", "blendshapecount"] or times is None:
        return False
    others = [k for k, name in enumerate(header) if k and name not in names]
    if any(_numbers(rows, k) is None for k in others):
        return False
    if not _has_radians(rows, clip):
        return False
    late = (times - times[0] - clip.times + _DAY / 2) % _DAY - _DAY / 2
    return bool(np.abs(late).max() <= _FRAME) and _has(header, rows, names, clip.arkit_weights())


def is_plain_csv(content: bytes, clip: Clip) -> bool:
    """Whether a script finds a clip in a CSV by the names `time_s` and those of the channels.

    A channel without numbers, which FaceEdit carries, would stop it.
    """
    rows = None if content.startswith(BOM) else _rows(content)
    if rows is None or SECONDS not in rows[0] or len(rows) != len(clip) + 1:
        return False
    times = _numbers(rows, rows[0].index(SECONDS))
    if times is None or not 0 <= times[0] < _DAY:
        return False
    channels = [k for k, name in enumerate(rows[0]) if canonical_channel(name)]
    if any(_numbers(rows, k) is None for k in channels) or not _has_radians(rows, clip):
        return False
    is_timed = bool(np.abs(times - times[0] - clip.times).max() <= _LATE)
    return is_timed and _has(rows[0], rows, clip.channels, clip.weights)


def _rows(content: bytes) -> list[list[str]] | None:
    """The header and the rows of a CSV with commas; None if a cell is empty or absent."""
    try:
        text = content.decode("utf-8-sig")
        rows = [row for row in csv.reader(text.splitlines()) if row]
    except (UnicodeDecodeError, csv.Error):
        return None
    width = len(rows[0]) if rows else 0
    if len(rows) < 2 or any(len(row) != width or not all(row) for row in rows):
        return None
    return rows


def _has(header: list[str], rows: list[list[str]], names: Sequence[str], weights: Floats) -> bool:
    """Whether a table has these weights (T, K) in columns of these names."""
    if not set(names) <= set(header):
        return False
    for name, wanted in zip(names, weights.T, strict=True):
        found = _numbers(rows, header.index(name))
        if found is None or np.abs(found - wanted).max() > _OFF:
            return False
    return True


def _has_radians(rows: list[list[str]], clip: Clip) -> bool:
    """Whether the rotations of a table are those of a clip, and not in degrees."""
    if clip.rotations is None:
        return True
    for name, column in found_rotations(rows[0]).items():
        found, wanted = _numbers(rows, column), clip.rotations[:, ROTATION_INDEX[name]]
        if found is None or np.abs(found - wanted).max() > _TURNED:
            return False
    return True


def _numbers(rows: list[list[str]], column: int) -> Doubles | None:
    """(T,) the numbers in a column; None if one is none that other readers know."""
    texts = [row[column] for row in rows[1:]]
    return np.array(texts, np.float64) if all(map(_NUMBER.fullmatch, texts)) else None


def _sixtieths(texts: list[str]) -> Times | None:
    """(T,) seconds of the day of timecodes with 60 frames a second; None if a text is not one."""
    out = np.empty(len(texts))
    for row, text in enumerate(texts):
        match = _TIMECODE.fullmatch(text)
        if match is None:
            return None
        hours, minutes, seconds = int(match[1]), int(match[2]), int(match[3])
        out[row] = (hours * 60 + minutes) * 60 + seconds + float(match[4]) / SIXTIETHS
    return out
