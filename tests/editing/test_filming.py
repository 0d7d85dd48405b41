"""Films of a take, decoded again: pictures, sound, their times, and what giving up leaves."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from support.films import make_broadcast_wav, make_film, make_wav, number_of
from support.rigs import tiny_rig, tiny_take
from support.takes import make_livelink_csv

from faceedit_app import render
from faceedit_app.cli import main
from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.core.head import Head
from faceedit_app.editing.edits.media import MediaFile, Placement
from faceedit_app.editing.filming import Filmed, FilmView, Shot, film_take, media_of
from faceedit_app.formats.opening import open_take
from faceedit_app.media import film_writer
from faceedit_app.media.film import Film
from faceedit_app.media.film_writer import Encoder, FilmFormat
from faceedit_app.media.sound import read_sound

RIG = tiny_rig()
TAKE = tiny_take(frames=100, rate=50.0)
WEIGHTS = TAKE.clip.arkit_weights()


class Greys:
    """Paints the opening of the mouth as grey, 5 for each millimetre."""

    def __init__(self, _rig: object, width: int, height: int) -> None:
        self._size, self.closed = (height, width, 4), False

    def draw(self, vertices: Any, _camera: object, smooth: bool) -> NDArray[np.uint8]:
        assert smooth
        return np.full(self._size, grey_of(float(vertices[1, 1] - vertices[0, 1])), np.uint8)

    def prepare(self) -> None:
        pass

    def close(self) -> None:
        self.closed = True


def grey_of(opening: float) -> int:
    return min(round(opening * 1000 * 5), 255)


@pytest.fixture(autouse=True)
def greys(monkeypatch: pytest.MonkeyPatch) -> list[Greys]:
    opened: list[Greys] = []

    def open_renderer(rig: object, width: int, height: int) -> Greys:
        opened.append(Greys(rig, width, height))
        return opened[-1]

    monkeypatch.setattr(render, "open_renderer", open_renderer)
    return opened


def film(path: Path, media: Placement | None = None, **options: Any) -> Filmed:
    shot = Shot(**({"size": (96, 64)} | options))
    done = film_take(TAKE, WEIGHTS, RIG, media or Placement(), path, shot)
    assert done is not None
    return done


def pictures_of(path: Path) -> list[NDArray[np.uint8]]:
    with av.open(str(path)) as container:
        frames = [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]
        return [np.asarray(frame, np.uint8) for frame in frames]


def openings(weights: NDArray[np.float32]) -> list[int]:
    """The greys of frames."""
    return [grey_of(float(v[1, 1] - v[0, 1])) for v in map(RIG.vertices, weights)]


@pytest.mark.parametrize("ending", [".mp4", ".webm"])
def test_every_frame_becomes_a_picture_in_its_place(ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"face{ending}"
    done = film(path)
    assert (done.frames, done.rate) == (100, 50)
    again = Film(path)
    assert len(again) == 100
    np.testing.assert_allclose(again.times, np.arange(100) / 50, atol=1e-3)
    again.close()
    shown = [float(picture[:, :, 1].mean()) for picture in pictures_of(path)]
    np.testing.assert_allclose(shown, openings(WEIGHTS), atol=4)
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_mpeg_4_does_where_there_is_no_h264(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    mp4 = film_writer.FILM_FORMATS[0]
    other = (Encoder("no_such_codec", "None"), *mp4.video[-1:])
    fewer = (replace(mp4, video=other), *film_writer.FILM_FORMATS[1:])
    monkeypatch.setattr(film_writer, "FILM_FORMATS", fewer)
    assert film(tmp_path / "face.mp4").codecs == "MPEG-4"
    assert len(pictures_of(tmp_path / "face.mp4")) == 100


def test_without_any_encoder_one_line_says_so(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    none = FilmFormat("mp4", "MP4", ".mp4", (Encoder("no_such_codec", "H.264"),))
    monkeypatch.setattr(film_writer, "FILM_FORMATS", (none,))
    with pytest.raises(FaceEditError, match=r"MP4 needs an encoder for H\.264"):
        film(tmp_path / "face.mp4")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("rate", "count"), [(25.0, 50), (24000 / 1001, 48), (60.0, 120)])
def test_another_rate(rate: float, count: int, tmp_path: Path) -> None:
    path = tmp_path / "face.mp4"
    assert film(path, rate=rate).frames == count
    with av.open(str(path)) as container:
        assert container.streams.video[0].average_rate == Fraction(rate).limit_denominator(60000)
        assert sum(1 for _ in container.decode(video=0)) == count


def test_a_gap_shows_what_the_window_shows(tmp_path: Path) -> None:
    clip = replace(TAKE.clip, times=TAKE.clip.times + np.where(np.arange(100) < 50, 0.0, 0.5))
    path = tmp_path / "face.mp4"
    done = film_take(replace(TAKE, clip=clip), WEIGHTS, RIG, Placement(), path, Shot(size=(64, 64)))
    assert done is not None
    assert done.frames == 125
    frames = [clip.frame_at(number / 50) for number in range(125)]
    shown = [float(picture[:, :, 1].mean()) for picture in pictures_of(path)]
    np.testing.assert_allclose(shown, openings(WEIGHTS[frames]), atol=4)


@pytest.mark.parametrize("ending", [".mp4", ".webm"])
@pytest.mark.parametrize("offset", [0.0, 0.4, -0.3])
def test_the_sound_is_where_it_is_in_the_take(ending: str, offset: float, tmp_path: Path) -> None:
    wav = make_wav(tmp_path / "talk.wav", at=0.5, rate=44100, channels=2)
    path = tmp_path / f"face{ending}"
    film(path, Placement(MediaFile(wav, offset)))
    sound = read_sound(path)
    assert sound is not None
    assert sound.channels == 2
    loud = np.abs(sound.samples.astype(int)).max(axis=1) > 4000
    began = sound.start + float(np.argmax(loud)) / sound.rate
    assert began == pytest.approx(0.5 + offset, abs=0.02)
    assert sound.end == pytest.approx(2.0, abs=0.06)


def test_both_faces_are_side_by_side(tmp_path: Path) -> None:
    path = tmp_path / "both.mp4"
    edited = WEIGHTS.copy()
    edited[:, :] = 0
    assert (
        film_take(TAKE, edited, RIG, Placement(), path, Shot(FilmView.BOTH, size=(128, 64)))
        is not None
    )
    for number, picture in enumerate(pictures_of(path)):
        assert picture.shape == (64, 128, 3)
        left, right = picture[:, :56, 1].mean(), picture[:, 72:, 1].mean()
        assert left == pytest.approx(openings(WEIGHTS[number : number + 1])[0], abs=5)
        assert right == pytest.approx(grey_of(0.002), abs=5)


@pytest.mark.parametrize("rate", [50.0, 25.0])
def test_the_head_turns_if_it_is_followed(rate: float, tmp_path: Path) -> None:
    turns = np.zeros((len(WEIGHTS), 9), np.float32)
    turns[:, 2] = np.linspace(0, 1.2, len(turns))  # rolled, the mouth opens aside
    take = replace(TAKE, clip=replace(TAKE.clip, rotations=turns))
    edited = (turns / 2).astype(np.float32)
    head = Head(RIG)

    def greys_of(rotations: NDArray[np.float32]) -> list[int]:
        rows = range(0, 100, round(50 / rate))
        turned = [head.turned(RIG.vertices(WEIGHTS[k]), rotations[k]) for k in rows]
        return [grey_of(float(v[1, 1] - v[0, 1])) for v in turned]

    for follows in (False, True):
        path = tmp_path / f"both_{follows}.mp4"
        shot = Shot(FilmView.BOTH, size=(128, 64), rate=rate, follows_head=follows)
        assert film_take(take, WEIGHTS, RIG, Placement(), path, shot, rotations=edited) is not None
        pictures = pictures_of(path)
        left = [picture[:, :56, 1].mean() for picture in pictures]
        right = [picture[:, 72:, 1].mean() for picture in pictures]
        still = np.zeros_like(turns)
        assert left == pytest.approx(greys_of(turns if follows else still), abs=6)
        assert right == pytest.approx(greys_of(edited if follows else still), abs=6)


def test_the_film_plays_beside_the_face(tmp_path: Path) -> None:
    source = make_film(tmp_path / "source.mp4", frames=30, rate=25)
    wide = Film(source).frame_at(0).shape
    path = tmp_path / "beside.mp4"
    size = (2 * wide[1], wide[0])
    media = Placement(film=MediaFile(source, 0.2))
    film(path, media, view=FilmView.FILM, size=size, rate=25.0)
    found = [number_of(picture[:, : wide[1]]) for picture in pictures_of(path)]
    assert found == [0] * 5 + list(range(30)) + [0] * 15


@pytest.mark.parametrize("view", [FilmView.FILM_ABOVE, FilmView.FILM_BELOW])
def test_the_film_plays_above_or_below_the_face(view: FilmView, tmp_path: Path) -> None:
    source = make_film(tmp_path / "source.mp4", frames=30, rate=25)
    high, wide = Film(source).frame_at(0).shape[:2]
    path = tmp_path / "stacked.mp4"
    media = Placement(film=MediaFile(source, 0.2))
    film(path, media, view=view, size=(wide, 2 * high), rate=25.0)
    shown = pictures_of(path)
    assert shown[0].shape == (2 * high, wide, 3)
    rows = slice(0, high) if view is FilmView.FILM_ABOVE else slice(high, None)
    found = [number_of(picture[rows]) for picture in shown]
    assert found == [0] * 5 + list(range(30)) + [0] * 15


def test_pictures_are_numbered_in_a_folder(tmp_path: Path) -> None:
    wav = make_wav(tmp_path / "talk.wav", seconds=3)
    folder = tmp_path / "pictures"
    film(folder, Placement(MediaFile(wav)), form="png", rate=25.0)
    names = sorted(path.name for path in folder.iterdir())
    assert names == [*(f"{number:06d}.png" for number in range(1, 51)), "sound.wav"]
    with Image.open(folder / "000001.png") as picture:
        assert picture.size == (96, 64)
    sound = read_sound(folder / "sound.wav")
    assert sound is not None
    assert sound.end == pytest.approx(2.0)
    with pytest.raises(FileError, match="not an empty folder"):
        film(folder, form="png")


@pytest.mark.parametrize("form", ["mp4", "webm", "png"])
def test_giving_up_leaves_what_was_there(form: str, tmp_path: Path, greys: list[Greys]) -> None:
    path = tmp_path / "face"
    if form != "png":
        path.write_text("an earlier film")
    seen: list[tuple[int, int]] = []
    done = film_take(
        TAKE, WEIGHTS, RIG, Placement(), path, Shot(size=(64, 64), form=form),
        lambda count, of: seen.append((count, of)), lambda: len(seen) == 10,
    )  # fmt: skip
    assert done is None
    assert seen == [(number, 100) for number in range(1, 11)]
    assert [p.name for p in tmp_path.iterdir()] == ([] if form == "png" else ["face"])
    assert all(renderer.closed for renderer in greys)


def test_what_cannot_be_filmed_is_said_in_one_line(tmp_path: Path) -> None:
    with pytest.raises(FaceEditError, match="no film to show with the face"):
        film(tmp_path / "a.mp4", view=FilmView.FILM)
    with pytest.raises(FaceEditError, match=r"must end in \.mp4 or \.webm"):
        film(tmp_path / "a.avi")
    with pytest.raises(FileError, match="cannot be written"):
        film(tmp_path / "nowhere" / "a.mp4")
    with pytest.raises(FileError, match="missing"):
        film(tmp_path / "a.mp4", Placement(MediaFile(tmp_path / "gone.wav")))
    assert list(tmp_path.iterdir()) == []


def test_odd_sizes_are_made_even(tmp_path: Path) -> None:
    film(tmp_path / "a.mp4", size=(97, 65), view=FilmView.BOTH)
    assert pictures_of(tmp_path / "a.mp4")[0].shape == (64, 96, 3)


def test_what_lies_beside_a_take_is_placed_by_its_clock(tmp_path: Path) -> None:
    take = open_take(make_livelink_csv(tmp_path / "take.csv"))
    assert media_of(take) == Placement()
    assert take.clip.timecodes is not None
    wav = make_broadcast_wav(tmp_path / "take.wav", 12 * 3600 + 0.5)
    placed = media_of(take).sound
    assert placed is not None
    assert placed.path == wav
    assert placed.offset == pytest.approx(0.5, abs=0.02)


def test_sound_without_a_clock_begins_with_the_file_of_a_take_that_has_no_face_at_first(
    tmp_path: Path,
) -> None:
    take = open_take(make_livelink_csv(tmp_path / "take.csv", untracked=range(30)))
    make_wav(tmp_path / "take.wav")
    placed = media_of(take).sound
    assert placed is not None
    assert placed.offset == pytest.approx(-0.5, abs=1e-6)
    make_broadcast_wav(tmp_path / "take.wav", 12 * 3600 + 0.5)
    placed = media_of(take).sound
    assert placed is not None
    assert placed.offset == pytest.approx(0.0, abs=0.02)


def test_the_command_films_a_take(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    take = make_livelink_csv(tmp_path / "take.csv")
    make_wav(tmp_path / "take.wav")
    out = tmp_path / "take.mp4"
    command = ["render", str(take), "-o", str(out), "--size", "64x64", "--film-fps", "30"]
    assert main(command) == 0
    said = capfd.readouterr().out
    assert said.startswith(f"{out}: 60 pictures at 30 fps, ")
    assert "AAC" in said
    with av.open(str(out)) as container:
        assert container.streams.audio
    out = out.rename(tmp_path / "first.mp4")  # beside the take, it would be taken for its film
    command[3] = str(out)
    assert main([*command, "--silent"]) == 0
    with av.open(str(out)) as container:
        assert not container.streams.audio
    assert main([*command, "--view", "side"]) == 2
    assert "--view side: must be face, both, film" in capfd.readouterr().err
