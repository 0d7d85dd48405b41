"""The rows of a take that have a time: its frames, and in its gaps those without a face."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Indices, Times
from faceedit_app.core.clip import Clip, nearest
from faceedit_app.formats.take import LostRows


@dataclass(frozen=True, eq=False)
class TimedRows:
    """The rows at which times are shown and typed, in order of time.

    Attributes:
        clip: the take's frames.
        times: (N,) seconds of the rows.
        frames: (N,) the frame that a row is; for a row without a face, the one before it.
        past: (N,) 0 for a frame; the n-th row without a face after a frame has n.
        timecodes: N texts of the file, "" for a row that has none; None if the take has none.
    """

    clip: Clip
    times: Times
    frames: Indices
    past: Indices
    timecodes: tuple[str, ...] | None

    @classmethod
    def of(cls, clip: Clip, lost: LostRows | None = None) -> TimedRows:
        """The rows of a take.

        Args:
            lost: those without a face, if it has any.
        """
        frames = np.arange(len(clip))
        codes = clip.timecodes or None
        if lost is None or not lost.positions:
            return cls(clip, clip.times, frames, np.zeros_like(frames), codes)
        places = np.concatenate([frames, lost.positions])
        order = np.argsort(places, kind="stable")
        before = np.floor(places[order]).astype(np.intp)
        times: Times = np.concatenate([clip.times, lost.times(clip)])[order]
        if codes is not None:
            both = (*codes, *(lost.timecodes or ("",) * len(lost.positions)))
            codes = tuple(both[row] for row in order.tolist())
        return cls(clip, times, before, np.arange(len(before)) - _first(before), codes)

    def __len__(self) -> int:
        return len(self.times)

    def at(self, seconds: float) -> int:
        """The row nearest to a time."""
        return nearest(self.times, seconds)

    def of_frame(self, frame: int) -> int:
        """The row of a frame."""
        return int(np.searchsorted(self.frames, frame))

    def number(self, row: int) -> str:
        """The number of a frame, from 1, such as `150`; `150+4` is the fourth row after it."""
        frame, past = int(self.frames[row]) + 1, int(self.past[row])
        return f"{frame}+{past}" if past else str(frame)

    def timecode(self, row: int) -> str:
        """The timecode of a row without the thousandths of a frame, such as `12:00:02:30`.

        Only for a take that has timecodes. A row without its own counts on from the frame's.
        """
        assert self.timecodes is not None
        own = self.timecodes[row]
        if own:
            return whole_timecode(own)
        first = self.timecodes[self.of_frame(int(self.frames[row]))]
        return f"{whole_timecode(first)}+{self.past[row]}"


def whole_timecode(text: str) -> str:
    """A timecode as people know it, `12:00:02:30`, without the thousandths of a frame."""
    return text.replace(",", ".").partition(".")[0]


def _first(frames: Indices) -> Indices:
    """(N,) the first row with the same frame (N,), which does not decrease."""
    return np.asarray(np.searchsorted(frames, frames), np.intp)
