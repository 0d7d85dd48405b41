"""A take: the file of a recorded performance, its clip, and the way back to a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from faceedit_app.core.arrays import Floats
from faceedit_app.core.clip import Clip


class Source(Protocol):
    """What a format keeps of a file so that it can write it again, changed only where edited."""

    def encode(self, tracked: Floats, edited: Floats) -> bytes:
        """The whole file with the weights of `edited` (T, K) in place of `tracked` (T, K).

        Cells whose weight is unchanged keep the source's own text, to the byte.
        """
        ...


@dataclass(frozen=True)
class Take:
    """A performance that the user has opened.

    Attributes:
        path: where it was read from.
        format: the name of the format, for the user.
        clip: the tracked weights.
        carried: names of the file's other columns, which are kept as they are.
        notes: one-line remarks on oddities that were found and how they were handled.
        source: what the format needs to write the file again.
    """

    path: Path
    format: str
    clip: Clip
    carried: tuple[str, ...]
    notes: tuple[str, ...]
    source: Source
