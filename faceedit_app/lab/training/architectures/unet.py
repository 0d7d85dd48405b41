"""1-D U-Nets over time.

They keep the resolution: a sequence of any length T goes in and one of length T comes out. Each
block is batch normalisation, a convolution of 3 frames and an activation; time is halved by
max-pooling and doubled again by up-sampling, and skip layers carry the fast movements across.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Self

import torch
from torch import Tensor, nn
from torch.nn import functional as F

from faceedit_app.lab.training.architectures.base import Stacked

if TYPE_CHECKING:
    from faceedit_app.lab.training.settings import TrainingSettings


# By the name in the settings. ONNX Runtime has no fast ELU: it takes a third of the networks' time,
# and convolutions on either side of it cannot hand on their blocks.
ACTIVATIONS: dict[str, type[nn.ELU | nn.SiLU]] = {"elu": nn.ELU, "silu": nn.SiLU}


def _convolution(inputs: int, outputs: int) -> nn.Conv2d:
    # Time as a picture of one row: ONNX Runtime lays out only those in blocks, and answers a fifth
    # sooner. To torch it is the same.
    return nn.Conv2d(inputs, outputs, (1, 3), padding=(0, 1))


def _block(inputs: int, outputs: int, activation: str) -> nn.Sequential:
    return nn.Sequential(
        nn.BatchNorm2d(inputs),
        _convolution(inputs, outputs),
        ACTIVATIONS[activation](inplace=True),
    )


class UNet(nn.Module):
    """Resolution-preserving 1-D U-Net.

    Args:
        inputs, outputs: numbers of channels.
        widths: features at each time scale, finest first.
        activation: key of `ACTIVATIONS`.
    """

    def __init__(
        self, inputs: int, outputs: int, widths: tuple[int, ...], activation: str = "elu"
    ) -> None:
        super().__init__()
        pairs = list(zip((inputs, *widths[:-1]), widths, strict=True))
        self.down = nn.ModuleList(
            nn.Sequential(_block(a, b, activation), _block(b, b, activation)) for a, b in pairs
        )
        rising = list(zip(widths[::-1][1:], widths[::-1], strict=False))
        self.up = nn.ModuleList(
            nn.Sequential(_block(fine + coarse, fine, activation), _block(fine, fine, activation))
            for fine, coarse in rising
        )
        self.out = _convolution(widths[0], outputs)

    @property
    def scale(self) -> int:
        """Frames that the coarsest level sees as one; lengths are padded to a multiple."""
        return 1 << (len(self.down) - 1)

    @property
    def radius(self) -> int:
        """Frames on either side that can influence a frame of the output."""
        scales = [1 << i for i in range(len(self.down))]
        return 2 * sum(scales) + 2 * sum(scales[:-1]) + 1 + scales[-1] - 1

    def forward(self, sequence: Tensor) -> Tensor:
        """(N, inputs, T) -> (N, outputs, T); T must be a multiple of `scale`."""
        x, skips = sequence.unsqueeze(2), []
        for i, level in enumerate(self.down):
            x = level(F.max_pool2d(x, (1, 2)) if i else x)
            skips.append(x)
        for level, skip in zip(self.up, skips[-2::-1], strict=True):
            x = level(torch.cat([F.interpolate(x, scale_factor=(1.0, 2.0)), skip], dim=1))
        result: Tensor = self.out(x).squeeze(2)
        return result


class UNets(Stacked):
    """A region's regressor and autoencoder, both U-Nets.

    Args:
        widths, activation: of both, see `UNet`.
    """

    name = "unet"
    regressor: UNet
    autoencoder: UNet

    def __init__(
        self,
        controls: int,
        channels: int,
        widths: tuple[int, ...],
        residual: bool = True,
        adapted: bool = False,
        activation: str = "elu",
    ) -> None:
        self.widths, self.activation = tuple(widths), activation
        super().__init__(controls, channels, residual, adapted)
        if residual:
            nn.init.zeros_(self.autoencoder.out.weight)
            nn.init.zeros_(self.autoencoder.out.bias)  # type: ignore[arg-type]

    @classmethod
    def of(cls, controls: int, channels: int, settings: TrainingSettings) -> Self:
        """See `Architecture.of`."""
        return cls(
            controls,
            channels,
            settings.widths_for(controls),
            settings.residual,
            settings.adapt_statistics,
            settings.activation,
        )

    def network(self, inputs: int, outputs: int) -> UNet:
        """See `Stacked.network`."""
        return UNet(inputs, outputs, self.widths, self.activation)

    @property
    def settings(self) -> dict[str, Any]:
        """See `Architecture.settings`."""
        return {
            "widths": list(self.widths),
            "residual": self.residual,
            "adapted": self.adapted is not None,
            "activation": self.activation,
        }

    @property
    def scale(self) -> int:
        """See `Architecture.scale`."""
        return self.regressor.scale

    @property
    def radius(self) -> int:
        """See `Architecture.radius`."""
        return self.regressor.radius + self.autoencoder.radius
