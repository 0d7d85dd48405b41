"""The baseline: Holden, Saito and Komura, "A Deep Learning Framework for Character Motion
Synthesis and Editing" (SIGGRAPH 2016), adapted to face regions as section 4.1 of our paper says.

A one-layer convolutional autoencoder learns a latent space of motion at half the frame rate; a
two-layer convolutional regressor maps controls to it. The halving of time is what smooths lip
and lid closures away. One such pair a region, trained on the same data.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import save
from torch import Tensor, nn
from torch.nn import functional as F

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.core.errors import FileError
from faceedit_app.core.regions import Region
from faceedit_app.core.rig import Distances
from faceedit_app.lab.training.data import Performance
from faceedit_app.lab.training.examples import Examples
from faceedit_app.lab.training.fit import Epoch, fingerprint
from faceedit_app.lab.training.loop import Checkpoint, History, learn
from faceedit_app.lab.training.losses import Losses
from faceedit_app.lab.training.settings import FitSettings
from faceedit_app.networks.files import REMEDY

FOLDER = "holden"
"""Below a folder of models: the baseline's files, one a region."""

HIDDEN = 64  # features of the latent space, and of the regressor's first layer
FILTER = 15  # frames; the original's 25 at our lower rate
FORMAT = "faceedit-holden"


class HoldenNetworks(nn.Module):
    """The baseline's networks for one region.

    Attributes:
        mean: (C,) mm, subtracted from the controls.
    """

    mean: Tensor

    def __init__(self, controls: int, channels: int, hidden: int = HIDDEN):
        super().__init__()
        self.register_buffer("mean", torch.zeros(controls))
        wide = FILTER // 2
        self.encoder = nn.Conv1d(channels, hidden, FILTER, padding=wide)
        self.decoder = nn.Conv1d(hidden, channels, FILTER, padding=wide)
        self.regressor = nn.Sequential(
            nn.Conv1d(controls, hidden, FILTER, padding=wide),
            nn.ReLU(inplace=True),
            nn.Conv1d(hidden, hidden, FILTER, padding=wide),
            nn.ReLU(inplace=True),
        )

    def encode(self, weights: Tensor) -> Tensor:
        """(N, K, T) weights -> (N, hidden, T / 2)."""
        return F.max_pool1d(F.relu(self.encoder(weights)), 2)

    def decode(self, latent: Tensor) -> Tensor:
        """(N, hidden, T / 2) -> (N, K, T) weights."""
        result: Tensor = self.decoder(F.interpolate(latent, scale_factor=2.0))
        return result

    def forward(self, controls: Tensor) -> Tensor:
        """(N, C, T) mm -> (N, K, T) weights; T is even."""
        latent = F.max_pool1d(self.regressor(controls - self.mean[:, None]), 2)
        return self.decode(latent)


@dataclass
class HoldenModel:
    """The trained baseline of one region; see `RegionModel`."""

    region: str
    controls: tuple[str, ...]
    channels: tuple[str, ...]
    networks: HoldenNetworks

    def answer(self, curves: Doubles) -> Doubles:
        """Curves (T, C) mm at 25 fps, any T -> (T, K) weights, not bounded."""
        columns = [CONTROL_INDEX[c] for c in self.controls]
        padded = np.pad(curves[:, columns], ((0, len(curves) % 2), (0, 0)), "edge")
        inputs = torch.from_numpy(padded.T[None].astype(np.float32))
        with torch.inference_mode():
            weights: Doubles = self.networks(inputs)[0].T.numpy().astype(np.float64)
        return weights[: len(curves)]


def fit_holden(
    region: Region,
    performances: Sequence[Performance],
    distances: Distances,
    settings: FitSettings,
    report: Callable[[Epoch], None] = lambda epoch: None,
    checkpoints: Path | None = None,
) -> tuple[HoldenModel, dict[str, History]]:
    """Train the baseline on the same examples, with the same optimiser and as many epochs.

    First the autoencoder on weights, then the regressor through the frozen decoder; both learn
    the mean squared weight error, as in the original.
    """
    torch.manual_seed(settings.seed)
    examples = Examples(region, performances, distances, settings)
    losses = Losses(examples.own_distances, settings)
    networks = HoldenNetworks(len(region.controls), len(region.channels))
    networks.mean.copy_(torch.from_numpy(examples.mean))
    mark = fingerprint(performances, distances, settings)
    histories: dict[str, History] = {}
    manifold = nn.ModuleList([networks.encoder, networks.decoder])
    stages: list[tuple[str, int, int, nn.Module]] = [
        ("holden autoencoder", 3, settings.epochs_autoencoder, manifold),
        ("holden regressor", 4, settings.epochs_regressor, networks.regressor),
    ]
    for name, number, of, network in stages:
        histories[name] = learn(
            network,
            (lambda batch, _: networks.decode(networks.encode(batch.weights)))
            if network is manifold
            else (lambda batch, _: networks(batch.controls)),
            losses.mse,
            lambda epoch, number=number: examples.epoch(1000 * number + epoch),  # type: ignore[misc]
            examples.validation,
            of,
            settings,
            number,
            Checkpoint(checkpoints / f"{region.id}.{name}.safetensors", mark)
            if checkpoints
            else None,
            lambda n, loss, held, name=name, of=of: report(  # type: ignore[misc]
                Epoch(region.id, name, n, of, loss, held)
            ),
        )
        manifold.requires_grad_(False)
        if histories[name].stopped:
            break
    model = HoldenModel(region.id, region.controls, region.channels, networks.eval())
    return model, histories


def save_holden(path: Path | str, model: HoldenModel) -> None:
    """Write the baseline of one region."""
    about = {
        "format": FORMAT,
        "region": model.region,
        "controls": model.controls,
        "channels": model.channels,
        "hidden": model.networks.encoder.out_channels,
    }
    tensors = {k: v.contiguous() for k, v in model.networks.state_dict().items()}
    write_atomically(path, save(tensors, {"about": json.dumps(about)}))


def load_holden(path: Path | str) -> HoldenModel:
    """Read the baseline of one region.

    Raises:
        FileError: missing, damaged, or something else.
    """
    path = Path(path)
    try:
        with safe_open(str(path), framework="pt") as file:
            about = json.loads((file.metadata() or {})["about"])
            tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
        controls, channels = tuple(about["controls"]), tuple(about["channels"])
        networks = HoldenNetworks(len(controls), len(channels), int(about["hidden"]))
        networks.load_state_dict(tensors)
        return HoldenModel(str(about["region"]), controls, channels, networks.eval())
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise FileError(path, f"cannot be read ({reason})", REMEDY) from error
    except (SafetensorError, KeyError, ValueError, TypeError, RuntimeError) as error:
        raise FileError(path, "is no baseline of FaceEdit, or is damaged", REMEDY) from error
