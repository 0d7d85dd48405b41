"""Figures on how a performance moves, to compare synthesised takes with real ones.

Everything is measured at 25 frames a second, the networks' rate. A missing channel (one that
never moves) gives NaN instead of a figure.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import find_peaks

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Bools, Doubles, Floats, Indices
from faceedit_app.core.regions import LOWER, MODELLED_CHANNELS

TimedWeights = tuple[Doubles, Floats]
"""Times (T,) in seconds and weights (T, 52) in ARKit order."""

RATE = 25.0
BLINK_RATE = 60.0  # lids close in about 90 ms: 25 frames a second cannot time that

PAIRS: tuple[tuple[str, str], ...] = (
    ("jawOpen", "mouthClose"),
    ("jawOpen", "mouthFunnel"),
    ("jawOpen", "mouthPucker"),
    ("jawOpen", "mouthLowerDownLeft"),
    ("jawOpen", "mouthUpperUpLeft"),
    ("jawOpen", "mouthStretchLeft"),
    ("jawOpen", "mouthRollLower"),
    ("jawOpen", "mouthPressLeft"),
    ("jawOpen", "mouthShrugLower"),
    ("mouthFunnel", "mouthPucker"),
    ("mouthRollLower", "mouthRollUpper"),
    ("mouthSmileLeft", "mouthFrownLeft"),
    ("mouthSmileLeft", "cheekSquintLeft"),
    ("mouthSmileLeft", "mouthSmileRight"),
    ("browDownLeft", "browInnerUp"),
    ("browInnerUp", "browOuterUpLeft"),
    ("eyeBlinkLeft", "eyeBlinkRight"),
    ("eyeBlinkLeft", "eyeSquintLeft"),
    ("eyeBlinkLeft", "eyeWideLeft"),
    ("eyeBlinkLeft", "eyeLookDownLeft"),
)
MOUTH_CHANNELS: tuple[str, ...] = LOWER.channels
STD_CHANNELS: tuple[str, ...] = tuple(c for c in MODELLED_CHANNELS if not c.endswith("Right"))


@dataclass(frozen=True)
class MotionStatistics:
    """What `measure` found.

    Attributes:
        seconds: length of all takes together.
        speaking_share: part of the time within 0.4 s of a peak of the jaw, 0..1.
        jaw_peaks: peaks of `jawOpen` a second, while speaking.
        jaw_height: median height of those peaks above the 5th percentile.
        closures: lip closures a minute, while speaking.
        blinks: blinks a minute.
        blink_close_ms, blink_open_ms: median time from 10 % of a blink to its peak, and back.
        blink_peak: median peak of `eyeBlinkLeft`.
        above_4hz, above_8hz: share of the modelled channels' variance, 0..1.
        jaw_above_4hz: the same of `jawOpen` alone, which moods hardly move.
        speed: median over moving channels of the mean absolute change per second by their
            standard deviation.
        std: standard deviation by channel.
        correlations: Pearson's r by pair of channels, in the order of `PAIRS`.
    """

    seconds: float
    speaking_share: float
    jaw_peaks: float
    jaw_height: float
    closures: float
    blinks: float
    blink_close_ms: float
    blink_open_ms: float
    blink_peak: float
    above_4hz: float
    above_8hz: float
    jaw_above_4hz: float
    speed: float
    std: dict[str, float]
    correlations: dict[tuple[str, str], float]


def measure(takes: Iterable[TimedWeights]) -> MotionStatistics:
    """Figures of a set of takes of one person, each centred on its own mean for the shapes.

    Raises:
        ValueError: there is no take of at least a second.
    """
    usable = [take for take in takes if len(take[0]) > 2 and take[0][-1] - take[0][0] >= 1.0]
    if not usable:
        raise ValueError("no take of at least one second to measure")
    slow = [_resampled(take, RATE) for take in usable]
    centred = np.concatenate([w - w.mean(axis=0) for w in slow])
    jaw = np.concatenate([w[:, ARKIT_INDEX["jawOpen"]] for w in slow])
    gap = np.concatenate([_gap(w) for w in slow])
    low, high = np.percentile(jaw, [5, 95])
    peaks, speaking = _jaw_peaks(slow, prominence=max(0.03, 0.12 * (high - low)))
    heights = [float(w[p, ARKIT_INDEX["jawOpen"]] - low) for w, p in zip(slow, peaks, strict=True)
               for p in p]  # fmt: skip
    spoken = max(sum(float(s.sum()) for s in speaking) / RATE, 1.0 / RATE)
    seconds = len(jaw) / RATE
    wide = float(np.percentile(gap, 95))
    closings = sum(_closures(_gap(w)[s], wide) for w, s in zip(slow, speaking, strict=True))
    blinks = [b for take in usable for b in _blinks(_resampled(take, BLINK_RATE))]
    above4, above8 = _high_shares(slow, MODELLED_CHANNELS)
    moving = centred.std(axis=0) > 1e-3
    speeds = np.mean([np.abs(np.diff(w, axis=0)).mean(axis=0) for w in slow], axis=0) * RATE
    return MotionStatistics(
        seconds=seconds,
        speaking_share=spoken / seconds,
        jaw_peaks=len(heights) / spoken,
        jaw_height=_median(heights),
        closures=60.0 * closings / spoken,
        blinks=60.0 * len(blinks) / seconds,
        blink_close_ms=1000.0 * _median([b[0] for b in blinks]),
        blink_open_ms=1000.0 * _median([b[1] for b in blinks]),
        blink_peak=_median([b[2] for b in blinks]),
        above_4hz=above4,
        above_8hz=above8,
        jaw_above_4hz=_high_shares(slow, ("jawOpen",))[0],
        speed=_median((speeds[moving] / centred.std(axis=0)[moving]).tolist()),
        std={c: float(centred[:, ARKIT_INDEX[c]].std()) for c in STD_CHANNELS},
        correlations={pair: _correlation(centred, pair) for pair in PAIRS},
    )


def spectrum(
    takes: Iterable[TimedWeights], channels: Sequence[str] = MOUTH_CHANNELS, segment: float = 2.56
) -> tuple[Doubles, Doubles]:
    """How fast some channels move: Welch's spectrum over segments of some seconds.

    Returns:
        Frequencies (F,) in Hz above 0, and the share of the variance per Hz (F,).
    """
    frames = int(segment * RATE)
    columns = [ARKIT_INDEX[c] for c in channels]
    total = np.zeros(frames // 2 + 1)
    window = np.hanning(frames)[:, None]
    for take in takes:
        if len(take[0]) < 3:
            continue
        weights = _resampled(take, RATE)[:, columns]
        for first in range(0, len(weights) - frames + 1, frames // 2):
            part = weights[first : first + frames]
            moved = (part - part.mean(axis=0)) * window
            total += (np.abs(np.fft.rfft(moved, axis=0)) ** 2).sum(axis=1)
    frequency: Doubles = np.fft.rfftfreq(frames, 1.0 / RATE)[1:].astype(np.float64)
    power: Doubles = total[1:] / max(float(total[1:].sum() * frequency[0]), 1e-12)
    return frequency, power


def table(figures: Mapping[str, MotionStatistics]) -> str:
    """A plain text table: one column for each set of takes, one row for each figure."""
    columns = list(figures.values())
    rows: list[tuple[str, list[str]]] = [
        ("seconds", [f"{f.seconds:.0f}" for f in columns]),
        ("speaking, share of the time", [f"{f.speaking_share:.2f}" for f in columns]),
        ("jaw peaks a second (speaking)", _cells([f.jaw_peaks for f in columns])),
        ("jaw peak height", _cells([f.jaw_height for f in columns])),
        ("lip closures a minute (speaking)", _cells([f.closures for f in columns], 1)),
        ("blinks a minute", _cells([f.blinks for f in columns], 1)),
        ("blink closing, ms", _cells([f.blink_close_ms for f in columns], 0)),
        ("blink opening, ms", _cells([f.blink_open_ms for f in columns], 0)),
        ("blink peak", _cells([f.blink_peak for f in columns])),
        ("variance above 4 Hz", _cells([f.above_4hz for f in columns], 4)),
        ("variance above 8 Hz", _cells([f.above_8hz for f in columns], 4)),
        ("jaw variance above 4 Hz", _cells([f.jaw_above_4hz for f in columns], 4)),
        ("speed, std a second", _cells([f.speed for f in columns])),
    ]
    rows += [(f"std {c}", _cells([f.std[c] for f in columns], 3)) for c in STD_CHANNELS]
    rows += [(f"r {a} {b}", _cells([f.correlations[a, b] for f in columns])) for a, b in PAIRS]
    titles = list(figures)
    first = max(len(label) for label, _ in rows)
    width = max(8, *(len(t) for t in titles)) + 2
    lines = [" " * first + "".join(t.rjust(width) for t in titles)]
    lines += [label.ljust(first) + "".join(c.rjust(width) for c in cells) for label, cells in rows]
    return "\n".join(lines) + "\n"


def _cells(values: Sequence[float], digits: int = 2) -> list[str]:
    return ["-" if np.isnan(v) else f"{v:.{digits}f}" for v in values]


def _median(values: Sequence[float]) -> float:
    return float(np.median(values)) if len(values) else float("nan")


def _resampled(take: TimedWeights, rate: float) -> Doubles:
    times, weights = take
    grid = np.arange(times[0], times[-1], 1.0 / rate)
    return np.stack([np.interp(grid, times, weights[:, k]) for k in range(weights.shape[1])], 1)


def _gap(weights: Doubles) -> Doubles:
    """How far the lips are apart, in units of `jawOpen`: (T, 52) -> (T,)."""
    gap: Doubles = weights[:, ARKIT_INDEX["jawOpen"]] - weights[:, ARKIT_INDEX["mouthClose"]]
    return gap


def _jaw_peaks(takes: Sequence[Doubles], prominence: float) -> tuple[list[Indices], list[Bools]]:
    """Frames of the peaks of the jaw, and which frames are near one, for each take."""
    peaks, speaking = [], []
    for weights in takes:
        found, _ = find_peaks(weights[:, ARKIT_INDEX["jawOpen"]], prominence=prominence)
        near = np.zeros(len(weights), bool)
        for frame in found:
            near[max(0, frame - int(0.4 * RATE)) : frame + int(0.4 * RATE) + 1] = True
        peaks.append(found)
        speaking.append(near)
    return peaks, speaking


def _closures(gap: Doubles, wide: float) -> int:
    """How often the lips come together (15 % of `wide`) after having been apart (30 %)."""
    count, apart = 0, False
    for value in gap:
        if value > 0.3 * wide:
            apart = True
        elif apart and value < 0.15 * wide:
            count, apart = count + 1, False
    return count


def _blinks(weights: Doubles) -> list[tuple[float, float, float]]:
    """Seconds of closing, seconds of opening and peak of each blink, from (T, 52) at 60 fps."""
    lid = weights[:, ARKIT_INDEX["eyeBlinkLeft"]]
    peaks, _ = find_peaks(lid, prominence=0.25, width=(3, 30), rel_height=0.5)
    out = []
    for peak in peaks:
        base = float(np.median(lid[max(0, peak - 30) : peak + 45]))
        level = base + 0.1 * (lid[peak] - base)
        if lid[peak] - base < 0.2:
            continue
        start, stop = peak, peak
        while start > 0 and lid[start] > level:
            start -= 1
        while stop < len(lid) - 1 and lid[stop] > level:
            stop += 1
        out.append(((peak - start) / BLINK_RATE, (stop - peak) / BLINK_RATE, float(lid[peak])))
    return out


def _high_shares(takes: Sequence[Doubles], channels: Sequence[str]) -> tuple[float, float]:
    """Share of the variance of these channels above 4 and above 8 Hz."""
    columns = [ARKIT_INDEX[c] for c in channels]
    sums = np.zeros(3)
    for weights in takes:
        x = weights[:, columns] - weights[:, columns].mean(axis=0)
        power = (np.abs(np.fft.rfft(x * np.hanning(len(x))[:, None], axis=0)) ** 2).sum(axis=1)
        frequency = np.fft.rfftfreq(len(x), 1.0 / RATE)
        sums += [power[1:].sum(), power[frequency > 4].sum(), power[frequency > 8].sum()]
    return float(sums[1] / sums[0]), float(sums[2] / sums[0])


def _correlation(centred: Doubles, pair: tuple[str, str]) -> float:
    a, b = (centred[:, ARKIT_INDEX[name]] for name in pair)
    scale = float(a.std() * b.std())
    return float((a * b).mean() / scale) if scale > 1e-7 else float("nan")
