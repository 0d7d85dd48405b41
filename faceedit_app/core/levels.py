"""Strength by channel: a multiplier, an offset and a soft limit for the weights of each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.arrays import Doubles, Floats

Level = tuple[float, float, float]  # multiplier, offset, ceiling
UNCHANGED: Level = (1.0, 0.0, 1.0)
STRONGEST_LEVEL = 10.0  # multiplier of a channel
# A soft limit leaves weights below this share of its ceiling as they are.
KNEE = 0.7


def softly_limited(values: Doubles, ceiling: Doubles) -> Doubles:
    """Values (N, K) that approach `ceiling` (K,) smoothly; those below `KNEE` of it are unchanged.

    Value and slope are continuous, the order of values is kept, and the ceiling is never passed.
    Rotations are limited in both directions.
    """
    size, knee = np.abs(values), KNEE * ceiling
    room = ceiling - knee
    above = knee + room * -np.expm1(-np.maximum(size - knee, 0.0) / room)
    limited: Doubles = np.where(size > knee, np.copysign(above, values), values)
    return limited


def is_level(level: Level) -> bool:
    """Whether the numbers of a level are within their bounds."""
    factor, offset, limit = level
    return 0 <= factor <= STRONGEST_LEVEL and abs(offset) <= 1 and 0 < limit <= 1


@dataclass(frozen=True)
class Levels:
    """How strongly a character answers each channel.

    A ceiling of 1 does not limit: a multiplier above 1 may take a shape beyond its full strength.

    Attributes:
        by_channel: the levels of those that differ from `UNCHANGED`.
    """

    by_channel: Mapping[str, Level] = field(default_factory=dict)

    def __bool__(self) -> bool:
        return bool(self.by_channel)

    @cached_property
    def _table(self) -> tuple[list[int], Doubles]:
        columns = [ARKIT_INDEX[channel] for channel in self.by_channel]
        return columns, np.array(list(self.by_channel.values()), np.float64).reshape(-1, 3).T

    @property
    def factors(self) -> Floats:
        """(52,) the multipliers."""
        factors = np.ones(len(ARKIT_CHANNELS), np.float32)
        columns, numbers = self._table
        factors[columns] = numbers[0]
        return factors

    @property
    def offsets(self) -> Floats:
        """(52,) what is added after the multiplier."""
        offsets = np.zeros(len(ARKIT_CHANNELS), np.float32)
        columns, numbers = self._table
        offsets[columns] = numbers[1]
        return offsets

    def applied(self, weights: NDArray[np.floating]) -> Floats:
        """Weights (..., 52) in ARKit's order as the character shows them.

        An offset below 0 takes no weight below 0.
        """
        shown = np.array(weights, np.float32)
        if not self.by_channel:
            return shown
        columns, (factor, offset, limit) = self._table
        now = shown[..., columns].astype(np.float64)
        levelled = factor * now + offset
        levelled = np.where(limit < 1, softly_limited(levelled, limit), levelled)
        shown[..., columns] = np.maximum(levelled, np.minimum(now, 0.0))
        return shown
