"""The network that completes requests: a small U-Net over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Self

import torch
from torch import Tensor, nn

from faceedit_app.lab.training.architectures.base import Architecture
from faceedit_app.lab.training.architectures.unet import UNet
from faceedit_app.networks.completion import FEATURES

if TYPE_CHECKING:
    from faceedit_app.lab.training.settings import TrainingSettings

_DOUBT = -1.0  # what a new network answers, before the sigmoid: most takes are right


class CompletionUNet(Architecture):
    """The completion network of a region with C curves.

    Args:
        controls: 5 C features in.
        channels: 1 + C out: the share, then how much further each curve goes.
        widths, activation: see `UNet`.
    """

    name = "completion"

    def __init__(
        self, controls: int, channels: int, widths: tuple[int, ...], activation: str
    ) -> None:
        super().__init__(controls, channels)
        self.widths, self.activation = tuple(widths), activation
        self.unet = UNet(controls, channels, self.widths, activation)
        nn.init.zeros_(self.unet.out.weight)
        bias = self.unet.out.bias
        assert bias is not None
        nn.init.zeros_(bias)
        with torch.no_grad():
            bias[0] = _DOUBT

    @classmethod
    def of(cls, controls: int, channels: int, settings: TrainingSettings) -> Self:
        """See `Architecture.of`; `controls` is the number C of curves, and so is `channels`."""
        return cls(
            FEATURES * controls, 1 + channels, settings.completion_widths, settings.activation
        )

    @property
    def settings(self) -> dict[str, Any]:
        """See `Architecture.settings`."""
        return {"widths": list(self.widths), "activation": self.activation}

    @property
    def scale(self) -> int:
        """See `Architecture.scale`."""
        return self.unet.scale

    @property
    def radius(self) -> int:
        """See `Architecture.radius`."""
        return self.unet.radius

    def forward(self, features: Tensor) -> Tensor:
        """(N, 5 C, T) -> (N, 1 + C, T); the first in 0..1."""
        answer = self.unet(features)
        return torch.cat([torch.sigmoid(answer[:, :1]), answer[:, 1:]], dim=1)

    def answers(self, controls: Tensor) -> dict[str, Tensor]:
        """See `Architecture.answers`."""
        return {"system": self(controls)}
