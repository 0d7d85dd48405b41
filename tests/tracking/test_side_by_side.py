"""Film and face side by side."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from support.face_films import face_pictures, make_face_film, speaking
from support.faces import shipped_rig
from support.tracker import needs_tracker

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.media.film import Film
from faceedit_app.tracking.side_by_side import HEIGHT, SideBySide, write_side_by_side
from faceedit_app.tracking.tracker import track_film


@needs_tracker
def test_a_report_shows_film_tracked_and_edited_face(tmp_path: Path) -> None:
    film = make_face_film(tmp_path / "face.mp4", face_pictures(speaking(12)))
    rig = shipped_rig()
    tracked = track_film(film, rig)
    edited = tracked.clip.weights.copy()
    edited[:, ARKIT_INDEX["jawOpen"]] = 0.8
    picture, mp4 = write_side_by_side(
        tmp_path / "both.mp4", SideBySide.of_tracked(tracked, edited), rig
    )
    shown = np.asarray(Image.open(picture))
    assert shown.shape == (4 * HEIGHT, 3 * HEIGHT, 3)
    plain, changed = (shown[:, k * HEIGHT : (k + 1) * HEIGHT].astype(int) for k in (1, 2))
    assert np.abs(plain - changed).max() > 60
    moving = Film(mp4)
    assert len(moving) == 12
    np.testing.assert_allclose(moving.times, tracked.landmarks.times, atol=1e-3)
    high, wide = moving.picture(3).shape[:2]
    assert wide == pytest.approx(3 * high, abs=3)
    moving.close()
