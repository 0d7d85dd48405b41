"""The training loop: Adam, the best epoch kept, resumable, and stoppable at any time."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence, Sized
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

import numpy as np
import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import save
from torch import Tensor, nn

from faceedit_app.core.arrays import Indices
from faceedit_app.core.atomic import write_atomically
from faceedit_app.lab.training.settings import TrainingSettings

State = dict[str, Tensor]
E = TypeVar("E", bound=Sized)  # examples
B = TypeVar("B")  # some of them, as tensors


@dataclass
class History:
    """The losses of the epochs so far.

    Attributes:
        losses, held: mean loss of each epoch on the windows learned from, and held out.
        stopped: the user stopped before the last epoch.
    """

    losses: list[float] = field(default_factory=list)
    held: list[float] = field(default_factory=list)
    stopped: bool = False


@dataclass(frozen=True)
class Checkpoint:
    """Where a stage of the training is kept, so that it can go on after an interruption.

    Attributes:
        path: safetensors: the network, its best state, the optimiser's; JSON: the losses.
        fingerprint: of settings and data; a checkpoint of another training is not used.
    """

    path: Path
    fingerprint: str

    @classmethod
    def of_stage(
        cls, folder: Path | None, region: str, name: str, fingerprint: str
    ) -> Checkpoint | None:
        """That of one stage of a region's training, in a folder; None without a folder."""
        if folder is None:
            return None
        return cls(folder / f"{region}.{name}.safetensors", fingerprint)

    def write(
        self, network: nn.Module, best: State, optimiser: torch.optim.Adam, history: History
    ) -> None:
        """Keep the state after an epoch."""
        tensors = {f"now.{k}": v for k, v in network.state_dict().items()}
        tensors |= {f"best.{k}": v for k, v in best.items()}
        for number, moments in optimiser.state_dict()["state"].items():
            tensors |= {f"adam.{number}.{k}": v for k, v in moments.items()}
        about = {
            "fingerprint": self.fingerprint,
            "losses": history.losses,
            "held": history.held,
        }
        content = {k: v.detach().clone().contiguous() for k, v in tensors.items()}
        write_atomically(self.path, save(content, {"about": json.dumps(about)}))

    def read(self, network: nn.Module, optimiser: torch.optim.Adam) -> tuple[History, State] | None:
        """Bring network and optimiser to the kept state; None if there is none of this training."""
        try:
            with safe_open(str(self.path), framework="pt") as file:
                about = json.loads((file.metadata() or {})["about"])
                if about["fingerprint"] != self.fingerprint:
                    return None
                tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
            network.load_state_dict(_below("now.", tensors))
            state: dict[int, State] = {}
            for name, value in _below("adam.", tensors).items():
                number, key = name.split(".")
                state.setdefault(int(number), {})[key] = value
            groups = optimiser.state_dict()["param_groups"]
            optimiser.load_state_dict({"state": state, "param_groups": groups})
            history = History(
                [float(x) for x in about["losses"]], [float(x) for x in about["held"]]
            )
            return history, _below("best.", tensors)
        except (OSError, SafetensorError, KeyError, ValueError, TypeError, RuntimeError):
            return None  # missing or damaged: start over


def _below(prefix: str, tensors: State) -> State:
    return {k.removeprefix(prefix): v for k, v in tensors.items() if k.startswith(prefix)}


def rate(settings: TrainingSettings, epochs: int, held: Sequence[float]) -> float:
    """The learning rate of the next epoch, after held-out losses `held`.

    A cosine from `learning_rate` to its share `final_rate`; or, as in the paper, a factor `decay`
    each time `patience` epochs in a row brought no improvement.
    """
    if settings.final_rate is not None:
        part = 0.5 + 0.5 * math.cos(math.pi * len(held) / max(epochs, 1))
        return settings.learning_rate * (settings.final_rate + (1 - settings.final_rate) * part)
    best, waited, decays = math.inf, 0, 0
    for loss in held:
        waited = 0 if loss < best else waited + 1
        best = min(best, loss)
        if waited == settings.patience:
            waited, decays = 0, decays + 1
    return settings.learning_rate * settings.decay**decays


def learn(
    network: nn.Module,
    forward: Callable[[B, torch.Generator | None], Tensor],
    loss_of: Callable[[Tensor, B], Tensor],
    examples: Callable[[int], E],
    validation: E,
    batch_of: Callable[[E, Indices], B],
    epochs: int,
    settings: TrainingSettings,
    stage: int,
    checkpoint: Checkpoint | None = None,
    report: Callable[[int, float, float], None] = lambda number, loss, held: None,
) -> History:
    """Train a network and leave it at the epoch of the lowest held-out loss.

    Each epoch draws its chance from the seed, the stage and its own number, so that a training
    that was interrupted and goes on gives the same network as one that was not. Ctrl+C ends it
    early, with the best state so far.

    Args:
        forward: the answer to a batch; with a generator while learning, without when judged.
        examples: the windows to learn from in an epoch (1, 2, ...).
        batch_of: some of the examples, as tensors.
        stage: number of the stage, to distinguish those of one training.
        checkpoint: where to go on from, and where to keep the state after each epoch.
        report: called after each epoch with its number and the two losses.
    """
    learned = [p for p in network.parameters() if p.requires_grad]
    size = sum(p.numel() for p in learned)
    optimiser = torch.optim.Adam(
        learned, settings.learning_rate, weight_decay=2 * settings.l2 / max(size, 1)
    )
    history, best = History(), _copy(network)
    if checkpoint is not None and (found := checkpoint.read(network, optimiser)):
        history, best = found
    try:
        for number in range(len(history.held) + 1, epochs + 1):
            for group in optimiser.param_groups:
                group["lr"] = rate(settings, epochs, history.held)
            chance = np.random.default_rng([settings.seed, stage, number])
            loss = _learn_epoch(
                network, forward, loss_of, examples(number), batch_of, chance, settings, optimiser
            )
            network.eval()
            held = _epoch(
                lambda b: forward(b, None),
                loss_of,
                lambda rows: batch_of(validation, rows),
                np.arange(len(validation)),
                512,
                None,
            )
            if held < min(history.held, default=math.inf):
                best = _copy(network)
            history.losses.append(loss)
            history.held.append(held)
            if checkpoint is not None:
                checkpoint.write(network, best, optimiser, history)
            report(number, loss, held)
    except KeyboardInterrupt:
        history.stopped = True
    network.load_state_dict(best)
    network.eval()
    return history


def _learn_epoch(
    network: nn.Module,
    forward: Callable[[B, torch.Generator | None], Tensor],
    loss_of: Callable[[Tensor, B], Tensor],
    windows: E,
    batch_of: Callable[[E, Indices], B],
    chance: np.random.Generator,
    settings: TrainingSettings,
    optimiser: torch.optim.Optimizer,
) -> float:
    """Learn from all windows once, in random order; the loss."""
    noise = torch.Generator().manual_seed(int(chance.integers(2**62)))
    network.train()
    return _epoch(
        lambda batch: forward(batch, noise),
        loss_of,
        lambda rows: batch_of(windows, rows),
        chance.permutation(len(windows)),
        settings.batch,
        optimiser,
    )


def _copy(network: nn.Module) -> State:
    return {k: v.clone() for k, v in network.state_dict().items()}


def _epoch(
    forward: Callable[[B], Tensor],
    loss_of: Callable[[Tensor, B], Tensor],
    batch_of: Callable[[Indices], B],
    order: Indices,
    batch: int,
    optimiser: torch.optim.Optimizer | None,
) -> float:
    """One pass; with an optimiser it learns. Returns the mean loss."""
    total = 0.0
    for first in range(0, len(order), batch):
        rows = order[first : first + batch]
        examples = batch_of(rows)
        with torch.set_grad_enabled(optimiser is not None):
            loss = loss_of(forward(examples), examples)
        if optimiser is not None:
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
        total += float(loss.detach()) * len(rows)
    return total / len(order)
