"""Time as people read it: seconds, frames, or the recording's timecode, as they choose."""

from __future__ import annotations

from enum import StrEnum

from PySide6.QtCore import QObject, Signal

from faceedit_app.core.clip import Clip
from faceedit_app.formats.timing import format_time


class Unit(StrEnum):
    """How times are shown."""

    SECONDS = "seconds"
    FRAMES = "frames"
    TIMECODE = "timecode"


class Clock(QObject):
    """The unit that times are shown in.

    Signals:
        changed(): it is another one.
    """

    changed = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.unit = Unit.SECONDS

    def choose(self, unit: Unit) -> None:
        """Show times in another unit."""
        if unit != self.unit:
            self.unit = unit
            self.changed.emit()


def label(clip: Clip, seconds: float, unit: Unit) -> str:
    """What stands at a time of the ruler, where its own seconds do not: a frame or a timecode."""
    frame = clip.frame_at(seconds)
    if unit is Unit.TIMECODE and clip.timecodes:
        return clip.timecodes[frame].partition(".")[0]
    return str(frame + 1)  # people count frames from 1


def times(clip: Clip, frame: int) -> tuple[str, str, str]:
    """When a frame is: as the source tells it, in seconds, and counted from 1."""
    seconds = format_time(float(clip.times[frame]))
    return (
        clip.timecodes[frame] if clip.timecodes else seconds,
        f"{seconds} / {format_time(clip.duration)}",
        f"frame {frame + 1} / {len(clip)}",
    )
