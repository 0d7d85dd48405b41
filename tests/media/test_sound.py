"""Reading sound, and drawing it as few numbers."""

from __future__ import annotations

import os
import struct
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest
from av.audio import AudioStream
from support.films import make_film, make_wav
from support.places import SHARED

from faceedit_app.core.errors import FileError
from faceedit_app.media import beside, is_media
from faceedit_app.media.container import Abandoned, opened
from faceedit_app.media.sound import Sound, extremes_of, read_sound


def sound_of(samples: np.ndarray, rate: int = 1000) -> Sound:
    return Sound(Path("x.wav"), rate, samples, 0.0, extremes_of(samples))


def burst_in(sound: Sound) -> float:
    """Seconds of the file at which something begins to be heard."""
    return float(np.argmax(np.abs(sound.samples).max(axis=1) > 2000)) / sound.rate + sound.start


def test_a_wav_is_read_as_it_is(tmp_path: Path) -> None:
    sound = read_sound(make_wav(tmp_path / "a.wav", channels=2))
    assert sound is not None
    assert (sound.rate, sound.channels, len(sound.samples)) == (8000, 2, 16000)
    assert sound.end == pytest.approx(2.0)
    assert burst_in(sound) == pytest.approx(0.5, abs=0.002)
    left, right = np.abs(sound.samples.astype(int)).max(axis=0)
    assert left == pytest.approx(20000, abs=300)
    assert right == pytest.approx(10000, abs=300)


@pytest.mark.parametrize(("name", "codec"), [("a.mp3", "libmp3lame"), ("a.m4a", "aac")])
def test_compressed_sound_keeps_its_time(tmp_path: Path, name: str, codec: str) -> None:
    if codec not in av.codecs_available:
        pytest.skip(f"FFmpeg was built without {codec}")
    source = read_sound(make_wav(tmp_path / "a.wav", rate=16000))
    assert source is not None
    with av.open(str(tmp_path / name), "w") as out:
        stream = out.add_stream(codec, rate=16000, layout="mono")
        assert isinstance(stream, AudioStream)
        data = source.read(0, len(source.samples)).T
        frame = av.AudioFrame.from_ndarray(np.ascontiguousarray(data), "fltp", "mono")
        frame.sample_rate, frame.pts, frame.time_base = 16000, 0, Fraction(1, 16000)
        out.mux(stream.encode(frame))
        out.mux(stream.encode(None))
    sound = read_sound(tmp_path / name)
    assert sound is not None
    assert burst_in(sound) == pytest.approx(0.5, abs=0.01)


def test_the_sound_of_a_film_counts_from_its_first_picture(tmp_path: Path) -> None:
    stamps = [300 + 20 * i for i in range(60)]  # the film begins half a second late
    sound = read_sound(make_film(tmp_path / "a.mp4", stamps=stamps, sound=1.0))
    assert sound is not None
    assert sound.start == pytest.approx(-0.5, abs=0.03)
    assert burst_in(sound) == pytest.approx(0.5, abs=0.03)


def test_a_film_may_be_silent(tmp_path: Path) -> None:
    assert read_sound(make_film(tmp_path / "a.mp4", frames=5)) is None


def test_reading_between_samples_and_beyond_the_ends() -> None:
    sound = sound_of(np.array([[0], [16384], [-16384]], np.int16))
    assert sound.read(-1, 5)[:, 0].tolist() == [0, 0, 0.5, -0.5, 0]
    assert sound.read(0.5, 3, 0.5)[:, 0].tolist() == [0.25, 0.5, 0.0]
    assert sound.read(100, 2)[:, 0].tolist() == [0, 0]


@pytest.mark.parametrize("width", [3.0, 50.0, 700.0, 9000.0])
def test_each_pixel_shows_its_loudest_samples(width: float) -> None:
    rng = np.random.default_rng(0)
    samples = rng.integers(-30000, 30000, (200_000, 2)).astype(np.int16)
    samples[:100_000] //= 10
    sound = sound_of(samples)
    count, first = 40, 60_000.5
    columns = sound.columns(first / 1000, (first + count * width) / 1000, count)
    slack = max(1, width // 4)  # a pixel shows a little of its neighbours
    for i in range(count):
        start, stop = first + i * width, first + (i + 1) * width
        if start >= len(samples):
            assert np.isnan(columns[i]).all()
            continue
        inner = samples[int(start) : int(stop)]
        outer = samples[max(int(start - slack - 1), 0) : int(stop + slack + 2)]
        assert outer.min() / 32768 <= columns[i, 0] + 1e-6
        assert columns[i, 1] - 1e-6 <= outer.max() / 32768
        if len(inner):
            assert columns[i, 0] <= inner.min() / 32768 + 1e-6
            assert columns[i, 1] >= inner.max() / 32768 - 1e-6


def test_a_waveform_has_no_columns_before_and_after_the_sound() -> None:
    sound = sound_of(np.ones((500, 1), np.int16))
    columns = sound.columns(-1.0, 2.0, 30)
    heard = (~np.isnan(columns[:, 0])).nonzero()[0]
    assert set(range(10, 15)) <= set(heard.tolist()) <= set(range(9, 16))


def test_what_is_wrong_with_a_file_is_said_in_a_line(tmp_path: Path) -> None:
    text = tmp_path / "a.wav"
    text.write_text("this is no sound\n" * 100)
    whole = make_wav(tmp_path / "b.wav")
    empty = make_wav(tmp_path / "c.wav", seconds=0.0, at=9.0)
    (tmp_path / "d.m4a").write_bytes(b"")
    (tmp_path / "e.mov").write_bytes(whole.read_bytes()[:30])
    for name in (text.name, empty.name, "d.m4a", "e.mov", "gone.wav", "."):
        with pytest.raises(FileError) as caught:
            read_sound(tmp_path / name)
        assert "\n" not in str(caught.value)
        assert len(str(caught.value)) - len(str(tmp_path)) < 160


def test_a_cut_off_file_is_read_as_far_as_it_goes(tmp_path: Path) -> None:
    whole = make_wav(tmp_path / "a.wav").read_bytes()
    (tmp_path / "b.wav").write_bytes(whole[: len(whole) // 2])
    sound = read_sound(tmp_path / "b.wav")
    assert sound is not None
    assert sound.end == pytest.approx(1.0, abs=0.05)


def test_reading_can_be_given_up(tmp_path: Path) -> None:
    with pytest.raises(Abandoned):
        read_sound(make_wav(tmp_path / "a.wav"), lambda: True)


def test_what_lies_beside_a_take_under_its_name(tmp_path: Path) -> None:
    take = tmp_path / "slate_1_iPhone.csv"
    assert beside(take) == (None, None)
    film = tmp_path / "slate_1_iPhone.mov"
    film.touch()
    (tmp_path / "slate_1.wav").touch()
    assert beside(take) == (None, film)
    sound = tmp_path / "slate_1_iPhone.WAV"
    sound.touch()
    assert beside(tmp_path / "slate_1_iPhone_edited.csv") == (sound, film)
    assert is_media(sound)
    assert not is_media(take)


@pytest.mark.skipif(not SHARED.is_dir(), reason="needs the samples in shared/cases/hostile")
@pytest.mark.parametrize(
    ("name", "problem"),
    [
        ("film_with_apac_sound.mov", "has sound in a format that FFmpeg does not know"),
        ("sound_hole_96k.mkv", "has 118 minutes of gaps in its sound"),
        ("fuzz_media1_d8f3b8d3.avi", "it claims 1342193280 samples per second"),
        ("fuzz_media1_99c77a1e.wav", "has sound in a format that FFmpeg does not know"),
    ],
)
def test_a_small_file_cannot_ask_for_much_memory(name: str, problem: str) -> None:
    with pytest.raises(FileError, match=problem):
        read_sound(SHARED / "cases" / "hostile" / name)


def test_a_header_cannot_make_ffmpeg_take_hundreds_of_megabytes(tmp_path: Path) -> None:
    path, size = make_wav(tmp_path / "a.wav"), 300 << 20
    plain = path.read_bytes()
    with path.open("wb") as file:  # a name of the program that takes 300 MB, most of them a hole
        tag = b"INFOISFT" + struct.pack("<I", size)
        file.write(plain[:36] + b"LIST" + struct.pack("<I", size + len(tag)) + tag + b"Mine")
        file.seek(size - 4, os.SEEK_CUR)
        file.write(plain[36:])
    with opened(path) as container:
        assert "encoder" not in container.metadata
    sound = read_sound(path)
    assert sound is not None
    assert sound.end == pytest.approx(2.0)


def test_a_long_hole_in_a_sound_is_refused_before_it_is_filled(tmp_path: Path) -> None:
    with av.open(str(tmp_path / "a.mkv"), "w") as out:
        stream = out.add_stream("pcm_s16le", rate=8000, layout="mono")
        assert isinstance(stream, AudioStream)
        for pts in (0, 3600 * 8000):
            frame = av.AudioFrame.from_ndarray(np.zeros((1, 800), np.int16), "s16", "mono")
            frame.sample_rate, frame.pts, frame.time_base = 8000, pts, Fraction(1, 8000)
            out.mux(stream.encode(frame))
        out.mux(stream.encode(None))
    with pytest.raises(FileError, match="has 60 minutes of gaps in its sound; cut out"):
        read_sound(tmp_path / "a.mkv")


def test_a_pipe_is_refused_as_sound(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.wav")
    with pytest.raises(FileError, match="is not a regular file"):
        read_sound(tmp_path / "a.wav")


@pytest.mark.parametrize(
    ("take", "film"),
    [
        ("slate_1_iPhone_cal_edited.csv", "slate_1_iPhone.mov"),
        ("slate_1_iPhone_cal_edited_edited.csv", "slate_1_iPhone.mov"),
        ("talk_blendshape_data.csv", "talk.mp4"),
        ("talk_blendshape_data_edited.csv", "talk.mp4"),
        ("_edited.csv", "_edited.mov"),
    ],
)
def test_what_tools_add_to_the_name_of_a_take(take: str, film: str, tmp_path: Path) -> None:
    (tmp_path / film).touch()
    assert beside(tmp_path / take) == (None, tmp_path / film)
