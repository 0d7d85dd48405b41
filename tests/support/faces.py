"""Characters and networks for tests: the shipped face, and small random ones."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import torch

from faceedit_app.characters.glb import read_rig
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROLS
from faceedit_app.core.regions import REGIONS, Region
from faceedit_app.core.resources import shipped
from faceedit_app.core.rig import Material, Rig
from faceedit_app.lab.training.model_files import RegionModel, as_file
from faceedit_app.lab.training.models import RegionNetworks
from faceedit_app.networks.engine import Engine
from faceedit_app.networks.inference import RegionAnswer

# Networks this small gain nothing from threads, and lose much where others use the machine.
torch.set_num_threads(1)


@lru_cache(maxsize=1)
def shipped_rig() -> Rig:
    """The character that FaceEdit ships with."""
    return read_rig(shipped("assets/character.glb"))


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


def random_networks(
    controls: int, channels: int, widths: tuple[int, ...] = (4, 6, 8), seed: int = 0
) -> RegionNetworks:
    """Networks that were never trained, in which the autoencoder answers as well."""
    torch.manual_seed(seed)
    networks = RegionNetworks(controls, channels, widths)
    torch.nn.init.normal_(networks.autoencoder.out.weight, std=0.2)
    for module in networks.modules():
        if isinstance(module, torch.nn.BatchNorm1d):
            module.running_mean.uniform_(-0.1, 0.1)
            module.running_var.uniform_(0.5, 1.5)
    return networks.eval()


def random_model(region: Region, seed: int = 0) -> RegionModel:
    """A region's model with random networks and a random covariance."""
    random = np.random.default_rng(seed)
    count = len(region.channels)
    mixing = random.normal(0, 0.2, (count, count)) / np.sqrt(count)
    networks = random_networks(len(region.controls), count, seed=seed)
    return RegionModel(
        region=region.id,
        controls=region.controls,
        channels=region.channels,
        networks=networks,
        covariance=mixing @ mixing.T + 0.01 * np.eye(count),
        low=np.full(len(region.controls), 0.2),
        high=np.full(len(region.controls), 60.0),
        widths=(4, 6, 8),
        notes="random",
    )


def random_models(seed: int = 0) -> list[RegionModel]:
    """Random networks for every region: they answer, and what they answer is nonsense."""
    return [random_model(region, seed + i) for i, region in enumerate(REGIONS)]


def random_engine(seed: int = 0) -> Engine:
    """An engine of `random_models`."""
    return Engine({m.region: RegionAnswer(as_file(m)) for m in random_models(seed)})


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
