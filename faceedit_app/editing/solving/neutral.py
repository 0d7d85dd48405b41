"""Take a rest pose away from weights, and keep lips together that weights would tear."""

from __future__ import annotations

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles

_JAW, _CLOSE = ARKIT_INDEX["jawOpen"], ARKIT_INDEX["mouthClose"]


def without_rest(values: Doubles, rest: Doubles, peak: Doubles) -> Doubles:
    """Values (N, K) with a rest pose (K,) taken away, and the height of peaks (K,) kept.

    Subtracting alone would cost a blink of 0.9 over a squint of 0.3 a third of its height. So what
    lies between rest and peak is stretched to lie between 0 and the peak: a blink that closed the
    lids still does, and nothing but the scale of the motion changes. What lies above the peak
    stays as it is.
    """
    stretched = (values - rest) * (peak / (peak - rest))
    moved: Doubles = np.where(values < peak, np.maximum(stretched, np.minimum(values, 0.0)), values)
    return moved


def keep_lips_together(values: Doubles, before: Doubles) -> None:
    """Keep mouthClose <= jawOpen, in place: mouthClose is a corrective, which tears any rig alone.

    If the take itself exceeds this, the same excess is allowed. So mouthClose follows a jaw that
    is lowered.
    """
    excess = np.maximum(before[:, _CLOSE] - before[:, _JAW], 0.0)
    moved = (values[:, [_CLOSE, _JAW]] != before[:, [_CLOSE, _JAW]]).any(axis=1)
    most = values[:, _JAW] + excess
    over = moved & (values[:, _CLOSE] > most)
    values[over, _CLOSE] = most[over]
