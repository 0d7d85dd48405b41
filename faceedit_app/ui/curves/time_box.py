"""A field for a time of the take."""

from __future__ import annotations

from faceedit_app.core.clip import Clip
from faceedit_app.ui.look.number import NumberBox
from faceedit_app.ui.state.time_display import Unit, label
from faceedit_app.ui.state.timeline import Timeline
from faceedit_app.ui.state.typed_time import typed_frame, typed_seconds


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
        line, number = self._timeline, self.number_in(text)
        assert line.clip is not None
        if self._clip is None and number is not None and 0 <= number <= self.maximum():
            return number
        if line.display.counts_frames:
            return typed_frame(line.clip, text, line.display.unit, line.frame) + 1.0
        return min(typed_seconds(text), self.maximum())
