"""U-Nets over time in plain numpy: few passes over memory, none of it allocated while answering.

Several networks of the same widths, such as those of two regions, are worked through side by side:
half of the time of networks as small as these goes into calling numpy. `models.UNet` says what is
computed; a test holds the two together.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Exact = NDArray[np.float64]
Parameters = Mapping[str, NDArray[Any]]

Sizes = tuple[int, int]  # features in and out

BATCH_NORM_EPSILON = 1e-5  # torch's
SMALLEST_SCALE = 1e-30
# Lengths of sequence whose memory is kept. A take needs two: its chunks and its last one.
KEPT = 3


@dataclass(frozen=True)
class _Kernel:
    """One network's convolution of 3 frames.

    Batch normalisation before it is folded into it: the scale into the taps, the shift into the
    bias. What the input is padded with at either end is what would normalise to zero.

    Attributes:
        taps: (3, I, O) for the frame before, the frame itself and the one after.
        bias: (O,).
        edge: (I,) the value of the frames before the first and after the last.
    """

    taps: Floats
    bias: Floats
    edge: Floats

    @classmethod
    def of(
        cls,
        parameters: Parameters,
        name: str,
        scale: Exact | float = 1.0,
        shift: Exact | float = 0.0,
    ) -> _Kernel:
        """Read it, with what normalises its input."""
        weight = parameters[f"{name}.weight"].astype(np.float64)  # (O, I, 3)
        inputs = weight.shape[1]
        scale = np.broadcast_to(
            np.where(np.abs(scale) < SMALLEST_SCALE, SMALLEST_SCALE, scale), inputs
        )
        shift = np.broadcast_to(shift, inputs)
        taps = weight.transpose(2, 1, 0) * scale[:, None]
        bias = parameters[f"{name}.bias"] + np.einsum("oik,i->o", weight, shift)
        edge = -shift / scale
        return cls(*(np.asarray(values, np.float32) for values in (taps, bias, edge)))

    @classmethod
    def of_block(cls, parameters: Parameters, name: str) -> _Kernel:
        """The convolution of a block of batch normalisation, convolution and ELU."""
        gain, bias, mean, variance = (
            parameters[f"{name}.0.{part}"].astype(np.float64)
            for part in ("weight", "bias", "running_mean", "running_var")
        )
        scale = gain / np.sqrt(variance + BATCH_NORM_EPSILON)
        return cls.of(parameters, f"{name}.1", scale, bias - mean * scale)

    def padded(self, inputs: int, outputs: int) -> _Kernel:
        """The same with more features, which are zero."""
        more_in, more_out = inputs - self.taps.shape[1], outputs - self.taps.shape[2]
        return _Kernel(
            np.pad(self.taps, ((0, 0), (0, more_in), (0, more_out))),
            np.pad(self.bias, (0, more_out)),
            np.pad(self.edge, (0, more_in)),
        )


class _Convolution:
    """The convolutions of B networks: padded input (B, T + 2, I) -> (B, T, O).

    Args:
        kernels: of each network.
        least: I and O are no smaller than that.

    Attributes:
        edge: (B, 1, I).
        outputs: O.
        products: multiplications for one frame.
    """

    def __init__(self, kernels: Sequence[_Kernel], least: Sizes = (0, 0)) -> None:
        shapes = np.array([kernel.taps.shape for kernel in kernels])
        inputs, self.outputs = (int(n) for n in np.maximum(shapes[:, 1:].max(axis=0), least))
        self.products = int(shapes.prod(axis=1).sum())
        kernels = [kernel.padded(inputs, self.outputs) for kernel in kernels]
        # Laid out as BLAS reads them; numpy would copy anything else at each product.
        taps = np.ascontiguousarray(np.stack([k.taps for k in kernels], axis=1))
        self._before, self._at, self._after = taps
        self._bias = np.stack([k.bias for k in kernels])[:, None]
        self.edge = np.stack([k.edge for k in kernels])[:, None]

    def __call__(self, padded: Floats, out: Floats, scratch: Floats) -> None:
        """Write the (B, T, O) result to `out`: three products, and no copy of the input."""
        np.matmul(padded[:, :-2], self._before, out=out)
        np.matmul(padded[:, 1:-1], self._at, out=scratch)
        out += scratch
        np.matmul(padded[:, 2:], self._after, out=scratch)
        out += scratch
        out += self._bias


class _Stage:
    """A convolution with the memory that it works in, for one length of sequence.

    Attributes:
        inside: (B, T, I) its input, to be filled in before the call.
        result: (B, T, O) memory for its output.
    """

    def __init__(self, convolution: _Convolution, frames: int) -> None:
        self._convolution = convolution
        self._padded = np.tile(convolution.edge, (1, frames + 2, 1))
        self.inside = self._padded[:, 1:-1]
        shape = (2, len(convolution.edge), frames, convolution.outputs)
        self.result, self._scratch = np.empty(shape, np.float32)

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
    """U-Nets ready for sequences of one length."""

    def __init__(self, nets: UNets, frames: int) -> None:
        def pair(convolutions: tuple[_Convolution, _Convolution], level: int) -> list[_Stage]:
            return [_Stage(convolution, frames >> level) for convolution in convolutions]

        levels = len(nets.down)
        self._down = [pair(nets.down[i], i) for i in range(levels)]
        self._up = [pair(nets.up[i], levels - 2 - i) for i in range(levels - 1)]
        self._out = _Stage(nets.out, frames)

    def __call__(self, x: Floats) -> Floats:
        self._down[0][0].inside[:] = x
        # A level's output goes straight to where the way up joins it to what comes from below.
        for i, (joined, _) in enumerate(reversed(self._up)):
            first, second = self._down[i]
            first.elu(second.inside)
            skip = second.elu(joined.inside[:, :, -second.result.shape[2] :])
            np.maximum(skip[:, 0::2], skip[:, 1::2], out=self._down[i + 1][0].inside)
        first, second = self._down[-1]
        first.elu(second.inside)
        x = second.elu(None if self._up else self._out.inside)
        for i, (first, second) in enumerate(self._up):
            features = x.shape[2]
            first.inside[:, 0::2, :features] = x
            first.inside[:, 1::2, :features] = x
            first.elu(second.inside)
            x = second.elu(self._out.inside if i == len(self._up) - 1 else None)
        return self._out.plain()


class UNets:
    """B networks as `models.UNet`, time before features. Not for several threads at once.

    Networks with fewer inputs or outputs than others get some that are zero.

    Args:
        networks: of each its tensors by their name in the torch module.
        name: the networks' own name there.
        levels: how many time scales they have.
        least: they get at least so many inputs and outputs. A product of matrices of other sizes
            may be rounded otherwise; where sizes agree, a network answers bit for bit alike in
            any company.

    Raises:
        KeyError, ValueError: tensors are missing, or their widths differ.
    """

    def __init__(
        self, networks: Sequence[Parameters], name: str, levels: int, least: Sizes = (0, 0)
    ) -> None:
        def pair(part: str, inputs: int = 0) -> tuple[_Convolution, _Convolution]:
            def kernels(place: int) -> list[_Kernel]:
                return [_Kernel.of_block(net, f"{name}.{part}.{place}") for net in networks]

            return _Convolution(kernels(0), (inputs, 0)), _Convolution(kernels(1))

        inputs, outputs = least
        self.down = [pair(f"down.{i}", inputs if i == 0 else 0) for i in range(levels)]
        self.up = [pair(f"up.{i}") for i in range(levels - 1)]  # the coarsest first
        out = [_Kernel.of(net, f"{name}.out") for net in networks]
        self.out = _Convolution(out, (0, outputs))
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
        """(B, T, I) -> (B, T, O), overwritten by the next call.

        T is a multiple of the coarsest scale. What a network says does not depend on the others.
        """
        frames = x.shape[1]
        ready = self._passes.pop(frames, None) or _Pass(self, frames)
        self._passes[frames] = ready
        if len(self._passes) > KEPT:
            del self._passes[next(iter(self._passes))]  # the one not used for longest
        return ready(x)
