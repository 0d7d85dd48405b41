"""Shapes that some exporters store for weights of 0 to 100: a hundredth of what they are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from faceedit_app.characters.character import Character
from faceedit_app.characters.matches import ShapeMatch

_MOST = 1.0  # mm that whole shapes never stay below
_PLAUSIBLE = (3.0, 150.0)  # mm that the largest move of any face
REMARK = "its shapes are full at a weight of 100; they are shown, and exported, that way"


def in_percent(
    character: Character,
    match: ShapeMatch,
    target: Callable[[int, str], NDArray[np.float32] | None],
    scale: float,
) -> ShapeMatch | None:
    """The match with all shapes a hundred times as strong; None if they are strong as they are.

    Args:
        target: returns the displacements (V, 3) of a part's target by its name.
        scale: metres per unit of the file.
    """
    farthest = 0.0
    for part in range(len(character.parts)):
        for shares in match.shares.values():
            for share in shares:
                moves = target(part, share.name)
                if moves is not None:
                    far = float(np.abs(moves).max(initial=0.0)) * abs(share.weight)
                    farthest = max(farthest, 1000.0 * scale * far)
    if farthest > _MOST or not _PLAUSIBLE[0] < 100.0 * farthest < _PLAUSIBLE[1]:
        return None
    whole = {
        channel: tuple(replace(share, weight=100.0 * share.weight) for share in shares)
        for channel, shares in match.shares.items()
    }
    return replace(match, shares=whole)
