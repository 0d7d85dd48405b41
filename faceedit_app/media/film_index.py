"""The index of a film: when each picture is shown, where decoding can begin, what is missing."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.errors import FileError
from faceedit_app.media.container import (
    AS_MP4,
    check,
    film_stream,
    films,
    opened,
    use_threads,
)
from faceedit_app.media.limits import most_pixels

if TYPE_CHECKING:
    from av import VideoFrame
    from av.container import InputContainer
    from av.video.stream import VideoStream

Ticks = NDArray[np.int64]

# Containers with the time of each picture. In others (MPEG) times are guesses after a seek, so they
# are decoded from the beginning whenever the playhead moves back.
_EXACT = {"mov", "mp4", "matroska", "webm", "avi"}
_MATROSKA = {"matroska", "webm"}
_MISSING = 0.2  # seconds; a film whose end is that much before what its file says breaks off


@dataclass(frozen=True)
class FilmIndex:
    """The index of a film. Pictures are numbered in the order in which they are shown.

    Attributes:
        tick: the seconds in a tick.
        stamps: (F,) ticks at which the pictures are shown.
        keys: (P,) the pictures at which decoding can begin; the first is 0.
        key_stamps: (P,) ticks to seek to for these; files are in decoding order.
        timecode: of the first picture, as the file writes it, if it has one.
        remarks: what the user should know about the file.
    """

    tick: float
    stamps: Ticks
    keys: Ticks
    key_stamps: Ticks
    timecode: str | None = None
    remarks: tuple[str, ...] = ()

    def number(self, stamp: int) -> int:
        """The number of the picture that is shown at a tick."""
        at = int(np.searchsorted(self.stamps, stamp, side="right")) - 1
        return max(at, 0)


def index_of(
    path: Path, container: InputContainer, stopped: Callable[[], bool] | None = None
) -> FilmIndex:
    """Index a film, without decoding it if possible.

    Args:
        path: its file.
        container: the same, just opened.
        stopped: asked now and then; True gives up.

    Raises:
        FileError: it has no pictures, or does not say when they are shown.
        Abandoned: `stopped` said so.
    """
    stream = film_stream(container)
    if stream.width * stream.height > most_pixels(path):
        problem = f"has pictures of {stream.width} x {stream.height} pixels, too large for its size"
        raise FileError(path, problem, "make them smaller, or copy it again if it is damaged")
    index, remarks = _by_packets(path, container, stream, stopped), []
    if index is None:
        index, untimed = _by_decoding(path, stopped)
        if untimed:
            remarks.append(f"{untimed} pictures do not say when they are shown: they are left out")
    missing = _said_end(container, stream) - index.tick * float(index.stamps[-1]) - _step(index)
    if missing > _MISSING:
        remarks.append(f"the film breaks off: its last {missing:.1f} s are missing in the file")
    count = len(films(container))
    if count > 1:
        remarks.append(f"the file holds {count} films: the first is used")
    if not _EXACT & _format(container):
        index = replace(index, keys=index.keys[:1], key_stamps=index.key_stamps[:1])
    return replace(index, timecode=_timecode(container), remarks=tuple(remarks))


def decoded(container: InputContainer, stream: VideoStream) -> Iterator[VideoFrame]:
    """Pictures in the order in which they are shown; damaged ones are left out."""
    from av.error import ArgumentError, InvalidDataError

    for packet in container.demux(stream):
        try:
            frames = packet.decode()
        except (InvalidDataError, ArgumentError):  # the other is said of pictures too large
            continue
        yield from frames


def _by_packets(
    path: Path,
    container: InputContainer,
    stream: VideoStream,
    stopped: Callable[[], bool] | None,
) -> FilmIndex | None:
    """Index a film without decoding it; None if not every picture has a time (AVI, old MPEG)."""
    shown: list[int] = []
    keys: list[tuple[int, int]] = []
    for packet in container.demux(stream):
        check(stopped)
        if packet.size == 0 or packet.is_discard:
            continue
        if packet.pts is None:
            return None
        shown.append(packet.pts)
        if packet.is_keyframe:
            keys.append((packet.pts, packet.pts if packet.dts is None else packet.dts))
    if not shown:
        raise FileError(path, "has no pictures", "choose another file")
    return _made(stream, shown, keys)


def _by_decoding(path: Path, stopped: Callable[[], bool] | None) -> tuple[FilmIndex, int]:
    """Index a film by decoding it; also the number of pictures without a time."""
    shown: list[int] = []
    keys: list[tuple[int, int]] = []
    untimed = 0
    with opened(path) as container:
        stream = film_stream(container)
        use_threads(path, stream)
        for frame in decoded(container, stream):
            check(stopped)
            if frame.pts is None:
                untimed += 1
                continue
            shown.append(frame.pts)
            if frame.key_frame:
                keys.append((frame.pts, frame.pts if frame.dts is None else frame.dts))
        if not shown and untimed:
            raise FileError(path, "does not say when its pictures are shown", AS_MP4)
        if not shown:
            raise FileError(path, "has no pictures", "choose another file")
        return _made(stream, shown, keys), untimed


def _made(stream: VideoStream, shown: list[int], keys: list[tuple[int, int]]) -> FilmIndex:
    assert stream.time_base is not None
    stamps = np.unique(np.array(shown, np.int64))
    pairs = np.array(sorted(keys) or [(shown[0], shown[0])], np.int64)
    numbers = np.searchsorted(stamps, pairs[:, 0])
    numbers[0] = 0  # pictures whose key was cut off are decoded as far as possible
    return FilmIndex(float(stream.time_base), stamps, numbers, pairs[:, 1])


def _format(container: InputContainer) -> set[str]:
    return set(container.format.name.split(","))


def _step(index: FilmIndex) -> float:
    """Seconds for which the last picture is shown, as far as is known."""
    steps = np.diff(index.stamps)
    return index.tick * float(np.median(steps)) if len(steps) else 0.0


def _said_end(container: InputContainer, stream: VideoStream) -> float:
    """When the film ends by what its file says, seconds; 0 if it does not say."""
    names = _format(container)
    if names & _MATROSKA:
        for name, text in stream.metadata.items():
            if name.startswith("DURATION"):
                return _seconds(text)
        is_alone = len(container.streams.video) + len(container.streams.audio) == 1
        return (container.duration or 0) / 1e6 if is_alone else 0.0
    if "avi" in names:
        return float(stream.frames / stream.average_rate) if stream.average_rate else 0.0
    if not names & _EXACT or not stream.duration or stream.time_base is None:
        return 0.0  # FFmpeg guesses it for the others, from where the file ends
    return float(((stream.start_time or 0) + stream.duration) * stream.time_base)


def _seconds(text: str) -> float:
    """Seconds from Matroska's 00:01:02.345; 0 if it is something else."""
    try:
        hours, minutes, rest = text.split(":")
        return 3600.0 * int(hours) + 60.0 * int(minutes) + float(rest)
    except ValueError:
        return 0.0


def _timecode(container: InputContainer) -> str | None:
    """The timecode, which cameras write to the video stream, a separate one, or the file."""
    for holder in (film_stream(container), *container.streams, container):
        if text := holder.metadata.get("timecode"):
            return str(text)
    return None
