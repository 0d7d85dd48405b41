"""A field for a time of the take."""

from __future__ import annotations

from faceedit_app.ui.look.number import NumberBox
from faceedit_app.ui.state.time_display import Unit, label
from faceedit_app.ui.state.timed_rows import TimedRows
from faceedit_app.ui.state.timeline import Timeline
from faceedit_app.ui.state.typed_time import typed_row, typed_seconds


class TimeBox(NumberBox):
    """A field for a time; in frames or timecode, its number is that of the row, counted from 1."""

    def __init__(self, timeline: Timeline) -> None:
        self._timeline = timeline  # first: it is asked what to show at once
        super().__init__()

    @property
    def _rows(self) -> TimedRows | None:
        """The take's rows, if their numbers or timecodes are shown."""
        line = self._timeline
        return line.rows if line.display.counts_frames else None

    def textFromValue(self, value: float) -> str:
        """The timecode or the number of the row, or the seconds."""
        rows = self._rows
        if rows is None:
            return super().textFromValue(value)
        row = min(max(round(value), 1), len(rows)) - 1
        return label(rows, float(rows.times[row]), self._timeline.display.unit)

    def valueFromText(self, text: str) -> float:
        """The row that a timecode or a frame's number means, or the seconds."""
        if text == self.specialValueText():
            return self.minimum()
        if self._timeline.clip is None:
            return super().valueFromText(text)
        try:
            return self._meant(self.typed(text))
        except ValueError:
            return self.value()

    def why_not(self, text: str) -> str:
        """Why a text is no time of the take; "" if it is one."""
        if self._timeline.clip is None:
            return super().why_not(text)
        try:
            self._meant(self.typed(text))
        except ValueError as error:
            return str(error)
        return ""

    def _meant(self, text: str) -> float:
        """The number that a text means; one that lies beyond the take means its end.

        Raises:
            ValueError: what is wrong with it, in one line for the user.
        """
        line, rows, number = self._timeline, self._rows, self.number_in(text)
        if number is not None and not 0 <= number <= self.maximum():
            number = None
        if rows is None:
            return min(typed_seconds(text), self.maximum()) if number is None else number
        if number is not None and line.display.unit is Unit.FRAMES:
            frame = min(max(round(number), 1), len(rows.clip)) - 1
            return rows.of_frame(frame) + 1.0
        return typed_row(rows, text, line.display.unit, rows.at(line.time)) + 1.0
