"""Rows without a face: when they are, and which of them a file with other frames gets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles, Indices, Times
from faceedit_app.core.clip import Clip, nearest_rows
from faceedit_app.formats.time_columns import text_times
from faceedit_app.formats.timecode import BadTimecode
from faceedit_app.formats.timing import BadRow, NoTimes, counted

_SAME = 1e-9  # of a gap, by which a row that is off its even place is taken to be there

_INSTANT = 1e-6  # seconds
_LEAST = 1e-3  # of the mean step, by which rows are apart if their times are trusted


@dataclass(frozen=True, eq=False)
class Faceless:
    """Rows without a face, on the clock of a clip.

    Attributes:
        rows: (L,) which of their file's rows without a face they are.
        times: (L,) seconds, in order; outside the clip if they come before or after all faces.
    """

    rows: Indices
    times: Times

    def __len__(self) -> int:
        return len(self.rows)

    def only(self, which: Bools) -> Faceless:
        """Those for which `which` (L,) is True."""
        return Faceless(self.rows[which], self.times[which])

    def between(self, clip: Clip) -> Bools:
        """(L,) which of them lie between two frames of their clip."""
        return np.asarray((self.times > clip.times[0]) & (self.times < clip.times[-1]), np.bool_)

    @property
    def leading(self) -> int:
        """How many come before the first frame."""
        return int((self.times < 0).sum())

    def at_rate(self, before: Clip, after: Clip) -> Faceless:
        """The rows that a clip at another rate gets: each is the nearest row of the file.

        Args:
            before: their clip.
            after: the same at its own even times.
        """
        if after is before or not len(self):
            return self
        rate = after.rate
        first = min(round(float(self.times[0]) * rate), 0)
        last = round(max(float(self.times[-1]), float(before.times[-1])) * rate)
        numbers = np.setdiff1d(np.arange(first, last + 1), np.rint(after.times * rate))
        times = numbers / rate
        row, frame = nearest_rows(self.times, times), nearest_rows(before.times, times)
        is_row = np.abs(self.times[row] - times) < np.abs(before.times[frame] - times) + _INSTANT
        is_row |= (times < 0) | (times > before.times[-1])
        return Faceless(self.rows[row[is_row]], times[is_row])


def find_faceless(lost: Bools, clip: Clip, told: Times | None) -> Faceless | None:
    """The rows (R,) without a face on the clip's clock; None if there are none.

    Args:
        lost: (R,) which rows have none.
        told: (R,) seconds of the rows on a clock of their own, if they have any.
    """
    if not lost.any() or len(lost) - int(lost.sum()) != len(clip):
        return None
    places, last = lost_places(lost, told), len(clip) - 1
    times = np.interp(places, np.arange(len(clip)), clip.times)
    before, after = places < 0, places > last
    times[before] = places[before] / clip.rate
    times[after] = clip.times[-1] + (places[after] - last) / clip.rate
    if told is not None and last and told[~lost][-1] > told[~lost][0]:
        frames, rows = told[~lost], told[lost]
        second = float(clip.times[-1]) / (frames[-1] - frames[0])
        if np.all(np.diff([*rows[before], frames[0]]) > 0):
            times[before] = (rows[before] - frames[0]) * second
        if np.all(np.diff([frames[-1], *rows[after]]) > 0):
            times[after] = clip.times[-1] + (rows[after] - frames[-1]) * second
    return Faceless(np.arange(len(places)), times)


def lost_places(lost: Bools, told: Times | None = None) -> Doubles:
    """(L,) where the rows (R,) without a face lie, in frames; 4.5 is between frames 4 and 5.

    Between two frames they lie where their own times say, or else evenly. Below 0 they lie before
    the first frame, and after the last one they count on.

    Args:
        lost: (R,) which rows have none.
        told: (R,) seconds of the rows on a clock of their own, if they have any.
    """
    rows, frames = np.flatnonzero(lost), np.flatnonzero(~lost)
    before = np.searchsorted(frames, rows) - 1
    counts = np.bincount(before + 1, minlength=len(frames) + 1)
    place = np.arange(len(rows)) - np.searchsorted(before, before)
    steps = counts[before + 1] + 1
    even = before + (place + 1) / steps
    first, last = before < 0, before == len(frames) - 1
    even[first] = place[first] - counts[0]
    even[last] = before[last] + place[last] + 1.0
    if told is None:
        return even
    between = ~first & ~last
    edges = frames[before[between]], frames[before[between] + 1]
    least = _LEAST * abs(told[-1] - told[0]) / len(told)
    backwards = np.concatenate([[0], np.cumsum(np.diff(told) <= least)])
    start, end = told[edges[0]], told[edges[1]]
    share = (told[rows[between]] - start) / np.where(end > start, end - start, 1.0)
    own = before[between] + share
    trusted = (backwards[edges[0]] == backwards[edges[1]]) & (np.abs(own - even[between]) > _SAME)
    even[between] = np.where(trusted, own, even[between])
    return even


def told_times(cells: Sequence[str], name: str) -> Times | None:
    """(R,) seconds of all rows by the column of the times; None if not all have a usable one.

    Args:
        cells: (R) its texts.
        name: of the column.
    """
    try:
        return text_times(cells, name).times
    except NoTimes as none:
        return none.numbers
    except (BadTimecode, BadRow):
        return None


def left_out_note(rows: Faceless | None, clip: Clip, why: str, instead: str = "") -> str:
    """What to say of rows without a face that a file does not get; "" if there are none.

    Args:
        rows: on the clock of `clip`.
        why: a file has no place for them.
        instead: what those between two frames get if they are not left out.
    """
    if rows is None or not len(rows):
        return ""
    inner = int(rows.between(clip).sum()) if instead else 0
    outer = len(rows) - inner
    parts = [f"{counted(inner, 'row')} without a face {instead}"] if inner else []
    if outer:
        parts.append(f"{counted(outer, 'row')} without a face {_are(outer)} left out")
    return f"{', '.join(parts)}: {why}"


def _are(count: int) -> str:
    return "is" if count == 1 else "are"
