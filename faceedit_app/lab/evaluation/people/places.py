"""Where takes are edited: drawn by the take's name, the same in every run."""

from __future__ import annotations

import zlib
from collections.abc import Sequence

import numpy as np

from faceedit_app.core.arrays import Bools, Times
from faceedit_app.formats.take import Take

SEED = 2019
GAP = 3.5  # frames; a frame or two that a recording dropped make no difference


def random_for(take: Take, purpose: str) -> np.random.Generator:
    """The random numbers of a take for a purpose; they depend on nothing but the two names."""
    return np.random.default_rng([SEED, zlib.crc32(f"{take.path.name} {purpose}".encode())])


def pick(
    random: np.random.Generator, times: Times, where: Bools, apart: float, most: int
) -> list[float]:
    """Draw times from frames where something is true.

    Args:
        times: (T,) seconds.
        where: (T,) bool.
        apart: seconds between any two, at least.
        most: how many at most.

    Returns:
        Seconds, in order.
    """
    chosen: list[float] = []
    for time in random.permutation(times[where]).tolist():
        if len(chosen) == most:
            break
        if all(abs(time - other) >= apart for other in chosen):
            chosen.append(time)
    return sorted(chosen)


def inside(times: Times, margin: float) -> Bools:
    """(T,) whether a frame is farther than `margin` seconds from both ends and from any gap."""
    result: Bools = (times > times[0] + margin) & (times < times[-1] - margin)
    for before, after in gaps(times):
        result &= (times < before - margin) | (times > after + margin)
    return result


def gaps(times: Times) -> list[tuple[float, float]]:
    """The last second before, and the first after, each gap of more than `GAP` frames."""
    steps = np.diff(times)
    places = np.flatnonzero(steps > GAP * np.median(steps))
    return [(float(times[i]), float(times[i + 1])) for i in places]


def frames(times: Times, start: float, end: float) -> slice:
    """The frames from `start` to `end` seconds, both included."""
    first, last = np.searchsorted(times, (start - 1e-6, end + 1e-6)).tolist()
    return slice(first, last)


def runs(where: Bools) -> Sequence[slice]:
    """The unbroken runs of true frames."""
    edges = np.diff(np.concatenate([[0], where.astype(np.int8), [0]]))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    return [slice(int(a), int(b)) for a, b in zip(starts, ends, strict=True)]
