"""The film beside the face: the picture of the frame, mirrored, out of reach."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QRectF, QSize
from PySide6.QtGui import QImage, QPainter
from support.films import make_film
from support.media import FakeOutput, settle, shown, with_media
from support.takes import make_livelink_csv
from support.waiting import run_events
from support.windows import Bench, editor_of, session_of, trigger

from faceedit_app.tracking.landmarker import LANDMARKS
from faceedit_app.ui.media.film_pane import FilmPlace, best_place
from faceedit_app.ui.media.landmark_paint import paint_landmarks


def test_the_film_shows_the_picture_of_the_frame(bench: Bench, devices: list[FakeOutput]) -> None:
    window = with_media(bench, make_film(bench.folder / "a.mp4", 60, 30))
    for seconds in (0.0, 1.0, 0.5, 0.499, 1.95, 0.7, 0.02):
        window.timeline.go_to_time(seconds)
        expected = int((window.timeline.time + 5e-4) * 30)
        assert shown(bench, window) == expected
    window.timeline.go_to_time(1.0)
    editor_of(window).film.offset.setValue(0.4)
    assert shown(bench, window) == 18


def rgb(image: QImage, x: int, y: int) -> tuple[int, int, int]:
    color = image.pixelColor(x, y)
    return color.red(), color.green(), color.blue()


def test_a_mirrored_film_is_shown_as_in_a_mirror_and_kept_in_the_project(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    window = bench.editing()
    assert not window.actions_["mirror_film"].isEnabled()
    window.media.add(make_film(bench.folder / "a.mp4", 60, 30))
    settle(bench, window)
    window.timeline.go_to_time(1.0)
    shown(bench, window)
    screen = editor_of(window).film.screen_
    plain = screen.grab().toImage()
    steps = session_of(window).state
    trigger(window, "mirror_film")
    assert window.actions_["mirror_film"].isChecked()
    mirrored = screen.grab().toImage()
    assert mirrored != plain
    differ = [
        abs(a - b)
        for y in range(0, plain.height(), 7)
        for x in range(0, plain.width(), 3)
        for a, b in zip(rgb(mirrored, x, y), rgb(plain, plain.width() - 1 - x, y), strict=True)
    ]
    assert np.mean(differ) < 3.0
    assert session_of(window).state == steps, "no step: it is a way to look"
    bench.answers["save_project"] = bench.folder / "p.faceedit"
    trigger(window, "save")
    again = bench.window(bench.folder / "p.faceedit")
    settle(bench, again)
    assert again.media.mirrored
    assert again.actions_["mirror_film"].isChecked()
    other = make_livelink_csv(bench.folder / "another.csv", seconds=1.0)
    again.commands.file.open(other)
    bench.qtbot.waitUntil(lambda: again.document.path == other)
    assert not again.media.mirrored


@pytest.mark.usefixtures("qapp")
def test_landmarks_do_not_hide_a_small_face() -> None:
    """The points of an eye's control, painted over eyes that are 40 and 400 pixels apart."""
    places = np.full((LANDMARKS, 2), np.nan)
    places[[33, 263, 386, 374]] = (0.3, 0.4), (0.7, 0.4), (0.7, 0.4), (0.7, 0.4)
    painted = []
    for side in (100, 1000):
        image = QImage(side, side, QImage.Format.Format_Grayscale8)
        image.fill(0)
        painter = QPainter(image)
        paint_landmarks(painter, places, QRectF(0, 0, side, side))
        painter.end()
        painted.append(int((np.frombuffer(image.constBits(), np.uint8) > 64).sum()))
    small, large = painted
    assert 0 < small <= 6
    assert 20 < large < 60


def test_outside_of_the_film_it_says_where_it_is(bench: Bench, devices: list[FakeOutput]) -> None:
    window = with_media(bench, make_film(bench.folder / "a.mp4", 30, 30))
    screen = editor_of(window).film.screen_
    window.timeline.go_to_time(2.5)
    assert screen.index == -1
    assert screen._note == "The film ended at 0:01.000"
    window.media.move_film(2.0)
    assert shown(bench, window) == 15
    window.timeline.go_to_time(0.5)
    assert screen._note == "The film begins at 0:02.000"
    screen.grab()


def test_sound_and_picture_of_a_film_move_together(bench: Bench, devices: list[FakeOutput]) -> None:
    window = with_media(bench, make_film(bench.folder / "a.mp4", sound=1.0))
    editor = editor_of(window)
    editor.sound.offset.setValue(0.3)
    assert window.media.film is not None
    assert window.media.film.offset == 0.3
    assert editor.film.offset.value() == 0.3


def test_a_film_that_vanishes_says_so(bench: Bench, devices: list[FakeOutput]) -> None:
    path = make_film(bench.folder / "a.mp4", 300, 30, gop=10)
    window = with_media(bench, path)
    screen = editor_of(window).film.screen_
    assert shown(bench, window) == 0
    bench.qtbot.waitUntil(lambda: screen._film is not None and screen._film.cached(12) is not None)
    assert screen._film is not None
    screen._film.close()
    screen._film._cache.clear()
    path.unlink()
    window.timeline.go_to_time(2.0)
    bench.qtbot.waitUntil(lambda: "is missing" in screen._note, timeout=10_000)


@pytest.mark.parametrize("place", ["above", "below", "beside"])
def test_the_film_lies_where_it_was_put_and_stays_there(
    place: str, bench: Bench, devices: list[FakeOutput]
) -> None:
    window = bench.editing()
    window.show()
    assert not window.actions_[f"film_{place}"].isEnabled(), "there is no film yet"
    window.media.add(make_film(bench.folder / "a.mp4", 60, 30))
    settle(bench, window)
    trigger(window, f"film_{place}")
    page = editor_of(window)
    film, face = page.film.geometry(), page.face.geometry()
    lies = {
        "beside": film.right() < face.left(),
        "above": film.bottom() < face.top(),
        "below": face.bottom() < film.top(),
    }
    assert [name for name, there in lies.items() if there] == [place]
    assert min(film.width(), film.height(), face.width(), face.height()) >= 140
    ticked = [n for n in ("beside", "above", "below") if window.actions_[f"film_{n}"].isChecked()]
    assert ticked == [place]
    again = bench.editing()
    assert editor_of(again).film_place == place


@pytest.mark.parametrize("place", ["above", "below", "beside"])
def test_film_and_face_are_whole_in_a_small_window(
    place: str, bench: Bench, devices: list[FakeOutput]
) -> None:
    window = bench.editing()
    window.resize(1000, 600)
    window.show()
    window.media.add(make_film(bench.folder / "a.mp4", 60, 30))
    settle(bench, window)
    trigger(window, f"film_{place}")
    page = editor_of(window)
    run_events()
    for pane in (page.film, page.face):
        bottom = pane.mapTo(page.side, pane.rect().bottomLeft())
        assert bottom.y() < page.lists.y(), "the lists hide a part of it"
    assert page.face.height() >= 100


def test_a_film_with_its_own_sound_has_one_offset_field(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    window = with_media(bench, make_film(bench.folder / "a.mp4", sound=1.0))
    editor = editor_of(window)
    assert not editor.sound.offset.isHidden()
    assert editor.film.offset.isHidden(), "the sound's moves both"
    window.media.remove_sound()
    assert not editor.film.offset.isHidden()


@pytest.mark.parametrize(
    ("film", "faces", "place"),
    [
        ((1920, 1080), (7, 10), FilmPlace.ABOVE),
        ((1080, 1920), (7, 10), FilmPlace.BESIDE),
        ((1080, 1920), (14, 10), FilmPlace.BESIDE),
        ((1000, 1000), (7, 10), FilmPlace.BESIDE),
        ((1000, 1000), (14, 10), FilmPlace.ABOVE),
    ],
)
def test_the_place_makes_film_and_face_large(
    film: tuple[int, int], faces: tuple[int, int], place: FilmPlace
) -> None:
    assert best_place(QSize(*film), QSize(*faces), QSize(580, 500), QSize(580, 590)) is place


def test_a_wide_film_lies_above_the_face_until_it_is_gone_or_put_elsewhere(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    path = make_film(bench.folder / "a.mp4", 60, 30)
    window = with_media(bench, path)
    page = editor_of(window)
    bench.qtbot.waitUntil(lambda: page.film_place is FilmPlace.ABOVE)
    trigger(window, "remove_film")
    assert page.film_place is FilmPlace.BESIDE
    window.media.add(path)
    bench.qtbot.waitUntil(lambda: page.film_place is FilmPlace.ABOVE)
    page.settle_layout()
    assert page.film_place is FilmPlace.BESIDE, "the next take may have no film"
    trigger(window, "film_beside")
    trigger(window, "show_both")
    assert page.film_place is FilmPlace.BESIDE
    trigger(window, "remove_film")
    window.media.add(path)
    bench.qtbot.waitUntil(lambda: page.film.screen_.shape is not None)
    assert page.film_place is FilmPlace.BESIDE
