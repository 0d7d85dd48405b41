"""Fitting the network that completes requests, from damaged takes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Indices
from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.controls import control_named
from faceedit_app.core.regions import Region
from faceedit_app.core.rig import Rig
from faceedit_app.lab.training.architectures.completion import CompletionUNet
from faceedit_app.lab.training.damage import Curves, Requests, requests
from faceedit_app.lab.training.data import Performance, stretches
from faceedit_app.lab.training.export import described
from faceedit_app.lab.training.fit import Epoch, fingerprint
from faceedit_app.lab.training.loop import Checkpoint, History, learn
from faceedit_app.lab.training.settings import TrainingSettings
from faceedit_app.lab.training.variety import play
from faceedit_app.networks.completion import CompletionDescription, CompletionNetwork
from faceedit_app.networks.made_for import MadeFor

STAGE = 5
# Passes over the held-out stretches: each has another place, damage and request.
HELD_OUT_PASSES = 8


@dataclass
class TrainedCompletion:
    """A region's trained completion network.

    Attributes:
        description, network: what is written to the file.
        history: its losses.
        errors: on held-out examples, mean squared error in variances of the take's curves, as
            `network` answers, and if everything were `kept` or taken from `around`.
    """

    description: CompletionDescription
    network: CompletionUNet
    history: History
    errors: dict[str, float]

    def content(self) -> bytes:
        """The content of its file."""
        return described(self.network, self.description.to_json())

    def answering(self) -> CompletionNetwork:
        """The network as the application would use it, without a file."""
        return CompletionNetwork(self.content(), Path(f"{self.description.region}.onnx"))


def is_completed(region: Region) -> bool:
    """Whether a region has curves that move although they are not asked for."""
    return any(control_named(name).closes is None for name in region.own)


def fit_completion(
    region: Region,
    performances: Sequence[Performance],
    rig: Rig,
    settings: TrainingSettings,
    report: Callable[[Epoch], None] = lambda epoch: None,
    checkpoints: Path | None = None,
) -> TrainedCompletion | None:
    """Train the network of a region.

    Returns:
        None if the settings want none, no take has the region, or all its curves are held.
    """
    distances = rig.arkit_distances
    performances = [take for take in performances if _has(take, region)]
    if not settings.epochs_completion or not performances or not is_completed(region):
        return None
    curves = Curves.of(region, performances, distances)
    torch.manual_seed(settings.seed)
    learned, held = stretches(performances, settings)
    variety, window = settings.variety, settings.window

    def epoch(number: int) -> Requests:
        random = np.random.default_rng([settings.seed, 8, number])
        takes = learned
        if variety is not None:
            takes = [play(take, variety, window, settings.mirror, random) for take in learned]
        return requests(takes, curves, distances, window, random)

    chance = np.random.default_rng([settings.seed, 9])
    validation = requests(held * HELD_OUT_PASSES, curves, distances, window, chance)
    network = CompletionUNet.of(len(region.own), len(region.own), settings)
    mark = fingerprint(performances, distances, settings)
    of = settings.epochs_completion
    history = learn(
        network,
        lambda batch, _: network(batch.features),
        loss,
        epoch,
        validation,
        RequestBatch.of,
        of,
        settings,
        STAGE,
        Checkpoint.of_stage(checkpoints, region.id, "completion", mark),
        lambda n, now, aside: report(Epoch(region.id, "completion", n, of, now, aside)),
    )
    description = CompletionDescription(
        region=region.id,
        controls=region.own,
        made_for=MadeFor.of(rig, region.own),
        architecture={"name": network.name, **network.settings},
        scale=network.scale,
    )
    return TrainedCompletion(description, network.eval(), history, _errors(network, validation))


def save_completion(path: Path, trained: TrainedCompletion) -> None:
    """Write a completion network; the same network always gives the same bytes.

    Raises:
        FileError: it cannot be written.
    """
    write_atomically(path, trained.content())


@dataclass(frozen=True)
class RequestBatch:
    """Some requests as tensors; see `Requests`."""

    features: Tensor
    away: Tensor
    truth: Tensor
    share: Tensor
    other: Tensor

    @classmethod
    def of(cls, examples: Requests, rows: Indices) -> RequestBatch:
        """Some of the requests."""
        part = examples.at(rows)
        every = (part.features, part.away, part.truth, part.share, part.other)
        return cls(*map(torch.from_numpy, every))


def loss(answer: Tensor, batch: RequestBatch) -> Tensor:
    """Mean squared error of the completed curves, where edits change anything."""
    share, further = answer[:, :1], answer[:, 1:]
    return _error(batch.share * share * (batch.away + further * batch.other), batch)


def _error(change: Tensor, batch: RequestBatch) -> Tensor:
    where = batch.share * batch.other
    return ((change - batch.truth) ** 2 * where).sum() / where.sum().clamp(min=1.0)


def _errors(network: CompletionUNet, validation: Requests) -> dict[str, float]:
    batch = RequestBatch.of(validation, np.arange(len(validation)))
    with torch.inference_mode():
        return {
            "network": float(loss(network(batch.features), batch)),
            "kept": float(_error(torch.zeros_like(batch.away), batch)),
            "around": float(_error(batch.share * batch.away, batch)),
        }


def _has(take: Performance, region: Region) -> bool:
    return bool(take.captured[[ARKIT_INDEX[c] for c in region.channels]].any())
