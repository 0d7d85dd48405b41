"""Webcams: which are connected, what they show, and a film of it.

FFmpeg reads them by the system's own interface: Video4Linux, DirectShow or AVFoundation.
"""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from faceedit_app.core.arrays import Pixels
from faceedit_app.core.errors import FaceEditError, Unavailable
from faceedit_app.media.growing_film import GrowingFilm
from faceedit_app.media.microphone import Microphone
from faceedit_app.media.pixels import pixels_of

if TYPE_CHECKING:
    from av import VideoFrame

_KINDS = {"linux": "v4l2", "win32": "dshow", "darwin": "avfoundation"}
_PREVIEW = 640  # pixels of the longest side of what is shown
_POLL = 0.004  # seconds; AVFoundation does not wait for a picture
_BROKEN = 50  # pictures in a row that cannot be decoded; the first few often cannot
_PATIENCE = 3.0  # seconds in which a webcam should let go
NO_WEBCAM = (
    "No webcam was found: connect one, or film yourself with a phone and choose File > Track a film"
)
_REMEDY = "close other programs that use it, or choose another one"
# What is asked of a webcam, the best first; one without these sizes refuses all but the last.
_WISHES: tuple[dict[str, str], ...] = (
    {"video_size": "1280x720", "framerate": "30"},
    {"video_size": "640x480", "framerate": "30"},
    {},
)
_COMPRESSED = {"v4l2": {"input_format": "mjpeg"}}  # USB is too slow for 720p as it is


@dataclass(frozen=True)
class Webcam:
    """A webcam.

    Attributes:
        name: shown to the user.
        address: what FFmpeg opens.
        kind: FFmpeg's name of the interface; empty for a file.
    """

    name: str
    address: str
    kind: str = ""


def webcams() -> list[Webcam]:
    """The webcams that are connected, the system's own choice first; may take a second.

    Raises:
        Unavailable: PyAV is not installed, or knows no webcams on this system.
    """
    av, kind = _library(), _KINDS.get(sys.platform, "")
    try:
        devices = av.enumerate_input_devices(kind)
    except (ValueError, OSError) as error:
        raise Unavailable(
            "PyAV cannot look for webcams on this system; film yourself with a phone, and choose "
            "File > Track a film"
        ) from error
    found = [one for one in devices if not one.media_types or "video" in one.media_types]
    found.sort(key=lambda one: not one.is_default)
    return [Webcam(one.description or one.name, _address(kind, one.name), kind) for one in found]


def find_webcam(name: str = "") -> Webcam:
    """The webcam with a part of this name; the system's own choice if it is empty.

    Raises:
        FaceEditError: there is none.
        Unavailable: as `webcams`.
    """
    found = webcams()
    if not found:
        raise FaceEditError(NO_WEBCAM)
    chosen = next((one for one in found if name.casefold() in one.name.casefold()), None)
    if chosen is None:
        names = ", ".join(one.name for one in found)
        raise FaceEditError(f"There is no webcam {name}; there are {names}")
    return chosen


def _address(kind: str, name: str) -> str:
    return {"dshow": f"video={name}", "avfoundation": f"{name}:none"}.get(kind, name)


def _library() -> Any:
    try:
        import av
    except ImportError as error:
        raise Unavailable(
            f"Webcams need PyAV, which cannot be loaded ({error}); run: pip install av"
        ) from error
    return av


@contextmanager
def pictures_of(webcam: Webcam) -> Iterator[Iterator[VideoFrame]]:
    """The pictures of a webcam as they come; they end when it is unplugged.

    Raises:
        FaceEditError: it cannot be opened, or no longer read.
    """
    container = _opened(webcam)
    try:
        yield _frames(webcam, container)
    finally:
        container.close()


def _opened(webcam: Webcam) -> Any:
    av, failed = _library(), None
    if not webcam.kind:
        return av.open(webcam.address)
    more = _COMPRESSED.get(webcam.kind)
    wishes = ([_WISHES[0] | more] if more else []) + list(_WISHES)
    for wish in wishes:
        try:
            container = av.open(webcam.address, format=webcam.kind, options=wish)
        except (OSError, ValueError, LookupError) as error:  # FFmpeg's errors are these too
            failed = error
            continue
        if container.streams.video:
            return container
        container.close()
    raise _error(webcam, "cannot be opened", failed) from failed


def _frames(webcam: Webcam, container: Any) -> Iterator[VideoFrame]:
    stream, broken = container.streams.video[0], 0
    av = _library()
    while True:
        try:
            for frame in container.decode(stream):
                broken = 0
                yield frame
            return
        except BlockingIOError:
            time.sleep(_POLL)
        except av.error.InvalidDataError as error:
            broken += 1
            if broken > _BROKEN:
                raise _error(webcam, "sends pictures that cannot be read", error) from error
        except (OSError, ValueError, LookupError) as error:
            raise _error(webcam, "cannot be read any more", error) from error


def _error(webcam: Webcam, what: str, error: Exception | None) -> FaceEditError:
    reason = (getattr(error, "strerror", "") or str(error or "")).lower()
    return FaceEditError(f"{webcam.name} {what}{f' ({reason})' if reason else ''}: {_REMEDY}")


class WebcamRecorder:
    """Shows what a webcam sees and, from `begin` to `end`, records it into a film.

    It reads in a thread of its own. If it fails while it records, the film holds what came before.

    Args:
        webcam: the webcam.
        seen: is given each picture (H, W, 4) BGRA, made smaller, in that thread.
        failed: is given the reason if it ends by itself, in that thread.

    Attributes:
        seconds: of the film so far.
    """

    def __init__(
        self,
        webcam: Webcam,
        seen: Callable[[Pixels], None],
        failed: Callable[[FaceEditError], None],
    ) -> None:
        self._webcam, self._seen, self._failed = webcam, seen, failed
        self._film: GrowingFilm | None = None
        self._lock = threading.Lock()  # guards the film
        self._closing = threading.Event()
        self.seconds = 0.0
        self._thread = threading.Thread(target=self._work, name="webcam", daemon=True)
        self._thread.start()

    def begin(self, path: Path, microphone: Microphone | None = None) -> None:
        """Record from the next picture on.

        Args:
            path: the MP4, which must be new.
            microphone: where its sound comes from; closed with the film.

        Raises:
            FileError: it cannot be written.
        """
        try:
            film = GrowingFilm(path, microphone)
        except FaceEditError:
            if microphone is not None:
                microphone.close()
            raise
        with self._lock:
            self._film, self.seconds = film, 0.0

    def end(self) -> bool:
        """Finish the film; False if no picture came, and so there is no film.

        Raises:
            FileError: the end of it cannot be written.
        """
        with self._lock:
            film, self._film = self._film, None
        return film is not None and film.finish()

    def close(self) -> None:
        """Let go of the webcam; a film that is being recorded is finished."""
        self._closing.set()
        with suppress(FaceEditError):  # the window closes, and the film is there but for its end
            self.end()
        if threading.current_thread() is not self._thread:
            self._thread.join(_PATIENCE)

    def _work(self) -> None:
        try:
            with pictures_of(self._webcam) as frames:
                for frame in frames:
                    if self._closing.is_set():
                        return
                    with self._lock:
                        if self._film is not None:
                            self.seconds = self._film.add(frame)
                    self._seen(_small(frame))
            if not self._closing.is_set():
                raise _error(self._webcam, "was disconnected", None)
        except FaceEditError as error:
            self._failed(error)
        except Exception as error:  # FFmpeg's errors have no common class but this
            self._failed(_error(self._webcam, "cannot be read", error))


def _small(frame: VideoFrame) -> Pixels:
    share = min(1.0, _PREVIEW / max(frame.width, frame.height))
    width, height = (max(1, round(side * share)) for side in (frame.width, frame.height))
    return pixels_of(frame, width, height)
