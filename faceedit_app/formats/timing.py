"""From the moments of a file's rows to a frame rate and the gaps between frames."""

from __future__ import annotations

import numpy as np

from faceedit_app.core.arrays import Times
from faceedit_app.core.clip import Gap

DEFAULT_RATE = 60.0
_RATES = (10, 12, 15, 20, 24, 25, 30, 48, 50, 60, 90, 100, 120, 240)
_BROADCAST_RATES = tuple(rate * 1000 / 1001 for rate in (24, 30, 48, 60, 120))
# 29.97 and 30 are 0.1 % apart: a slower rate is believed only where it is clearly the nearer.
_BROADCAST_TOLERANCE = 0.0003
# Cameras drift from what they promise; Live Link Face at "60" was measured to run at 59.9.
_DRIFT = 0.005
_GAP = 1.5  # steps, in frames, from which on a frame must be missing


def nominal_rate(measured: float, uncertainty: float) -> float | None:
    """The standard rate that a measured one stands for, or None.

    Args:
        measured: frames per second.
        uncertainty: relative error of the measurement, from how finely the file tells time.
    """
    if uncertainty <= _BROADCAST_TOLERANCE:
        for rate in _BROADCAST_RATES:
            if abs(measured / rate - 1) <= _BROADCAST_TOLERANCE:
                return rate
    nearest = min(_RATES, key=lambda rate: abs(measured / rate - 1))
    if abs(measured / nearest - 1) <= max(_DRIFT, min(uncertainty, 0.05)):
        return float(nearest)
    return None


def typical_step(steps: Times) -> float:
    """The mean of the steps that are about one frame, so that neither gaps nor jitter count.

    Args:
        steps: (N,) from row to row in any unit, at least one of them above 0.
    """
    median = float(np.median(steps[steps > 0]))
    usual = steps[(steps > median / _GAP) & (steps < median * _GAP)]
    return float(usual.mean()) if len(usual) else median


def find_gaps(times: Times, rate: float) -> tuple[Gap, ...]:
    """Where at least one frame is missing.

    Args:
        times: (T,) seconds, increasing.
        rate: frames per second.
    """
    steps = np.diff(times) * rate
    where = np.flatnonzero(steps >= _GAP)
    return tuple(Gap(int(i), max(1, round(float(steps[i])) - 1)) for i in where)


def gap_notes(gaps: tuple[Gap, ...]) -> tuple[str, ...]:
    """One remark that says how many gaps there are and how long, or none."""
    if not gaps:
        return ()
    missing = sum(gap.missing for gap in gaps)
    return (f"{counted(len(gaps), 'gap')}, {counted(missing, 'frame')} missing",)


def counted(number: int, noun: str) -> str:
    """`1 frame`, `2 frames`."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def format_rate(rate: float) -> str:
    """`60 fps`, `29.97 fps`."""
    return f"{rate:.3f}".rstrip("0").rstrip(".") + " fps"


def format_time(seconds: float) -> str:
    """`0:04.533`, `2:14.330`, `1:00:00.000`."""
    thousandths = round(seconds * 1000)
    minutes, rest = divmod(thousandths, 60_000)
    tail = f"{rest // 1000:02d}.{rest % 1000:03d}"
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{tail}" if hours else f"{minutes}:{tail}"
