"""Write films as phones record them, to be tracked: at uneven times, and compressed as one likes.

`media/film_writer.py` writes the films that users get, at a steady rate and with sound.
"""

from __future__ import annotations

import io
from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path

from faceedit_app.core.arrays import Pixels, Times
from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.errors import Unavailable
from faceedit_app.media.container import file_errors

_CODECS = ("libx264", "libopenh264")
_RATE = 6_000_000  # bits a second, for the encoder that has no constant quality
_TICK = Fraction(1, 90_000)  # seconds; what MP4 players expect


def write_film(
    path: Path, pictures: Iterable[Pixels], times: Times, rate: float, crf: int = 18
) -> None:
    """Write a film without sound, completely or not at all.

    Args:
        path: an MP4.
        pictures: (H, W, 3) RGB each, all of one size; both sides even.
        times: when each is shown, seconds from the first.
        rate: nominal pictures per second.
        crf: x264's constant rate factor; more is smaller and worse.

    Raises:
        FileError: it cannot be written.
        Unavailable: PyAV has no H.264 encoder here.
    """
    import av
    from av.video.stream import VideoStream

    codec = next((name for name in _CODECS if name in av.codecs_available), None)
    if codec is None:
        raise Unavailable("Films cannot be written: PyAV has no H.264 encoder; run: pip install av")
    memory = io.BytesIO()
    with file_errors(path), av.open(memory, "w", format="mp4") as out:
        stream = out.add_stream(codec, rate=Fraction(rate).limit_denominator(60_000))
        assert isinstance(stream, VideoStream)
        stream.pix_fmt = "yuv420p"
        if codec == "libx264":
            # Threads would make the bytes depend on the machine.
            stream.options = {"crf": str(crf), "preset": "veryfast", "threads": "1"}
        else:
            stream.bit_rate = _RATE
        stream.codec_context.time_base = _TICK
        for number, (picture, seconds) in enumerate(zip(pictures, times.tolist(), strict=True)):
            if number == 0:
                stream.height, stream.width = picture.shape[:2]
            frame = av.VideoFrame.from_ndarray(picture, format="rgb24")
            frame.pts, frame.time_base = round(seconds / _TICK), _TICK
            out.mux(stream.encode(frame))
        out.mux(stream.encode(None))
    write_atomically(path, memory.getvalue())
