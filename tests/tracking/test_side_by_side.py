"""Film and face side by side."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from support.face_films import RATE, face_pictures, make_face_film, speaking
from support.faces import shipped_rig
from support.films import make_film
from support.tracker import needs_tracker

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.clip import Clip
from faceedit_app.core.errors import FileError
from faceedit_app.media.film import Film
from faceedit_app.tracking.drawing import DRAWN
from faceedit_app.tracking.landmark_file import StoredLandmarks
from faceedit_app.tracking.landmarker import LANDMARKS
from faceedit_app.tracking.side_by_side import HEIGHT, SideBySide, check_names, write_side_by_side
from faceedit_app.tracking.tracker import track_film


def test_a_gap_is_dark_until_it_is_filled(tmp_path: Path) -> None:
    film = Film(make_film(tmp_path / "film.mp4", frames=10, rate=25))
    weights = np.zeros((10, len(ARKIT_CHANNELS)), np.float32)
    times = np.arange(10) / 25
    whole = Clip(weights, ARKIT_CHANNELS, times, 25.0)
    seen = np.r_[:3, 6:10]
    gap = Clip(weights[seen], ARKIT_CHANNELS, times[seen], 25.0)
    stored = _landmarks(10)
    tracked, filled = SideBySide.of_take(film, stored, gap, whole, 0.0).faces
    assert np.flatnonzero(~tracked.is_there).tolist() == [3, 4, 5]
    assert filled.is_there.all()
    assert filled.rows.tolist() == list(range(10))
    assert len(SideBySide.of_take(film, stored, gap, gap, 0.0).faces) == 1, "nothing was edited"
    nods, shakes = (replace(whole, rotations=np.full((10, 9), by, np.float32)) for by in (0.1, 0.2))
    for follows, count in ((False, 1), (True, 2)):
        assert len(SideBySide.of_take(film, stored, nods, shakes, 0.0, follows).faces) == count
    with pytest.raises(FileError, match=r"film\.mp4: shows nothing of the take; move"):
        SideBySide.of_take(film, stored, gap, whole, 9.0)
    film.close()


def _landmarks(pictures: int) -> StoredLandmarks:
    """Landmarks of so many pictures without a face."""
    points = np.full((pictures, len(DRAWN), 2), np.nan)
    rows = np.full(LANDMARKS, -1, np.intp)
    return StoredLandmarks("film.mp4", (90, 60), points, np.zeros(pictures), rows)


def test_no_file_is_lost_beside_the_new_film(tmp_path: Path) -> None:
    film, output = tmp_path / "me.mp4", tmp_path / "both.mp4"
    film.touch()
    check_names(output, [film])
    with pytest.raises(FileError, match="would be written over"):
        check_names(film, [film])
    output.with_suffix(".png").touch()
    with pytest.raises(FileError, match=r"both\.png: is there already, and both\.mp4"):
        check_names(output, [film])
    output.touch()  # the user was asked whether to replace it
    check_names(output, [film])


@needs_tracker
def test_a_report_shows_film_tracked_and_edited_face(tmp_path: Path) -> None:
    times = np.delete(np.arange(12), [3, 4, 7, 9]) / RATE  # the camera left some out
    film = make_face_film(tmp_path / "face.mp4", face_pictures(speaking(8)), times.tolist())
    rig = shipped_rig()
    tracked = track_film(film, rig)
    weights = tracked.clip.weights.copy()
    weights[:, ARKIT_INDEX["jawOpen"]] = 0.8
    edited = replace(tracked.clip, weights=weights)
    mp4 = tmp_path / "both.mp4"
    mp4.write_text("my only recording")
    side_by_side = SideBySide.of_tracked(tracked, edited)
    straight, followed = side_by_side.faces
    turns = np.zeros((len(weights), 9), np.float32)
    turns[:, 0] = 0.6
    faces = straight, replace(followed, turns=turns)
    picture, backups = write_side_by_side(mp4, replace(side_by_side, faces=faces), rig)
    assert backups == (tmp_path / "both.mp4.bak", None)
    shown = np.asarray(Image.open(picture))
    assert shown.shape == (4 * (HEIGHT + 32) + 32, 3 * HEIGHT, 3)
    plain, changed = (shown[:, k * HEIGHT : (k + 1) * HEIGHT].astype(int) for k in (1, 2))
    assert np.abs(plain - changed).max() > 60
    brows = slice(32 + HEIGHT // 4, 32 + 2 * HEIGHT // 5)  # above what an open mouth moves
    assert np.abs(plain - changed)[brows].mean() > 5, "the head is turned"
    moving = Film(mp4)
    nearest = np.abs(moving.times[:, None] - tracked.landmarks.times).min(axis=0)
    assert nearest.max() < 1e-3, "each picture is shown at its time"
    assert len(moving) == pytest.approx(12, abs=1)
    high, wide = moving.picture(3).shape[:2]
    assert wide == pytest.approx(3 * high, abs=3)
    moving.close()
