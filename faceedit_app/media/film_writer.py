"""Write a film with PyAV: MP4, WebM, or numbered PNG pictures, with sound.

Which encoders there are depends on how FFmpeg was built. The best of those present is taken; what
each one's licence asks for is in docs/releasing.md.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
import wave
from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from faceedit_app.core import on_disk
from faceedit_app.core.arrays import Pixels
from faceedit_app.core.atomic import keep_other, not_written, target_of
from faceedit_app.core.containers import holds_film
from faceedit_app.core.errors import FaceEditError, FileError, Unavailable
from faceedit_app.media.sound import Sound

if TYPE_CHECKING:
    from av.container import OutputContainer

_SAMPLES = 48_000  # a second; what all players take
_BLOCK = 4_800  # samples that are encoded at once
_BT709 = 1  # FFmpeg's number for it, in all three colour properties
_LIMITED = 1  # colour range of films
_FINEST = 60_000  # denominator of a frame rate, so that 59.94 is 60000/1001


@dataclass(frozen=True)
class Encoder:
    """An encoder of FFmpeg.

    Attributes:
        codec: FFmpeg's name.
        name: shown to the user.
        options: for high quality.
    """

    codec: str
    name: str
    options: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class FilmFormat:
    """A kind of film.

    Attributes:
        key: the name on the command line.
        name: shown to the user.
        ending: of its files, with the dot; "" for a folder of pictures.
        video, sound: encoders, the best first.
    """

    key: str
    name: str
    ending: str
    video: tuple[Encoder, ...] = ()
    sound: tuple[Encoder, ...] = ()


# fmt: off
FILM_FORMATS: tuple[FilmFormat, ...] = (
    FilmFormat("mp4", "MP4", ".mp4", (
        Encoder("libx264", "H.264 (x264)", {"crf": "18", "preset": "veryfast"}),
        Encoder("libopenh264", "H.264 (OpenH264)", {"b": "8000000"}),
        Encoder("h264_videotoolbox", "H.264 (macOS)", {"b": "8000000"}),
        Encoder("h264_mf", "H.264 (Windows)", {"b": "8000000"}),
        Encoder("mpeg4", "MPEG-4", {"q": "2", "qmin": "2", "qmax": "3"}),
    ), (Encoder("aac", "AAC", {"b": "192000"}),)),
    FilmFormat("webm", "WebM", ".webm", (
        Encoder("libvpx-vp9", "VP9",
                {"crf": "24", "b": "0", "deadline": "realtime", "cpu-used": "6", "row-mt": "1"}),
        Encoder("libvpx", "VP8", {"crf": "10", "b": "8000000", "deadline": "realtime"}),
    ), (Encoder("libopus", "Opus", {"b": "160000"}), Encoder("libvorbis", "Vorbis"))),
    FilmFormat("png", "PNG pictures", "", (Encoder("png", "PNG"),)),
)
# fmt: on


def film_format(path: Path, key: str | None = None) -> FilmFormat:
    """The format of a film.

    Args:
        path: the file; its ending decides if `key` is None.
        key: `FilmFormat.key`.

    Raises:
        FaceEditError: there is no such format.
    """
    for form in FILM_FORMATS:
        if form.key == key or (key is None and path.suffix.lower() == form.ending):
            return form
    if key is not None:
        raise FaceEditError(f"{key}: must be one of {', '.join(f.key for f in FILM_FORMATS)}")
    raise FaceEditError(f"{path}: must end in .mp4 or .webm, or be a folder for pictures")


@dataclass(frozen=True)
class Soundtrack:
    """A sound, and the second of the film at which its file begins."""

    sound: Sound
    offset: float = 0.0

    def samples(self, start: int, count: int) -> np.ndarray[Any, Any]:
        """(C, count) float32 in -1..1, from sample `start` of the film at 48 kHz."""
        step = self.sound.rate / _SAMPLES
        seconds = start / _SAMPLES - self.offset - self.sound.start
        block = self.sound.read(seconds * self.sound.rate, count, step)
        return np.ascontiguousarray(block.T)


class Writer(Protocol):
    """Writes the pictures of a film, one after the other.

    Attributes:
        codecs: the names of its encoders, for the user.
        backup: once it is written, the copy of a file of another kind that it replaced, if any.
    """

    codecs: str
    backup: Path | None

    def add(self, picture: Pixels) -> None:
        """Add a picture (H, W, 3) uint8, RGB."""


@contextlib.contextmanager
def writing(
    path: Path, form: FilmFormat, size: tuple[int, int], rate: float, track: Soundtrack | None
) -> Iterator[Writer]:
    """Write a film; it is there once the block ends without an error, else nothing is.

    Args:
        path: the file, or the folder for pictures, which must be new or empty.
        form: its format.
        size: width and height, even numbers.
        rate: pictures per second.
        track: its sound.

    Raises:
        FileError: it cannot be written.
        Unavailable: PyAV, or an encoder, is not there.
    """
    path = target_of(path) if form.ending else _new_folder(path)
    try:
        room = Path(tempfile.mkdtemp(prefix=f".{path.name}.", dir=path.parent))
    except OSError as error:
        raise not_written(path, error) from error
    try:
        part = room / f"film{form.ending}"
        writer: _FilmWriter | _PictureWriter
        if form.ending:
            writer = _FilmWriter(part, form, size, rate, track)
            try:
                yield writer
                writer.finish()
            finally:
                writer.close()
        else:
            part.mkdir()
            writer = _PictureWriter(part)
            yield writer
            if track is not None:
                count = len(list(part.iterdir()))
                _write_wav(part / "sound.wav", track, round(count / rate * _SAMPLES))
            if path.exists():
                path.rmdir()
        writer.backup = keep_other(path, holds_film)
        part.replace(path)
    except (FaceEditError, GeneratorExit):
        raise
    except OSError as error:
        raise not_written(path, error) from error
    finally:
        shutil.rmtree(room, ignore_errors=True)


def _new_folder(path: Path) -> Path:
    """A folder for pictures, which is made once they are written.

    Raises:
        FileError: something is there already.
    """
    path = Path(os.path.realpath(path))
    if on_disk.exists(path) and (not on_disk.is_folder(path) or any(path.iterdir())):
        raise FileError(path, "exists and is not an empty folder", "choose a new folder")
    return path


class _FilmWriter:
    """Encodes pictures and sound into one file, side by side."""

    def __init__(
        self,
        path: Path,
        form: FilmFormat,
        size: tuple[int, int],
        rate: float,
        track: Soundtrack | None,
    ) -> None:
        try:
            import av
        except ImportError as error:
            raise Unavailable(f"Films need PyAV, which cannot be loaded ({error})") from error
        self._av, self._track = av, track
        self.backup: Path | None = None
        self._rate = Fraction(rate).limit_denominator(_FINEST)
        options = {"movflags": "+faststart"} if form.ending == ".mp4" else {}
        self._container: OutputContainer = av.open(f"file:{path}", "w", options=options)
        try:
            video = self._open_video(form, size)
            sound = self._open_sound(form) if track is not None else None
        except BaseException:
            self.close()
            raise
        self._frames = self._heard = 0
        self.codecs = video.name + (f" and {sound.name}" if sound is not None else "")

    def add(self, picture: Pixels) -> None:
        """Add a picture (H, W, 3) uint8, RGB, and the sound until it ends."""
        frame = self._av.VideoFrame.from_ndarray(picture, format="rgb24")
        # With several threads FFmpeg 8 corrupts pixels at the borders of their slices.
        frame = frame.reformat(
            format=self._video.codec_context.pix_fmt, dst_colorspace="ITU709", threads=1
        )
        frame.pts, frame.time_base = self._frames, 1 / self._rate
        self._container.mux(self._video.encode(frame))
        self._frames += 1
        self._sound_until(int(self._frames / self._rate * _SAMPLES))

    def finish(self) -> None:
        """Write what the encoders still hold."""
        self._container.mux(self._video.encode())
        if self._track is not None:
            for part in self._resampler.resample(None):
                self._encode(part)
            self._container.mux(self._audio.encode())
        self._container.close()

    def close(self) -> None:
        """Close the file, finished or not."""
        with contextlib.suppress(OSError, ValueError):
            self._container.close()

    def _open_video(self, form: FilmFormat, size: tuple[int, int]) -> Encoder:
        for encoder in form.video:
            if self._works(encoder, size):
                stream = self._container.add_stream(encoder.codec, rate=self._rate)
                assert isinstance(stream, self._av.VideoStream)
                stream.options = dict(encoder.options)
                self._describe(stream.codec_context, size)
                stream.codec_context.open()
                self._video = stream
                return encoder
        raise self._missing(form, form.video)

    def _works(self, encoder: Encoder, size: tuple[int, int]) -> bool:
        """Whether an encoder is there and takes such pictures; some need a graphics card."""
        if encoder.codec not in self._av.codecs_available:
            return False
        try:
            trial = self._av.CodecContext.create(encoder.codec, "w")
            self._describe(trial, size)
            trial.time_base = 1 / self._rate
            trial.open()
        except (OSError, ValueError, LookupError, RuntimeError):  # FFmpeg's errors are these too
            return False
        return True

    @staticmethod
    def _describe(context: Any, size: tuple[int, int]) -> None:
        context.width, context.height = size
        context.pix_fmt = "yuv420p"
        context.color_primaries = context.color_trc = context.colorspace = _BT709
        context.color_range = _LIMITED

    def _open_sound(self, form: FilmFormat) -> Encoder:
        for encoder in form.sound:
            if encoder.codec in self._av.codecs_available:
                stream = self._container.add_stream(encoder.codec, rate=_SAMPLES)
                assert isinstance(stream, self._av.AudioStream)
                stream.options = dict(encoder.options)
                stream.layout = "stereo"
                stream.codec_context.open()
                self._audio = stream
                self._resampler = self._av.AudioResampler(
                    format=stream.format.name,
                    layout="stereo",
                    rate=_SAMPLES,
                    frame_size=stream.codec_context.frame_size or 960,
                )
                return encoder
        raise self._missing(form, form.sound)

    @staticmethod
    def _missing(form: FilmFormat, encoders: tuple[Encoder, ...]) -> Unavailable:
        names = " or ".join(encoder.name for encoder in encoders)
        return Unavailable(
            f"{form.name} needs an encoder for {names}, which this FFmpeg lacks; "
            f"choose another kind of film"
        )

    def _sound_until(self, stop: int) -> None:
        while self._track is not None and self._heard < stop:
            count = min(_BLOCK, stop - self._heard)
            samples = self._track.samples(self._heard, count)
            layout = "stereo" if len(samples) == 2 else "mono"
            block = self._av.AudioFrame.from_ndarray(samples, format="fltp", layout=layout)
            block.sample_rate, block.pts = _SAMPLES, self._heard
            block.time_base = Fraction(1, _SAMPLES)
            for part in self._resampler.resample(block):
                self._encode(part)
            self._heard += count

    def _encode(self, part: Any) -> None:
        self._container.mux(self._audio.encode(part))


class _PictureWriter:
    """Writes numbered pictures into a folder."""

    codecs = "PNG"

    def __init__(self, folder: Path) -> None:
        self._folder, self._count = folder, 0
        self.backup: Path | None = None

    def add(self, picture: Pixels) -> None:
        """Add a picture (H, W, 3) uint8, RGB."""
        from PIL import Image

        self._count += 1
        Image.fromarray(picture).save(self._folder / f"{self._count:06d}.png", compress_level=1)


def _write_wav(path: Path, track: Soundtrack, count: int) -> None:
    with wave.open(str(path), "wb") as file:
        file.setnchannels(track.sound.channels)
        file.setsampwidth(2)
        file.setframerate(_SAMPLES)
        for start in range(0, count, _SAMPLES):
            block = track.samples(start, min(_SAMPLES, count - start))
            file.writeframes((block.T * 32767).clip(-32768, 32767).astype("<i2").tobytes())
