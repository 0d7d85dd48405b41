"""The selection in numbers: start and end of the hold, and both falloffs."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QGridLayout, QLabel, QSizePolicy, QWidget

from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.gestures import Span
from faceedit_app.ui.curves.selection_mouse import SelectionMouse
from faceedit_app.ui.look.number import NumberBox
from faceedit_app.ui.state.clock import Unit
from faceedit_app.ui.state.timeline import FALLOFF_RANGE, Timeline

_LONGEST = 1e6


class RangeFields(QWidget):
    """Four number fields, in two rows beside the ruler.

    Signals:
        left(): Enter was pressed or the focus was lost, which ends a gesture on a number.
    """

    left = Signal()

    def __init__(
        self, timeline: Timeline, edges: SelectionMouse, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._timeline, self._edges = timeline, edges
        names = "Selection start", "Selection end", "Falloff in", "Falloff out"
        self._boxes = tuple(self._field(name) for name in names)
        self.start, self.end, self.fade_in, self.fade_out = self._boxes
        self.setFixedWidth(style.HEADER_WIDTH)
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        grid = QGridLayout(self)
        grid.setContentsMargins(10, 0, 8, 0)
        grid.setHorizontalSpacing(4)
        grid.setVerticalSpacing(1)
        for row, (words, left, right) in enumerate(
            (("Range", self.start, self.end), ("Falloff", self.fade_in, self.fade_out))
        ):
            label = QLabel(words)
            label.setObjectName("caption")
            label.setBuddy(left)
            label.setFont(style.scaled_font(self, 0.88))
            grid.addWidget(label, row, 0)
            grid.addWidget(left, row, 1)
            grid.addWidget(right, row, 2)
        grid.setColumnStretch(1, 1)
        grid.setColumnStretch(2, 1)
        for box in (self.start, self.end):
            box.valueChanged.connect(self._select)
        for box in (self.fade_in, self.fade_out):
            box.valueChanged.connect(self._fade)
        timeline.selection_changed.connect(self.sync)
        timeline.falloff_changed.connect(self.sync)
        timeline.clock.changed.connect(self._show_unit)
        self._show_unit()

    def _field(self, name: str) -> NumberBox:
        box = NumberBox()
        box.setObjectName("small")
        box.setKeyboardTracking(False)  # ignore half-typed numbers
        box.setAlignment(Qt.AlignmentFlag.AlignCenter)
        box.setMaximum(_LONGEST)
        box.setAccessibleName(name)
        box.setFont(style.scaled_font(self, 0.88))
        box.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        box.editingFinished.connect(self.left)
        # Enter returns the focus to the curves.
        box.lineEdit().returnPressed.connect(lambda: self.window().setFocus())
        return box

    @property
    def _in_frames(self) -> bool:
        return self._timeline.clock.unit is Unit.FRAMES and self._timeline.clip is not None

    def _show_unit(self) -> None:
        """Show times in frames, or in seconds."""
        unit = "frames, counted from 1" if self._in_frames else "seconds"
        tips = (
            f"Start of the selection, in {unit}",
            f"End of the selection, in {unit}",
            *(
                f"Time over which an edit fades {way}, in {unit.partition(',')[0]}.\n"
                "The wheel changes it while you drag."
                for way in ("in", "out")
            ),
        )
        for box, tip in zip(self._boxes, tips, strict=True):
            is_time = box in (self.start, self.end)
            with QSignalBlocker(box):
                box.setDecimals((0 if is_time else 1) if self._in_frames else 3 if is_time else 2)
                box.setSingleStep(1.0 if self._in_frames else 0.05)
            box.setToolTip(tip)
        self.sync()

    def _shown(self, seconds: float) -> float:
        """The number that stands for a time."""
        clip = self._timeline.clip
        return clip.frame_at(seconds) + 1.0 if self._in_frames and clip is not None else seconds

    def _meant(self, number: float) -> float:
        """The time for which a number stands, within the take."""
        clip = self._timeline.clip
        if self._in_frames and clip is not None:
            return float(clip.times[min(max(round(number), 1), len(clip)) - 1])
        return min(max(number, 0.0), self._timeline.duration)

    @property
    def _frame(self) -> float:
        """Seconds per unit of the falloffs."""
        clip = self._timeline.clip
        return 1.0 / clip.rate if self._in_frames and clip is not None else 1.0

    def sync(self) -> None:
        """Show the timeline's selection; without one, start and end are empty."""
        line = self._timeline
        chosen, least = line.selection, 1.0 if self._in_frames else 0.0
        for box, seconds in zip((self.start, self.end), chosen or (0.0, 0.0), strict=True):
            with QSignalBlocker(box):
                # The special text for the minimum means “nothing selected”.
                box.setMinimum(least if chosen is not None else least - 1.0)
                box.setSpecialValueText("" if chosen is not None else "–")
                box.setValue(self._shown(seconds) if chosen is not None else least - 1.0)
        for box, seconds in zip(
            (self.fade_in, self.fade_out), (line.falloff, line.falloff_out), strict=True
        ):
            with QSignalBlocker(box):
                box.setMaximum(FALLOFF_RANGE[1] / self._frame)
                box.setValue(seconds / self._frame)

    def _select(self) -> None:
        """Move the end that was typed; the other one stays exactly where it is."""
        line = self._timeline
        if self.sender() is self.start:
            start = self._meant(self.start.value())
            end = max(line.selection[1] if line.selection else start, start)
        else:
            end = self._meant(self.end.value())
            start = min(line.selection[0] if line.selection else end, end)
        self._edges.place(Span(start, end, line.falloff, line.falloff_out))
        self.sync()

    def _fade(self) -> None:
        line = self._timeline
        fade_in, fade_out = line.falloff, line.falloff_out
        if self.sender() is self.fade_in:
            fade_in = self.fade_in.value() * self._frame
        else:
            fade_out = self.fade_out.value() * self._frame
        if (chosen := line.selection) is not None:
            self._edges.place(Span(*chosen, fade_in, fade_out))
        else:
            line.set_falloffs(fade_in, fade_out)
