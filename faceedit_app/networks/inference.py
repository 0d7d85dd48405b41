"""Answering with a region's networks in plain numpy.

The networks are small (a third of a million parameters) and the sequences short, so a few matrix
products on one core answer sooner than torch does, start without loading it, and give the same
picture in an installed bundle as in a checkout. `models.py` says what is computed; tests hold the
two together.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from faceedit_app.networks.files import RegionFile
from faceedit_app.networks.unet import UNet

Floats = NDArray[np.float32]


def time_scale(levels: int) -> int:
    """Frames that the coarsest of some levels sees as one."""
    return 1 << (levels - 1)


def time_radius(levels: int) -> int:
    """Frames on either side that can influence a frame of a U-Net's output."""
    scales = [1 << i for i in range(levels)]
    return 2 * sum(scales) + 2 * sum(scales[:-1]) + 1 + scales[-1] - 1


class RegionAnswer:
    """The trained networks of one region, ready to answer.

    Attributes:
        region, controls, channels, covariance, low, high, natural: as in `RegionFile`.
        scale: sequence lengths must be a multiple of this.
        radius: frames on either side that can influence a frame of the answer.

    Raises:
        KeyError, ValueError: the file's tensors are not those of the networks.
    """

    def __init__(self, file: RegionFile) -> None:
        self.region, self.controls, self.channels = file.region, file.controls, file.channels
        self.covariance, self.low, self.high = file.covariance, file.low, file.high
        levels = len(file.widths)
        self.scale, self.radius = time_scale(levels), 2 * time_radius(levels)
        self._mean = file.tensors["mean"].astype(np.float32)
        self._regressor = UNet(file.tensors, "regressor", levels)
        self._autoencoder = UNet(file.tensors, "autoencoder", levels)
        self._adapted = UNet(file.tensors, "adapted", levels) if file.adapted else None
        self._residual, self.natural = file.residual, file.natural
        probe = self(np.zeros((1, self.scale, len(self.controls)), np.float32), 1.0)
        if probe.shape[2] != len(self.channels):
            raise ValueError(f"answers {probe.shape[2]} channels, not {len(self.channels)}")

    @property
    def products(self) -> float:
        """Multiplications for one frame of the full system's answer."""
        nets = (self._regressor, self._autoencoder, self._adapted)
        return sum(net.products for net in nets if net is not None)

    def __call__(self, controls: Floats, naturalness: float) -> Floats:
        """(B, T, C) mm -> (B, T, K) weights; naturalness 0 = regressor, 1 = full system.

        What a sequence is answered with does not depend on the others in the batch.
        """
        return np.stack([self._answer(sequence, naturalness) for sequence in controls])

    def _answer(self, controls: Floats, naturalness: float) -> Floats:
        centred = controls - self._mean
        regressed = self._regressor(centred).copy()
        if naturalness == 0:
            return regressed
        prepared = regressed if self._adapted is None else self._adapted(centred)
        cleaned = self._autoencoder(prepared)  # ours to change, until the next call
        if self._residual:
            cleaned += prepared
        return regressed + np.float32(naturalness) * (cleaned - regressed)
