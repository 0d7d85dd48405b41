"""What was seen in rendered films is kept, and found again by what they show."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.face_films import speaking
from support.faces import shipped_rig

from faceedit_app.lab.evaluation.kept_films import KeptFilms
from faceedit_app.lab.evaluation.rendered_films import Conditions, Truth
from faceedit_app.tracking.film_landmarks import FilmLandmarks

TRUTH = Truth(speaking(10), np.arange(10) / 25.0)
PLAIN = Conditions("plain")


class Maker:
    """Makes landmarks, and counts how often."""

    def __init__(self) -> None:
        self.made = 0

    def __call__(self) -> FilmLandmarks:
        self.made += 1
        random = np.random.default_rng(self.made)
        points = random.normal(size=(10, 478, 3))
        colors = random.integers(0, 255, (10, 478, 3)).astype(np.uint8)
        lips = random.integers(0, 255, (10, 80, 3)).astype(np.uint8)
        path, times = Path("film.mp4"), TRUTH.times
        return FilmLandmarks(path, times, 25.0, None, (640, 480), points, np.ones(10), colors, lips)


def test_a_film_is_made_once_and_comes_back_as_it_was(tmp_path: Path) -> None:
    make = Maker()
    first = KeptFilms(tmp_path / "kept").of(shipped_rig(), TRUTH, PLAIN, make)
    again = KeptFilms(tmp_path / "kept").of(shipped_rig(), TRUTH, PLAIN, make)
    assert make.made == 1
    assert (again.rate, again.size) == (first.rate, first.size)
    for name in ("times", "points", "probabilities", "colors", "lips"):
        np.testing.assert_array_equal(getattr(again, name), getattr(first, name))


def test_another_film_is_another_one(tmp_path: Path) -> None:
    make, kept, rig = Maker(), KeptFilms(tmp_path), shipped_rig()
    other = replace(TRUTH, weights=TRUTH.weights * np.float32(0.5))
    kept.of(rig, TRUTH, PLAIN, make)
    kept.of(rig, other, PLAIN, make)
    kept.of(rig, TRUTH, replace(PLAIN, noise=1.0), make)
    kept.of(replace(rig, neutral=rig.neutral * np.float32(1.1)), TRUTH, PLAIN, make)
    assert make.made == 4


@pytest.mark.parametrize("content", [b"", b"no archive"])
def test_a_damaged_file_is_made_again(tmp_path: Path, content: bytes) -> None:
    make, kept = Maker(), KeptFilms(tmp_path)
    kept.of(shipped_rig(), TRUTH, PLAIN, make)
    (file,) = tmp_path.iterdir()
    file.write_bytes(content)
    kept.of(shipped_rig(), TRUTH, PLAIN, make)
    assert make.made == 2


def test_nothing_is_kept_without_a_folder() -> None:
    make = Maker()
    for _ in range(2):
        KeptFilms(None).of(shipped_rig(), TRUTH, PLAIN, make)
    assert make.made == 2
