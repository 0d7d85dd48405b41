"""Changed weights are rounded, so that they are the same on every computer."""

from __future__ import annotations

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles, Floats

# Changed weights are multiples of this. The last bits of a matrix product depend on the processor;
# rounded, nearly all weights are the same on every one. It moves a jaw by less than a micrometre.
DECIMALS = 5


def rounded(values: Floats | Doubles, before: Floats) -> Floats:
    """(N, K) float32: changed values rounded, the others with the bits that they had before.

    A value is changed if it differs by more than rounding does: the take's numbers may have more
    digits, and an edit that gives the same number to `DECIMALS` digits must not take them away.

    Args:
        values, before: (N, K) all 52 weights in ARKit order, or other numbers.
    """
    exact = values.astype(np.float64)
    same = np.abs(exact - before.astype(np.float64)) < 0.5 * 10.0**-DECIMALS
    result: Floats = np.where(same, before, exact.round(DECIMALS).astype(np.float32))
    if result.shape[1] == len(ARKIT_INDEX):
        jaw, lips = ARKIT_INDEX["jawOpen"], ARKIT_INDEX["mouthClose"]
        # Lips that are no more closed than the jaw is open stay so.
        over = (result[:, lips] > result[:, jaw]) & (exact[:, lips] <= exact[:, jaw])
        result[over, lips] = result[over, jaw]
    return result
