"""The baseline: Holden, Saito and Komura, "A Deep Learning Framework for Character Motion
Synthesis and Editing" (SIGGRAPH 2016), adapted to face regions as section 4.1 of our paper says.

A one-layer convolutional autoencoder learns a latent space of motion at half the frame rate; a
two-layer convolutional regressor maps controls to it. The halving of time is what smooths lip
and lid closures away.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Self

from torch import Tensor, nn
from torch.nn import functional as F

from faceedit_app.lab.training.architectures.base import Architecture

if TYPE_CHECKING:
    from faceedit_app.lab.training.settings import TrainingSettings

HIDDEN = 64  # features of the latent space, and of the regressor's first layer
FILTER = 15  # frames; the original's 25 at our lower rate


class HoldenNetworks(Architecture):
    """The baseline's networks for one region."""

    name = "holden"

    def __init__(self, controls: int, channels: int, hidden: int = HIDDEN) -> None:
        super().__init__(controls, channels)
        wide = FILTER // 2
        self.encoder = nn.Conv1d(channels, hidden, FILTER, padding=wide)
        self.decoder = nn.Conv1d(hidden, channels, FILTER, padding=wide)
        self.regressor = nn.Sequential(
            nn.Conv1d(controls, hidden, FILTER, padding=wide),
            nn.ReLU(inplace=True),
            nn.Conv1d(hidden, hidden, FILTER, padding=wide),
            nn.ReLU(inplace=True),
        )

    @classmethod
    def of(cls, controls: int, channels: int, settings: TrainingSettings) -> Self:
        """See `Architecture.of`."""
        return cls(controls, channels)

    @property
    def settings(self) -> dict[str, Any]:
        """See `Architecture.settings`."""
        return {"hidden": self.encoder.out_channels}

    @property
    def scale(self) -> int:
        """See `Architecture.scale`."""
        return 2

    @property
    def radius(self) -> int:
        """See `Architecture.radius`."""
        # Two layers, pooled in twos, and one of half the rate's frames doubled.
        return 3 * (FILTER // 2) + 1

    def encode(self, weights: Tensor) -> Tensor:
        """(N, K, T) weights -> (N, hidden, T / 2)."""
        return F.max_pool1d(F.relu(self.encoder(weights)), 2)

    def decode(self, latent: Tensor) -> Tensor:
        """(N, hidden, T / 2) -> (N, K, T) weights."""
        result: Tensor = self.decoder(F.interpolate(latent, scale_factor=2.0))
        return result

    def forward(self, controls: Tensor) -> Tensor:
        """(N, C, T) mm -> (N, K, T) weights; T is even."""
        return self.decode(F.max_pool1d(self.regressor(controls - self.mean), 2))

    def answers(self, controls: Tensor) -> dict[str, Tensor]:
        """See `Architecture.answers`."""
        return {"system": self(controls)}
