"""Text whose weights are replaced in place, while all other bytes stay the same."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.formats.numbers import (
    NumberFormat,
    as_written,
    detect_format,
    kept_text,
    shortest,
)

_FORMAT_SAMPLE = 10_000
WHOLE = NumberFormat(0, padded=True)


@dataclass(frozen=True)
class SpanSource:
    """A text file, and where a clip's weights are in it (`take.Source`).

    Attributes:
        content: the file.
        spans: (T, K, 2) where each number begins and ends.
        scale: the value of a full blendshape in the file.
        decimal: what stands between the units and the decimals of a number.
        form: how to write a number; None = as the file's others are written.
        copies: (T, K, 2) each, where the file has the same weights again; -1 if it does not.
    """

    content: bytes
    spans: NDArray[np.int64]
    scale: float = 1.0
    decimal: bytes = b"."
    form: NumberFormat | None = None
    copies: tuple[NDArray[np.int64], ...] = ()

    def encode(self, tracked: Floats, edited: Floats) -> bytes:
        """The whole file; see `take.Source.encode`."""
        changed = tracked != edited
        if not changed.any():
            return self.content
        spans, values = self.spans[changed], shortest(edited[changed]) * self.scale
        spans = np.concatenate([spans, *(copy[changed] for copy in self.copies)])
        values = np.tile(values, 1 + len(self.copies))
        spans, values = spans[spans[:, 0] >= 0], values[spans[:, 0] >= 0]
        order = np.argsort(spans[:, 0])
        write, pieces, done = self._writer(), [], 0
        for (start, end), value in zip(spans[order].tolist(), values[order].tolist(), strict=True):
            number = kept_text(self.content[start:end], write(value), self.decimal)
            pieces += [self.content[done:start], number]
            done = end
        return b"".join([*pieces, self.content[done:]])

    def as_written(self, weights: Floats) -> Doubles:
        """See `take.RoundingSource.as_written`."""
        return as_written(weights, self.scale, self._form)

    @cached_property
    def _form(self) -> NumberFormat:
        """How the file writes its numbers."""
        if self.form is not None:
            return self.form
        flat = self.spans.reshape(-1, 2)
        sample = islice(flat.tolist(), 0, None, max(1, len(flat) // _FORMAT_SAMPLE))
        texts = (self.content[a:b].replace(self.decimal, b".") for a, b in sample)
        return detect_format(texts, self.scale)

    def _writer(self) -> Callable[[float], bytes]:
        write = self._form.write
        return lambda number: write(number).replace(b".", self.decimal)
