"""Takes of people, for what is measured on them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.arrays import Floats
from faceedit_app.core.clip import Clip
from faceedit_app.formats.take import Take
from faceedit_app.lab.evaluation.people.opened import Opened
from faceedit_app.lab.evaluation.people.references import References
from faceedit_app.lab.evaluation.people.sources import TakeSource, Tracker
from faceedit_app.lab.evaluation.systems import Systems
from support.performances import RIG, performance
from support.sessions import take_of


def take_with(weights: Floats, name: str = "take.csv", rate: float = 25.0) -> Take:
    times = np.arange(len(weights)) / rate
    clip = Clip(weights.astype(np.float32), ARKIT_CHANNELS, times, rate)
    return replace(take_of(clip), path=Path(name))


def source_with(*takes: Take, name: str = "someone") -> TakeSource:
    people = [replace(performance(1.0), weights=take.clip.arkit_weights()) for take in takes]
    return TakeSource(name, Tracker.IPHONE, takes, tuple(people))


def opened_on(weights: Floats, systems: Systems, learned: References) -> Opened:
    return Opened(take_with(weights), RIG, systems, learned)


def talking(frames: int = 400, closures: bool = True) -> Floats:
    """A jaw that opens and shuts once a second, with the lips at 0 in between."""
    weights = np.zeros((frames, 52), np.float32)
    time = np.arange(frames) / 25.0
    jaw = 0.4 * np.clip(np.sin(2 * np.pi * time), 0.0 if closures else 0.3, None)
    weights[:, ARKIT_INDEX["jawOpen"]] = jaw
    return weights
