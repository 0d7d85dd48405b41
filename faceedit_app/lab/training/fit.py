"""Fitting the networks of a region (paper, sections 3.2 and 3.3).

    faceedit train --data DIR... -o models

reads every take below the folders and writes one file per region and a model card.
"""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.regions import Region
from faceedit_app.core.rig import Distances, Rig
from faceedit_app.lab.training.architectures import ARCHITECTURES, Stacked
from faceedit_app.lab.training.data import Performance
from faceedit_app.lab.training.examples import Examples
from faceedit_app.lab.training.loop import Checkpoint, History, learn
from faceedit_app.lab.training.losses import Losses, WindowBatch, salt_and_pepper
from faceedit_app.lab.training.model_files import TrainedRegion
from faceedit_app.lab.training.settings import TrainingSettings, as_json

REGRESSOR, AUTOENCODER = 1, 2


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
class FittedRegion:
    """A region's model and what the held-out windows say about it.

    Attributes:
        model: ready to be saved.
        mse: held-out mean squared weight error of `regressor` and `system`.
        control_mm: held-out median absolute control error, likewise.
        windows: numbers of training (an epoch) and held-out windows.
        histories: losses by stage.
        stopped: the user stopped the training; the best so far is kept.
        completion: held-out errors of its completion network, see `TrainedCompletion`, if any.
    """

    model: TrainedRegion
    mse: dict[str, float]
    control_mm: dict[str, float]
    windows: tuple[int, int]
    histories: dict[str, History]
    stopped: bool = False
    completion: dict[str, float] | None = None


def fit_region(
    region: Region,
    performances: Sequence[Performance],
    rig: Rig,
    settings: TrainingSettings,
    report: Callable[[Epoch], None] = lambda epoch: None,
    start: TrainedRegion | None = None,
    checkpoints: Path | None = None,
) -> FittedRegion:
    """Train a region's regressor, then its autoencoder behind the frozen regressor.

    Args:
        rig: the character that the controls are measured on, and the networks are made for.
        report: called after each epoch.
        start: go on from these networks, with their input mean and within their ranges.
        checkpoints: folder to keep the state in, and to go on from.
    """
    torch.manual_seed(settings.seed)
    examples = Examples(region, performances, rig, settings)
    losses = Losses(examples.own_distances, settings)
    networks = _networks(region, examples, settings, start)
    low, high = examples.bounds
    covariance = examples.covariance
    if start is not None:
        known = start.description
        low, high = np.minimum(low, known.low), np.maximum(high, known.high)
        covariance = 0.5 * (covariance + known.covariance)
    mark = fingerprint(performances, rig.arkit_distances, settings, start)
    histories: dict[str, History] = {}

    def stage(name: str, number: int, of: int, network: nn.Module) -> None:
        histories[name] = learn(
            network,
            _forward(networks, settings, (low, high), number == AUTOENCODER),
            losses.system if number == AUTOENCODER else losses.regressor,
            lambda epoch: examples.epoch(1000 * number + epoch),
            examples.validation,
            WindowBatch.of,
            of,
            settings,
            number,
            Checkpoint.of_stage(checkpoints, region.id, name, mark),
            lambda n, loss, held: report(Epoch(region.id, name, n, of, loss, held)),
        )

    stage("regressor", REGRESSOR, settings.epochs_regressor, networks.regressor)
    networks.regressor.requires_grad_(False)
    if not histories["regressor"].stopped:
        behind = _behind_the_regressor(networks)
        stage("autoencoder", AUTOENCODER, settings.epochs_autoencoder, behind)
    description = examples.describe(
        networks,
        covariance=covariance,
        low=low,
        high=high,
        notes=json.dumps(as_json(settings)),
        natural=examples.natural,
    )
    return _judge(TrainedRegion(description, networks.eval()), losses, examples, histories)


def _behind_the_regressor(networks: Stacked) -> nn.Module:
    """What is trained once the regressor is frozen."""
    learned = nn.ModuleList([networks.autoencoder])
    if networks.adapted is not None:  # its statistics follow the noise, its weights do not
        networks.adapted.load_state_dict(networks.regressor.state_dict())
        networks.adapted.requires_grad_(False)
        learned.append(networks.adapted)
    return learned


def fingerprint(
    performances: Sequence[Performance],
    distances: Distances,
    settings: TrainingSettings,
    start: TrainedRegion | None = None,
) -> str:
    """A text that is the same for the same takes, controls, settings and beginning."""
    takes = [
        [take.name, len(take.weights), float(distances.measure(take.weights).sum(dtype=np.float64))]
        for take in performances
    ]
    first = (
        None
        if start is None
        else sum(float(p.detach().double().sum()) for p in start.networks.parameters())
    )
    return json.dumps([as_json(settings), takes, first])


def _networks(
    region: Region, examples: Examples, settings: TrainingSettings, start: TrainedRegion | None
) -> Stacked:
    if start is not None:
        networks = copy.deepcopy(start.networks).requires_grad_(True)
    else:
        kind = ARCHITECTURES[settings.architecture]
        networks = kind.of(len(region.controls), len(region.channels), settings)
        networks.mean.copy_(torch.from_numpy(examples.mean)[:, None])
    if not isinstance(networks, Stacked):
        raise FaceEditError(f"the architecture {networks.name!r} is not trained in two stages")
    return networks


def _forward(
    networks: Stacked,
    settings: TrainingSettings,
    bounds: Sequence[np.ndarray[tuple[int], np.dtype[np.float64]]],
    system: bool,
) -> Callable[[WindowBatch, torch.Generator | None], Tensor]:
    """What a stage computes; the full system sees noise while it learns."""
    low, high = (torch.from_numpy(np.asarray(x, np.float32)) for x in bounds)

    def forward(batch: WindowBatch, random: torch.Generator | None) -> Tensor:
        controls = batch.controls
        if not system:
            return networks.regress(controls)
        if random is not None:
            controls = salt_and_pepper(controls, low, high, settings, random)
        return networks.clean(networks.prepare(controls))

    return forward


def _judge(
    model: TrainedRegion, losses: Losses, examples: Examples, histories: dict[str, History]
) -> FittedRegion:
    batch = WindowBatch.of(examples.validation, np.arange(len(examples.validation)))
    with torch.inference_mode():
        answers = model.networks.answers(batch.controls)
        return FittedRegion(
            model,
            {k: float(losses.mse(v, batch)) for k, v in answers.items()},
            {k: float(losses.control_error(v, batch).abs().median()) for k, v in answers.items()},
            examples.count,
            histories,
            any(history.stopped for history in histories.values()),
        )
