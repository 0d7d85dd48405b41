"""Pictures written as a film."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from faceedit_app.core.errors import FileError
from faceedit_app.lab.evaluation.film_file import write_film
from faceedit_app.media.film import Film


def grey(count: int, size: tuple[int, int] = (480, 960)) -> list[NDArray[np.uint8]]:
    return [np.full((*size, 3), 20 * number, np.uint8) for number in range(count)]


def test_pictures_and_times_come_back(tmp_path: Path) -> None:
    times = np.array([0.0, 0.04, 0.1, 0.14, 0.3])
    write_film(tmp_path / "a.mp4", grey(5), times, 25.0)
    film = Film(tmp_path / "a.mp4")
    np.testing.assert_allclose(film.times, times, atol=1e-4)
    picture = film.picture(3)
    assert picture.shape == (480, 960, 4)
    assert picture[..., :3].mean() == pytest.approx(60, abs=3)
    film.close()


def test_the_same_pictures_give_the_same_bytes(tmp_path: Path) -> None:
    for name in "ab":
        write_film(tmp_path / f"{name}.mp4", grey(4), np.arange(4) / 25, 25.0)
    assert (tmp_path / "a.mp4").read_bytes() == (tmp_path / "b.mp4").read_bytes()


def test_nothing_is_written_if_it_fails(tmp_path: Path) -> None:
    def broken() -> object:
        yield from grey(2)
        raise FileError(tmp_path / "film.mp4", "is gone", "find it")

    with pytest.raises(FileError):
        write_film(tmp_path / "a.mp4", broken(), np.arange(4) / 25, 25.0)  # type: ignore[arg-type]
    with pytest.raises(FileError):
        write_film(tmp_path / "none" / "a.mp4", grey(2), np.arange(2) / 25, 25.0)
    assert not list(tmp_path.iterdir())
