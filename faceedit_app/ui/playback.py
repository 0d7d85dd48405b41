"""Moves the playhead by a clock; frames are dropped rather than time stretched.

The clock is the sound's while something is heard, so that lips and voice stay together however
slow the drawing is, and the one on the wall otherwise.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Protocol

from PySide6.QtCore import QObject, Qt, QTimer, Signal

from faceedit_app.ui.timeline import Timeline

SPEEDS = (0.25, 0.5, 1.0)
_TICK_MS = 8  # finer than any display; a tick without a new frame costs nothing


class Voice(Protocol):
    """What is heard while the take is played."""

    def start(self, seconds: float, speed: float, loop: tuple[float, float] | None) -> bool:
        """Sound from a time of the take on, repeating `loop`; False if nothing can be heard."""

    def heard(self) -> float:
        """Seconds by the clock of what is heard since `start`; they never go back."""

    def stop(self) -> None:
        """Be silent."""


class Playback(QObject):
    """Plays the open take.

    Args:
        timeline: whose playhead is moved.
        clock: seconds that only grow, for playing in silence; tests bring their own.

    Attributes:
        voice: what is heard while playing; None for silence.

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
        self._loop = False
        # Where the playhead was (seconds) when the clock showed what.
        self._anchor = (0.0, 0.0)
        self._moving = False
        self._timer = QTimer(self, interval=_TICK_MS)
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self.tick)
        timeline.playhead_moved.connect(self._follow)
        timeline.selection_changed.connect(self._range_changed)

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
            self.resync()
            self.loop_changed.emit(loop)

    def set_speed(self, speed: float) -> None:
        """Play slower, from where the playhead is."""
        self._speed = speed
        self.resync()

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
        self._timer.start()
        self.resync()
        self.playing_changed.emit(True)

    def pause(self) -> None:
        """Stop where the playhead is."""
        if self.playing:
            self._timer.stop()
            if self._is_heard and self.voice is not None:
                self.voice.stop()
            self._is_heard = False
            self.playing_changed.emit(False)

    def resync(self) -> None:
        """Start clock and sound anew from the playhead, if it is playing."""
        if not self.playing:
            return
        now, loop = self._timeline.time, self._range() if self._loop else None
        voice = self.voice
        self._is_heard = voice is not None and voice.start(now, self._speed, loop)
        self._anchor = (now, self._now())

    def tick(self) -> None:
        """Bring the playhead to where the clock says it is."""
        (began, at), clock = self._anchor, self._now()
        now = began + (clock - at) * self._speed
        first, last = self._range()
        if now < last:
            self._go_to(now)
        elif self._loop:
            # A late tick keeps its place in the beat; the sound has repeated by itself.
            now = first + (now - last) % max(last - first, 1e-6)
            self._anchor = (now, clock)
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
            self.resync()

    def _range_changed(self) -> None:
        if self._loop:
            self.resync()

    def _now(self) -> float:
        """Seconds that only grow."""
        if self._is_heard and self.voice is not None:
            return self.voice.heard()
        return self._clock()
