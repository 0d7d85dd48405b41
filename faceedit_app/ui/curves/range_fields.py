"""The selection in numbers: start and end of the hold, and both falloffs."""

from __future__ import annotations

import re

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QFont, QFontMetricsF
from PySide6.QtWidgets import QHBoxLayout, QLabel, QSizePolicy, QVBoxLayout, QWidget

from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.gestures import Span
from faceedit_app.ui.curves.scale import Interval
from faceedit_app.ui.curves.selection_mouse import SelectionMouse
from faceedit_app.ui.curves.time_box import TimeBox
from faceedit_app.ui.look.number import NumberBox
from faceedit_app.ui.state.time_display import Unit
from faceedit_app.ui.state.timeline import FALLOFF_RANGE, Timeline

_LONGEST = 1e6
_SIZE = 0.88  # of the font, at most
_LEFT, _RIGHT, _GAP = 10, 8, 4  # pixels
_AROUND = 11  # pixels in a field that are not for its text


class RangeFields(QWidget):
    """Four number fields, in two rows beside the ruler.

    Signals:
        left(): numbers are set, and what is typed next is another step.
    """

    left = Signal()

    def __init__(
        self, timeline: Timeline, edges: SelectionMouse, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._timeline, self._edges = timeline, edges
        self.start, self.end = TimeBox(timeline), TimeBox(timeline)
        self.fade_in, self.fade_out = NumberBox(), NumberBox()
        self._boxes = self.start, self.end, self.fade_in, self.fade_out
        self._setting: TimeBox | None = None  # the end that is being set
        self._typed: set[TimeBox] = set()  # ends that are set; the other one belongs to the step
        self._made: Interval | None = None  # the selection that they made
        names = "Selection start", "Selection end", "Falloff in", "Falloff out"
        for box, name in zip(self._boxes, names, strict=True):
            self._prepare(box, name)
        self._range_label, falloff_label = self._caption("Range"), self._caption("Falloff")
        self._range_label.setBuddy(self.start)
        falloff_label.setBuddy(self.fade_in)
        self._lay_out((self._range_label, self.start, self.end), (falloff_label, *self._boxes[2:]))
        for box in (self.start, self.end):
            box.valueChanged.connect(self._select)
            box.editingFinished.connect(lambda box=box: self._leave_end(box))
        for box in (self.fade_in, self.fade_out):
            box.valueChanged.connect(self._fade)
            box.editingFinished.connect(self._leave_range)
        timeline.selection_changed.connect(self.sync)
        timeline.falloff_changed.connect(self.sync)
        timeline.display.changed.connect(self._show_unit)
        self._show_unit()

    def _caption(self, words: str) -> QLabel:
        caption = QLabel(words)
        caption.setObjectName("caption")
        caption.setFont(style.scaled_font(self, _SIZE))
        return caption

    def _lay_out(self, *rows: tuple[QLabel, QWidget, QWidget]) -> None:
        self.setFixedWidth(style.HEADER_WIDTH)
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        self._wide = wide = max(caption.sizeHint().width() for caption, *_ in rows)
        column = QVBoxLayout(self)
        column.setContentsMargins(_LEFT, 0, _RIGHT, 0)
        column.setSpacing(1)
        for caption, left, right in rows:
            caption.setFixedWidth(wide)
            row = QHBoxLayout()
            row.setSpacing(_GAP)
            row.addWidget(caption)
            row.addWidget(left, 1)
            row.addWidget(right, 1)
            column.addLayout(row)

    def _prepare(self, box: NumberBox, name: str) -> None:
        box.setObjectName("small")
        box.setKeyboardTracking(False)  # ignore half-typed numbers
        box.setAlignment(Qt.AlignmentFlag.AlignCenter)
        box.setMaximum(_LONGEST)
        box.setAccessibleName(name)
        _set_font(box, style.scaled_font(self, _SIZE))
        box.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)

    @property
    def _in_frames(self) -> bool:
        """Whether the numbers are rows, whatever is shown for them."""
        return self._timeline.display.counts_frames and self._timeline.clip is not None

    def _show_unit(self) -> None:
        """Show times in seconds or frames, or as timecode."""
        coded = self._in_frames and self._timeline.display.unit is Unit.TIMECODE
        lengths = "frames" if self._in_frames else "seconds"
        times = "as timecode" if coded else f"in {lengths}"
        times += ", counted from 1" if self._in_frames and not coded else ""
        self._range_label.setHidden(coded)  # two timecodes take its place
        for box, which in ((self.start, "Start"), (self.end, "End")):
            box.setToolTip(f"{which} of the selection, {times}")
            self._count(box, 0 if self._in_frames else 3)
        for fade, way in ((self.fade_in, "in"), (self.fade_out, "out")):
            fade.setToolTip(
                f"Time over which an edit fades {way}, in {lengths}.\n"
                "The wheel changes it while you drag."
            )
            self._count(fade, 1 if self._in_frames else 2)
        self.sync()

    def _count(self, box: NumberBox, decimals: int) -> None:
        with QSignalBlocker(box):
            box.setDecimals(decimals)
            box.setSingleStep(1.0 if self._in_frames else 0.05)

    def _shown(self, seconds: float) -> float:
        """The number that stands for a time."""
        rows = self._timeline.rows
        return rows.at(seconds) + 1.0 if self._in_frames and rows is not None else seconds

    def _meant(self, number: float) -> float:
        """The time for which a number stands, within the take."""
        rows = self._timeline.rows
        if self._in_frames and rows is not None:
            return float(rows.times[min(max(round(number), 1), len(rows)) - 1])
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
        for fade, seconds in (
            (self.fade_in, line.falloff),
            (self.fade_out, line.falloff_out),
        ):
            with QSignalBlocker(fade):
                fade.setMaximum(FALLOFF_RANGE[1] / self._frame)
                fade.setValue(seconds / self._frame)

        self._fit()

    def _fit(self) -> None:
        """Show all of both ends, in one size."""
        caption = 0 if self._range_label.isHidden() else self._wide + _GAP
        room = (style.HEADER_WIDTH - _LEFT - _RIGHT - _GAP - caption) // 2 - _AROUND
        font = style.scaled_font(self, _SIZE)
        metrics = QFontMetricsF(font)
        ends = (self.start, self.end)
        # Any digits, or the size would change while an end is dragged.
        needed = max(metrics.horizontalAdvance(re.sub(r"\d", "0", box.text())) for box in ends)
        if needed > room:
            font = style.scaled_font(self, _SIZE * room / needed)
        for box in ends:
            _set_font(box, font)

    def _select(self) -> None:
        """Move the end that was typed; the other one stays exactly where it is.

        If they would pass each other, the other end comes along, unless it was typed just before:
        then they change places.
        """
        line = self._timeline
        box, other = (
            (self.start, self.end) if self.sender() is self.start else (self.end, self.start)
        )
        if box in self._typed or line.selection != self._made:
            self._leave_range()
        typed = self._meant(box.value())
        start, end = line.selection or (typed, typed)
        stays = end if box is self.start else start
        if other not in self._typed:
            stays = max(stays, typed) if box is self.start else min(stays, typed)
        span = Span(min(typed, stays), max(typed, stays), line.falloff, line.falloff_out)
        self._edges.place(span)
        line.bring_into_view(span.start, span.end)
        self._setting, self._made = box, line.selection
        self.sync()

    def _leave_end(self, box: TimeBox) -> None:
        """One end is set; the other one may follow, as part of the same step."""
        if box is self._setting:
            self._typed.add(box)

    def _leave_range(self) -> None:
        """Other numbers are another step."""
        self._typed.clear()
        self._setting = None
        self.left.emit()

    def _fade(self) -> None:
        if self._typed:
            self._leave_range()
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


def _set_font(box: NumberBox, font: QFont) -> None:
    """Set the font of a field, whose text does not follow it by itself."""
    for widget in (box, box.lineEdit()):
        if widget.font() != font:
            widget.setFont(font)
