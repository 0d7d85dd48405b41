"""Answering with a region's networks in plain numpy.

The networks are small (a third of a million parameters) and the sequences short, so a few matrix
products on one core answer sooner than torch does, start without loading it, and give the same
picture in an installed bundle as in a checkout. `models.py` says what is computed; tests hold the
two together.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faceedit_app.networks.files import RegionFile

Floats = NDArray[np.float32]
Parameters = Mapping[str, NDArray[Any]]

BATCH_NORM_EPSILON = 1e-5  # torch's


def time_scale(levels: int) -> int:
    """Frames that the coarsest of some levels sees as one."""
    return 1 << (levels - 1)


def time_radius(levels: int) -> int:
    """Frames on either side that can influence a frame of a U-Net's output."""
    scales = [1 << i for i in range(levels)]
    return 2 * sum(scales) + 2 * sum(scales[:-1]) + 1 + scales[-1] - 1


class _Convolution:
    """A convolution of 3 frames, zero-padded: (B, T, I) -> (B, T, O)."""

    def __init__(self, parameters: Parameters, name: str) -> None:
        weight = parameters[f"{name}.weight"]  # (O, I, 3)
        self.taps = np.ascontiguousarray(weight.transpose(2, 1, 0), np.float32).reshape(
            -1, len(weight)
        )
        self.bias = parameters[f"{name}.bias"].astype(np.float32)

    def __call__(self, padded: Floats) -> Floats:
        """`padded` (B, T + 2, I) has a frame of zeros at either end."""
        batch, frames, inputs = padded.shape[0], padded.shape[1] - 2, padded.shape[2]
        # Three neighbouring frames lie next to each other in memory: one row of the product.
        rows = np.lib.stride_tricks.as_strided(
            padded, (batch, frames, 3 * inputs), padded.strides, writeable=False
        )
        out = np.ascontiguousarray(rows).reshape(batch * frames, 3 * inputs) @ self.taps
        out += self.bias
        return out.reshape(batch, frames, -1)


class _Block:
    """Batch normalisation, convolution, ELU."""

    def __init__(self, parameters: Parameters, name: str) -> None:
        gain, bias, mean, variance = (
            parameters[f"{name}.0.{part}"].astype(np.float64)
            for part in ("weight", "bias", "running_mean", "running_var")
        )
        scale = gain / np.sqrt(variance + BATCH_NORM_EPSILON)
        self.scale = scale.astype(np.float32)
        self.shift = (bias - mean * scale).astype(np.float32)
        self.convolution = _Convolution(parameters, f"{name}.1")

    def __call__(self, x: Floats) -> Floats:
        padded = np.zeros((x.shape[0], x.shape[1] + 2, x.shape[2]), np.float32)
        inner = padded[:, 1:-1]
        np.multiply(x, self.scale, out=inner)
        inner += self.shift
        out = self.convolution(padded)
        below = np.minimum(out, 0.0)
        np.exp(below, out=below)
        below -= 1.0
        np.maximum(out, 0.0, out=out)
        out += below
        return out


class _UNet:
    """`models.UNet`, time before features."""

    def __init__(self, parameters: Parameters, name: str, levels: int) -> None:
        def pair(part: str) -> tuple[_Block, _Block]:
            return _Block(parameters, f"{name}.{part}.0"), _Block(parameters, f"{name}.{part}.1")

        self.down = [pair(f"down.{i}") for i in range(levels)]
        self.up = [pair(f"up.{i}") for i in range(levels - 1)]
        self.out = _Convolution(parameters, f"{name}.out")

    def __call__(self, x: Floats) -> Floats:
        """(B, T, I) -> (B, T, O); T is a multiple of the coarsest scale."""
        skips = []
        for i, (first, second) in enumerate(self.down):
            if i:
                x = np.maximum(x[:, 0::2], x[:, 1::2])
            x = second(first(x))
            skips.append(x)
        for (first, second), skip in zip(self.up, skips[-2::-1], strict=True):
            x = second(first(np.concatenate([np.repeat(x, 2, axis=1), skip], axis=2)))
        return self.out(np.pad(x, ((0, 0), (1, 1), (0, 0))))


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
        self._regressor = _UNet(file.tensors, "regressor", levels)
        self._autoencoder = _UNet(file.tensors, "autoencoder", levels)
        self._adapted = _UNet(file.tensors, "adapted", levels) if file.adapted else None
        self._residual, self.natural = file.residual, file.natural
        probe = self(np.zeros((1, self.scale, len(self.controls)), np.float32), 1.0)
        if probe.shape[2] != len(self.channels):
            raise ValueError(f"answers {probe.shape[2]} channels, not {len(self.channels)}")

    def __call__(self, controls: Floats, naturalness: float) -> Floats:
        """(B, T, C) mm -> (B, T, K) weights; naturalness 0 = regressor, 1 = full system."""
        centred = controls - self._mean
        regressed = self._regressor(centred)
        if naturalness == 0:
            return regressed
        prepared = regressed if self._adapted is None else self._adapted(centred)
        cleaned = self._autoencoder(prepared)
        if self._residual:
            cleaned += prepared
        return regressed + np.float32(naturalness) * (cleaned - regressed)
