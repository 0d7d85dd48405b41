"""Array types, named after what they hold."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
"""Weights, vertices and curves, as stored and shown."""

Doubles = NDArray[np.float64]
"""Intermediate results."""

Times = NDArray[np.float64]
"""Seconds."""

Bools = NDArray[np.bool_]

Indices = NDArray[np.intp]
"""Row or column numbers of another array."""

Pixels = NDArray[np.uint8]
"""(height, width, channels) of a picture, top row first."""

Samples = NDArray[np.int16]
"""(samples, channels) of a sound, or (samples,) of one channel."""
