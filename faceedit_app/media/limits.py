"""Bounds for FFmpeg, which believes what damaged files claim about themselves."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterator
from functools import cache
from pathlib import Path

_LARGEST_BLOCK = 256 << 20  # bytes of one allocation; an 8K picture of 48 bits takes 204 MB
_MOST_PIXELS = 40_000_000  # of a picture, which is more than 8K
_SMALL_PIXELS = 1920 * 1080  # which any file may have
_PIXELS_PER_BYTE = 1000  # of the whole file; films of faces have fewer than 100
_BYTES_PER_THREAD = 1 << 20  # of a file; threads take memory for what it claims
_MOST_THREADS = 16  # as many as FFmpeg takes by itself


def most_pixels(path: Path) -> int:
    """How many pixels a picture of a film may have: the larger the file, the more.

    Raises:
        OSError: the file is missing.
    """
    room = path.stat().st_size * _PIXELS_PER_BYTE
    return min(max(room, _SMALL_PIXELS), _MOST_PIXELS)


def threads_for(path: Path) -> int:
    """How many threads may decode a film; each takes memory for pictures as large as it claims.

    Raises:
        OSError: the file is missing.
    """
    useful = 1 + path.stat().st_size // _BYTES_PER_THREAD
    return min(useful, os.cpu_count() or 1, _MOST_THREADS)


@cache
def limit_blocks() -> bool:
    """Bound the size of each allocation of FFmpeg, which a few bytes could set to 2 GB.

    Returns:
        Whether FFmpeg's libraries were found, which PyAV has no way to.
    """
    for library in _libraries():
        try:
            limit = ctypes.CDLL(library).av_max_alloc
        except (OSError, AttributeError):
            continue
        limit.argtypes, limit.restype = [ctypes.c_size_t], None
        limit(_LARGEST_BLOCK)
        return True
    return False


def _libraries() -> Iterator[str]:
    """Where FFmpeg's function may be: in what PyAV links to, or in a file beside it (Windows)."""
    import av._core

    yield av._core.__file__
    for folder in Path(av.__file__).parent.parent.glob("av.libs"):
        yield from map(str, folder.glob("*avutil*"))
