"""What is kept beside a take to be drawn over its film."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest

from faceedit_app.core.errors import FileError
from faceedit_app.tracking.drawing import DRAWN
from faceedit_app.tracking.film_landmarks import FilmLandmarks
from faceedit_app.tracking.landmark_file import beside, read_landmarks, write_landmarks
from faceedit_app.tracking.person import Person
from faceedit_app.tracking.pose import Lens
from faceedit_app.tracking.tracker import Tracked


def some(path: Path) -> Tracked:
    random = np.random.default_rng(1)
    points = random.uniform(0, 300, (5, 478, 3))
    points[2] = np.nan
    colors = np.zeros((5, 478, 3), np.uint8)
    film = FilmLandmarks(
        path, np.arange(5) / 25, 25.0, None, (400, 300), points, np.ones(5), colors
    )
    lens = Lens(np.zeros(2), 800.0)
    person = Person(np.zeros((1, 3)), np.zeros(1, np.intp), lens, 0.0, np.ones((2, 2)))
    return Tracked(
        film, np.zeros((5, 52)), np.zeros((5, 3)), np.array([1, 1, 0, 0.49, 0.5]), person
    )


def test_what_is_drawn_comes_back_to_a_sixteenth_of_a_pixel(tmp_path: Path) -> None:
    tracked, take = some(tmp_path / "face.mp4"), tmp_path / "take.csv"
    write_landmarks(tracked, take)
    stored = read_landmarks(beside(take))
    assert stored.film == "face.mp4"
    places = stored.at(1)
    assert places is not None
    known = list(DRAWN)
    expected = tracked.landmarks.points[1, known, :2]
    np.testing.assert_allclose(places[known] * (400, 300), expected, atol=0.04)
    assert stored.at(2) is None
    assert stored.at(3) is None, "a gap"
    assert stored.at(4) is not None
    assert stored.at(99) is None
    assert stored.confidence[4] == pytest.approx(0.5, abs=0.01)


def damaged_inside() -> bytes:
    """An archive of which one member cannot be decompressed."""
    whole = io.BytesIO()
    np.savez_compressed(whole, numbers=np.arange(1000))
    content = whole.getvalue()
    return content[:60] + b"\xff" * 40 + content[100:]


@pytest.mark.parametrize(
    "content", [b"", b"no archive", b"PK\x05\x06" + bytes(18), damaged_inside()]
)
def test_something_else_is_one_line(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "take.landmarks.npz"
    path.write_bytes(content)
    with pytest.raises(FileError, match="track the film again"):
        read_landmarks(path)


def test_a_file_with_objects_is_refused(tmp_path: Path) -> None:
    """Unpickling could run anything."""
    path = tmp_path / "take.landmarks.npz"
    np.savez(path, numbers=np.array([{}], object))
    with pytest.raises(FileError):
        read_landmarks(path)
