"""A take's film: any picture by its number, fast in both directions."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.arrays import Pixels, Times
from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.media.container import (
    file_errors,
    film_stream,
    open_container,
    opened,
    use_threads,
)
from faceedit_app.media.film_index import decoded, index_of
from faceedit_app.media.pixels import pixels_of

if TYPE_CHECKING:
    from av import VideoFrame
    from av.container import InputContainer

LONGEST_SIDE = 1280  # pixels; larger films are scaled down
_MEMORY = 192 * 2**20  # bytes of cached pictures
BEHIND = 24  # pictures cached on the way to the wanted one, when the playhead moves back
_AHEAD = 12  # pictures decoded ahead of the playhead


class Film:
    """A film. `cached` may be called from any thread, `picture` from one at a time.

    Attributes:
        path: its file.
        times: (F,) float64, the times of the pictures in seconds from the first; phones record at
            a varying rate.
        rate: pictures per second on average.
        timecode: of the first picture, as the file writes it, if it has one.
        remarks: what the user should know about the file, a sentence without its full stop each.
        damaged: the pictures that are damaged, as far as they were asked for; another one, or part
            of one, is shown instead.
    """

    def __init__(self, path: Path, stopped: Callable[[], bool] | None = None) -> None:
        """Open a film and index its pictures.

        Args:
            stopped: asked now and then; True gives up.

        Raises:
            FileError: it cannot be read or has no pictures.
            Unavailable: PyAV is not installed.
            Abandoned: `stopped` said so.
        """
        self.path = path
        with opened(path) as container:
            self._index = index_of(path, container, stopped)
        self.timecode, self.remarks = self._index.timecode, self._index.remarks
        stamps = self._index.stamps
        self.times: Times = (stamps - stamps[0]) * self._index.tick
        self.rate = (len(stamps) - 1) / float(self.times[-1]) if len(stamps) > 1 else 25.0
        self._container: InputContainer | None = None
        self._frames: Iterator[VideoFrame] | None = None
        self._next = 0  # the picture that is decoded next
        self.damaged: set[int] = set()
        self._cache: OrderedDict[int, Pixels] = OrderedDict()
        self._bytes = 0
        self._lock = threading.Lock()  # guards the cache

    def __len__(self) -> int:
        return len(self.times)

    @property
    def duration(self) -> float:
        """Seconds from the first picture to the end of the last."""
        return float(self.times[-1]) + 1.0 / self.rate

    def index_at(self, seconds: float) -> int:
        """The number of the picture that is shown at a time."""
        # Takes and films round times differently: allow half a millisecond.
        at = int(np.searchsorted(self.times, seconds + 5e-4, side="right")) - 1
        return min(max(at, 0), len(self.times) - 1)

    def frame_at(self, seconds: float) -> Pixels:
        """The picture at a time; see `picture`."""
        return self.picture(self.index_at(seconds))

    def cached(self, index: int) -> Pixels | None:
        """A picture from the cache, or None."""
        with self._lock:
            found = self._cache.get(index)
            if found is not None:
                self._cache.move_to_end(index)
            return found

    def picture(self, index: int, behind: int = 0) -> Pixels:
        """A picture, upright and with square pixels.

        Args:
            index: its number.
            behind: the number of pictures before it to cache too, if they are decoded anyway.

        Returns:
            (H, W, 4) uint8: blue, green, red, 255. If it is damaged, the nearest picture before it,
            or else the first that is not.

        Raises:
            FileError: the file has been removed or can no longer be read.
        """
        found = self.cached(index)
        if found is None:
            with file_errors(self.path):
                found = self._decode(index, behind)
        return found

    def close(self) -> None:
        """Close the file."""
        if self._container is not None:
            self._container.close()
        self._container = self._frames = None

    def _decode(self, index: int, behind: int) -> Pixels:
        key = int(np.searchsorted(self._index.keys, index, side="right")) - 1
        if self._frames is not None and self._index.keys[key] <= self._next <= index:
            found = self._go_on(index, behind)
            if found is not None:
                return found
        for earlier in (key, key - 1, 0):  # an earlier key, if the seek went too far
            if earlier >= 0:
                self._seek(earlier)
                found = self._go_on(index, behind, any_=earlier == 0)
                if found is not None:
                    return found
        raise FileError(self.path, "cannot be decoded", "convert it to MP4 (H.264) and use that")

    def _go_on(self, index: int, behind: int, any_: bool = False) -> Pixels | None:
        """Decode up to a picture; None if the film ends before it, or has none up to it.

        Args:
            any_: take the next picture if there is none up to it, since the first are damaged.
        """
        latest: VideoFrame | None = None
        shown = -1  # the number of the latest
        for frame in self._frames or ():
            at = self._index.number(frame.pts or 0)
            if at > index and latest is None and not any_:
                return None
            self._next = at + 1
            if at <= index or latest is None:
                latest, shown = frame, at
            if index - behind <= at < index or at > index:
                self._keep(at, frame)
            if at >= index:
                break
        if latest is None:
            return None
        if shown != index:
            self.damaged.add(index)
        return self._keep(index, latest)

    def _seek(self, key: int) -> None:
        if key == 0:
            self.close()  # reopen it, which begins at the first picture in every container
        if self._container is None:
            self._container = open_container(self.path)
            use_threads(self.path, film_stream(self._container))
        stream = film_stream(self._container)
        if key > 0:
            self._container.seek(int(self._index.key_stamps[key]), stream=stream, backward=True)
        self._frames = (f for f in decoded(self._container, stream) if f.pts is not None)
        self._next = 0

    def _keep(self, index: int, frame: VideoFrame) -> Pixels:
        picture = _upright(frame, self._aspect())
        if frame.is_corrupt:
            self.damaged.add(index)
        with self._lock:
            if index not in self._cache:
                self._cache[index] = picture
                self._bytes += picture.nbytes
            while self._bytes > _MEMORY and len(self._cache) > 2:
                _, old = self._cache.popitem(last=False)
                self._bytes -= old.nbytes
        return picture

    def _aspect(self) -> float:
        assert self._container is not None
        return float(film_stream(self._container).sample_aspect_ratio or 1)


def _upright(frame: VideoFrame, aspect: float) -> Pixels:
    """A decoded picture, upright, with square pixels and of limited size."""
    wide, high = frame.width * aspect, float(frame.height)
    scale = min(1.0, LONGEST_SIDE / max(wide, high))
    size = max(1, round(wide * scale)), max(1, round(high * scale))
    pixels = pixels_of(frame, *size)
    turns = round(frame.rotation / 90) % 4  # quarter turns, anticlockwise
    if turns == 0:
        return pixels
    # A pixel as one number: four times as fast.
    turned = np.rot90(np.ascontiguousarray(pixels).view(np.uint32)[:, :, 0], turns)
    return np.ascontiguousarray(turned)[:, :, None].view(np.uint8)


class Projector:
    """Decodes a film in its own thread: the wanted picture first, then those after it.

    Only the last request counts: if decoding is slower than the playhead, pictures are skipped.

    Args:
        film: the film, which must not be used elsewhere.
        ready: called in the thread with the number of each wanted picture.
        failed: called in the thread if the film can no longer be read.
    """

    def __init__(
        self,
        film: Film,
        ready: Callable[[int], None],
        failed: Callable[[FaceEditError], None],
    ) -> None:
        self._film, self._ready, self._failed = film, ready, failed
        self._wish = threading.Condition()
        self._wanted: int | None = None
        self._closed = False
        self._thread = threading.Thread(target=self._work, name="film", daemon=True)
        self._thread.start()

    def want(self, index: int) -> None:
        """Decode a picture next, unless it is cached, and then those after it."""
        with self._wish:
            self._wanted = index
            self._wish.notify()

    def close(self) -> None:
        """Stop the thread and close the file."""
        with self._wish:
            self._closed = True
            self._wish.notify()
        self._thread.join(timeout=2.0)

    def _work(self) -> None:
        try:
            before = -1
            while (index := self._next_wish()) is not None:
                back = index < before
                self._film.picture(index, BEHIND if back else 0)
                self._ready(index)
                before = index
                if not back:
                    self._run_ahead(index)
        except FaceEditError as error:
            self._failed(error)
        finally:
            self._film.close()

    def _next_wish(self) -> int | None:
        with self._wish:
            self._wish.wait_for(lambda: self._closed or self._wanted is not None)
            index, self._wanted = self._wanted, None
            return None if self._closed else index

    def _run_ahead(self, index: int) -> None:
        for beyond in range(index + 1, min(index + 1 + _AHEAD, len(self._film))):
            with self._wish:
                if self._closed or self._wanted is not None:
                    return
            self._film.picture(beyond)
