"""What is asked of one region of one chunk."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Doubles
from faceedit_app.editing.edits.settings import Settings
from faceedit_app.editing.solving.last_layer import LastLayer

# The arrays of a request: first those that differ with each step of a drag.
_ARRAYS = ("wanted", "slow", "quick", "unlike", "before", "tracked", "hold", "calm", "influence")


@dataclass(frozen=True)
class RegionRequest:
    """What is asked of a region on the N frames of a chunk.

    Attributes:
        settings: how edits are answered.
        layer: the take's own last layer; None without networks, or to resynthesize.
        unlike: (N,) in 0..1, how unlike the take this request is.
        influence: (N, K) in 0..1, where each channel may answer.
        slow: (N, H) mm, the slow part of the change of the curves that the networks listen to.
        before: (N, H) mm, these curves as tracked.
        quick: (N, C) mm, the quick part of the change of its own curves.
        tracked, wanted: (N, C) mm, its own curves as they are and as they should be.
        hold: (N, C) in 0..1, how firmly its own curves are asked for.
        calm: (N, C) in 0..1, how far they are asked to be calm.
    """

    settings: Settings
    layer: LastLayer | None
    unlike: Doubles
    influence: Doubles
    slow: Doubles
    before: Doubles
    quick: Doubles
    tracked: Doubles
    wanted: Doubles
    hold: Doubles
    calm: Doubles

    def equals(self, other: RegionRequest) -> bool:
        """Whether another request asks for exactly the same."""
        if self is other:
            return True
        if self.layer is not other.layer or self.settings != other.settings:
            return False
        return all(np.array_equal(getattr(self, name), getattr(other, name)) for name in _ARRAYS)
