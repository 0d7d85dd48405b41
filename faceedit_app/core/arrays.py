"""The arrays that FaceEdit computes with, by what they hold."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
"""Weights, vertices and curves as they are kept and shown."""

Doubles = NDArray[np.float64]
"""What is computed on the way."""

Times = NDArray[np.float64]
"""Seconds."""

Bools = NDArray[np.bool_]

Indices = NDArray[np.intp]
"""Which rows or columns of another array."""

Pixels = NDArray[np.uint8]
"""(height, width, channels) of a picture, top row first."""
