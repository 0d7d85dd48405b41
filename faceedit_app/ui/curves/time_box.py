"""A field for a time of the take."""

from __future__ import annotations

from faceedit_app.core.clip import Clip
from faceedit_app.ui.look.number import NumberBox
from faceedit_app.ui.state.time_display import Unit, label
from faceedit_app.ui.state.timeline import Timeline
from faceedit_app.ui.state.typed_time import typed_frame


class TimeBox(NumberBox):
    """A field for a time; as a timecode, its number is that of the frame, counted from 1."""

    def __init__(self, timeline: Timeline) -> None:
        self._timeline = timeline  # first: it is asked what to show at once
        super().__init__()

    @property
    def _clip(self) -> Clip | None:
        """The take, if its timecode is shown."""
        line = self._timeline
        return line.clip if line.display.unit is Unit.TIMECODE else None

    def textFromValue(self, value: float) -> str:
        """The timecode of the frame, or the number."""
        clip = self._clip
        if clip is None:
            return super().textFromValue(value)
        frame = min(max(round(value), 1), len(clip)) - 1
        return label(clip, float(clip.times[frame]), Unit.TIMECODE)

    def valueFromText(self, text: str) -> float:
        """The frame that a timecode means, or the number."""
        clip = self._clip
        if clip is None:
            return super().valueFromText(text)
        if text == self.specialValueText():
            return self.minimum()
        try:
            return typed_frame(clip, text, Unit.TIMECODE, self._timeline.frame) + 1.0
        except ValueError:
            return self.value()

    def why_not(self, text: str) -> str:
        """Why a text is no time of the take; "" if it is one."""
        line = self._timeline
        if line.clip is None:
            return super().why_not(text)
        if self._clip is None:
            number = self.number_in(text)
            if number is not None and number >= 0:
                return ""  # what lies beyond the take means its end
        try:
            typed_frame(line.clip, text, line.display.unit, line.frame)
        except ValueError as error:
            return str(error)
        return "" if self._clip is not None else "Type a number, such as 4.5"
