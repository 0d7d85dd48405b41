"""The bar at the bottom: playback controls and the playhead's time."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QMouseEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QWidget

from faceedit_app.core.clip import Clip
from faceedit_app.ui.look.icons import icon
from faceedit_app.ui.look.theme import GAP
from faceedit_app.ui.look.widgets import Choice, bar_row, caption, icon_button
from faceedit_app.ui.page.time_entry import TimeEntry
from faceedit_app.ui.state.actions import TIP, Actions
from faceedit_app.ui.state.playback import SPEEDS, Playback
from faceedit_app.ui.state.time_display import Unit, times
from faceedit_app.ui.state.timed_rows import TimedRows
from faceedit_app.ui.state.timeline import Timeline
from faceedit_app.ui.state.typed_time import typed_moment

_UNITS = (Unit.TIMECODE, Unit.SECONDS, Unit.FRAMES)


class Transport(QWidget):
    """Transport buttons, speed, and the time in three units."""

    def __init__(self, actions: Actions, timeline: Timeline, playback: Playback) -> None:
        super().__init__()
        self._timeline, self._playback = timeline, playback
        self._clip: Clip | None = None
        self._play = actions["play"]
        self._icons = {False: icon("play"), True: icon("pause")}
        self.speed = self._speed_box()
        self.extras = QHBoxLayout()  # for widgets that the page adds
        self.clock, self.seconds, self.frame = (
            TimeLabel(actions[f"unit_{unit}"], self.type_time) for unit in _UNITS
        )
        self._labels = (self.clock, self.seconds, self.frame)
        self.entry = TimeEntry(self)
        self.entry.ended.connect(lambda: self.window().setFocus())  # the window gets the keys again
        self._lay_out(actions)
        timeline.playhead_moved.connect(self._show_time)
        timeline.display.changed.connect(self._show_unit)
        playback.playing_changed.connect(lambda playing: self._play.setIcon(self._icons[playing]))
        self.set_clip(None)

    def _lay_out(self, actions: Actions) -> None:
        row = bar_row(self, "transport")
        for name in ("start", "back", "play", "forward", "end", "loop"):
            look = "play" if name == "play" else "icon"
            row.addWidget(icon_button(actions[name], look, repeats=name in ("back", "forward")))
        row.addSpacing(GAP)
        row.addWidget(caption("Speed", self.speed))
        row.addWidget(self.speed)
        row.addLayout(self.extras)
        row.addStretch()
        for label in self._labels:
            label.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
            row.addWidget(label)
            row.addSpacing(GAP)
        row.addStretch()
        row.addWidget(icon_button(actions["zoom_out"], repeats=True))
        row.addWidget(icon_button(actions["zoom_in"], repeats=True))
        row.addWidget(icon_button(actions["fit"]))

    def _speed_box(self) -> Choice:
        box = Choice()
        box.setToolTip("Playback speed. Slower sound is lower in pitch; above 1× it is silent.")
        for speed in SPEEDS:
            box.addItem(f"{speed:g}×", speed)
        box.setCurrentIndex(SPEEDS.index(1.0))
        box.currentIndexChanged.connect(lambda i: self._playback.set_speed(SPEEDS[i]))
        return box

    def restore_speed(self) -> None:
        """Play at normal speed again."""
        self.speed.setCurrentIndex(SPEEDS.index(1.0))

    def set_clip(self, clip: Clip | None) -> None:
        """Show the times of another take, or of none."""
        self._clip = clip
        self.speed.setEnabled(clip is not None)
        if clip is not None:
            # Wide enough for the last frame and for filled ones: nothing moves during playback.
            rows = self._timeline.rows or TimedRows.of(clip)
            widest = {len(rows) - 1, int(rows.past.argmax())}
            shown = [times(rows, row) for row in widest]
            for label, *texts in zip(self._labels, *shown, strict=True):
                label.ensurePolished()
                wide = max(map(label.fontMetrics().horizontalAdvance, texts))
                label.setMinimumWidth(wide + GAP)
            self.clock.setVisible(bool(clip.timecodes))
        self._show_time()
        self._show_unit()

    def _show_time(self) -> None:
        rows, texts = self._timeline.rows, ("", "", "")
        if self._clip is not None and rows is not None:
            texts = times(rows, rows.at(self._timeline.time))
        for label, text in zip(self._labels, texts, strict=True):
            label.setText(text)

    def type_time(self) -> None:
        """Let the user type a time to go to, in the unit in which times are shown."""
        rows, unit = self._timeline.rows, self._timeline.display.unit
        if self._clip is None or rows is None:
            return

        def go(text: str) -> None:
            now = rows.at(self._timeline.time)
            self._timeline.visit(typed_moment(rows, text, unit, now))

        label = self._labels[_UNITS.index(unit)]
        text = label.text().partition("/")[0].removeprefix("frame").strip()
        self.entry.begin(label, text, f"Go to a time, in {unit}", go)

    def _show_unit(self) -> None:
        """Highlight the time in the ruler's unit."""
        for label, unit in zip(self._labels, _UNITS, strict=True):
            label.show_chosen(unit is self._timeline.display.unit)


class TimeLabel(QLabel):
    """A time; a click makes the ruler show its unit, another click lets the user type.

    Args:
        action: makes the ruler show this unit.
        type_time: lets the user type a time.
    """

    def __init__(self, action: QAction, type_time: Callable[[], None]) -> None:
        super().__init__()
        self._action, self._type_time = action, type_time
        self.setCursor(Qt.CursorShape.PointingHandCursor)
        self.setToolTip(
            f"{action.property(TIP)}.\nClick to use this unit on the ruler."
            " Click again, or press G, to type a time."
        )
        self.show_chosen(False)

    def show_chosen(self, chosen: bool) -> None:
        """Highlight it, or not."""
        self.setObjectName("clock" if chosen else "caption")
        self.style().unpolish(self)
        self.style().polish(self)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Choose this unit, or type if it is chosen already."""
        if self._action.isChecked():
            self._type_time()
        else:
            self._action.trigger()
