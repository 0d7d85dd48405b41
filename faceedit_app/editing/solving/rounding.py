"""Changed weights are rounded, so that they are the same on every computer."""

from __future__ import annotations

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Floats

# Changed weights are multiples of this. The last bits of a matrix product depend on the processor;
# rounded, nearly all weights are the same on every one. It moves a jaw by less than a micrometre.
DECIMALS = 5


def rounded(weights: Floats, tracked: Floats) -> Floats:
    """(N, 52) float32: changed weights rounded, the others with the bits of the take."""
    near = np.round(weights.astype(np.float64), DECIMALS).astype(np.float32)
    result: Floats = np.where(weights == tracked, tracked, near)
    jaw, lips = ARKIT_INDEX["jawOpen"], ARKIT_INDEX["mouthClose"]
    # Lips that are no more closed than the jaw is open stay so.
    over = (result[:, lips] > result[:, jaw]) & (weights[:, lips] <= weights[:, jaw])
    result[over, lips] = result[over, jaw]
    return result
