"""A reader of the application, with a valid file that it reads."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path


class Wrong(Exception):
    """A damaged file was read as something that it cannot be."""


@dataclass(frozen=True)
class Reader:
    """A reader, and a valid file for it.

    Attributes:
        name: what it reads, such as `edits`.
        ending: of its files.
        content: of a valid file.
        read: reads a file; raises FaceEditError if it is damaged.
    """

    name: str
    ending: str
    content: bytes
    read: Callable[[Path], object]


def reader_of(name: str, path: Path, read: Callable[[Path], object]) -> Reader:
    """The reader of a file that is there."""
    return Reader(name, path.suffix, path.read_bytes(), read)
