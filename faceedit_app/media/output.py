"""Sound output, and the clock that playback follows.

`Mixer` computes each sample and `DeviceClock` when it is heard; both work without a device, for
tests. `Loudspeaker` is the device.
"""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from faceedit_app.core.arrays import Floats
from faceedit_app.core.errors import Unavailable
from faceedit_app.media.sound import Sound

if TYPE_CHECKING:
    import sounddevice


GRAIN = 0.08  # seconds of sound at the playhead while scrubbing
FADE = 0.006  # seconds over which sounds fade in and out, to avoid clicks
LATENCY = 0.09  # seconds of buffered sound; the window may be busy for as long
_SETTLING = 0.15  # weight of a new measurement in the clock
_PATIENCE = 0.4  # seconds to wait for a device to begin


@dataclass
class _Voice:
    """A stretch of sound that is playing.

    Attributes:
        at: the next sample of the sound.
        step: samples of the sound per sample of the device.
        left: samples of the device until it ends, or None.
        around: (first, last) sample of the loop, or None.
        gain, wanted: its present gain and the gain it fades to, 0..1.
    """

    at: float
    step: float
    left: int | None = None
    around: tuple[float, float] | None = None
    gain: float = 0.0
    wanted: float = 1.0

    @property
    def is_over(self) -> bool:
        """Whether it has ended."""
        faded = self.wanted == 0.0 and self.gain == 0.0
        return faded or (self.left is not None and self.left <= 0)


class Mixer:
    """Computes the samples for the device: playback, grains and volume.

    `fill` is called in the device's thread, everything else in the window's.

    Args:
        rate: the device's samples per second.
        channels: the device's channels.
    """

    def __init__(self, rate: float, channels: int) -> None:
        self.rate, self.channels = rate, channels
        self._lock = threading.Lock()
        self._sound: Sound | None = None
        self._offset = 0.0
        self._voices: list[_Voice] = []
        self._volume = self._heard_volume = 1.0
        self.played = 0  # device samples since `play`
        self._playing = False

    def use(self, sound: Sound | None, offset: float) -> None:
        """Set the sound, which begins at `offset` seconds of the take."""
        with self._lock:
            if sound is not self._sound:
                self._voices.clear()
            self._sound, self._offset = sound, offset

    def set_volume(self, volume: float) -> None:
        """Set the volume, 0..1."""
        self._volume = min(max(volume, 0.0), 1.0)

    def play(self, seconds: float, speed: float, loop: tuple[float, float] | None) -> None:
        """Play from a time of the take.

        Args:
            seconds: where to begin.
            speed: also changes the pitch, as on tape, which keeps lips and sound together.
            loop: the first and last second of a loop, or None.
        """
        with self._lock:
            self._hush()
            self._begin(seconds, speed, None, loop)
            self.played, self._playing = 0, True

    def grain(self, seconds: float) -> None:
        """Play a grain from a time of the take; it replaces the last one."""
        with self._lock:
            self._hush()
            self._begin(seconds, 1.0, round(GRAIN * self.rate), None)

    def stop(self) -> None:
        """Stop the sound."""
        with self._lock:
            self._hush()

    def _hush(self) -> None:
        self._playing = False
        for voice in self._voices:
            voice.wanted = 0.0

    def _begin(
        self, seconds: float, speed: float, left: int | None, loop: tuple[float, float] | None
    ) -> None:
        if self._sound is not None:
            step = speed * self._sound.rate / self.rate
            around = None
            if loop is not None and loop[1] > loop[0]:
                around = self._sample(loop[0]), self._sample(loop[1])
            self._voices.append(_Voice(self._sample(seconds), step, left, around))

    def _sample(self, seconds: float) -> float:
        """The sample of the sound at a time of the take."""
        assert self._sound is not None
        return (seconds - self._offset - self._sound.start) * self._sound.rate

    def fill(self, out: Floats) -> None:
        """Write the next samples for the device to `out` (n, C)."""
        count = len(out)
        with self._lock:
            out[:] = 0.0
            for voice in self._voices:
                out += self._rendered(voice, count)
            self._voices = [voice for voice in self._voices if not voice.is_over]
            if self._playing:
                self.played += count
        before, self._heard_volume = self._heard_volume, self._volume
        out *= np.linspace(before, self._heard_volume, count, dtype=np.float32)[:, None]
        np.clip(out, -1.0, 1.0, out=out)

    def _rendered(self, voice: _Voice, count: int) -> Floats:
        fade, steps = max(1.0, FADE * self.rate), np.arange(1, count + 1, dtype=np.float32)
        way = 1.0 if voice.wanted > voice.gain else -1.0
        ramp = np.full(count, voice.gain, np.float32)
        if voice.wanted != voice.gain:
            ramp = np.clip(voice.gain + way * steps / fade, 0.0, 1.0)
        voice.gain = float(ramp[-1])
        if voice.left is not None:
            ramp = ramp * np.clip((voice.left - steps) / fade, 0.0, 1.0)
            voice.left -= count
        faded: Floats = self._spread(self._samples(voice, count)) * ramp[:, None]
        return faded

    def _samples(self, voice: _Voice, count: int) -> Floats:
        sound = self._sound
        assert sound is not None
        if voice.around is None:
            part = sound.read(voice.at, count, voice.step)
            voice.at += count * voice.step
            return part
        parts = []
        while count > 0:
            first, last = voice.around
            if voice.at >= last:
                voice.at = first + (voice.at - last) % (last - first)
            some = min(count, max(1, int(np.ceil((last - voice.at) / voice.step))))
            parts.append(sound.read(voice.at, some, voice.step))
            voice.at += some * voice.step
            count -= some
        return np.concatenate(parts)

    def _spread(self, sounds: Floats) -> Floats:
        if sounds.shape[1] == self.channels:
            return sounds
        mono = sounds.mean(axis=1, keepdims=True, dtype=np.float32)
        return np.repeat(mono, self.channels, axis=1)


class DeviceClock:
    """Seconds of sound heard since playback began.

    The device asks for blocks of samples at irregular times. Each block says when its first sample
    will be heard; a smoothed estimate of when the first sample of all was heard gives a steady
    clock. It continues by the wall clock if the device stops.

    Args:
        wall: a monotonic clock, seconds.
    """

    def __init__(self, wall: Callable[[], float] = time.perf_counter) -> None:
        self._wall = wall
        self._zero: float | None = None  # wall time at which the first sample was heard
        self._begun = wall()
        self._last = 0.0

    def restart(self) -> None:
        """Restart the clock: playback begins, and nothing has been heard yet."""
        self._zero, self._begun, self._last = None, self._wall(), 0.0

    def block(self, delivered: float, latency: float) -> None:
        """Note that the device takes a block.

        Args:
            delivered: seconds of sound before this block.
            latency: seconds until this block is heard.
        """
        zero = self._wall() + latency - delivered
        if self._zero is None or abs(zero - self._zero) > 0.1:  # begun, or after a dropout
            self._zero = zero
        else:
            self._zero += _SETTLING * (zero - self._zero)

    def __call__(self) -> float:
        """Seconds heard; never decreases."""
        # A device that never begins must not stop the playhead.
        zero = self._begun + _PATIENCE if self._zero is None else self._zero
        self._last = max(self._last, self._wall() - zero)
        return self._last


class Output(Protocol):
    """Plays a take's sound: `Loudspeaker`, or a substitute in tests."""

    @property
    def is_alive(self) -> bool:
        """Whether the device still works."""

    def use(self, sound: Sound | None, offset: float) -> None:
        """Set the sound, which begins at `offset` seconds of the take."""

    def set_volume(self, volume: float) -> None:
        """0..1."""

    def play(self, seconds: float, speed: float, loop: tuple[float, float] | None) -> None:
        """Play from a time of the take; see `Mixer.play`."""

    def heard(self) -> float:
        """Seconds heard since `play`, by the device's clock."""

    def grain(self, seconds: float) -> None:
        """Play a grain; see `Mixer.grain`."""

    def stop(self) -> None:
        """Stop the sound."""

    def close(self) -> None:
        """Release the device."""


class Loudspeaker:
    """The system's sound device."""

    def __init__(self, sound: Sound) -> None:
        """Open the device for a sound.

        Raises:
            Unavailable: there is no device, or PortAudio is missing.
        """
        device = sound_library()
        self.clock = DeviceClock()
        try:
            try:
                self._stream, rate = self._opened(device, sound)
            except device.PortAudioError:
                _look_again(device)
                self._stream, rate = self._opened(device, sound)
            self.mixer = Mixer(rate, self._stream.channels)
            self._stream.start()
        except device.PortAudioError as error:
            raise Unavailable(
                f"No sound: the sound device cannot be used ({_reason(error)});"
                " check the system's sound settings"
            ) from error

    def _opened(self, device: Any, sound: Sound) -> tuple[sounddevice.OutputStream, float]:
        """A stream at the sound's rate, else at the device's, and that rate."""
        options = {
            "channels": sound.channels,
            "dtype": "float32",
            "latency": LATENCY,
            "callback": self._fill,
        }
        try:
            return device.OutputStream(samplerate=sound.rate, **options), float(sound.rate)
        except device.PortAudioError:
            facts = device.query_devices(kind="output")
            options["channels"] = min(sound.channels, int(facts["max_output_channels"]))
            rate = float(facts["default_samplerate"])
            return device.OutputStream(samplerate=rate, **options), rate

    def _fill(self, out: Floats, frames: int, times: Any, status: object) -> None:
        """Called in the device's thread for `frames` more samples."""
        mixer = self.mixer
        ahead = float(times.outputBufferDacTime - times.currentTime)
        # Some systems do not tell when a block is heard.
        latency = ahead if 0.0 < ahead < 1.0 else float(self._stream.latency)
        self.clock.block(mixer.played / mixer.rate, latency)
        mixer.fill(out)

    @property
    def is_alive(self) -> bool:
        """See `Output`."""
        return bool(self._stream.active)

    def use(self, sound: Sound | None, offset: float) -> None:
        """See `Output`."""
        self.mixer.use(sound, offset)

    def set_volume(self, volume: float) -> None:
        """See `Output`."""
        self.mixer.set_volume(volume)

    def play(self, seconds: float, speed: float, loop: tuple[float, float] | None) -> None:
        """See `Output`."""
        self.mixer.play(seconds, speed, loop)
        self.clock.restart()

    def heard(self) -> float:
        """See `Output`."""
        return self.clock()

    def grain(self, seconds: float) -> None:
        """See `Output`."""
        self.mixer.grain(seconds)

    def stop(self) -> None:
        """See `Output`."""
        self.mixer.stop()

    def close(self) -> None:
        """See `Output`."""
        self._stream.close()


def open_output(sound: Sound) -> Output:
    """Open the system's sound device; may take a second, so never in the window's thread.

    Raises:
        Unavailable: there is no device, or PortAudio is missing.
    """
    return Loudspeaker(sound)


def sound_library() -> Any:
    try:
        import sounddevice
    except (ImportError, OSError) as error:
        raise Unavailable(
            f"No sound: {_reason(error)}; install libportaudio2 and the package sounddevice"
        ) from error
    return sounddevice


def _look_again(device: Any) -> None:
    """Make PortAudio find devices that were plugged in since it was loaded."""
    with contextlib.suppress(AttributeError):  # there is no public function yet
        device._terminate()
        device._initialize()


def _reason(error: Exception) -> str:
    return str(error).splitlines()[0].rstrip(".") if str(error) else type(error).__name__
