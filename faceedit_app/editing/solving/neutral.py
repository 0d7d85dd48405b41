"""Take a rest pose away from weights, and keep lips together that weights would tear.

A neutral rest belongs to the take: curves start from the take without it, wherever it stands in the
list of edits. Only behind other edits of its channels does it act in its place among these.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles
from faceedit_app.editing.edits.edit import Edit, Op

_JAW, _CLOSE = ARKIT_INDEX["jawOpen"], ARKIT_INDEX["mouthClose"]


def divided(edits: Sequence[Edit]) -> tuple[list[Edit], list[Edit]]:
    """The edits that act on the take and its curves, and those that act on channels afterwards."""
    first: list[Edit] = []
    then: list[Edit] = []
    for edit in edits:
        is_late = bool(edit.channels) and edit.op is not Op.NEUTRAL
        is_late |= edit.op is Op.NEUTRAL and is_behind(edit.channels, then)
        (then if is_late else first).append(edit)
    return first, then


def is_behind(channels: Collection[str], edits: Sequence[Edit]) -> bool:
    """Whether other edits of channels have changed some channels already."""
    return any(
        edit.effect is not None and not set(channels).isdisjoint(edit.channels) for edit in edits
    )


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
