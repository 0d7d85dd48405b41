"""Any picture of a film by its number: pictures that carry their number say whether it is so."""

from __future__ import annotations

import os
import struct
import threading
from pathlib import Path

import av
import numpy as np
import pytest
from support.face_films import make_face_film
from support.films import SIZE, damage_pictures, make_film, number_of

from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.media.container import Abandoned
from faceedit_app.media.film import Film, Projector
from faceedit_app.media.limits import most_pixels, threads_for


@pytest.fixture
def film(tmp_path: Path) -> Film:
    return Film(make_film(tmp_path / "a.mp4"))


def test_every_picture_is_the_right_one_in_any_order(film: Film) -> None:
    assert len(film) == 60
    assert film.rate == pytest.approx(30.0)
    assert film.duration == pytest.approx(2.0)
    order = np.random.default_rng(0).permutation(60).tolist()
    for index in [*order, *range(60), *range(59, -1, -1)]:
        film._cache.clear()
        assert number_of(film.picture(index)) == index


@pytest.mark.parametrize(
    ("name", "codec", "b_frames"), [("a.mov", "libx264", 3), ("a.mpg", "mpeg2video", 2)]
)
@pytest.mark.parametrize("gop", [1, 7, 250])
def test_whatever_the_file_is_like(
    tmp_path: Path, name: str, codec: str, b_frames: int, gop: int
) -> None:
    film = Film(make_film(tmp_path / name, 50, 25, gop=gop, b_frames=b_frames, codec=codec))
    for index in (40, 41, 3, 49, 0, 20, 19):
        film._cache.clear()
        assert number_of(film.picture(index)) == index
    film.close()
    assert number_of(film.picture(7)) == 7


def test_files_that_do_not_tell_when_pictures_are_shown(tmp_path: Path) -> None:
    film = Film(make_film(tmp_path / "a.avi", 30, 30, b_frames=0, codec="mpeg4"))
    for index in (20, 4, 29):
        assert number_of(film.picture(index)) == index


def test_a_picture_is_shown_until_the_next_begins(film: Film) -> None:
    assert film.index_at(-1.0) == 0
    assert film.index_at(0.0333) == 1
    assert film.index_at(0.0666) == 2
    assert film.index_at(0.065) == 1
    assert film.index_at(99.0) == 59
    assert number_of(film.frame_at(1.017)) == 30


def test_phones_record_with_a_varying_rate(tmp_path: Path) -> None:
    stamps = np.cumsum([0, *np.random.default_rng(1).integers(8, 40, 39)]).tolist()
    film = Film(make_film(tmp_path / "a.mov", stamps=stamps))
    np.testing.assert_allclose(film.times, np.array(stamps) / 600, atol=1e-6)
    for index, stamp in enumerate(stamps):
        assert number_of(film.frame_at(stamp / 600 + 0.002)) == index


@pytest.mark.parametrize("turn", [90, 180, 270])
def test_phones_say_how_to_turn_the_picture(tmp_path: Path, turn: int) -> None:
    picture = Film(make_film(tmp_path / "a.mov", rotation=turn)).picture(5)
    upright = np.rot90(picture, -turn // 90)
    assert upright.shape == (SIZE[1], SIZE[0], 4)
    assert number_of(upright) == 5
    assert picture.flags.c_contiguous


@pytest.mark.parametrize("width", [640, 642, 644])
def test_pictures_of_any_width_are_whole(tmp_path: Path, width: int) -> None:
    levels = [60, 200, 90, 230]
    pictures = [np.full((48, width, 3), level, np.uint8) for level in levels]
    film = Film(make_face_film(tmp_path / "plain.mp4", pictures))
    for index in range(len(levels)):
        assert np.ptp(film.picture(index)[..., :3]) <= 6, index
    film.close()


def test_a_damaged_stretch_shows_what_is_there(tmp_path: Path) -> None:
    path = make_film(tmp_path / "a.mov", frames=120, gop=10)
    data = bytearray(path.read_bytes())
    data[len(data) // 3 : len(data) // 3 + 400] = bytes(400)
    path.write_bytes(data)
    film = Film(path)
    assert number_of(film.picture(2)) == 2
    for index in range(0, 120, 3):
        film.picture(index)


def test_a_film_whose_beginning_is_damaged_begins_where_it_is_not(tmp_path: Path) -> None:
    path = make_film(tmp_path / "a.mov", frames=60, gop=10)
    damage_pictures(path, slice(8))
    film = Film(path)
    first = number_of(film.picture(0))
    assert 0 < film.index_at(first / film.rate) <= 10
    assert number_of(film.picture(30)) == 30
    assert film.damaged == {0}
    film.picture(first - 1)
    film.picture(first)
    assert film.damaged == {0, first - 1}


def test_a_picture_that_claims_to_be_huge_is_damaged_and_takes_no_memory(tmp_path: Path) -> None:
    path = make_film(tmp_path / "a.webm", frames=30, gop=10, b_frames=0, codec="libvpx")
    before, _, after = path.read_bytes().rpartition(b"\x9d\x01\x2a" + struct.pack("<HH", *SIZE))
    path.write_bytes(before + b"\x9d\x01\x2a" + struct.pack("<HH", 16383, 16383) + after)
    film = Film(path)
    assert [number_of(film.picture(index)) for index in (0, 19, 20, 29)] == [0, 19, 19, 19]
    assert film.damaged == {20, 29}


def test_a_film_may_not_claim_larger_pictures_than_its_size_allows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = make_film(tmp_path / "a.mp4", frames=5)
    assert (most_pixels(path), threads_for(path)) == (1920 * 1080, 1)
    with path.open("ab") as file:
        file.truncate(64 << 20)
    assert (most_pixels(path), threads_for(path)) == (40_000_000, min(os.cpu_count() or 1, 16))
    monkeypatch.setattr("faceedit_app.media.limits._MOST_PIXELS", 160 * 32 - 1)
    with pytest.raises(FileError, match="has pictures of 160 x 32 pixels, too large for its size"):
        Film(path)


@pytest.mark.parametrize(
    ("name", "codec", "kept"),
    [("a.mkv", "libx264", 0.5), ("a.avi", "mpeg4", 0.7), ("a.mpg", "mpeg2video", 1.0)],
)
def test_a_film_that_breaks_off_says_how_much_is_missing(
    tmp_path: Path, name: str, codec: str, kept: float
) -> None:
    path = make_film(tmp_path / name, frames=90, gop=10, b_frames=0, codec=codec)
    assert Film(path).remarks == ()
    whole = path.read_bytes()
    path.write_bytes(whole[: round(kept * len(whole))])
    film = Film(path)
    missing = 3.0 - film.duration
    said = f"the film breaks off: its last {missing:.1f} s are missing in the file"
    assert film.remarks == ((said,) if kept < 1 else ())
    assert kept == 1 or missing > 0.5


def test_sound_that_is_longer_than_the_film_is_not_missing(tmp_path: Path) -> None:
    assert Film(make_film(tmp_path / "a.mp4", stamps=[0, 20, 40, 60], sound=0.1)).remarks == ()


def test_of_two_films_in_a_file_the_first_is_used_which_is_said(tmp_path: Path) -> None:
    one = make_film(tmp_path / "one.mp4")
    with av.open(str(one)) as source, av.open(str(tmp_path / "two.mkv"), "w") as out:
        packets = [packet for packet in source.demux(video=0) if packet.size]
        streams = [out.add_stream_from_template(source.streams.video[0]) for _ in range(2)]
        for stream in streams:
            for packet in packets:
                packet.stream = stream
                out.mux(packet)
    film = Film(tmp_path / "two.mkv")
    assert film.remarks == ("the file holds 2 films: the first is used",)
    assert number_of(film.picture(7)) == 7


def test_pictures_without_times_are_no_film(tmp_path: Path) -> None:
    make_film(tmp_path / "a.h264").rename(tmp_path / "a.mp4")
    with pytest.raises(FileError, match="does not say when its pictures are shown; convert it"):
        Film(tmp_path / "a.mp4")


def test_what_is_wrong_is_said_in_a_line(tmp_path: Path, film: Film) -> None:
    (tmp_path / "b.mov").write_bytes(b"no film" * 50)
    for path in (tmp_path / "b.mov", tmp_path / "gone.mov"):
        with pytest.raises(FileError) as caught:
            Film(path)
        assert "\n" not in str(caught.value)
    film.path.unlink()
    with pytest.raises(FileError, match="is missing"):
        film.picture(0)
    with pytest.raises(FileError):
        Film(film.path, lambda: True)


def test_indexing_can_be_given_up(tmp_path: Path) -> None:
    with pytest.raises(Abandoned):
        Film(make_film(tmp_path / "a.mp4", frames=5), lambda: True)


def test_memory_is_bounded(film: Film, monkeypatch: pytest.MonkeyPatch) -> None:
    one = film.picture(0).nbytes
    monkeypatch.setattr("faceedit_app.media.film._MEMORY", 10 * one)
    for index in range(40):
        film.picture(index)
    assert film.cached(39) is not None
    assert film.cached(0) is None
    assert film._bytes <= 10 * one


def test_the_projector_shows_the_last_wish_and_reads_ahead(film: Film) -> None:
    shown: list[int] = []
    arrived = threading.Condition()
    errors: list[FaceEditError] = []

    def ready(index: int) -> None:
        with arrived:
            shown.append(index)
            arrived.notify()

    projector = Projector(film, ready, errors.append)
    for wish in (3, 50, 20):
        projector.want(wish)
    with arrived:
        assert arrived.wait_for(lambda: 20 in shown, timeout=10)
    until = threading.Event()
    for _ in range(500):
        if film.cached(30) is not None:
            break
        until.wait(0.01)
    picture = film.cached(30)
    assert picture is not None
    assert number_of(picture) == 30
    projector.close()
    assert not errors


def test_the_projector_tells_that_the_film_is_gone(film: Film) -> None:
    film.path.unlink()
    failed = threading.Event()
    projector = Projector(film, lambda _: None, lambda _: failed.set())
    projector.want(3)
    assert failed.wait(10)
    projector.close()
