"""Moves the playhead by the clock on the wall; frames are dropped rather than time stretched."""

from __future__ import annotations

import time
from collections.abc import Callable

from PySide6.QtCore import QObject, Qt, QTimer, Signal

from faceedit_app.ui.timeline import Timeline

SPEEDS = (0.25, 0.5, 1.0)
_TICK_MS = 8  # finer than any display; a tick without a new frame costs nothing


class Playback(QObject):
    """Plays the open take.

    Args:
        timeline: whose playhead is moved.
        clock: seconds that only grow; tests bring their own.

    Signals:
        playing_changed(bool)
        loop_changed(bool)
    """

    playing_changed = Signal(bool)
    loop_changed = Signal(bool)

    def __init__(
        self,
        timeline: Timeline,
        clock: Callable[[], float] = time.perf_counter,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._timeline, self._clock = timeline, clock
        self._speed = 1.0
        self._loop = False
        # Where the playhead was (seconds) when the clock showed what.
        self._anchor = (0.0, 0.0)
        self._moving = False
        self._timer = QTimer(self, interval=_TICK_MS)
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self.tick)
        timeline.playhead_moved.connect(self._follow)

    @property
    def playing(self) -> bool:
        """Whether time passes."""
        return self._timer.isActive()

    @property
    def loop(self) -> bool:
        """Whether the selection or the whole take is repeated."""
        return self._loop

    @property
    def speed(self) -> float:
        """Seconds of the take per second on the wall."""
        return self._speed

    def set_loop(self, loop: bool) -> None:
        """Repeat the selection, or the whole take."""
        if loop != self._loop:
            self._loop = loop
            self.loop_changed.emit(loop)

    def set_speed(self, speed: float) -> None:
        """Play slower, from where the playhead is."""
        self._drop_anchor()
        self._speed = speed

    def toggle(self) -> None:
        """Play or pause."""
        if self.playing:
            self.pause()
        else:
            self.play()

    def play(self) -> None:
        """Play on from the playhead; from the start when it stands at the end."""
        if self.playing or self._timeline.frames < 2:
            return
        first, last = self._range()
        now = self._timeline.time
        outside = self._loop and not first <= now < last
        if outside or self._timeline.frame == self._timeline.frames - 1:
            self._go_to(first)
        self._drop_anchor()
        self._timer.start()
        self.playing_changed.emit(True)

    def pause(self) -> None:
        """Stop where the playhead is."""
        if self.playing:
            self._timer.stop()
            self.playing_changed.emit(False)

    def tick(self) -> None:
        """Bring the playhead to where the clock says it is."""
        began, at = self._anchor
        now = began + (self._clock() - at) * self._speed
        first, last = self._range()
        if now < last:
            self._go_to(now)
        elif self._loop:
            # A late tick keeps its place in the beat.
            now = first + (now - last) % max(last - first, 1e-6)
            self._anchor = (now, self._clock())
            self._go_to(now)
        else:
            self._go_to(last)
            self.pause()

    def _range(self) -> tuple[float, float]:
        """The seconds that are played."""
        selection = self._timeline.selection
        if self._loop and selection is not None and selection[1] > selection[0]:
            return selection
        return 0.0, self._timeline.duration

    def _go_to(self, seconds: float) -> None:
        self._moving = True
        self._timeline.go_to_time(seconds)
        self._moving = False

    def _follow(self) -> None:
        """Somebody else moved the playhead: play on from there."""
        if not self._moving:
            self._drop_anchor()

    def _drop_anchor(self) -> None:
        self._anchor = (self._timeline.time, self._clock())
