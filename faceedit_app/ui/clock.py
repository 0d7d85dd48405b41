"""Time as people read it: the source's timecode, seconds or frames, as they choose."""

from __future__ import annotations

from enum import StrEnum

from faceedit_app.core.clip import Clip
from faceedit_app.formats.timing import format_time


class Unit(StrEnum):
    """How times are shown."""

    SECONDS = "seconds"
    FRAMES = "frames"
    TIMECODE = "timecode"


def clock(clip: Clip, frame: int, unit: Unit) -> str:
    """When a frame is. People count frames from 1; a take without timecode has seconds."""
    match unit:
        case Unit.FRAMES:
            return f"frame {frame + 1}"
        case Unit.TIMECODE if clip.timecodes:
            return clip.timecodes[frame]
        case _:
            return format_time(float(clip.times[frame]))
