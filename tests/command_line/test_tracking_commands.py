"""`faceedit track` and what it says."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import av
import pytest
from support.face_films import face_pictures, make_face_film, speaking
from support.films import make_film
from support.tracker import needs_tracker

from faceedit_app.cli import main
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.opening import open_session
from faceedit_app.formats.opening import open_take
from faceedit_app.media import webcam
from faceedit_app.media.film import Film
from faceedit_app.media.webcam import WebcamRecorder

pytestmark = needs_tracker
FRAMES = 8  # the fewest


@pytest.fixture(scope="module")
def film(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("films")
    return make_face_film(folder / "face.mp4", face_pictures(speaking(FRAMES)))


def test_a_film_becomes_a_take(
    film: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    take = tmp_path / "me.csv"
    assert main(["track", str(film), "-o", str(take)]) == 0
    assert f"{take}: {FRAMES} frames at 25 fps" in capsys.readouterr().out
    assert len(open_take(take).clip) == FRAMES
    again = tmp_path / "fast.csv"
    assert main(["track", str(film), "-o", str(again), "--fps", "50"]) == 0
    assert f"{again}: {2 * FRAMES} frames at 50 fps" in capsys.readouterr().out
    assert len(open_take(again).clip) == 2 * FRAMES


def test_a_file_that_is_there_is_kept(
    film: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    take = tmp_path / "me.csv"
    take.write_text("my only recording")
    assert main(["track", str(film), "-o", str(take)]) == 0
    assert (tmp_path / "me.csv.bak").read_text() == "my only recording"
    assert "me.csv.bak" in capsys.readouterr().err


def test_the_film_itself_is_never_replaced(film: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = film.read_bytes()
    assert main(["track", str(film), "-o", str(film)]) == 2
    assert "does not end in .csv" in capsys.readouterr().err
    assert film.read_bytes() == before


def test_a_folder_is_tracked_and_what_fails_is_reported(
    film: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    films = tmp_path / "films"
    films.mkdir()
    (films / "a.mp4").write_bytes(film.read_bytes())
    (films / "A.mov").write_bytes(film.read_bytes())
    make_film(films / "b.mp4", frames=12)
    assert main(["track", str(films), "-o", str(tmp_path / "takes"), "--json"]) == 1
    said = capsys.readouterr()
    other, facts = sorted(json.loads(said.out), key=lambda one: str(one["path"]))
    assert facts["frames"] == other["frames"] == FRAMES
    assert facts["lost"] == 0
    assert (facts["path"], facts["rate"]) == (str(tmp_path / "takes" / "a.mp4_tracked.csv"), 25)
    assert facts["duration_s"] == pytest.approx(FRAMES / 25)
    assert "b.mp4: shows no face" in said.err
    assert sorted(path.name for path in (tmp_path / "takes").iterdir()) == [
        "A.mov_tracked.csv",
        "A.mov_tracked.landmarks.npz",
        "a.mp4_tracked.csv",
        "a.mp4_tracked.landmarks.npz",
    ]


def test_a_report_shows_edits(
    film: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    take, edits = tmp_path / "me.csv", tmp_path / "edits.json"
    assert main(["track", str(film), "-o", str(take)]) == 0
    session = open_session(take)
    session.add(Edit(("mouth_opening",), Op.OFFSET, 0.1, 0.3, 0.1, 5.0))
    session.save_edits(edits)
    report = ["--report", str(tmp_path / "report"), "--edits", str(edits)]
    assert main(["track", str(film), "-o", str(take), *report]) == 0
    assert sorted(path.name for path in (tmp_path / "report").iterdir()) == [
        "side_by_side.mp4",
        "side_by_side.png",
    ]


def test_a_webcam_is_recorded_until_it_ends(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A film stands in for the webcam; it is unplugged when the film is over."""
    source, film = make_film(tmp_path / "source.mp4", frames=20), tmp_path / "me.mp4"
    found = [webcam.Webcam("Desk", str(source)), webcam.Webcam("Other", "none")]
    monkeypatch.setattr(webcam, "webcams", lambda: found)
    begun, begin, pictures_of = threading.Event(), WebcamRecorder.begin, webcam.pictures_of

    @contextmanager
    def waiting(chosen: webcam.Webcam) -> Iterator[Iterator[av.VideoFrame]]:
        with pictures_of(chosen) as frames:
            assert begun.wait(20)
            yield frames

    def noted(recorder: WebcamRecorder, *given: Any) -> None:
        begin(recorder, *given)
        begun.set()

    monkeypatch.setattr(webcam, "pictures_of", waiting)
    monkeypatch.setattr(WebcamRecorder, "begin", noted)
    assert main(["webcam", str(film), "--webcam", "desk", "--no-sound"]) == 2
    said = capsys.readouterr()
    assert "Desk was disconnected" in said.err
    assert str(film) in said.out
    assert len(Film(film)) == 20
    assert main(["webcam", str(tmp_path / "b.mp4"), "--webcam", "roof"]) == 2
    assert "There is no webcam roof; there are Desk, Other" in capsys.readouterr().err
    assert main(["webcam", str(film), "--webcam", "desk", "--no-sound"]) == 2
    assert "exists; choose a new name" in capsys.readouterr().err
    found.clear()
    assert main(["webcam", str(tmp_path / "b.mp4")]) == 2
    assert "No webcam was found" in capsys.readouterr().err
    assert not (tmp_path / "b.mp4").exists()


def test_a_film_that_does_not_exist_says_what_to_check(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["track", str(tmp_path / "no.mp4"), "-o", str(tmp_path / "me.csv")]) == 2
    assert "no.mp4: does not exist; check the name" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("more", "problem"),
    [
        (["--face", "here"], "--face here: must be X,Y"),
        (["--face", "2,0"], "X and Y must be from 0 to 1"),
        (["--face", "0.5,0.5,-1"], "SECONDS must be 0 or more"),
        (["--face", "0.5,0.5,1,2"], "must be X,Y or X,Y,SECONDS"),
        (["--face", "0.02,0.98,0.2"], "shows no face at 0.02,0.98 after 0.20 s; choose a place"),
        (["--edits", "e.json"], "give --report"),
        (["--fps", "0"], "cannot have 0 frames"),
    ],
)
def test_wrong_options_are_one_line(
    film: Path, tmp_path: Path, more: list[str], problem: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["track", str(film), "-o", str(tmp_path / "me.csv"), *more]) == 2
    said = capsys.readouterr().err
    assert problem in said
    assert said.count("\n") == 1
    assert not (tmp_path / "me.csv").exists()


@pytest.mark.parametrize("name", ["take.glb", "take.json", "take", "TAKE.mp4"])
@pytest.mark.parametrize("command", ["track film.mp4 -o", "record --seconds 0.01"])
def test_a_csv_is_written_only_under_the_name_of_one(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    command: str,
    name: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "film.mp4").write_bytes(b"not read before the check")
    assert main([*command.split(), name]) == 2
    [said] = capsys.readouterr().err.splitlines()
    assert f"{name}: would be a Live Link Face CSV, but does not end in .csv; choose" in said
    assert not (tmp_path / name).exists()


@pytest.mark.parametrize(
    ("more", "problem"),
    [
        (["-o", "no/me.csv"], "no/me.csv: cannot be written (its folder does not exist)"),
        (["-o", "file/me.csv"], "file/me.csv: cannot be written (not a directory)"),
        (["-o", f"{'m' * 300}.csv"], ".csv: has too long a name; choose a shorter one"),
        (["--report", "file"], "file: cannot be a folder (file is a file)"),
        (["--report", "file/new"], "file/new: cannot be a folder (file is a file)"),
        (["--report", "new", "--edits", "file"], "file, line 1: is not JSON"),
        (["--report", "new", "--edits", "file", "--fps", "30"], "leave --fps out"),
    ],
)
def test_what_cannot_be_written_is_said_before_a_film_is_tracked(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    more: list[str],
    problem: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "film.mp4").write_bytes(b"not read before the check")
    (tmp_path / "file").write_text("mine")
    assert main(["track", "film.mp4", *more]) == 2
    [said] = capsys.readouterr().err.splitlines()
    assert problem in said
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "film.mp4"]


def test_films_are_not_tracked_into_a_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.mp4").write_bytes(b"")
    (tmp_path / "takes").write_text("mine")
    assert main(["track", str(tmp_path), "-o", str(tmp_path / "takes")]) == 2
    [said] = capsys.readouterr().err.splitlines()
    assert "takes: cannot be a folder" in said
    assert main(["track", str(tmp_path), "-o", str(tmp_path / "me.csv")]) == 2
    assert "me.csv: would be a folder of takes; give a folder" in capsys.readouterr().err
    assert (tmp_path / "takes").read_text() == "mine"
