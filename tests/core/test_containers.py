"""Whether a file holds a film or sound alone is known by its content, whatever it is called."""

from __future__ import annotations

from pathlib import Path

import av
import numpy as np
from av.audio.stream import AudioStream

from faceedit_app.core.containers import Holds, holds, holds_film
from faceedit_app.lab.attacks.valid_media import media_readers


def kind_of(path: Path) -> Holds | None:
    with path.open("rb") as file:
        return holds(file)


def sound_alone(path: Path, codec: str) -> Path:
    with av.open(str(path), "w") as out:
        stream = out.add_stream(codec, rate=48_000, layout="mono")
        assert isinstance(stream, AudioStream)
        frame = av.AudioFrame.from_ndarray(np.zeros((1, 4800), np.int16), "s16", "mono")
        frame.sample_rate = 48_000
        out.mux(stream.encode(frame))
        out.mux(stream.encode(None))
    return path


def test_films_and_sounds_of_every_kind_are_told_apart(tmp_path: Path) -> None:
    for reader in media_readers(tmp_path):
        path = tmp_path / f"a{reader.ending}"
        path.write_bytes(reader.content)
        expected = Holds.SOUND if reader.name == "sounds" else Holds.FILM
        assert kind_of(path) is expected, reader.ending
        assert holds_film(path) == (expected is Holds.FILM)
    for ending, codec in ((".mp4", "aac"), (".mov", "pcm_s16le"), (".mkv", "pcm_s16le")):
        path = sound_alone(tmp_path / f"b{ending}", codec)
        assert kind_of(path) is Holds.SOUND, ending
    assert kind_of(sound_alone(tmp_path / "b.webm", "libopus")) is Holds.SOUND
    assert kind_of(sound_alone(tmp_path / "b.aiff", "pcm_s16be")) is Holds.SOUND


def test_a_film_that_was_cut_off_is_not_taken_for_one_that_may_be_replaced(tmp_path: Path) -> None:
    mp4 = next(one for one in media_readers(tmp_path) if one.ending == ".mp4").content
    path = tmp_path / "cut.mp4"
    path.write_bytes(mp4[: mp4.index(b"moov")])
    assert kind_of(path) is Holds.UNKNOWN
    path.write_bytes(b"\0\0\0\1" + b"mdat" + (1 << 62).to_bytes(8, "big") + b"\0\0\0\0moov")
    assert kind_of(path) is Holds.UNKNOWN


def test_what_is_neither_is_said_to_be_neither(tmp_path: Path) -> None:
    path = tmp_path / "a"
    for content in (b"", b"RIFF\0\0\0\0WEBP", b"Timecode,jawOpen\n", b"\0\0\0\x1cftypheic"):
        path.write_bytes(content)
        assert kind_of(path) is None, content
    for length in range(60):  # of Matroska, cut anywhere
        path.write_bytes((b"\x1aE\xdf\xa3\x80\x18\x53\x80\x67\x01" + b"\xff" * 60)[:length])
        assert kind_of(path) in (None, Holds.UNKNOWN)
    assert not holds_film(tmp_path)
