"""Steady noise is taken out of speech before it is aligned: fricatives drown in it first.

Spectral subtraction with a floor (Berouti, Schwartz and Makhoul 1979, "Enhancement of speech
corrupted by acoustic noise"). The noise in each band is what the band has in its quieter frames.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.errors import FaceEditError

RATE = 16_000  # samples per second of the acoustic model
Samples = NDArray[np.int16]

_CLEAN = 29.0  # dB between loud and quiet frames; with less noise, sounds stay as they are
_BLOCK = 60 * RATE  # samples, over which noise counts as steady
_SHORTEST = RATE  # samples, in which noise can be told from speech
_FRAME, _STEP, _FFT = 400, 160, 512  # samples: 25 and 10 ms
_QUIET = 0.3  # quantile of a band's frames that is noise
_OVER = 2.0  # times the noise that is taken away: its frames vary
_FLOOR = 0.05  # of the amplitude stays, so that nothing rings


class Stopped(FaceEditError):
    """The user cancelled it."""


def without_noise(voice: Samples, progress: Callable[[float], bool]) -> Samples:
    """The sound with less noise if it has any; the same sound if it is clean.

    Args:
        voice: (N,) int16 at 16 kHz.
        progress: False gives up.

    Raises:
        Stopped: `progress` said so.
    """
    if len(voice) < _SHORTEST or _contrast(voice) > _CLEAN:
        return voice
    cleaned = []
    for block in np.array_split(voice, max(round(len(voice) / _BLOCK), 1)):
        if not progress(0.0):
            raise Stopped("Cancelled")
        cleaned.append(_subtracted(block))
    return np.concatenate(cleaned)


def frame_power(voice: Samples) -> Doubles:
    """(T,) mean square of each frame of 10 ms."""
    whole = voice[: len(voice) // _STEP * _STEP].reshape(-1, _STEP)
    power: Doubles = np.mean(np.square(whole.astype(np.float64)), axis=1)
    return power


def _contrast(voice: Samples) -> float:
    """Loud frames over quiet ones, dB: more than the signal-to-noise ratio, as speech has gaps."""
    low, high = np.percentile(frame_power(voice), (10, 90))
    return 10.0 * float(np.log10(max(high, 1.0) / max(low, 1.0)))


def _subtracted(voice: Samples) -> Samples:
    window = np.hanning(_FRAME + 1)[:-1].astype(np.float32)
    padded = np.pad(voice.astype(np.float32), (_FRAME, 2 * _FRAME))
    frames = sliding_window_view(padded, _FRAME)[::_STEP] * window
    bands = np.fft.rfft(frames, _FFT).astype(np.complex64)
    power = np.square(np.abs(bands))
    noise = _OVER * np.quantile(power, _QUIET, axis=0)
    bands *= np.maximum(1.0 - noise / np.maximum(power, 1e-9), _FLOOR)
    parts = np.fft.irfft(bands, _FFT)[:, :_FRAME] * window
    sound, weight = np.zeros(len(padded)), np.full(len(padded), 1e-6)
    for i, part in enumerate(parts):  # overlap and add
        at = slice(i * _STEP, i * _STEP + _FRAME)
        sound[at] += part
        weight[at] += window**2
    cleaned = (sound / weight)[_FRAME : _FRAME + len(voice)]
    quiet: Samples = np.clip(np.rint(cleaned), -32768, 32767).astype(np.int16)
    return quiet
