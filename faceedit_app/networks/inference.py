"""Answering with a region's networks in plain numpy.

The networks are small (a third of a million parameters) and the sequences short, so a few matrix
products on one core answer sooner than torch does, start without loading it, and give the same
picture in an installed bundle as in a checkout. `models.py` says what is computed; tests hold the
two together.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from faceedit_app.networks.files import RegionFile
from faceedit_app.networks.unet import Sizes, UNets

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
        file: where they come from.
        region, controls, channels, covariance, low, high, natural: as in `RegionFile`.
        scale: sequence lengths must be a multiple of this.
        radius: frames on either side that can influence a frame of the answer.
        kind: networks of the same kind can answer together.

    Raises:
        KeyError, ValueError: the file's tensors are not those of the networks.
    """

    def __init__(self, file: RegionFile) -> None:
        self.file = file
        self.region, self.controls, self.channels = file.region, file.controls, file.channels
        self.covariance, self.low, self.high = file.covariance, file.low, file.high
        self.natural = file.natural
        levels = len(file.widths)
        self.kind = file.widths, file.adapted, file.residual
        self.scale, self.radius = time_scale(levels), 2 * time_radius(levels)
        self._alone = RegionGroup([file])
        probe = self(np.zeros((1, self.scale, len(self.controls)), np.float32), 1.0)
        if probe.shape[2] != len(self.channels):
            raise ValueError(f"answers {probe.shape[2]} channels, not {len(self.channels)}")

    @property
    def products(self) -> float:
        """Multiplications for one frame of the full system's answer."""
        return self._alone.products

    def __call__(self, controls: Floats, naturalness: float) -> Floats:
        """(B, T, C) mm -> (B, T, K) weights; naturalness 0 = regressor, 1 = full system.

        What a sequence is answered with does not depend on the others in the batch.
        """
        return np.stack([self._alone([x], naturalness)[0] for x in controls])


class RegionGroup:
    """The networks of several regions of one kind, answering in one go.

    Args:
        files: of the regions.
        least: controls and channels that the networks are made to have at least; see `UNets`.

    Raises:
        KeyError, ValueError: the tensors of a file are not those of the networks.
    """

    def __init__(self, files: Sequence[RegionFile], least: Sizes = (0, 0)) -> None:
        self._means = [file.tensors["mean"].astype(np.float32) for file in files]
        self._channels = [len(file.channels) for file in files]
        self._inputs = max(least[0], *(len(mean) for mean in self._means))
        outputs = max(least[1], *self._channels)

        def nets(name: str, inputs: int) -> UNets:
            tensors, levels = [file.tensors for file in files], len(files[0].widths)
            return UNets(tensors, name, levels, (inputs, outputs))

        self._regressor = nets("regressor", self._inputs)
        self._autoencoder = nets("autoencoder", outputs)
        self._adapted = nets("adapted", self._inputs) if files[0].adapted else None
        self._residual = files[0].residual

    @property
    def products(self) -> float:
        """Multiplications for one frame of the full system's answers."""
        nets = (self._regressor, self._autoencoder, self._adapted)
        return sum(net.products for net in nets if net is not None)

    def __call__(self, controls: Sequence[Floats], naturalness: float) -> list[Floats]:
        """Of each region (T, C) mm -> (T, K) weights; see `RegionAnswer`."""
        answers = self._answer(self._centred(controls), naturalness)
        return [answer[:, :k] for answer, k in zip(answers, self._channels, strict=True)]

    def _centred(self, controls: Sequence[Floats]) -> Floats:
        centred = np.zeros((len(controls), len(controls[0]), self._inputs), np.float32)
        for row, heard, mean in zip(centred, controls, self._means, strict=True):
            np.subtract(heard, mean, out=row[:, : len(mean)])
        return centred

    def _answer(self, centred: Floats, naturalness: float) -> Floats:
        regressed = self._regressor(centred).copy()
        if naturalness == 0:
            return regressed
        prepared = regressed if self._adapted is None else self._adapted(centred)
        cleaned = self._autoencoder(prepared)  # ours to change, until the next call
        if self._residual:
            cleaned += prepared
        return regressed + np.float32(naturalness) * (cleaned - regressed)
