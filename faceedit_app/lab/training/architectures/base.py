"""What every architecture has in common.

To add one: a module here with a subclass of `Stacked`, which has the two networks of the paper, its
class in `ARCHITECTURES`, and a recipe in `settings.py` that selects it. Any other subclass of
`Architecture` also needs a training of its own, as in `training/holden.py`. `export.py` turns it
into a file that the application reads; an operator that no other architecture needs is allowed in
`networks/graph.py`.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any, ClassVar, Self

import torch
from torch import Tensor, nn

if TYPE_CHECKING:
    from faceedit_app.lab.training.settings import TrainingSettings


class Architecture(nn.Module):
    """The networks of one region.

    Args:
        controls: number of controls C.
        channels: number of channels K.

    Attributes:
        name: key of `ARCHITECTURES`.
        mean: (C, 1) mm, subtracted from the controls (mean over the training set).
    """

    name: ClassVar[str]
    mean: Tensor

    def __init__(self, controls: int, channels: int) -> None:
        super().__init__()
        self.controls, self.channels = controls, channels
        self.register_buffer("mean", torch.zeros(controls, 1))

    @classmethod
    @abstractmethod
    def of(cls, controls: int, channels: int, settings: TrainingSettings) -> Self:
        """Untrained networks."""

    @property
    @abstractmethod
    def settings(self) -> dict[str, Any]:
        """Further arguments to make the same networks, as plain JSON values."""

    @property
    @abstractmethod
    def scale(self) -> int:
        """Sequence lengths must be a multiple of this."""

    @property
    @abstractmethod
    def radius(self) -> int:
        """Frames on either side that can influence a frame of the answer."""

    @abstractmethod
    def answers(self, controls: Tensor) -> dict[str, Tensor]:
        """What is exported: (N, C, T) mm -> (N, K, T) weights, by the name of the graph's output.

        `system` is what the networks answer; `regressor`, where there is one, what they answer at
        naturalness 0.
        """


class Stacked(Architecture):
    """Regressor and stacked denoising autoencoder (paper, sections 3.2 and 3.3).

    A residual autoencoder learns the correction to its input and starts as the identity: with a
    few minutes of data this keeps lip closures that the plain one of the paper smooths away.

    Args:
        residual: the autoencoder adds to its input instead of replacing it (not in the paper).
        adapted: the full system reads the regressor with batch-norm statistics of its own,
            adapted to noisy controls (as in the paper), so that the regressor alone keeps those
            that it was trained with.
    """

    regressor: nn.Module
    autoencoder: nn.Module
    adapted: nn.Module | None

    def __init__(self, controls: int, channels: int, residual: bool, adapted: bool) -> None:
        super().__init__(controls, channels)
        self.residual = residual
        self.regressor = self.network(controls, channels)
        self.autoencoder = self.network(channels, channels)
        self.adapted = self.network(controls, channels) if adapted else None

    @abstractmethod
    def network(self, inputs: int, outputs: int) -> nn.Module:
        """One of the networks, (N, inputs, T) -> (N, outputs, T)."""

    def regress(self, controls: Tensor) -> Tensor:
        """(N, C, T) mm -> (N, K, T) weights, as the regressor alone answers."""
        result: Tensor = self.regressor(controls - self.mean)
        return result

    def prepare(self, controls: Tensor) -> Tensor:
        """(N, C, T) mm -> (N, K, T) weights, as the regressor hands them to the autoencoder."""
        reader = self.regressor if self.adapted is None else self.adapted
        result: Tensor = reader(controls - self.mean)
        return result

    def clean(self, weights: Tensor) -> Tensor:
        """(N, K, T) weights -> (N, K, T) weights on natural motion."""
        cleaned: Tensor = self.autoencoder(weights)
        return weights + cleaned if self.residual else cleaned

    def answers(self, controls: Tensor) -> dict[str, Tensor]:
        """See `Architecture.answers`."""
        regressed = self.regress(controls)
        prepared = regressed if self.adapted is None else self.prepare(controls)
        return {"regressor": regressed, "system": self.clean(prepared)}
