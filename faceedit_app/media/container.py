"""Opening media files with PyAV; whatever FFmpeg says becomes one line."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from faceedit_app.core.errors import FileError, Unavailable

if TYPE_CHECKING:
    from av.container import InputContainer
    from av.video.stream import VideoStream

_COVER = 0x400  # FFmpeg's AV_DISPOSITION_ATTACHED_PIC
_REMEDY = "convert it to WAV or MP4 (H.264) and add that"


class Abandoned(Exception):
    """Nobody waits for the file any more."""


@contextlib.contextmanager
def opened(path: Path) -> Iterator[InputContainer]:
    """A media file to read from.

    Raises:
        FileError: it cannot be read or is no media file, now or while it is being read.
        Unavailable: PyAV is not installed.
    """
    with told(path):
        container = open_container(path)
        try:
            yield container
        finally:
            container.close()


def open_container(path: Path) -> InputContainer:
    """A media file; to be used inside `told` and closed by the caller."""
    try:
        import av
    except ImportError as error:
        raise Unavailable(
            f"Sound and film need PyAV, which cannot be loaded ({error}); run: pip install av"
        ) from error
    # FFmpeg would take a name with a colon for an address, and follow addresses in play lists.
    return av.open(
        f"file:{path}",
        metadata_errors="ignore",
        container_options={"protocol_whitelist": "file"},
    )


@contextlib.contextmanager
def told(path: Path) -> Iterator[None]:
    """Turn what FFmpeg raises into a FileError."""
    try:
        yield
    except (FileError, Unavailable, Abandoned):
        raise
    except (OSError, ValueError, ArithmeticError, LookupError, MemoryError, EOFError) as error:
        # FFmpeg's errors are kinds of OSError, ValueError or LookupError too.
        raise _explained(path, error) from error
    except Exception as error:
        if not type(error).__module__.startswith("av"):
            raise
        raise _explained(path, error) from error


def _explained(path: Path, error: Exception) -> FileError:
    if isinstance(error, FileNotFoundError):
        return FileError(path, "is not there", "look for it and add it again")
    if isinstance(error, PermissionError):
        return FileError(path, "may not be read", "change its permissions")
    if isinstance(error, MemoryError):
        return FileError(path, "is too long for the memory", "cut out the part of the take")
    reason = (getattr(error, "strerror", "") or str(error) or type(error).__name__).lower()
    return FileError(path, f"cannot be read as sound or film ({reason})", _REMEDY)


def find_film(container: InputContainer) -> VideoStream | None:
    """The first stream of moving pictures; the cover picture of a song is none."""
    return next((s for s in container.streams.video if not int(s.disposition) & _COVER), None)


def film_stream(container: InputContainer) -> VideoStream:
    """The first stream of moving pictures.

    Raises:
        FileError: there is none.
    """
    stream = find_film(container)
    if stream is None:
        path = Path(container.name.removeprefix("file:"))
        raise FileError(path, "has no film in it", "choose another file")
    return stream


def seconds(ticks: int | None, base: Fraction | None) -> float | None:
    """A time of a stream in seconds."""
    return None if ticks is None or base is None else float(ticks * base)


def check(stopped: Callable[[], bool] | None) -> None:
    """Stop reading where nobody waits for it.

    Raises:
        Abandoned: nobody does.
    """
    if stopped is not None and stopped():
        raise Abandoned
