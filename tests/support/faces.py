"""Characters and networks for tests: the shipped face, and small random ones."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest

from faceedit_app.characters.glb import read_rig
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROLS
from faceedit_app.core.regions import REGIONS
from faceedit_app.core.resources import CHARACTER, shipped
from faceedit_app.core.rig import Material, Rig
from faceedit_app.networks.engine import Engine
from support.networks import random_region, write_models


@lru_cache(maxsize=1)
def shipped_rig() -> Rig:
    """The character that FaceEdit ships with."""
    return read_rig(shipped(CHARACTER))


def random_rig(
    seed: int = 0, channels: tuple[str, ...] = ARKIT_CHANNELS, vertices: int = 24
) -> Rig:
    """A cloud of vertices: right in form, and not a face."""
    random, vertices = np.random.default_rng(seed), 24
    faces = random.integers(vertices, size=(10, 3)).astype(np.int32)
    moves = random.normal(0, 0.003, (len(channels), vertices, 3))
    moves[:, random.random(vertices) < 0.3] = 0.0
    return Rig(
        neutral=random.normal(0, 0.03, (vertices, 3)).astype(np.float32),
        faces=faces,
        channels=channels,
        deltas=moves.astype(np.float32),
        colors=random.random((vertices, 4)).astype(np.float32),
        materials=(Material("skin", 0, 7, 0.5, 0.0), Material("teeth", 7, 10, 0.25, 0.125)),
        control_pairs=np.arange(2 * len(CONTROLS), dtype=np.int32).reshape(-1, 2),
        name="Cloud",
        attribution="made by a test",
    )


def random_engine(seed: int = 0, rig: Rig | None = None) -> Engine:
    """Random networks for every region, made for a character; the shipped face if it is None."""
    rig = rig or shipped_rig()
    regions = map(rig.measures, REGIONS)
    return Engine({r.id: random_region(r, rig, seed + i) for i, r in enumerate(regions)})


def talking_clip(
    frames: int = 180,
    rate: float = 60.0,
    seed: int = 0,
    channels: tuple[str, ...] = ARKIT_CHANNELS,
    times: np.ndarray | None = None,
) -> Clip:
    """Smooth random weights between 0 and 0.6, with mouthClose below jawOpen."""
    random = np.random.default_rng(seed)
    times = np.arange(frames) / rate if times is None else times
    speed, phase = random.uniform(0.3, 2.5, len(channels)), random.uniform(0, 6, len(channels))
    weights = 0.3 + 0.3 * np.sin(2 * np.pi * times[:, None] * speed + phase)
    if {"mouthClose", "jawOpen"} <= set(channels):
        jaw = weights[:, channels.index("jawOpen")]
        weights[:, channels.index("mouthClose")] = 0.4 * jaw
    return Clip(weights.astype(np.float32), channels, times, rate)


@pytest.fixture(scope="session")
def models(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A folder of models for the shipped character, as given to `--models`."""
    return str(write_models(tmp_path_factory.mktemp("models"), shipped_rig(), 2))
