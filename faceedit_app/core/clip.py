"""Blendshape weights over time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX, ROTATIONS
from faceedit_app.core.arrays import Floats, Indices, Times

UNSURE = 0.8  # confidence below which the tracker may be wrong; below 0.5 it is a gap


@dataclass(frozen=True)
class Gap:
    """Frames that the recording lost.

    Attributes:
        frame: index of the last frame before the gap.
        missing: how many frames are missing.
    """

    frame: int
    missing: int


@dataclass(frozen=True)
class Clip:
    """Blendshape weights over time, as recorded: no frame is added or dropped.

    Attributes:
        weights: (T, K) float32, nominally 0..1; values above 1, which trackers write, are kept.
        channels: the K ARKit names, spelled as in `arkit.ARKIT_CHANNELS`, in the source's order.
        times: (T,) float64, seconds from the first frame, strictly increasing.
        rate: nominal frames per second.
        gaps: where frames are missing.
        timecodes: the T timecodes as the source writes them; empty if it has none.
        rotations: (T, 9) yaw, pitch and roll of the head, the left and the right eye, in radians,
            if the source has any of them; edits of curves leave them.
        rotation_names: which of these it has, in the order of `arkit.ROTATIONS`; the others are 0.
        confidence: (T,) how sure the tracker was of each frame, 0..1, if the source says so; 0 if
            it was filled.
    """

    weights: Floats
    channels: tuple[str, ...]
    times: Times
    rate: float
    gaps: tuple[Gap, ...] = ()
    timecodes: tuple[str, ...] | None = None
    rotations: Floats | None = None
    confidence: Floats | None = None
    rotation_names: tuple[str, ...] = ROTATIONS

    def __len__(self) -> int:
        return len(self.weights)

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the end of the last."""
        return float(self.times[-1]) + 1.0 / self.rate

    @property
    def gap_times(self) -> list[tuple[float, float]]:
        """First and last second of each gap."""
        return [
            (float(self.times[gap.frame]), float(self.times[gap.frame + 1])) for gap in self.gaps
        ]

    def frame_at(self, seconds: float) -> int:
        """Index of the frame nearest to a time, which is the one on screen."""
        return nearest(self.times, seconds)

    def arkit_weights(self) -> Floats:
        """(T, 52) float32 in ARKit order; channels that the source lacks are 0."""
        out = np.zeros((len(self.weights), len(ARKIT_INDEX)), np.float32)
        out[:, [ARKIT_INDEX[c] for c in self.channels]] = self.weights
        return out


def nearest(times: Times, seconds: float) -> int:
    """Index of the time (T,) nearest to `seconds`; of two that are as near, the earlier."""
    right = int(np.searchsorted(times, seconds))
    if right == 0:
        return 0
    if right == len(times):
        return right - 1
    before, after = times[right - 1], times[right]
    return right - 1 if seconds - before <= after - seconds else right


def nearest_rows(times: Times, wanted: Times) -> Indices:
    """(N,) indices of the times (T >= 1) nearest to those wanted (N,); see `nearest`."""
    right = np.clip(np.searchsorted(times, wanted), 1, max(len(times) - 1, 1))
    left, right = right - 1, np.minimum(right, len(times) - 1)
    return np.where(wanted - times[left] <= times[right] - wanted, left, right)
