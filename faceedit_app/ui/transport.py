"""The bar at the bottom: playing, where the playhead is, how edits fade."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtWidgets import QDoubleSpinBox, QHBoxLayout, QLabel, QWidget

from faceedit_app.core.clip import Clip
from faceedit_app.formats.timing import format_time
from faceedit_app.ui.actions import Actions
from faceedit_app.ui.icons import icon
from faceedit_app.ui.playback import SPEEDS, Playback
from faceedit_app.ui.theme import GAP
from faceedit_app.ui.timeline import FALLOFF_RANGE, Timeline
from faceedit_app.ui.widgets import Choice, bar_row, caption, divider, icon_button


class Transport(QWidget):
    """Transport buttons, clock, falloff and speed."""

    def __init__(self, actions: Actions, timeline: Timeline, playback: Playback) -> None:
        super().__init__()
        self._timeline, self._playback = timeline, playback
        self._clip: Clip | None = None
        self._play = actions["play"]
        self._icons = {False: icon("play"), True: icon("pause")}
        self.falloff = self._falloff_box()
        self.speed = self._speed_box()
        self.extras = QHBoxLayout()  # what the window adds to it
        self.clock, self.seconds, self.frame = QLabel(), QLabel(), QLabel()
        self._labels = (self.clock, self.seconds, self.frame)
        self._lay_out(actions)
        timeline.playhead_moved.connect(self._show_time)
        timeline.falloff_changed.connect(self._show_falloff)
        playback.playing_changed.connect(lambda playing: self._play.setIcon(self._icons[playing]))
        playback.loop_changed.connect(actions["loop"].setChecked)
        self.set_clip(None)

    def _lay_out(self, actions: Actions) -> None:
        row = bar_row(self, "transport")
        for name in ("start", "back", "play", "forward", "end", "loop"):
            row.addWidget(icon_button(actions[name], "play" if name == "play" else "icon"))
        row.addSpacing(GAP)
        row.addWidget(caption("Speed", self.speed))
        row.addWidget(self.speed)
        row.addLayout(self.extras)
        row.addStretch()
        self.clock.setObjectName("clock")
        self.clock.setToolTip("Time of the frame on screen, as the take tells it")
        for label in (self.seconds, self.frame):
            label.setObjectName("caption")
        for label in self._labels:
            label.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
            row.addWidget(label)
            row.addSpacing(GAP)
        row.addStretch()
        row.addWidget(caption("Falloff", self.falloff))
        row.addWidget(self.falloff)
        row.addSpacing(GAP)
        row.addWidget(divider())
        row.addWidget(icon_button(actions["fit"]))

    def _falloff_box(self) -> QDoubleSpinBox:
        box = QDoubleSpinBox(decimals=2, singleStep=0.05, suffix=" s")
        box.setKeyboardTracking(False)  # half-typed numbers are nobody's wish
        box.setAlignment(Qt.AlignmentFlag.AlignCenter)
        box.setRange(*FALLOFF_RANGE)
        box.setValue(self._timeline.falloff)
        box.setToolTip(
            "Seconds over which an edit fades in and out.\n"
            "Turn the wheel while dragging a curve to change it."
        )
        box.valueChanged.connect(self._timeline.set_falloff)
        # Enter hands the keys back to the curves.
        box.lineEdit().returnPressed.connect(lambda: self.window().setFocus())
        return box

    def _speed_box(self) -> Choice:
        box = Choice()
        box.setToolTip("How fast the take is played; slower sound is lower, as on tape")
        for speed in SPEEDS:
            box.addItem(f"{speed:g}×", speed)
        box.setCurrentIndex(len(SPEEDS) - 1)
        box.currentIndexChanged.connect(lambda i: self._playback.set_speed(SPEEDS[i]))
        return box

    def set_clip(self, clip: Clip | None) -> None:
        """Tell the time of another take, or of none."""
        self._clip = clip
        self.falloff.setEnabled(clip is not None)
        self.speed.setEnabled(clip is not None)
        if clip is not None:
            # Wide enough for the last frame, so that nothing jumps while playing.
            for label, text in zip(self._labels, _times(clip, len(clip) - 1), strict=True):
                label.ensurePolished()
                label.setMinimumWidth(label.fontMetrics().horizontalAdvance(text) + GAP)
        self._show_time()

    def _show_time(self) -> None:
        clip = self._clip
        frame = min(max(self._timeline.frame, 0), len(clip) - 1) if clip is not None else 0
        texts = _times(clip, frame) if clip is not None else ("", "", "")
        for label, text in zip(self._labels, texts, strict=True):
            label.setText(text)

    def _show_falloff(self, seconds: float) -> None:
        with QSignalBlocker(self.falloff):
            self.falloff.setValue(seconds)


def _times(clip: Clip, frame: int) -> tuple[str, str, str]:
    """When a frame is: as the source tells it, in seconds, and counted from 1."""
    seconds = format_time(float(clip.times[frame]))
    return (
        clip.timecodes[frame] if clip.timecodes else seconds,
        f"{seconds} / {format_time(clip.duration)}",
        f"frame {frame + 1} / {len(clip)}",
    )
