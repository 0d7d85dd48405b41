"""How a file writes its timecodes, so that others for new times look like its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from faceedit_app.core.arrays import Times
from faceedit_app.formats.timecode import parse_timecodes
from faceedit_app.formats.timecode_readings import (
    DEFAULT_BASE,
    can_drop,
    count_frames,
    dropped_numbers,
    read_stamps,
)

_NEAR = 0.02  # frames by which times may miss whole ones
_DAY = 86_400


@dataclass(frozen=True)
class TimecodeStyle:
    """`HH:MM:SS:FF` or `HH:MM:SS:FF.sss`.

    Attributes:
        base: frames that it counts in a second.
        drop: whether it is drop-frame: 0.1 % slower, and leaves out numbers at full minutes.
        separator: before the frames.
        point: before the thousandths.
        digits: after the point; 0 = none.
    """

    base: int = DEFAULT_BASE
    drop: bool = False
    separator: str = ":"
    point: str = "."
    digits: int = 3

    def fits(self, seconds: Times) -> bool:
        """Whether times (T,), seconds of the day, can be written."""
        frames = seconds * self._second
        return self.digits > 0 or bool(np.all(np.abs(frames - np.round(frames)) < _NEAR))

    def finer(self) -> TimecodeStyle:
        """The same with thousandths of a frame."""
        return replace(self, digits=3)

    def text(self, seconds: float) -> str:
        """The timecode of a time of day."""
        parts = 10**self.digits
        whole, part = divmod(round(seconds * self._second * parts), parts)
        if self.drop:
            whole = _with_dropped(whole, self.base)
        clock, frame = divmod(whole, self.base)
        clock %= _DAY
        text = f"{clock // 3600:02d}:{clock // 60 % 60:02d}:{clock % 60:02d}"
        width = len(str(self.base - 1))
        text = f"{text}{self.separator}{frame:0{width}d}"
        return f"{text}{self.point}{part:0{self.digits}d}" if self.digits else text

    @property
    def _second(self) -> float:
        """Frames in a real second."""
        return self.base / 1.001 if self.drop else float(self.base)


def style_of(texts: Sequence[str]) -> TimecodeStyle | None:
    """The style of T timecodes; None if their last fields mean something else."""
    stamps = parse_timecodes(texts)
    if len(texts) < 2:
        return None
    reading = read_stamps(stamps)
    drop = stamps.drop and can_drop(reading.base)
    second = reading.base / 1.001 if drop else float(reading.base)
    plain = count_frames(stamps, reading.base, drop)
    if reading.second != second or not np.array_equal(plain, reading.places):
        return None
    separator = ";" if stamps.drop else ":"
    point = "," if "," in texts[0] else "."
    return TimecodeStyle(reading.base, drop, separator, point, int(stamps.digits.max()))


def _with_dropped(frames: int, base: int) -> int:
    """The number of a frame in drop-frame timecode, which leaves some numbers out."""
    left_out = dropped_numbers(base)
    minute, ten = base * 60 - left_out, base * 600 - 9 * left_out
    tens, rest = divmod(frames, ten)
    minutes = max(rest - left_out, 0) // minute
    return frames + left_out * (9 * tens + minutes)
