"""A character that leaves lips and lids open where ours closes them, and a take that shows it."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Floats
from faceedit_app.core.rig import Rig
from support.faces import shipped_rig

JAW, CLOSE = ARKIT_INDEX["jawOpen"], ARKIT_INDEX["mouthClose"]


@lru_cache(maxsize=1)
def leaky_rig() -> Rig:
    """Our character with a mouthClose and a blink that do not close all the way."""
    rig = shipped_rig()
    deltas = rig.deltas.copy()
    deltas[rig.channel_index["mouthClose"]] *= 0.8
    deltas[rig.channel_index["jawOpen"]] *= 1.1
    for side in ("Left", "Right"):
        deltas[rig.channel_index[f"eyeBlink{side}"]] *= 0.85
    return replace(rig, deltas=deltas)


@lru_cache(maxsize=1)
def speech() -> Floats:
    """Four seconds at 30 fps: lips that meet by mouthClose, blinks, some smile."""
    time = np.arange(120) / 30.0
    weights = np.zeros((120, 52), np.float32)
    open_ = 0.5 - 0.5 * np.cos(2 * np.pi * 1.5 * time)
    weights[:, JAW] = 0.15 + 0.3 * open_
    weights[:, CLOSE] = weights[:, JAW] * (1 - open_)
    weights[:, ARKIT_INDEX["mouthSmileLeft"]] = 0.2 + 0.2 * np.sin(time)
    blink = np.exp(-(((time % 1.3) - 0.6) ** 2) / 0.005)
    for side in ("Left", "Right"):
        weights[:, ARKIT_INDEX[f"eyeBlink{side}"]] = 0.9 * blink
    return weights
