"""Open media files with PyAV, and turn FFmpeg's errors into one line."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from faceedit_app.core import on_disk
from faceedit_app.core.errors import FileError, Unavailable
from faceedit_app.media import is_film, is_media
from faceedit_app.media.limits import limit_blocks, most_pixels, threads_for

if TYPE_CHECKING:
    from av.audio.stream import AudioStream
    from av.container import InputContainer
    from av.video.stream import VideoStream

AS_MP4 = "convert it to MP4 (H.264) and use that"
_COVER = 0x400  # FFmpeg's AV_DISPOSITION_ATTACHED_PIC


class Abandoned(Exception):
    """Reading was stopped because the file is no longer needed."""


@contextlib.contextmanager
def opened(path: Path) -> Iterator[InputContainer]:
    """Open a media file for reading.

    Raises:
        FileError: it cannot be read or is not a media file; also raised while reading.
        Unavailable: PyAV is not installed.
    """
    with file_errors(path):
        container = open_container(path)
        try:
            yield container
        finally:
            container.close()


def open_container(path: Path) -> InputContainer:
    """Open a media file; use it inside `file_errors`, and close it."""
    if on_disk.exists(path) and not on_disk.is_file(path):  # a pipe or a device may never end
        raise FileError(path, "is not a regular file", "choose a sound or a film")
    try:
        import av
    except ImportError as error:
        raise Unavailable(
            f"Sound and film need PyAV, which cannot be loaded ({error}); run: pip install av"
        ) from error
    limit_blocks()
    bounds = {"max_pixels": str(most_pixels(path))}
    # FFmpeg would treat a name with a colon as an address, and follow addresses in playlists.
    container = av.open(
        f"file:{path}",
        metadata_errors="ignore",
        options=bounds,
        container_options={"protocol_whitelist": "file"},
    )
    for stream in container.streams.video:  # PyAV's own decoders are not those of the options above
        if stream.codec_context is not None:
            stream.codec_context.options = bounds
    return container


@contextlib.contextmanager
def file_errors(path: Path) -> Iterator[None]:
    """Turn FFmpeg's errors into a FileError."""
    try:
        yield
    except (FileError, Unavailable, Abandoned):
        raise
    except (OSError, ValueError, ArithmeticError, LookupError, MemoryError, EOFError) as error:
        # FFmpeg's errors are also OSError, ValueError or LookupError.
        raise _explained(path, error) from error
    except Exception as error:
        if not type(error).__module__.startswith("av"):
            raise
        raise _explained(path, error) from error


def _explained(path: Path, error: Exception) -> FileError:
    if isinstance(error, FileNotFoundError):
        return FileError(path, "is missing", "find it and add it again")
    if isinstance(error, PermissionError):
        return FileError(path, "may not be read", "change its permissions")
    if isinstance(error, MemoryError):
        return FileError(path, "needs more memory than there is", "cut out the part of the take")
    reason = (getattr(error, "strerror", "") or str(error) or type(error).__name__).lower()
    kind, form = "sound or film", "WAV or MP4 (H.264)"
    if is_media(path):
        kind, form = ("a film", "MP4 (H.264)") if is_film(path) else ("a sound", "WAV")
    remedy = f"copy it again if it is damaged, or convert it to {form} and use that"
    return FileError(path, f"cannot be read as {kind} ({reason})", remedy)


def films(container: InputContainer) -> list[VideoStream]:
    """The video streams that are no cover pictures."""
    return [s for s in container.streams.video if not int(s.disposition) & _COVER]


def find_film(container: InputContainer) -> VideoStream | None:
    """The first video stream that is not a cover picture, or None."""
    return next(iter(films(container)), None)


def find_sound(container: InputContainer) -> AudioStream | None:
    """The first sound stream that can be decoded, or None.

    Phones write a second, spatial one that FFmpeg does not decode.
    """
    usable = (s for s in container.streams.audio if s.codec_context is not None)
    return next((s for s in usable if s.codec_context.channels), None)


def has_sound(path: Path) -> bool:
    """Whether a media file has sound.

    Raises:
        FileError: it cannot be read.
    """
    with opened(path) as container:
        return bool(container.streams.audio)


def film_stream(container: InputContainer) -> VideoStream:
    """The first video stream that is not a cover picture.

    Raises:
        FileError: there is none.
    """
    stream, path = find_film(container), Path(container.name.removeprefix("file:"))
    if stream is None:
        raise FileError(path, "has no pictures", "choose another file")
    if stream.codec_context is None:
        raise FileError(path, "has pictures in a format that FFmpeg does not know", AS_MP4)
    return stream


def use_threads(path: Path, stream: VideoStream) -> None:
    """Decode a film in several threads, if it is worth them."""
    stream.thread_type = "AUTO"
    stream.codec_context.thread_count = threads_for(path)


def seconds(ticks: int | None, base: Fraction | None) -> float | None:
    """A stream's time in seconds; None if it is unknown."""
    return None if ticks is None or base is None else float(ticks * base)


def check(stopped: Callable[[], bool] | None) -> None:
    """Stop reading if the file is no longer needed.

    Raises:
        Abandoned: `stopped` returned True.
    """
    if stopped is not None and stopped():
        raise Abandoned
