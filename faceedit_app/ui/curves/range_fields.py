"""The selection in numbers: start and end of the hold, and both falloffs."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QDoubleSpinBox, QGridLayout, QLabel, QSizePolicy, QWidget

from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.gestures import Span
from faceedit_app.ui.curves.selection_mouse import SelectionMouse
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
        self.start = self._field("Selection start", "Start of the selection, in seconds")
        self.end = self._field("Selection end", "End of the selection, in seconds")
        fades = (
            "Time over which an edit fades {}, in seconds.\nThe wheel changes it while you drag."
        )
        self.fade_in = self._field("Falloff in", fades.format("in"), FALLOFF_RANGE[1])
        self.fade_out = self._field("Falloff out", fades.format("out"), FALLOFF_RANGE[1])
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
        self.sync()

    def _field(self, name: str, tip: str, most: float = _LONGEST) -> QDoubleSpinBox:
        box = QDoubleSpinBox(decimals=2, singleStep=0.05)
        box.setObjectName("small")
        box.setKeyboardTracking(False)  # ignore half-typed numbers
        box.setAlignment(Qt.AlignmentFlag.AlignCenter)
        box.setRange(0.0, most)
        box.setToolTip(tip)
        box.setAccessibleName(name)
        box.setFont(style.scaled_font(self, 0.88))
        box.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        box.editingFinished.connect(self.left)
        # Enter returns the focus to the curves.
        box.lineEdit().returnPressed.connect(lambda: self.window().setFocus())
        return box

    def sync(self) -> None:
        """Show the timeline's selection; without one, start and end are empty."""
        line = self._timeline
        chosen = line.selection
        values = (*(chosen or (0.0, 0.0)), line.falloff, line.falloff_out)
        boxes = (self.start, self.end, self.fade_in, self.fade_out)
        for box, value in zip(boxes, values, strict=True):
            with QSignalBlocker(box):
                box.setValue(value)
        for box in (self.start, self.end):
            # The special text for the minimum means “nothing selected”.
            box.setMinimum(0.0 if chosen is not None else -0.01)
            box.setSpecialValueText("" if chosen is not None else "–")
            if chosen is None:
                with QSignalBlocker(box):
                    box.setValue(-0.01)

    def _select(self) -> None:
        line = self._timeline
        last = line.duration
        start, end = (min(max(box.value(), 0.0), last) for box in (self.start, self.end))
        if self.sender() is self.start:
            end = max(end, start)
        else:
            start = min(start, end)
        self._edges.place(Span(start, end, line.falloff, line.falloff_out))
        self.sync()

    def _fade(self) -> None:
        fades = self.fade_in.value(), self.fade_out.value()
        if (chosen := self._timeline.selection) is not None:
            self._edges.place(Span(*chosen, *fades))
        else:
            self._timeline.set_falloffs(*fades)
