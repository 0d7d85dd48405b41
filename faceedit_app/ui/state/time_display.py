"""The unit in which times are shown: seconds, frames or the take's timecode."""

from __future__ import annotations

from enum import StrEnum

from PySide6.QtCore import QObject, Signal

from faceedit_app.core.clip import Clip
from faceedit_app.formats.timing import format_time
from faceedit_app.ui.state.timed_rows import TimedRows

_DECIMALS = 3  # of seconds: at 1000 frames a second, two frames read differently


class Unit(StrEnum):
    """A unit in which times are shown."""

    SECONDS = "seconds"
    FRAMES = "frames"
    TIMECODE = "timecode"


class TimeDisplay(QObject):
    """The unit in which times are shown.

    Attributes:
        chosen: by the user. A take without timecode is shown in seconds instead.

    Signals:
        changed(): times are shown in another unit.
    """

    changed = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.chosen = Unit.SECONDS
        self._has_timecode = True

    @property
    def unit(self) -> Unit:
        """The unit in which the open take's times are shown."""
        has_it = self._has_timecode or self.chosen is not Unit.TIMECODE
        return self.chosen if has_it else Unit.SECONDS

    @property
    def counts_frames(self) -> bool:
        """Whether a length of time is shown in frames, as with frame numbers and timecode."""
        return self.unit is not Unit.SECONDS

    def choose(self, unit: Unit) -> None:
        """Show times in another unit."""
        before, self.chosen = self.unit, unit
        if self.unit is not before:
            self.changed.emit()

    def follow(self, clip: Clip) -> None:
        """Show the times of another take."""
        before, self._has_timecode = self.unit, bool(clip.timecodes)
        if self.unit is not before:
            self.changed.emit()


def label(rows: TimedRows, seconds: float, unit: Unit) -> str:
    """The ruler's label of a time in frames or timecode: that of the nearest row."""
    row = rows.at(seconds)
    if unit is Unit.TIMECODE and rows.timecodes is not None:
        return rows.timecode(row)
    return rows.number(row)


def shown_time(rows: TimedRows, seconds: float, unit: Unit) -> str:
    """A time in the chosen unit, such as `2.500 s` or `151`."""
    return f"{shown_seconds(seconds)} s" if unit is Unit.SECONDS else label(rows, seconds, unit)


def shown_seconds(seconds: float) -> str:
    """A time in seconds with the same decimals everywhere, such as `2.500`."""
    return f"{seconds:.{_DECIMALS}f}"


def shown_range(rows: TimedRows, start: float, end: float, unit: Unit) -> str:
    """A range in the chosen unit, such as `2.500 to 3.000 s` or `frames 151 to 181`."""
    if unit is Unit.SECONDS:
        return f"{shown_seconds(start)} to {shown_seconds(end)} s"
    first, last = (label(rows, seconds, unit) for seconds in (start, end))
    return f"{'frames ' if unit is Unit.FRAMES else ''}{first} to {last}"


def times(rows: TimedRows, row: int) -> tuple[str, str, str]:
    """A row's time in three units: timecode, seconds, and frame number from 1.

    A row without a face, at which the playhead can only stand if it is filled, says so.
    """
    seconds = format_time(float(rows.times[row]))
    code = rows.timecode(row) if rows.timecodes is not None else seconds
    number = f"frame {rows.number(row)} / {len(rows.clip)}"
    filled = ", filled" if rows.past[row] else ""
    return code, f"{seconds} / {format_time(rows.clip.duration)}", number + filled
