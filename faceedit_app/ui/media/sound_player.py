"""Plays the take's sound: with playback, and briefly while scrubbing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from faceedit_app.core.errors import Unavailable
from faceedit_app.ui.media.take_media import TakeMedia
from faceedit_app.ui.state.background import Background
from faceedit_app.ui.state.playback import Playback
from faceedit_app.ui.state.timeline import Timeline

if TYPE_CHECKING:
    from faceedit_app.media.output import Output
    from faceedit_app.media.sound import Sound


class SoundPlayer(QObject):
    """The voice of playback. Without a sound device, playback is silent.

    Signals:
        changed(): volume, mute, or whether there is a device, changed.
        settled(): the user changed volume or mute.
    """

    changed = Signal()
    settled = Signal()

    def __init__(
        self, media: TakeMedia, timeline: Timeline, playback: Playback, background: Background
    ) -> None:
        super().__init__(media)
        self._media, self._timeline, self._playback = media, timeline, playback
        self._background = background
        self._output: Output | None = None
        self._job = 0
        self._opening = False
        self.problem = ""  # why there is no sound, in one line
        self.volume, self.muted = 1.0, False
        playback.voice = self
        media.sound_changed.connect(self._use_sound)
        media.placed.connect(self._place)
        timeline.playhead_moved.connect(self._scrub)

    # --- volume ------------------------------------------------------------------------------

    def set_volume(self, volume: float) -> None:
        """Set the volume, 0..1; above 0 it also unmutes."""
        self.volume = min(max(volume, 0.0), 1.0)
        self.muted = False if volume > 0 else self.muted
        self._show_volume()
        self.settled.emit()

    def set_muted(self, muted: bool) -> None:
        """Mute or unmute, keeping the volume."""
        self.muted = muted
        self._show_volume()
        self.settled.emit()

    def _show_volume(self) -> None:
        if self._output is not None:
            # Loudness is perceived in ratios: with a square, half the slider sounds half as loud.
            self._output.set_volume(0.0 if self.muted else self.volume**2)
        self.changed.emit()

    # --- the device --------------------------------------------------------------------------

    def _use_sound(self) -> None:
        """Open the device for another sound, which may take a second."""
        self.close()
        if self._media.sound is None:
            return
        job, sound = self._job, self._media.sound.item
        self._opening = True

        def opened(device: Output) -> None:
            if job != self._job:
                device.close()
                return
            self._output, self.problem, self._opening = device, "", False
            self._place()
            self._show_volume()

        def missing(error: Exception) -> None:
            if not isinstance(error, Unavailable):
                raise error
            if job == self._job:
                self.problem, self._opening = str(error), False
                self.changed.emit()

        self._background.run(lambda: _open(sound), opened, missing)

    def _place(self) -> None:
        if self._output is not None and self._media.sound is not None:
            self._output.use(self._media.sound.item, self._media.sound.offset)
            self._playback.resync()

    def close(self) -> None:
        """Release the device."""
        self._job += 1
        self._opening = False
        device, self._output = self._output, None
        if device is not None:
            device.close()
            self._playback.resync()

    # --- for playback ------------------------------------------------------------------------

    def start(self, seconds: float, speed: float, loop: tuple[float, float] | None) -> bool:
        """See `playback.Voice`."""
        if self._output is not None and not self._output.is_alive:
            self.close()  # unplugged
        if self._output is None:
            if not self._opening:
                self._use_sound()  # it plays as soon as a device is open
            return False
        self._output.play(seconds, speed, loop)
        return True

    def heard(self) -> float:
        """See `playback.Voice`."""
        return self._output.heard() if self._output is not None else 0.0

    def stop(self) -> None:
        """See `playback.Voice`."""
        if self._output is not None:
            self._output.stop()

    def _scrub(self) -> None:
        if self._output is not None and not self._playback.playing:
            self._output.grain(self._timeline.time)


def _open(sound: Sound) -> Output:
    from faceedit_app.media import output

    return output.open_output(sound)
