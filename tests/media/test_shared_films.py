"""Real films, where they are at hand; none of them is part of the project."""

from __future__ import annotations

from pathlib import Path

import av
import numpy as np
import pytest
from support.places import SHARED

from faceedit_app.media.film import Film
from faceedit_app.media.sound import read_sound

FILMS = sorted((SHARED / "data" / "video").glob("*.mpg"))

pytestmark = pytest.mark.skipif(
    not FILMS, reason="no real films here; FACEEDIT_SHARED may name their folder"
)


@pytest.mark.parametrize("path", FILMS, ids=lambda path: path.name)
def test_any_picture_is_what_playing_through_gives(path: Path) -> None:
    film = Film(path)
    with av.open(str(path)) as container:
        frames = container.decode(video=0)
        through = [frame.reformat(format="bgra", threads=1).to_ndarray() for frame in frames]
    assert len(film) == len(through) == 75
    for index in np.random.default_rng(0).integers(0, len(film), 40).tolist():
        film._cache.clear()
        np.testing.assert_array_equal(film.picture(index), through[index])


@pytest.mark.parametrize("path", FILMS, ids=lambda path: path.name)
def test_a_film_and_its_sound_are_as_long(path: Path) -> None:
    sound = read_sound(path)
    assert sound is not None
    assert sound.start == pytest.approx(0.0, abs=0.05)
    assert sound.end == pytest.approx(Film(path).duration, abs=0.05)
