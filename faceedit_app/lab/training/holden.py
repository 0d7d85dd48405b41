"""Training the baseline of the evaluation, see `architectures/holden.py`.

One such pair a region, trained on the same data.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import torch
from torch import nn

from faceedit_app.core.regions import Region
from faceedit_app.core.rig import Rig
from faceedit_app.lab.training.architectures.holden import HoldenNetworks
from faceedit_app.lab.training.data import Performance
from faceedit_app.lab.training.examples import Examples
from faceedit_app.lab.training.fit import Epoch, fingerprint
from faceedit_app.lab.training.loop import Checkpoint, History, learn
from faceedit_app.lab.training.losses import Losses, WindowBatch
from faceedit_app.lab.training.model_files import TrainedRegion
from faceedit_app.lab.training.settings import TrainingSettings

FOLDER = "holden"
"""Below a folder of models: the baseline's files, one a region."""


def fit_holden(
    region: Region,
    performances: Sequence[Performance],
    rig: Rig,
    settings: TrainingSettings,
    report: Callable[[Epoch], None] = lambda epoch: None,
    checkpoints: Path | None = None,
) -> tuple[TrainedRegion, dict[str, History]]:
    """Train the baseline on the same examples, with the same optimiser and as many epochs.

    First the autoencoder on weights, then the regressor through the frozen decoder; both learn
    the mean squared weight error, as in the original.
    """
    torch.manual_seed(settings.seed)
    examples = Examples(region, performances, rig, settings)
    losses = Losses(examples.own_distances, settings)
    networks = HoldenNetworks.of(len(region.controls), len(region.channels), settings)
    networks.mean.copy_(torch.from_numpy(examples.mean)[:, None])
    mark = fingerprint(performances, rig.arkit_distances, settings)
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
            WindowBatch.of,
            of,
            settings,
            number,
            Checkpoint.of_stage(checkpoints, region.id, name, mark),
            lambda n, loss, held, name=name, of=of: report(  # type: ignore[misc]
                Epoch(region.id, name, n, of, loss, held)
            ),
        )
        manifold.requires_grad_(False)
        if histories[name].stopped:
            break
    return TrainedRegion(examples.describe(networks), networks.eval()), histories
