"""The losses of the networks, and the noise on their inputs during training."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from faceedit_app.core.arrays import Indices
from faceedit_app.core.rig import Distances
from faceedit_app.lab.training.data import Windows
from faceedit_app.lab.training.settings import TrainingSettings


@dataclass(frozen=True)
class WindowBatch:
    """Windows as tensors; see `Windows`."""

    controls: Tensor
    weights: Tensor
    captured: Tensor
    still: Tensor

    @classmethod
    def of(cls, windows: Windows, rows: Indices) -> WindowBatch:
        """Some of the windows."""
        part = windows[rows]
        return cls(*map(torch.from_numpy, (part.controls, part.weights, part.captured, part.still)))


class Losses:
    """The terms of the losses of one region.

    Args:
        distances: the region's controls as a function of its own channels.
        settings: weights of the terms.
    """

    def __init__(self, distances: Distances, settings: TrainingSettings) -> None:
        self.gradients = torch.from_numpy(distances.gradients)
        self.shuts = torch.from_numpy(distances.shuts)[:, None]
        self.heights = torch.from_numpy(distances.offsets[:, 1].copy())[:, None]
        self.settings = settings

    def mse(self, answer: Tensor, batch: WindowBatch) -> Tensor:
        """Mean squared weight error over the captured channels."""
        mask = batch.captured[:, :, None].float()
        error = ((answer - batch.weights) ** 2 * mask).sum()
        return error / (mask.sum() * answer.shape[2])

    def velocity(self, answer: Tensor, batch: WindowBatch) -> Tensor:
        """Mean squared error of the change from frame to frame over the captured channels."""
        mask = batch.captured[:, :, None].float()
        error = ((answer - batch.weights).diff(dim=2) ** 2 * mask).sum()
        return error / (mask.sum() * (answer.shape[2] - 1))

    def control_error(self, answer: Tensor, batch: WindowBatch) -> Tensor:
        """(N, C, W) mm: the controls of the answer, through the rig, minus those of the take."""
        vectors = batch.still + torch.einsum("nkt,kcx->ncxt", answer, self.gradients)
        lengths = torch.sqrt((vectors**2).sum(2) + 1e-6)
        passed = self.shuts & (vectors[:, :, 1] * self.heights < 0)  # shut is 0, see `Distances`
        return lengths.masked_fill(passed, 0.0) - batch.controls

    def distance(self, answer: Tensor, batch: WindowBatch) -> Tensor:
        """Mean squared control error, in units; small distances (closures) count more."""
        how = self.settings
        error = self.control_error(answer, batch) / how.distance_unit_mm
        weight = 1.0 + how.near_weight * torch.exp(-batch.controls / how.near_mm)
        return (weight * error**2).mean()

    def regressor(self, answer: Tensor, batch: WindowBatch) -> Tensor:
        """The loss of the regressor (its L2 term is the optimiser's weight decay)."""
        loss = self.mse(answer, batch)
        if self.settings.distance_loss_regressor:
            loss = loss + self.settings.distance_loss_regressor * self.distance(answer, batch)
        return self._with_velocity(loss, answer, batch)

    def system(self, answer: Tensor, batch: WindowBatch) -> Tensor:
        """The loss of the full system: MSE + distances."""
        loss = self.mse(answer, batch)
        loss = loss + self.settings.distance_loss * self.distance(answer, batch)
        return self._with_velocity(loss, answer, batch)

    def _with_velocity(self, loss: Tensor, answer: Tensor, batch: WindowBatch) -> Tensor:
        if not self.settings.velocity_loss:
            return loss
        return loss + self.settings.velocity_loss * self.velocity(answer, batch)


def salt_and_pepper(
    controls: Tensor, low: Tensor, high: Tensor, settings: TrainingSettings, random: torch.Generator
) -> Tensor:
    """Set a share of the control values (N, C, W) to the ends of their range (C,), as wild edits
    do, in a share of the windows."""
    noisy = torch.rand(len(controls), 1, 1, generator=random) < settings.noisy_windows
    hit = torch.rand(controls.shape, generator=random) < settings.noise
    salt = torch.rand(controls.shape, generator=random) < 0.5
    extremes = torch.where(salt, high[:, None], low[:, None])
    return torch.where(noisy & hit, extremes, controls)
