"""Takes whose frame rate changes on the way: two recordings in one, or a camera that slowed down.

Such a stretch of a lower rate is not a row of gaps, and no mean of the rates is anybody's rate.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from faceedit_app.core.arrays import Bools, Times
from faceedit_app.formats.rates import nominal_rate

_FEWEST = 12  # steps of a stretch
_MOST = 8  # stretches of one take
_EVEN = 0.03  # share of a step by which others in its stretch may be off
_APART = 1.03  # factor between two rates
_SLOWEST = 5.5  # frames from row to row of a stretch; beyond, they were lost
_COVERED = 0.9  # share of the steps that must be in stretches
_MUCH = 0.2  # share of the steps whose rate may be the take's


@dataclass(frozen=True)
class SteadyRows:
    """Rows that come at one rate.

    Attributes:
        first, last: its rows.
        rate: frames per second.
    """

    first: int
    last: int
    rate: float


def stretches(times: Times, resolution: float = 0.0) -> list[SteadyRows]:
    """The stretches of a take whose frame rate changes; empty if it does not.

    Args:
        times: (T,) seconds, increasing.
        resolution: of the times, in seconds.
    """
    steps = np.diff(times)
    found: list[SteadyRows] = []
    for first, last in _runs(steps, 2.02 * resolution):
        length = float(times[last] - times[first])
        rate = nominal_rate((last - first) / length, max(2 * resolution / length, 1e-3))
        if rate is None:
            return []
        same = found and max(rate, found[-1].rate) < _APART * min(rate, found[-1].rate)
        if same:
            found[-1] = SteadyRows(found[-1].first, last, found[-1].rate)
        else:
            found.append(SteadyRows(first, last, rate))
    covered = sum(one.last - one.first for one in found)
    if not 1 < len(found) <= _MOST or covered < _COVERED * len(steps):
        return []
    return found


def usual_rate(found: list[SteadyRows]) -> float:
    """The take's rate: the highest that much of it has, so that no detail is lost."""
    rows = sum(one.last - one.first for one in found)
    return max(
        (one.rate for one in found if one.last - one.first >= _MUCH * rows),
        default=max(found, key=lambda one: one.last - one.first).rate,
    )


def evened_stretches(times: Times, found: list[SteadyRows], slack: float) -> Times:
    """The times (T,), even within each stretch if rounding alone explains that they are not.

    Args:
        slack: the largest difference of two roundings of the same time, in seconds.
    """
    out = times.copy()
    for one in found:
        part = slice(one.first, one.last + 1)
        even = np.arange(one.last + 1 - one.first) / one.rate
        late = times[part] - even
        if np.ptp(late) <= slack:
            out[part] = even + (late.max() + late.min()) / 2
    return out if np.all(np.diff(out) > 0) else times


def in_slower_stretch(steps: Times) -> Bools:
    """(N,) which of the steps belong to a stretch of even ones, longer than a frame.

    Args:
        steps: (N,) in frames.
    """
    out = np.zeros(len(steps), bool)
    for first, last in _runs(steps, 0.0):
        out[first:last] = _APART < steps[first] <= _SLOWEST
    return out


def _runs(steps: Times, slack: float) -> list[tuple[int, int]]:
    """First and last row of each run of enough even steps (N,)."""
    if not len(steps):
        return []
    near = np.abs(np.diff(steps)) <= np.maximum(slack, _EVEN * steps[1:])
    edges = [0, *(np.flatnonzero(~near) + 1).tolist(), len(steps)]
    return [(a, b) for a, b in pairwise(edges) if b - a >= _FEWEST]
