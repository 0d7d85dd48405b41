"""Moves the playhead by a clock, dropping frames rather than slowing down.

It is the sound's clock while sound plays, so that lips and voice stay in sync however slow the
drawing is, and the system's otherwise.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Protocol

from PySide6.QtCore import QObject, Qt, QTimer, Signal

from faceedit_app.ui.state.timeline import Timeline

SPEEDS = (0.25, 0.5, 1.0, 2.0)
FASTEST = 4.0  # times the speed, with J and L
RUN_UP = 0.5  # seconds before and after the range of Play around
_TICK_MS = 8  # finer than any display; a tick without a new frame is cheap


class Voice(Protocol):
    """Plays the sound of the take."""

    def start(self, seconds: float, speed: float, loop: tuple[float, float] | None) -> bool:
        """Start sound at a time of the take, repeating `loop`; False if there is none."""

    def heard(self) -> float:
        """Seconds of sound heard since `start`; they never decrease."""

    def stop(self) -> None:
        """Stop the sound."""


class Playback(QObject):
    """Plays the open take.

    Args:
        timeline: whose playhead is moved.
        clock: monotonic seconds, for playing without sound; tests pass their own.

    Attributes:
        voice: plays the sound; None for silence.

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
        self.voice: Voice | None = None
        self._is_heard = False
        self._speed = 1.0
        self._shuttle = 1.0  # factor on the speed; below 0, backwards
        self._around: tuple[float, float] | None = None  # range of Play around, in seconds
        self._came_from = 0.0  # seconds to go back to after that
        self._loop = False
        # Seconds of playhead and clock at the last sync.
        self._anchor = (0.0, 0.0)
        self._moving = False
        self._timer = QTimer(self, interval=_TICK_MS)
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self.tick)
        timeline.playhead_moved.connect(self._follow)
        timeline.selection_changed.connect(self._range_changed)

    @property
    def playing(self) -> bool:
        """Whether it is playing."""
        return self._timer.isActive()

    @property
    def loop(self) -> bool:
        """Whether the selection or the whole take is repeated."""
        return self._loop

    @property
    def speed(self) -> float:
        """Seconds of the take per second, as chosen."""
        return self._speed

    @property
    def pace(self) -> float:
        """Seconds of the take per second, as played; below 0, backwards."""
        return self._speed * self._shuttle

    def set_loop(self, loop: bool) -> None:
        """Repeat the selection, or the whole take."""
        if loop != self._loop:
            self._loop = loop
            self.resync()
            self.loop_changed.emit(loop)

    def set_speed(self, speed: float) -> None:
        """Set the speed, and continue from the playhead."""
        self._speed = speed
        self.resync()

    def toggle(self) -> None:
        """Play or pause."""
        if self.playing:
            self.pause()
        else:
            self.play()

    def play(self) -> None:
        """Play from the playhead, or from the start if it is at the end."""
        if self.playing or self._timeline.frames < 2:
            return
        self._shuttle, self._around = 1.0, None
        first, last = self._range()
        now = self._timeline.time
        outside = self._loop and not first <= now < last
        if outside or now >= self._timeline.snap(self._timeline.duration):
            self._go_to(first)
        self._timer.start()
        self.resync()
        self.playing_changed.emit(True)

    def shuttle(self, direction: int) -> None:
        """Play forwards (1) or backwards (-1); a repeated call doubles the speed, up to 4."""
        if self._timeline.frames < 2:
            return
        faster = self.playing and self._shuttle * direction > 0
        if not self.playing:
            now = self._timeline.time
            self.play()  # at the last frame it would start over
            if direction < 0:
                self._timeline.go_to_time(now)
        self._around = None
        self._shuttle = min(2 * abs(self._shuttle), FASTEST) * direction if faster else direction
        self.resync()

    def play_around(self) -> None:
        """Play the selection, or around the playhead, once with a run-up; then return."""
        line = self._timeline
        if line.frames < 2:
            return
        self.pause()
        came_from = line.time
        first, last = line.selection or (line.time - RUN_UP, line.time + RUN_UP)
        if line.selection is not None:
            first, last = first - RUN_UP, last + RUN_UP
        around = max(first, 0.0), min(last, line.duration)
        self._go_to(around[0])
        self.play()
        self._around, self._came_from = around, came_from
        self.resync()

    def pause(self) -> None:
        """Stop at the playhead."""
        self._around = None
        if self.playing:
            self._timer.stop()
            if self._is_heard and self.voice is not None:
                self.voice.stop()
            self._is_heard = False
            self.playing_changed.emit(False)

    def resync(self) -> None:
        """Restart clock and sound at the playhead, if it is playing."""
        if not self.playing:
            return
        repeats = self._loop and self._around is None
        now, loop = self._timeline.time, self._range() if repeats else None
        voice = self.voice
        if voice is not None and self._is_heard:
            voice.stop()
        can_be_heard = voice is not None and 0 < self.pace <= 1
        self._is_heard = can_be_heard and voice is not None and voice.start(now, self.pace, loop)
        self._anchor = (now, self._now())

    def tick(self) -> None:
        """Move the playhead to the clock's time."""
        (began, at), clock = self._anchor, self._now()
        now = began + (clock - at) * self.pace
        first, last = self._range()
        if self._shuttle < 0:
            self._tick_back(now, first, last)
        elif now < last:
            self._go_to(now)
        elif self._around is not None:
            self.pause()
            self._timeline.go_to_time(self._came_from)
        elif self._loop:
            # A late tick keeps the loop's rhythm; the sound repeats by itself.
            now = first + (now - last) % max(last - first, 1e-6)
            self._anchor = (now, clock)
            self._go_to(now)
        else:
            self._go_to(last)
            self.pause()

    def _tick_back(self, now: float, first: float, last: float) -> None:
        if now > first:
            self._go_to(now)
        elif self._loop:
            self._anchor = (last, self._now())
            self._go_to(last)
        else:
            self._go_to(first)
            self.pause()

    def _range(self) -> tuple[float, float]:
        """First and last second to play."""
        if self._around is not None:
            return self._around
        selection = self._timeline.selection
        if self._loop and selection is not None and selection[1] > selection[0]:
            return selection
        return 0.0, self._timeline.duration

    def _go_to(self, seconds: float) -> None:
        self._moving = True
        self._timeline.go_to_time(seconds)
        self._moving = False

    def _follow(self) -> None:
        """Something else moved the playhead: play on from there."""
        if not self._moving:
            self.resync()

    def _range_changed(self) -> None:
        if self._loop:
            self.resync()

    def _now(self) -> float:
        """Monotonic seconds."""
        if self._is_heard and self.voice is not None:
            return self.voice.heard()
        return self._clock()
