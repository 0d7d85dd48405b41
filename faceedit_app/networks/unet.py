"""A U-Net over time in plain numpy: few passes over memory, none of it allocated while answering.

`models.UNet` says what is computed; a test holds the two together.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Exact = NDArray[np.float64]
Parameters = Mapping[str, NDArray[Any]]

BATCH_NORM_EPSILON = 1e-5  # torch's
SMALLEST_SCALE = 1e-30
# Lengths of sequence whose memory is kept. A take needs two: its chunks and its last one.
KEPT = 3


class _Convolution:
    """A convolution of 3 frames: padded input (T + 2, I) -> (T, O).

    Batch normalisation before it is folded into it: the scale into the taps, the shift into the
    bias. What the input is padded with at either end is what would normalise to zero.

    Attributes:
        edge: (I,) the value of the frames before the first and after the last.
    """

    def __init__(
        self,
        parameters: Parameters,
        name: str,
        scale: Exact | float = 1.0,
        shift: Exact | float = 0.0,
    ) -> None:
        weight = parameters[f"{name}.weight"].astype(np.float64)  # (O, I, 3)
        inputs = weight.shape[1]
        scale = np.broadcast_to(
            np.where(np.abs(scale) < SMALLEST_SCALE, SMALLEST_SCALE, scale), inputs
        )
        shift = np.broadcast_to(shift, inputs)
        taps = weight.transpose(2, 1, 0) * scale[:, None]
        self._before, self._at, self._after = np.ascontiguousarray(taps, np.float32)
        bias = parameters[f"{name}.bias"] + np.einsum("oik,i->o", weight, shift)
        self._bias = bias.astype(np.float32)
        self.edge: Floats = (-shift / scale).astype(np.float32)
        self.outputs = len(weight)

    @property
    def products(self) -> int:
        """Multiplications for one frame."""
        return 3 * int(self._at.size)

    def __call__(self, padded: Floats, out: Floats, scratch: Floats) -> None:
        """Write the (T, O) result to `out`: three products, and no copy of the input."""
        np.matmul(padded[:-2], self._before, out=out)
        np.matmul(padded[1:-1], self._at, out=scratch)
        out += scratch
        np.matmul(padded[2:], self._after, out=scratch)
        out += scratch
        out += self._bias


def _block(parameters: Parameters, name: str) -> _Convolution:
    """The convolution of a block of batch normalisation, convolution and ELU."""
    gain, bias, mean, variance = (
        parameters[f"{name}.0.{part}"].astype(np.float64)
        for part in ("weight", "bias", "running_mean", "running_var")
    )
    scale = gain / np.sqrt(variance + BATCH_NORM_EPSILON)
    return _Convolution(parameters, f"{name}.1", scale, bias - mean * scale)


class _Stage:
    """A convolution with the memory that it works in, for one length of sequence.

    Attributes:
        inside: (T, I) its input, to be filled in before the call.
        result: (T, O) memory for its output.
    """

    def __init__(self, convolution: _Convolution, frames: int) -> None:
        self._convolution = convolution
        self._padded = np.tile(convolution.edge, (frames + 2, 1))
        self.inside = self._padded[1:-1]
        self.result, self._scratch = np.empty((2, frames, convolution.outputs), np.float32)

    def plain(self) -> Floats:
        """The convolution alone."""
        self._convolution(self._padded, self.result, self._scratch)
        return self.result

    def elu(self, into: Floats | None = None) -> Floats:
        """The convolution and ELU, written to `into` or else to `result`."""
        into = self.result if into is None else into
        below = np.minimum(self.plain(), 0.0, out=self._scratch)
        np.expm1(below, out=below)
        return np.maximum(self.result, below, out=into)


class _Pass:
    """A U-Net ready for sequences of one length."""

    def __init__(self, net: UNet, frames: int) -> None:
        def pair(convolutions: tuple[_Convolution, _Convolution], level: int) -> list[_Stage]:
            return [_Stage(convolution, frames >> level) for convolution in convolutions]

        levels = len(net.down)
        self._down = [pair(net.down[i], i) for i in range(levels)]
        self._up = [pair(net.up[i], levels - 2 - i) for i in range(levels - 1)]
        self._out = _Stage(net.out, frames)

    def __call__(self, x: Floats) -> Floats:
        self._down[0][0].inside[:] = x
        # A level's output goes straight to where the way up joins it to what comes from below.
        for i, (joined, _) in enumerate(reversed(self._up)):
            first, second = self._down[i]
            first.elu(second.inside)
            skip = second.elu(joined.inside[:, -second.result.shape[1] :])
            np.maximum(skip[0::2], skip[1::2], out=self._down[i + 1][0].inside)
        first, second = self._down[-1]
        first.elu(second.inside)
        x = second.elu(None if self._up else self._out.inside)
        for i, (first, second) in enumerate(self._up):
            features = x.shape[1]
            first.inside[0::2, :features] = x
            first.inside[1::2, :features] = x
            first.elu(second.inside)
            x = second.elu(self._out.inside if i == len(self._up) - 1 else None)
        return self._out.plain()


class UNet:
    """`models.UNet`, time before features. Not for several threads at once.

    Args:
        parameters: tensors by their name in the torch module.
        name: the network's own name there.
        levels: how many time scales it has.
    """

    def __init__(self, parameters: Parameters, name: str, levels: int) -> None:
        def pair(part: str) -> tuple[_Convolution, _Convolution]:
            return _block(parameters, f"{name}.{part}.0"), _block(parameters, f"{name}.{part}.1")

        self.down = [pair(f"down.{i}") for i in range(levels)]
        self.up = [pair(f"up.{i}") for i in range(levels - 1)]  # the coarsest first
        self.out = _Convolution(parameters, f"{name}.out")
        self._passes: dict[int, _Pass] = {}

    @property
    def products(self) -> float:
        """Multiplications for one frame."""
        deepest = len(self.down) - 1
        levels = [(pair, i) for i, pair in enumerate(self.down)]
        levels += [(pair, deepest - 1 - i) for i, pair in enumerate(self.up)]
        inner = sum(c.products / (1 << level) for pair, level in levels for c in pair)
        return inner + self.out.products

    def __call__(self, x: Floats) -> Floats:
        """(T, I) -> (T, O), overwritten by the next call; T is a multiple of the coarsest scale."""
        frames = len(x)
        ready = self._passes.pop(frames, None) or _Pass(self, frames)
        self._passes[frames] = ready
        if len(self._passes) > KEPT:
            del self._passes[next(iter(self._passes))]  # the one not used for longest
        return ready(x)
