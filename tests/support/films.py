"""Sounds and films for tests, made on the spot: a click track, and pictures that say which."""

from __future__ import annotations

import struct
import wave
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest
from av.video import VideoStream
from numpy.typing import NDArray

BITS, CELL = 10, 16  # a film's pictures carry their number as black and white squares
SIZE = (BITS * CELL, 2 * CELL)


def make_wav(
    path: Path, seconds: float = 2.0, rate: int = 8000, channels: int = 1, at: float = 0.5
) -> Path:
    """Silence, but for a burst of 0.1 s that begins at `at`; the right channel is half as loud."""
    samples = np.zeros((round(seconds * rate), channels), np.int16)
    burst = slice(round(at * rate), round((at + 0.1) * rate))
    count = len(samples[burst])
    tone = 20000 * np.sin(2 * np.pi * 440 * np.arange(count) / rate)
    samples[burst] = (tone[:, None] / np.arange(1, channels + 1)).astype(np.int16)
    with wave.open(str(path), "wb") as out:
        out.setnchannels(channels)
        out.setsampwidth(2)
        out.setframerate(rate)
        out.writeframes(samples.tobytes())
    return path


def make_broadcast_wav(path: Path, began: float) -> Path:
    """The same, in a Broadcast WAV that began so many seconds after midnight."""
    plain = make_wav(path).read_bytes()
    texts = bytes(256 + 32 + 32) + b"2026-01-01" + b"12:00:00"
    chunk = texts + struct.pack("<QH", round(began * 8000), 1) + bytes(254)
    bext = b"bext" + struct.pack("<I", len(chunk)) + chunk
    size = struct.pack("<I", len(plain) + len(bext) - 8)
    path.write_bytes(b"RIFF" + size + b"WAVE" + bext + plain[12:])
    return path


def numbered(number: int) -> NDArray[np.uint8]:
    """(H, W, 3): the number in binary, its highest bit at the left, over a light line."""
    picture = np.zeros((SIZE[1], SIZE[0], 3), np.uint8)
    for bit in range(BITS):
        if number >> (BITS - 1 - bit) & 1:
            picture[:CELL, bit * CELL : (bit + 1) * CELL] = 255
    picture[CELL:] = 128
    return picture


def damage_pictures(path: Path, which: slice) -> None:
    """Make pictures of a film, by their place in the file, impossible to decode."""
    with av.open(str(path)) as container:
        packets = [packet for packet in container.demux(video=0) if packet.size]
        places = [(packet.pos or 0, packet.size) for packet in packets[which]]
    data = bytearray(path.read_bytes())
    for place, size in places:
        data[place : place + size] = bytes(size)
    path.write_bytes(data)


def number_of(picture: NDArray[np.uint8]) -> int:
    """What `numbered` wrote, read from an upright picture."""
    row = picture[CELL // 2, CELL // 2 :: CELL, 1] > 128
    return int(sum(int(on) << (BITS - 1 - i) for i, on in enumerate(row)))


def make_film(
    path: Path,
    frames: int = 60,
    rate: int = 30,
    stamps: list[int] | None = None,
    gop: int = 12,
    b_frames: int = 2,
    sound: float | None = None,
    rotation: int = 0,
    codec: str = "libx264",
    timecode: str = "",
) -> Path:
    """A film whose pictures carry their numbers.

    Args:
        stamps: when each is shown, in 1/600 s; steady if None.
        gop: pictures between those at which decoding can begin.
        sound: seconds of the film at which a burst begins in its sound; None for no sound.
        rotation: by how much a player must turn the pictures against the clock, degrees.
    """
    if codec not in av.codecs_available:
        pytest.skip(f"FFmpeg was built without {codec}")
    base = Fraction(1, rate) if stamps is None else Fraction(1, 600)
    stamps = stamps or list(range(frames))
    with av.open(str(path), "w") as out:
        stream = out.add_stream(codec, rate=rate)
        assert isinstance(stream, VideoStream)
        stream.width, stream.height, stream.pix_fmt = *SIZE, "yuv420p"
        stream.codec_context.time_base = base
        stream.codec_context.gop_size = gop
        stream.codec_context.max_b_frames = b_frames
        tape = out.add_stream("aac", rate=8000, layout="mono") if sound is not None else None
        if timecode:
            stream.metadata["timecode"] = timecode
        if rotation:
            # What is stored is turned the other way.
            stream.set_display_rotation(rotation)
        for number, stamp in enumerate(stamps):
            frame = av.VideoFrame.from_ndarray(numbered(number))
            frame.pts, frame.time_base = stamp, base
            out.mux(stream.encode(frame))
        out.mux(stream.encode(None))
        if tape is not None:
            samples = np.zeros((1, round(frames / rate * 8000)), np.float32)
            start = round((sound or 0.0) * 8000)
            samples[0, start : start + 800] = np.sin(np.arange(800) * 2 * np.pi * 440 / 8000)
            whole = av.AudioFrame.from_ndarray(samples, format="fltp", layout="mono")
            whole.sample_rate, whole.pts, whole.time_base = 8000, 0, Fraction(1, 8000)
            out.mux(tape.encode(whole))
            out.mux(tape.encode(None))
    return path
