"""What is done to a sound before it is aligned: noise and long silences are taken out.

Fricatives drown in steady noise first. Silence beside speech is matched with any words, because the
recogniser takes the mean spectrum away, which is then that of the silence.

Noise: spectral subtraction with a floor (Berouti, Schwartz and Makhoul 1979, "Enhancement of speech
corrupted by acoustic noise"). The noise in each band is what the band has in its quieter frames.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from faceedit_app.core.arrays import Doubles, Indices, Samples
from faceedit_app.core.errors import FaceEditError

RATE = 16_000  # samples per second of the acoustic model
STEP = 0.01  # seconds of a frame

_CLEAN = 29.0  # dB between loud and quiet frames; with less noise, sounds stay as they are
_BLOCK = 60 * RATE  # samples, over which noise counts as steady
_SHORTEST = RATE  # samples, in which noise can be told from speech
_FRAME, _HOP, _FFT = 400, 160, 512  # samples: 25 and 10 ms
# The quantile of a band's frames that is noise, and how many times it is taken away: frames vary.
_WAYS = ((0.3, 2.0), (0.3, 1.0), (0.5, 2.0))
_FLOOR = 0.05  # of the amplitude stays, so that nothing rings
_SMOOTH = 30  # frames over which loudness is measured
_MARGIN = 30  # frames of silence that stay beside speech
_LONG = 100  # frames: shorter silences stay
_LEAST = 15.0  # dB between quiet and loud, with which silence can be told from speech


class Stopped(FaceEditError):
    """The user cancelled it."""


def views(voice: Samples, progress: Callable[[float], bool]) -> tuple[Samples, ...]:
    """A noisy sound with less noise, taken out in several ways; the sound alone if it is clean.

    Each way moves other edges of words; their median is right more often than any of them.

    Args:
        voice: (N,) int16 at 16 kHz.
        progress: False gives up.

    Raises:
        Stopped: `progress` said so.
    """
    if len(voice) < _SHORTEST or _contrast(voice) > _CLEAN:
        return (voice,)
    cleaned = []
    for quiet, over in _WAYS:
        blocks = []
        for block in np.array_split(voice, max(round(len(voice) / _BLOCK), 1)):
            if not progress(0.0):
                raise Stopped("Cancelled")
            blocks.append(_subtracted(block, quiet, over))
        cleaned.append(np.concatenate(blocks))
    return tuple(cleaned)


@dataclass(frozen=True)
class Spoken:
    """A sound without its long silences.

    Attributes:
        samples: (N,) int16 at 16 kHz.
        frames: (T,) the frames of the whole sound that it consists of.
    """

    samples: Samples
    frames: Indices

    def begin(self, time: float) -> float:
        """When something that begins at a time of it begins in the whole sound, seconds."""
        frame = min(int(time / STEP + 1e-6), len(self.frames) - 1)
        return time + STEP * (int(self.frames[frame]) - frame) if frame >= 0 else time

    def end(self, time: float) -> float:
        """When something that ends at a time of it ends in the whole sound, seconds."""
        return self.begin(max(time - STEP, 0.0)) + min(time, STEP)

    def inside(self, time: float) -> float:
        """The time within it of a time of the whole sound; a silence has that of its end."""
        frame = int(np.searchsorted(self.frames, int(time / STEP + 1e-6)))
        here = frame < len(self.frames) and self.frames[frame] * STEP <= time
        return STEP * frame + (time - self.frames[frame] * STEP if here else 0.0)


def without_silence(voice: Samples) -> Spoken:
    """The sound without the inner part of each silence of over a second.

    Silence is what is quieter than half-way, in dB, between quiet and loud.

    Args:
        voice: (N,) int16 at 16 kHz.
    """
    everything = Spoken(voice, np.arange(len(voice) // _HOP))
    if not len(everything.frames):
        return everything
    power = loudness(voice)
    low, high = max(np.percentile(power, 10), 1.0), max(power.max(), 1.0)
    if 10.0 * np.log10(high / low) < _LEAST:
        return everything
    quiet = np.concatenate([[False], power < np.sqrt(low * high), [False]])
    kept = np.ones(len(power), np.bool_)
    for begin, end in np.flatnonzero(np.diff(quiet)).reshape(-1, 2).tolist():
        if end - begin > _LONG:
            inner = slice(begin + _MARGIN if begin else 0, end - _MARGIN)
            kept[inner if end < len(power) else slice(inner.start, None)] = False
    frames = np.flatnonzero(kept)
    samples = voice[: len(power) * _HOP].reshape(-1, _HOP)[frames].ravel()
    return Spoken(samples, frames)


def loudness(voice: Samples) -> Doubles:
    """(T,) mean square around each frame of 10 ms."""
    return np.convolve(frame_power(voice), np.ones(_SMOOTH) / _SMOOTH, "same")[: len(voice) // _HOP]


def frame_power(voice: Samples) -> Doubles:
    """(T,) mean square of each frame of 10 ms."""
    whole = voice[: len(voice) // _HOP * _HOP].reshape(-1, _HOP)
    power: Doubles = np.mean(np.square(whole.astype(np.float64)), axis=1)
    return power


def _contrast(voice: Samples) -> float:
    """Loud frames over quiet ones, dB: more than the signal-to-noise ratio, as speech has gaps."""
    low, high = np.percentile(frame_power(voice), (10, 90))
    return 10.0 * float(np.log10(max(high, 1.0) / max(low, 1.0)))


def _subtracted(voice: Samples, quiet: float, over: float) -> Samples:
    window = np.hanning(_FRAME + 1)[:-1].astype(np.float32)
    padded = np.pad(voice.astype(np.float32), (_FRAME, 2 * _FRAME))
    frames = sliding_window_view(padded, _FRAME)[::_HOP] * window
    bands = np.fft.rfft(frames, _FFT).astype(np.complex64)
    power = np.square(np.abs(bands))
    noise = over * np.quantile(power, quiet, axis=0)
    bands *= np.maximum(1.0 - noise / np.maximum(power, 1e-9), _FLOOR)
    parts = np.fft.irfft(bands, _FFT)[:, :_FRAME] * window
    sound, weight = np.zeros(len(padded)), np.full(len(padded), 1e-6)
    for i, part in enumerate(parts):  # overlap and add
        at = slice(i * _HOP, i * _HOP + _FRAME)
        sound[at] += part
        weight[at] += window**2
    cleaned = (sound / weight)[_FRAME : _FRAME + len(voice)]
    less: Samples = np.clip(np.rint(cleaned), -32768, 32767).astype(np.int16)
    return less
