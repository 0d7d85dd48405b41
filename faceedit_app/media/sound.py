"""A take's sound in memory, and the extremes for its waveform."""

from __future__ import annotations

import io
import wave
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, cast

import numpy as np

from faceedit_app.core.arrays import Floats, Samples
from faceedit_app.core.errors import FileError
from faceedit_app.core.extremes import Extremes
from faceedit_app.media.container import check, find_film, find_sound, opened, seconds

if TYPE_CHECKING:
    from av import AudioFrame, AudioResampler
    from av.audio.stream import AudioStream
    from av.container import InputContainer


FULL = 32768.0  # full scale of 16 bits, which need a quarter of the memory of float64
BLOCK = 128  # samples in the smallest bin of the extremes
_QUARTER = 4  # waveform bins are at most a quarter of a pixel; coarser ones would be visible
_LONGEST = 2.0  # hours; a longer sound would fill the memory, and no take is as long
_HOLE = 0.02  # seconds; longer holes between packets are filled with silence
_MOST_SILENCE = 600.0  # seconds; a small file may claim hours of it
_FASTEST = 768_000  # samples per second; other rates are damage
_MOST_SAMPLES = round(_LONGEST * 3600 * 96_000)  # of all channels: two hours of 48 kHz stereo
_CUT = "cut out the part of the take"


def extremes_of(samples: Samples) -> Extremes:
    """The lowest and highest of (N, C) samples, by channel."""
    length, channels = samples.shape
    return Extremes(lambda rows: samples[rows], length, channels, np.int16, BLOCK)


def wav(samples: Samples, rate: int) -> bytes:
    """Samples (N, C) as a WAV of 16 bits."""
    content = io.BytesIO()
    with wave.open(content, "wb") as file:
        file.setnchannels(samples.shape[1])
        file.setsampwidth(2)
        file.setframerate(rate)
        file.writeframes(samples.astype("<i2").tobytes())
    return content.getvalue()


@dataclass(frozen=True)
class Sound:
    """A sound.

    Attributes:
        path: its file.
        rate: samples per second.
        samples: (N, C) int16, C is 1 or 2.
        start: seconds from the beginning of the file to the first sample; in a film, from the first
            picture, so that sound and pictures stay in step.
        extremes: the extremes for its waveform.
        began: when it began, seconds since midnight, if known (Broadcast WAV).
    """

    path: Path
    rate: int
    samples: Samples
    start: float
    extremes: Extremes
    began: float | None = None

    @property
    def channels(self) -> int:
        """1 or 2."""
        return int(self.samples.shape[1])

    @property
    def end(self) -> float:
        """Seconds from the file's beginning to the end of the last sample."""
        return self.start + len(self.samples) / self.rate

    def read(self, first: float, count: int, step: float = 1.0) -> Floats:
        """(count, C) float32 in -1..1, from sample `first`, every `step` samples.

        Interpolates linearly between samples; silent beyond both ends.
        """
        if step == 1.0:
            start = round(first)
            return self._rows(start, start + count)
        at = first + step * np.arange(count)
        start = int(np.floor(at[0]))
        rows = self._rows(start, int(np.floor(at[-1])) + 2)
        left = np.floor(at).astype(np.intp)
        part = (at - left).astype(np.float32)[:, None]
        left -= start
        mixed: Floats = rows[left] * (1 - part) + rows[left + 1] * part
        return mixed

    def _rows(self, start: int, stop: int) -> Floats:
        out = np.zeros((stop - start, self.channels), np.float32)
        first, last = max(start, 0), min(stop, len(self.samples))
        if first < last:
            out[first - start : last - start] = self.samples[first:last] / np.float32(FULL)
        return out

    def columns(self, first: float, last: float, count: int) -> Floats:
        """The waveform of a row of pixels.

        Args:
            first, last: seconds from the file's beginning at the left and the right edge.
            count: pixels.

        Returns:
            (count, 2) float32 in -1..1, lowest and highest sample of each pixel; NaN without sound.
        """
        edges = (np.linspace(first, last, count + 1) - self.start) * self.rate
        width = float(edges[1] - edges[0])
        wanted = int(width) // _QUARTER
        size = self.extremes.bin_size(wanted) if wanted >= BLOCK else 1
        total = -(-len(self.samples) // size)
        begins = np.floor(edges[:-1] / size).astype(np.int64)
        # A pixel includes the first sample of the next, so that the line has no breaks.
        ends = np.maximum(np.floor(edges[1:] / size).astype(np.int64) + 1, begins + 1)
        inside = (ends > 0) & (begins < total)
        out = np.full((count, 2), np.nan, np.float32)
        if inside.any():
            begins, ends = np.clip(begins[inside], 0, None), np.clip(ends[inside], None, total)
            low, high = self._range(int(begins[0]), int(ends[-1]), size)
            spans = np.stack([begins, ends], axis=1).ravel() - begins[0]
            # reduceat takes index pairs; an end beyond the array is the array's end.
            low, high = np.append(low, low[-1]), np.append(high, high[-1])
            out[inside, 0] = np.minimum.reduceat(low, spans)[::2] / FULL
            out[inside, 1] = np.maximum.reduceat(high, spans)[::2] / FULL
        return out

    def _range(self, first: int, last: int, size: int) -> tuple[Samples, Samples]:
        """The lowest and highest samples of bins, (N,) each, over all channels."""
        if size > 1:
            low, high = self.extremes.bins(first, last, size)
        else:
            low = high = self.samples[first:last]
        return low.min(axis=1), high.max(axis=1)


def read_sound(path: Path, stopped: Callable[[], bool] | None = None) -> Sound | None:
    """Read the first sound stream of any file that FFmpeg reads: WAV, MP3, M4A, MOV, ...

    Args:
        stopped: asked now and then; True gives up.

    Returns:
        The sound; None for a film without sound.

    Raises:
        FileError: it cannot be read, or has neither sound nor film.
        Unavailable: PyAV is not installed.
        Abandoned: `stopped` said so.
    """
    with opened(path) as container:
        stream = find_sound(container)
        if stream is None:
            if container.streams.audio:
                problem = "has sound in a format that FFmpeg does not know"
                raise FileError(path, problem, "convert it to WAV and use that")
            if find_film(container) is not None:
                return None
            raise FileError(path, "has neither sound nor film", "choose another file")
        hours = (container.duration or 0) / 3.6e9
        if hours > _LONGEST:
            raise FileError(path, f"is {hours:.1f} hours long", _CUT)
        tape = _Tape(path, stream)
        origin = tape.roll(container, stopped)
        began = _began(container, stream)
    if not tape.pieces:
        raise FileError(path, "has an empty sound track", "choose another file")
    samples = np.concatenate(tape.pieces)
    start = 0.0 if origin is None else tape.start - origin
    return Sound(path, tape.rate, samples, start, extremes_of(samples), began)


def _began(container: InputContainer, stream: AudioStream) -> float | None:
    """When a Broadcast WAV began, seconds since midnight; None for other files."""
    count, rate = container.metadata.get("time_reference", ""), stream.rate
    known = count.isdecimal() and len(count) <= 20  # 64 bits; files may contain anything
    return int(count) / rate if known and rate else None


class _Tape:
    """Collects the samples of a sound stream.

    Attributes:
        pieces: (n, C) int16 each, in order.
        rate: samples per second.
        start: the time of the first sample by the file's own clock, seconds.
    """

    def __init__(self, path: Path, stream: AudioStream) -> None:
        self._path, self._stream = path, stream
        self._channels = min(stream.codec_context.channels or 1, 2)
        self._resampler: AudioResampler | None = None
        self._written = 0
        self._silence = 0.0
        self.pieces: list[Samples] = []
        self.rate = 0
        self.start = 0.0

    def roll(self, container: InputContainer, stopped: Callable[[], bool] | None) -> float | None:
        """Decode all; returns the time of a film's first picture, None without a film."""
        from av.error import InvalidDataError

        film = find_film(container)
        first: int | None = None
        for packet in container.demux([self._stream, film] if film else [self._stream]):
            check(stopped)
            if packet.stream is film:
                if packet.size and not packet.is_discard and packet.pts is not None:
                    first = packet.pts if first is None else min(first, packet.pts)
                continue
            try:
                frames = packet.decode()
            except InvalidDataError:
                continue  # a damaged packet is a hole, not the end
            for frame in frames:
                self._add(cast("AudioFrame", frame))
        if self._resampler is not None:
            self._write(self._resampler.resample(None))
        return seconds(first, film.time_base) if film is not None else None

    def _add(self, frame: AudioFrame) -> None:
        from av import AudioResampler

        at = seconds(frame.pts, frame.time_base)
        if self._resampler is None:
            self.rate, self.start = frame.sample_rate, at or 0.0
            if not 0 < self.rate <= _FASTEST:
                problem = f"is damaged: it claims {self.rate} samples per second"
                raise FileError(self._path, problem, "convert it to WAV and use that")
            layout = "mono" if self._channels == 1 else "stereo"
            self._resampler = AudioResampler("s16", layout, self.rate)
        if at is not None:
            hole = at - self.start - self._written / self.rate
            if hole > _HOLE:
                self._silence += hole
                if self._silence > _MOST_SILENCE:
                    problem = f"has {self._silence / 60:.0f} minutes of gaps in its sound"
                    raise FileError(self._path, problem, _CUT)
                self.pieces.append(np.zeros((round(hole * self.rate), self._channels), np.int16))
                self._written += len(self.pieces[-1])
        frame.pts = None  # we fill holes ourselves
        self._write(self._resampler.resample(frame))

    def _write(self, frames: list[AudioFrame]) -> None:
        for frame in frames:
            packed = np.asarray(frame.to_ndarray(), np.int16)
            self.pieces.append(packed.reshape(-1, self._channels))
            self._written += len(self.pieces[-1])
            if self._written * self._channels > _MOST_SAMPLES:
                minutes = self._written / self.rate / 60
                raise FileError(self._path, f"has over {minutes:.0f} minutes of sound", _CUT)
