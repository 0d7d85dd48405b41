"""Small performances and settings for the tests of training and evaluation."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.lab.training.data import Performance
from faceedit_app.lab.training.settings import RECIPES, TrainingSettings
from support.faces import shipped_rig
from support.takes import livelink_names, make_livelink_csv

RIG = shipped_rig()
DISTANCES = RIG.arkit_distances


def performance(seconds: float = 20.0, seed: int = 0, source: str = "someone") -> Performance:
    """Smooth random weights of all channels, with mouthClose below jawOpen, at 25 fps."""
    random = np.random.default_rng(seed)
    time = np.arange(round(seconds * 25))[:, None] / 25.0
    channels = len(ARKIT_CHANNELS)
    speed, phase = random.uniform(0.2, 2.0, channels), random.uniform(0, 6, channels)
    weights = 0.25 + 0.25 * np.sin(2 * np.pi * time * speed + phase)
    close, jaw = ARKIT_INDEX["mouthClose"], ARKIT_INDEX["jawOpen"]
    weights[:, close] = np.minimum(weights[:, close], weights[:, jaw])
    captured = np.ones(channels, bool)
    return Performance(f"{source}_{seed}.csv", source, weights.astype(np.float32), captured)


def tiny(recipe: str = "faceedit", **changes: object) -> TrainingSettings:
    """A recipe that trains in a blink."""
    small = {"widths": (4, 6), "narrow_widths": None, "batch": 16}
    small |= {"epochs_regressor": 3, "epochs_autoencoder": 2}
    return replace(RECIPES[recipe], **(small | changes))  # type: ignore[arg-type]


def smallest(recipe: str = "faceedit", **changes: object) -> TrainingSettings:
    """A recipe for what is exported: the fewer layers, the sooner, and all share the graphs."""
    return tiny(recipe, widths=(4,), completion_widths=(4,), **changes)


def folder_of_takes(folder: Path, count: int = 2, seconds: float = 12.0) -> Path:
    """Takes as Live Link Face files that a telephone could have written."""
    folder.mkdir(parents=True, exist_ok=True)
    order = [ARKIT_INDEX[name[0].lower() + name[1:]] for name in livelink_names()]
    for i in range(count):
        weights = performance(seconds, seed=i).weights[:, order].astype(np.float64)
        make_livelink_csv(folder / f"take_{i}.csv", rate=30, weights=weights)
    return folder
