"""Takes in UTF-16, as spreadsheets write text: read as UTF-8, and written back."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.formats.take import (
    FillableSource,
    RotatingSource,
    RoundingSource,
    Source,
    SureSource,
    Take,
)

_SAMPLE = 256  # bytes that show whether every second one is 0
_FEWEST = 8
_ORDERS = {b"\xff\xfe": "utf-16-le", b"\xfe\xff": "utf-16-be"}


def as_utf8(content: bytes) -> tuple[bytes, str]:
    """A file's content in UTF-8, and the encoding it was in; "" if it is not UTF-16.

    Content that cannot be written back to the byte is left as it is.
    """
    encoding = _ORDERS.get(content[:2]) or _without_mark(content)
    if not encoding:
        return content, ""
    try:
        text = content.decode(encoding)
    except UnicodeDecodeError:
        return content, ""
    return text.encode(), encoding


def recoded(take: Take, encoding: str) -> Take:
    """The take, written back in this encoding; "" = as it is."""
    return replace(take, source=RecodedSource(take.source, encoding)) if encoding else take


def _without_mark(content: bytes) -> str:
    """The encoding of text in UTF-16 without a byte order mark: every second byte is 0."""
    head = content[:_SAMPLE]
    if len(head) < _FEWEST or len(content) % 2:
        return ""
    for zeros, encoding in ((1, "utf-16-le"), (0, "utf-16-be")):
        if not any(head[zeros::2]) and all(head[1 - zeros :: 2]):
            return encoding
    return ""


@dataclass(frozen=True)
class RecodedSource:
    """A source whose file is in another encoding than UTF-8 (`take.Source`)."""

    source: Source
    encoding: str

    def encode(self, tracked: Floats, edited: Floats) -> bytes:
        """The whole file; see `take.Source.encode`."""
        return self.source.encode(tracked, edited).decode().encode(self.encoding)

    def rotated(self, tracked: Floats, edited: Floats) -> RecodedSource:
        """See `take.RotatingSource.rotated`."""
        if not isinstance(self.source, RotatingSource):
            return self
        return replace(self, source=self.source.rotated(tracked, edited))

    def as_sure(self, tracked: Floats, edited: Floats) -> RecodedSource:
        """See `take.SureSource.as_sure`."""
        if not isinstance(self.source, SureSource):
            return self
        return replace(self, source=self.source.as_sure(tracked, edited))

    def as_written(self, weights: Floats) -> Doubles:
        """See `take.RoundingSource.as_written`."""
        if not isinstance(self.source, RoundingSource):
            return weights.astype(np.float64)
        return self.source.as_written(weights)

    def with_faces(self, weights: Floats) -> RecodedSource:
        """See `take.FillableSource.with_faces`."""
        if not isinstance(self.source, FillableSource):
            return self
        return replace(self, source=self.source.with_faces(weights))
