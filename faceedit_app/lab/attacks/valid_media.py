"""Valid sounds, films and models, small enough to be read thousands of times."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import av
import numpy as np
from av.audio.stream import AudioStream
from av.container import OutputContainer
from av.video.stream import VideoStream

from faceedit_app.core.resources import shipped
from faceedit_app.editing.opening import open_sound
from faceedit_app.formats.opening import open_take
from faceedit_app.lab.attacks.reader import Reader, reader_of
from faceedit_app.lab.attacks.valid_takes import small_take
from faceedit_app.media.film import Film
from faceedit_app.media.sound import read_sound
from faceedit_app.networks.completion import FOLDER, read_completion
from faceedit_app.networks.region import read_region

_RATE = 48_000  # samples a second, which every codec takes
_SOUNDS = {".wav": "pcm_s16le", ".flac": "flac", ".mp3": "mp3", ".m4a": "aac", ".ogg": "libopus"}
_FILMS = {".mkv": "mpeg4", ".mp4": "mpeg4", ".mov": "mjpeg", ".avi": "mpeg4", ".webm": "libvpx"}
_WITH_SOUND = (".mkv", ".mov")


def media_readers(folder: Path) -> Iterator[Reader]:
    """The readers of sounds and films.

    Args:
        folder: where files are made.
    """
    for ending in _SOUNDS:
        yield reader_of("sounds", _sound(folder / f"sound{ending}"), read_sound)
    for ending in _FILMS:
        yield reader_of("films", _film(folder / f"film{ending}"), read_film)
    yield reader_of("takes with films", folder / "film.mov", _read_beside)


def model_readers() -> Iterator[Reader]:
    """The readers of networks."""
    model = min(shipped("models").glob("*.onnx"), key=lambda path: path.stat().st_size)
    yield reader_of("models", model, read_region)
    model = min((shipped("models") / FOLDER).glob("*.onnx"), key=lambda path: path.stat().st_size)
    yield reader_of("completions", model, read_completion)


def _sound(path: Path) -> Path:
    """A file with a sound alone."""
    with av.open(str(path), "w") as out:
        _add_tone(out, _tone_of(out, _SOUNDS[path.suffix]))
    return path


def _film(path: Path) -> Path:
    """A few small pictures; some files also have a sound and a timecode."""
    with av.open(str(path), "w") as out:
        film = out.add_stream(_FILMS[path.suffix], rate=25)
        assert isinstance(film, VideoStream)
        film.width, film.height = 64, 48
        film.pix_fmt = "yuvj420p" if film.name == "mjpeg" else "yuv420p"
        sound = _tone_of(out, "pcm_s16le") if path.suffix in _WITH_SOUND else None
        if path.suffix == ".mov":
            film.metadata["timecode"] = "01:02:03:04"
        for shade in range(0, 200, 20):
            frame = av.VideoFrame.from_ndarray(np.full((48, 64, 3), shade, np.uint8), "rgb24")
            out.mux(film.encode(frame))
        out.mux(film.encode(None))
        if sound is not None:
            _add_tone(out, sound)
    return path


def _tone_of(out: OutputContainer, codec: str) -> AudioStream:
    """The stream of a tone; all streams come before the first packet."""
    stream = out.add_stream(codec, rate=_RATE, layout="mono")
    assert isinstance(stream, AudioStream)
    return stream


def _add_tone(out: OutputContainer, stream: AudioStream) -> None:
    """A tenth of a second."""
    tone = 8000 * np.sin(np.arange(_RATE // 10) / 20.0)
    frame = av.AudioFrame.from_ndarray(tone.astype(np.int16)[None], "s16", "mono")
    frame.sample_rate = _RATE
    out.mux(stream.encode(frame))
    out.mux(stream.encode(None))


def read_film(path: Path) -> None:
    """Index a film, and decode its first and last picture."""
    film = Film(path)
    try:
        for index in {0, len(film) - 1}:
            film.picture(index)
    finally:
        film.close()


def _read_beside(path: Path) -> None:
    """Open a take beside which a film lies, and its sound."""
    take = path.with_suffix(".csv")
    take.write_bytes(small_take())
    open_sound(open_take(take))
