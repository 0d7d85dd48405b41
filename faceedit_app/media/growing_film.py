"""A film that is recorded: whole but for its last second at every moment, even after a crash."""

from __future__ import annotations

import time
from contextlib import suppress
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from faceedit_app.core.atomic import not_written
from faceedit_app.core.errors import FileError, Unavailable
from faceedit_app.media.film_writer import film_format
from faceedit_app.media.microphone import Microphone

if TYPE_CHECKING:
    from av import VideoFrame

_TICK = Fraction(1, 90_000)  # seconds; what MP4 players expect
_NOMINAL = 30  # pictures per second; the times decide
_GOP = 30  # pictures to the next one at which a fragment begins
# Fragments, each with its own index: what was written stays readable whatever happens.
_FRAGMENTS = {
    "movflags": "frag_keyframe+empty_moov+default_base_moof",
    "flush_packets": "1",
}
_QUICK = {"libx264": {"preset": "ultrafast", "crf": "16", "tune": "zerolatency"}}


class GrowingFilm:
    """An MP4 with pictures at the times at which they came, and perhaps sound.

    Args:
        path: the file, which must be new.
        microphone: where the sound comes from; closed with the film.

    Raises:
        FileError: the file exists or cannot be written.
    """

    def __init__(self, path: Path, microphone: Microphone | None = None) -> None:
        self._path, self._microphone = path, microphone
        self._container: Any = None
        self._video: Any = None
        self._sound: Any = None
        self._began: float | None = None  # the first picture's time
        self._last = -1  # ticks
        try:
            path.open("xb").close()
        except FileExistsError as error:
            raise FileError(path, "exists", "choose a new name for the film") from error
        except OSError as error:
            raise self._explained(error) from error

    def add(self, frame: VideoFrame) -> float:
        """Add a picture, and the sound until it came.

        Returns:
            Seconds since the first picture.

        Raises:
            FileError: it cannot be written.
            Unavailable: this FFmpeg has no encoder.
        """
        try:
            if self._container is None:
                self._open(frame)
            width, height = self._video.width, self._video.height
            whole: Any = frame.reformat(width=width, height=height, format="yuv420p", threads=1)
            stamp = time.monotonic() if frame.time is None else frame.time
            self._began = stamp if self._began is None else self._began
            at = max(round((stamp - self._began) / _TICK), self._last + 1)
            self._last = at
            whole.pts, whole.time_base = at, _TICK
            self._container.mux(self._video.encode(whole))
            self._add_sound()
        except OSError as error:
            raise self._explained(error) from error
        return float(at * _TICK)

    def finish(self) -> bool:
        """Finish the file; False if there is no picture, and so no file.

        Raises:
            FileError: the end cannot be written.
        """
        if self._microphone is not None:
            self._microphone.close()
        if self._container is None:
            with suppress(OSError):
                self._path.unlink()
            return False
        try:
            self._add_sound()
            self._container.mux(self._video.encode())
            if self._sound is not None:
                self._container.mux(self._sound.encode())
            self._container.close()
        except OSError as error:
            raise self._explained(error) from error
        return True

    def _open(self, frame: VideoFrame) -> None:
        import av

        self._container = av.open(f"file:{self._path}", "w", format="mp4", options=_FRAGMENTS)
        # Encoders take even sides only.
        width, height = frame.width // 2 * 2, frame.height // 2 * 2
        self._video = self._encoder(width, height)
        microphone = self._microphone
        if microphone is not None:
            microphone.begin()
            self._sound = self._container.add_stream("aac", rate=microphone.rate, layout="mono")

    def _encoder(self, width: int, height: int) -> Any:
        import av

        for encoder in film_format(self._path, "mp4").video:
            try:
                trial: Any = av.CodecContext.create(encoder.codec, "w")
                trial.width, trial.height, trial.pix_fmt = width, height, "yuv420p"
                trial.time_base = _TICK
                trial.open()
            except (OSError, ValueError, LookupError, RuntimeError):  # FFmpeg's errors are these
                continue
            stream: Any = self._container.add_stream(encoder.codec, rate=_NOMINAL)
            stream.options = dict(encoder.options) | _QUICK.get(encoder.codec, {})
            stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
            stream.codec_context.time_base = _TICK
            stream.codec_context.gop_size, stream.codec_context.max_b_frames = _GOP, 0
            return stream
        raise Unavailable(
            "Films cannot be recorded: PyAV has no H.264 encoder; run: pip install av"
        )

    def _add_sound(self) -> None:
        if self._microphone is None or self._sound is None:
            return
        import av

        for start, samples in self._microphone.blocks():
            block = av.AudioFrame.from_ndarray(samples[None], format="fltp", layout="mono")
            block.sample_rate, block.pts = self._microphone.rate, start
            block.time_base = Fraction(1, self._microphone.rate)
            self._container.mux(self._sound.encode(block))

    def _explained(self, error: OSError) -> FileError:
        return not_written(self._path, error)
