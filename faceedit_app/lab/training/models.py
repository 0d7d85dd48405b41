"""The two networks of a region (paper, section 3.2, 3.3): 1-D U-Nets over time.

Both keep the resolution: a sequence of any length T goes in and one of length T comes out. Each
block is batch normalisation, a convolution of 3 frames and ELU; time is halved by max-pooling
and doubled again by up-sampling, and skip layers carry the fast movements across.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn
from torch.nn import functional as F

from faceedit_app.networks.inference import time_radius, time_scale

DEFAULT_WIDTHS = (32, 64, 128)


def _block(inputs: int, outputs: int) -> nn.Sequential:
    return nn.Sequential(
        nn.BatchNorm1d(inputs), nn.Conv1d(inputs, outputs, 3, padding=1), nn.ELU(inplace=True)
    )


class UNet(nn.Module):
    """Resolution-preserving 1-D U-Net.

    Args:
        inputs, outputs: numbers of channels.
        widths: features at each time scale, finest first.
    """

    def __init__(self, inputs: int, outputs: int, widths: tuple[int, ...] = DEFAULT_WIDTHS):
        super().__init__()
        pairs = list(zip((inputs, *widths[:-1]), widths, strict=True))
        self.down = nn.ModuleList(nn.Sequential(_block(a, b), _block(b, b)) for a, b in pairs)
        rising = list(zip(widths[::-1][1:], widths[::-1], strict=False))
        self.up = nn.ModuleList(
            nn.Sequential(_block(fine + coarse, fine), _block(fine, fine))
            for fine, coarse in rising
        )
        self.out = nn.Conv1d(widths[0], outputs, 3, padding=1)

    @property
    def scale(self) -> int:
        """Frames that the coarsest level sees as one; lengths are padded to a multiple."""
        return time_scale(len(self.down))

    @property
    def radius(self) -> int:
        """Frames on either side that can influence a frame of the output."""
        return time_radius(len(self.down))

    def forward(self, x: Tensor) -> Tensor:
        """(N, inputs, T) -> (N, outputs, T); T must be a multiple of `scale`."""
        skips = []
        for i, level in enumerate(self.down):
            x = level(F.max_pool1d(x, 2) if i else x)
            skips.append(x)
        for level, skip in zip(self.up, skips[-2::-1], strict=True):
            x = level(torch.cat([F.interpolate(x, scale_factor=2.0), skip], dim=1))
        result: Tensor = self.out(x)
        return result


class RegionNetworks(nn.Module):
    """Regressor and stacked autoencoder of one region.

    A residual autoencoder learns the correction to its input and starts as the identity: with a
    few minutes of data this keeps lip closures that the plain one of the paper smooths away.

    Args:
        controls: number of controls C.
        channels: number of channels K.
        widths: features of both U-Nets.
        residual: the autoencoder adds to its input instead of replacing it (not in the paper).
        adapted: the full system reads the regressor with batch-norm statistics of its own,
            adapted to noisy controls (as in the paper), so that the regressor alone keeps those
            that it was trained with.

    Attributes:
        mean: (C,) mm, subtracted from the controls (mean over the training set).
    """

    mean: Tensor

    def __init__(
        self,
        controls: int,
        channels: int,
        widths: tuple[int, ...] = DEFAULT_WIDTHS,
        residual: bool = True,
        adapted: bool = False,
    ):
        super().__init__()
        self.residual = residual
        self.register_buffer("mean", torch.zeros(controls))
        self.regressor = UNet(controls, channels, widths)
        self.autoencoder = UNet(channels, channels, widths)
        self.adapted = UNet(controls, channels, widths) if adapted else None
        if residual:
            nn.init.zeros_(self.autoencoder.out.weight)
            nn.init.zeros_(self.autoencoder.out.bias)  # type: ignore[arg-type]

    @property
    def scale(self) -> int:
        """Sequence lengths must be a multiple of this."""
        return self.regressor.scale

    @property
    def radius(self) -> int:
        """Frames on either side that can influence a frame of the answer."""
        return self.regressor.radius + self.autoencoder.radius

    def regress(self, controls: Tensor) -> Tensor:
        """(N, C, T) mm -> (N, K, T) weights, as the regressor alone answers."""
        result: Tensor = self.regressor(controls - self.mean[:, None])
        return result

    def prepare(self, controls: Tensor) -> Tensor:
        """(N, C, T) mm -> (N, K, T) weights, as the regressor hands them to the autoencoder."""
        reader = self.regressor if self.adapted is None else self.adapted
        result: Tensor = reader(controls - self.mean[:, None])
        return result

    def clean(self, weights: Tensor) -> Tensor:
        """(N, K, T) weights -> (N, K, T) weights on natural motion."""
        cleaned: Tensor = self.autoencoder(weights)
        return weights + cleaned if self.residual else cleaned

    def forward(self, controls: Tensor, naturalness: float = 1.0) -> Tensor:
        """(N, C, T) mm -> (N, K, T) weights; naturalness 0 = regressor, 1 = full system."""
        regressed = self.regress(controls)
        if naturalness == 0:
            return regressed
        prepared = regressed if self.adapted is None else self.prepare(controls)
        return torch.lerp(regressed, self.clean(prepared), naturalness)
