"""Fitting the networks of a region (paper, sections 3.2 and 3.3).

    faceedit train --data DIR... -o models

reads every take below the folders and writes one file per region and a model card.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.errors import FileError
from faceedit_app.core.regions import CONTROL_INDEX, Region
from faceedit_app.core.resample import GRID_RATE
from faceedit_app.core.rig import Distances
from faceedit_app.networks.models import DEFAULT_WIDTHS, RegionNetworks
from faceedit_app.networks.store import RegionModel
from faceedit_app.training.data import (
    Augmentation,
    Performance,
    Windows,
    augment,
    cut_windows,
    region_windows,
)


@dataclass(frozen=True)
class FitSettings:
    """Every number of the training. Those of the paper are marked (P)."""

    window: int = 64  # frames at 25 fps (P)
    overlap: float = 0.75  # of neighbouring windows (P)
    held_out: float = 0.05  # share of blocks kept for validation (P)
    batch: int = 128  # windows (P)
    learning_rate: float = 1e-3  # Adam (P)
    decay: float = 0.95  # of the learning rate (P) ...
    patience: int = 5  # ... after so many epochs without improvement (P)
    epochs_regressor: int = 40
    epochs_autoencoder: int = 30
    l2: float = 1e-5  # weight of the sum of squared parameters
    distance_loss: float = 1.0  # weight of the distance loss against the MSE (P) ...
    distance_unit_mm: float = 10.0  # ... with distances in this unit
    noise: float = 0.2  # share of control values set to salt or pepper (P) ...
    noisy_windows: float = 0.5  # ... in this share of the windows
    widths: tuple[int, ...] = DEFAULT_WIDTHS
    augmentation: Augmentation = field(default_factory=Augmentation)
    range_percentiles: tuple[float, float] = (0.05, 99.95)  # of each control, for `low`, `high`
    seed: int = 1


@dataclass(frozen=True)
class Epoch:
    """Progress: one pass over the data. Losses are means over the windows."""

    region: str
    stage: str
    number: int
    of: int
    loss: float
    validation: float


@dataclass
class Fitted:
    """A region's model and what the held-out windows say about it.

    Attributes:
        model: ready to be saved.
        mse: held-out mean squared weight error of `regressor` and `system`.
        control_mm: held-out median absolute control error, likewise.
        windows: numbers of training and held-out windows.
    """

    model: RegionModel
    mse: dict[str, float]
    control_mm: dict[str, float]
    windows: tuple[int, int]


@dataclass(frozen=True)
class Batch:
    """Windows as tensors; see `Windows`."""

    controls: Tensor
    weights: Tensor
    captured: Tensor
    still: Tensor

    @classmethod
    def of(cls, windows: Windows, rows: NDArray[np.intp]) -> Batch:
        """Some of the windows."""
        part = windows[rows]
        return cls(*map(torch.from_numpy, (part.controls, part.weights, part.captured, part.still)))


class Losses:
    """The terms of the two losses of one region.

    Args:
        gradients: (K, C, 3) mm: how the region's channels move its controls.
        settings: weights of the terms.
    """

    def __init__(self, gradients: NDArray[np.float32], settings: FitSettings) -> None:
        self.gradients = torch.from_numpy(gradients)
        self.settings = settings

    def mse(self, answer: Tensor, batch: Batch) -> Tensor:
        """Mean squared weight error over the captured channels."""
        mask = batch.captured[:, :, None].float()
        error = ((answer - batch.weights) ** 2 * mask).sum()
        return error / (mask.sum() * answer.shape[2])

    def control_error(self, answer: Tensor, batch: Batch) -> Tensor:
        """(N, C, W) mm: the controls of the answer, through the rig, minus those of the take."""
        vectors = batch.still + torch.einsum("nkt,kcx->ncxt", answer, self.gradients)
        return torch.sqrt((vectors**2).sum(2) + 1e-6) - batch.controls

    def regressor(self, answer: Tensor, batch: Batch) -> Tensor:
        """The loss of the regressor (its L2 term is the optimiser's weight decay)."""
        return self.mse(answer, batch)

    def system(self, answer: Tensor, batch: Batch) -> Tensor:
        """The loss of the full system: MSE + distances."""
        distance = self.control_error(answer, batch) / self.settings.distance_unit_mm
        return self.mse(answer, batch) + self.settings.distance_loss * (distance**2).mean()


def salt_and_pepper(
    controls: Tensor, low: Tensor, high: Tensor, settings: FitSettings, random: torch.Generator
) -> Tensor:
    """Set a share of the control values (N, C, W) to the ends of their range, as wild edits do."""
    noisy = torch.rand(len(controls), 1, 1, generator=random) < settings.noisy_windows
    hit = torch.rand(controls.shape, generator=random) < settings.noise
    salt = torch.rand(controls.shape, generator=random) < 0.5
    extremes = torch.where(salt, high[:, None], low[:, None])
    return torch.where(noisy & hit, extremes, controls)


def _epoch(
    forward: Callable[[Batch], Tensor],
    loss_of: Callable[[Tensor, Batch], Tensor],
    windows: Windows,
    order: NDArray[np.intp],
    batch: int,
    optimiser: torch.optim.Optimizer | None,
) -> float:
    """One pass; with an optimiser it learns. Returns the mean loss."""
    total = 0.0
    for first in range(0, len(order), batch):
        rows = order[first : first + batch]
        examples = Batch.of(windows, rows)
        with torch.set_grad_enabled(optimiser is not None):
            loss = loss_of(forward(examples), examples)
        if optimiser is not None:
            optimiser.zero_grad()
            loss.backward()  # type: ignore[no-untyped-call]
            optimiser.step()
        total += float(loss.detach()) * len(rows)
    return total / len(order)


def _learn(
    network: nn.Module,
    forward: Callable[[Batch, bool], Tensor],
    loss_of: Callable[[Tensor, Batch], Tensor],
    train: Windows,
    validation: Windows,
    epochs: int,
    settings: FitSettings,
    report: Callable[[int, float, float], None],
) -> None:
    """Adam with a decaying rate; leaves the network at the epoch of the lowest validation loss."""
    random = np.random.default_rng(settings.seed)
    optimiser = torch.optim.Adam(
        network.parameters(), settings.learning_rate, weight_decay=settings.l2
    )
    schedule = torch.optim.lr_scheduler.ReduceLROnPlateau(
        optimiser, factor=settings.decay, patience=settings.patience
    )
    best, kept = np.inf, {k: v.clone() for k, v in network.state_dict().items()}
    everything = np.arange(len(validation))
    for number in range(1, epochs + 1):
        network.train()
        order = random.permutation(len(train))
        loss = _epoch(lambda b: forward(b, True), loss_of, train, order, settings.batch, optimiser)
        network.eval()
        held = _epoch(
            lambda b: forward(b, False), loss_of, validation, everything, settings.batch, None
        )
        schedule.step(held)
        report(number, loss, held)
        if held < best:
            best, kept = held, {k: v.clone() for k, v in network.state_dict().items()}
    network.load_state_dict(kept)
    network.eval()


def fit_region(
    region: Region,
    performances: list[Performance],
    distances: Distances,
    settings: FitSettings,
    report: Callable[[Epoch], None] = lambda epoch: None,
) -> Fitted:
    """Train a region's regressor, then its autoencoder behind the frozen regressor.

    Args:
        distances: the eight controls as a function of the 52 weights in ARKit order.
        report: called after each epoch.
    """
    torch.manual_seed(settings.seed)
    train, validation = _examples(region, performances, distances, settings)
    networks = RegionNetworks(len(region.controls), len(region.channels), settings.widths)
    networks.mean.copy_(torch.from_numpy(train.controls.mean((0, 2))))
    low, high = np.percentile(
        train.controls.transpose(0, 2, 1).reshape(-1, len(region.controls)),
        settings.range_percentiles,
        axis=0,
    )
    losses = Losses(_gradients(region, distances), settings)

    def report_as(stage: str, of: int) -> Callable[[int, float, float], None]:
        return lambda n, loss, held: report(Epoch(region.id, stage, n, of, loss, held))

    _learn(
        networks.regressor,
        lambda batch, _: networks.regress(batch.controls),
        losses.regressor,
        train,
        validation,
        settings.epochs_regressor,
        settings,
        report_as("regressor", settings.epochs_regressor),
    )
    networks.regressor.requires_grad_(False)
    random = torch.Generator().manual_seed(settings.seed)
    ends = [torch.from_numpy(x.astype(np.float32)) for x in (low, high)]

    def system(batch: Batch, learning: bool) -> Tensor:
        controls = batch.controls
        if learning:
            controls = salt_and_pepper(controls, ends[0], ends[1], settings, random)
        return networks.clean(networks.regress(controls))

    _learn(
        networks.autoencoder,
        system,
        losses.system,
        train,
        validation,
        settings.epochs_autoencoder,
        settings,
        report_as("autoencoder", settings.epochs_autoencoder),
    )
    model = RegionModel(
        region=region.id,
        controls=region.controls,
        channels=region.channels,
        networks=networks.eval(),
        covariance=_covariance(train),
        low=low.astype(np.float64),
        high=high.astype(np.float64),
        widths=settings.widths,
    )
    return _judge(model, losses, train, validation)


def _examples(
    region: Region,
    performances: list[Performance],
    distances: Distances,
    settings: FitSettings,
) -> tuple[Windows, Windows]:
    """Training windows, altered copies included, and held-out windows as recorded."""
    weights, captured, blocks = cut_windows(performances, settings.window, settings.overlap)
    random = np.random.default_rng(settings.seed)
    chosen = random.permutation(blocks.max() + 1)
    count = max(1, round(settings.held_out * len(chosen)))
    while not np.isin(chosen[:count], blocks).any():  # short ends of takes hold no window
        count += 1
    held = np.isin(blocks, chosen[:count])
    more = augment(weights[~held], captured[~held], settings.augmentation, random)
    train = region_windows(region, *more, distances)
    validation = region_windows(region, weights[held], captured[held], distances)
    if not len(train) or not len(validation):
        raise FileError(
            "training data",
            f"is too little for the {region.label.lower()}: {len(train)} windows to learn from "
            f"and {len(validation)} to hold out",
            f"add takes of more than {4 * settings.window / GRID_RATE:.0f} seconds",
        )
    return train, validation


def _gradients(region: Region, distances: Distances) -> NDArray[np.float32]:
    rows = [ARKIT_INDEX[c] for c in region.channels]
    columns = [CONTROL_INDEX[c] for c in region.controls]
    return np.ascontiguousarray(distances.gradients[np.ix_(rows, columns)])


def _covariance(windows: Windows) -> NDArray[np.float64]:
    """(K, K) over the captured values of each pair of channels."""
    weights = windows.weights.astype(np.float64)
    seen = windows.captured.astype(np.float64)[:, :, None]
    count = weights.shape[2]
    mean = (weights * seen).sum((0, 2)) / np.maximum(seen.sum((0, 2)) * count, 1)
    centred = (weights - mean[:, None]) * seen
    pairs = np.einsum("nk,nl->kl", seen[:, :, 0], seen[:, :, 0]) * count
    joint = np.einsum("nkt,nlt->kl", centred, centred) / np.maximum(pairs, 1)
    # Pairs were seen on different windows, which can leave slightly negative directions.
    values, vectors = np.linalg.eigh(joint)
    floor = 1e-3 * values.max()
    result: NDArray[np.float64] = (vectors * np.maximum(values, floor)) @ vectors.T
    return result


def _judge(model: RegionModel, losses: Losses, train: Windows, held: Windows) -> Fitted:
    batch = Batch.of(held, np.arange(len(held)))
    with torch.inference_mode():
        answers = {
            "regressor": model.networks(batch.controls, 0.0),
            "system": model.networks(batch.controls, 1.0),
        }
        return Fitted(
            model,
            {k: float(losses.mse(v, batch)) for k, v in answers.items()},
            {k: float(losses.control_error(v, batch).abs().median()) for k, v in answers.items()},
            (len(train), len(held)),
        )
