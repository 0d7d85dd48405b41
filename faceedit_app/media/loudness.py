"""How loud a sound is over time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.arrays import Doubles, Times

if TYPE_CHECKING:  # imports PyAV, which is loaded with the first file
    from faceedit_app.media.sound import Sound

_SILENT = 1e-5  # of full scale; 100 dB below
_ENOUGH = 8000.0  # samples per second that suffice to measure loudness


def loudness(sound: Sound, times: Times, window: float) -> Doubles:
    """(N,) dB below full scale: the loudness around some times.

    Args:
        sound: the sound.
        times: (N,) seconds from the beginning of its file, in order.
        window: seconds around each time that are measured; beyond the sound it is silent.
    """
    step = max(int(sound.rate / _ENOUGH), 1)
    begin = (float(times[0]) - 0.5 * window - sound.start) * sound.rate
    count = int((float(times[-1] - times[0]) + window) * sound.rate / step) + 1
    samples = sound.read(round(begin), count * step)[::step].mean(axis=1)
    power = np.concatenate([[0.0], np.cumsum(np.square(samples, dtype=np.float64))])
    first = np.round((times - times[0]) * sound.rate / step).astype(np.intp)
    last = np.minimum(first + max(round(window * sound.rate / step), 1), count)
    mean = (power[last] - power[first]) / np.maximum(last - first, 1)
    level: Doubles = 20.0 * np.log10(np.sqrt(np.maximum(mean, 0.0)) + _SILENT)
    return level
