"""Tracking a film from the window."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from PySide6.QtCore import QPointF, Qt
from PySide6.QtTest import QTest
from support.face_films import RATE, SIZE, face_pictures, make_face_film, speaking
from support.films import make_film, make_wav
from support.media import settle
from support.tracker import needs_tracker
from support.windows import Bench, drop, editor_of, open_path, session_of, trigger

from faceedit_app import tracking
from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.controls import CONTROL_INDEX, LIP_OPENING
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.tracking import side_by_side, tracker
from faceedit_app.tracking.film_landmarks import Progress
from faceedit_app.ui.commands.tracking import suggested_take
from faceedit_app.ui.media.tracking_dialog import TrackingDialog
from faceedit_app.ui.start.window import MainWindow

pytestmark = needs_tracker


@pytest.fixture(scope="module")
def film(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A second of the character speaking; rendered before a window replaces the renderer."""
    return make_face_film(tmp_path_factory.mktemp("film") / "face.mp4", face_pictures(speaking(25)))


@pytest.fixture
def own(film: Path, tmp_path: Path) -> Path:
    """The film in a folder of this test."""
    path = tmp_path / film.name
    path.write_bytes(film.read_bytes())
    return path


def dialog_of(window: MainWindow) -> TrackingDialog:
    found = window.findChildren(TrackingDialog)
    assert found
    return found[-1]


def tracked(bench: Bench, window: MainWindow, take: Path) -> None:
    """Wait until the take is open, with its film."""
    bench.qtbot.waitUntil(lambda: window.document.path == take, timeout=60_000)
    settle(bench, window)


def test_a_film_becomes_a_take_beside_its_film(bench: Bench, own: Path) -> None:
    window = bench.window()
    take = own.with_name("face.csv")
    bench.answers |= {"film_to_track": own, "save_take": take}
    said: list[str] = []
    window.status.messageChanged.connect(said.append)
    trigger(window, "track_film")
    assert window.workspace.unfinished.names == ["face.csv"]  # closing asks about it
    tracked(bench, window, take)
    assert any(text.startswith("Tracked 25 frames of") for text in said)
    assert not any("found beside" in text for text in said), "it matters less"
    assert window.workspace.unfinished.names == []
    assert not any(dialog.isVisible() for dialog in window.findChildren(TrackingDialog))
    assert len(session_of(window).take.clip) == 25
    assert window.media.film is not None
    assert window.media.film.path == own
    assert not bench.errors
    bench.qtbot.waitUntil(lambda: window.media.overlay.stored is not None)
    screen = editor_of(window).film.screen_
    bench.qtbot.waitUntil(lambda: screen.index == screen.wanted)
    shown = screen.grab().toImage()
    trigger(window, "film_landmarks")
    assert screen.grab().toImage() != shown


def test_a_film_dropped_on_the_empty_window_is_tracked(bench: Bench, own: Path) -> None:
    window = bench.window()
    bench.answers["save_take"] = own.with_name("elsewhere.csv")
    drop(window, own)
    tracked(bench, window, own.with_name("elsewhere.csv"))
    # The take has another name: the film is added all the same.
    bench.qtbot.waitUntil(lambda: window.media.film is not None)


def test_cancel_keeps_the_open_take(bench: Bench, own: Path) -> None:
    window = bench.editing()
    take = own.with_name("face.csv")
    bench.answers |= {"film_to_track": own, "save_take": take}
    trigger(window, "track_film")
    QTest.keyClick(dialog_of(window), Qt.Key.Key_Escape)
    bench.qtbot.waitUntil(lambda: "not tracked" in window.status.currentMessage(), timeout=60_000)
    assert open_path(window) == bench.take
    assert not take.exists()
    assert not window.actions_["film_landmarks"].isChecked(), "the open take has none"
    assert window.workspace.unfinished.names == []


def test_a_film_without_a_face_is_one_message(bench: Bench, tmp_path: Path) -> None:
    window = bench.editing()
    bench.answers |= {
        "film_to_track": make_film(tmp_path / "n.mp4"),
        "save_take": tmp_path / "n.csv",
    }
    trigger(window, "track_film")
    bench.qtbot.waitUntil(lambda: bool(bench.errors), timeout=30_000)
    assert "shows no face" in bench.errors[0]
    assert open_path(window) == bench.take
    assert not (tmp_path / "n.csv").exists()


def _broken(path: Path) -> None:
    path.write_bytes(b"no film at all" * 40)


def _sound_only(path: Path) -> None:
    path.write_bytes(make_wav(path.with_suffix(".wav")).read_bytes())


def _photo(path: Path) -> None:
    Image.new("RGB", (64, 64)).save(path, "JPEG")


def _animated(path: Path) -> None:
    frames = [Image.new("RGB", (64, 64), (5 * i, 0, 0)) for i in range(12)]
    frames[0].save(path, "GIF", save_all=True, append_images=frames[1:], duration=40)


def _slow(path: Path) -> None:
    make_film(path, frames=12, rate=2)


NO_FILMS: dict[Callable[[Path], object], str] = {
    Path.touch: "cannot be read",
    Path.mkdir: "is not a regular file",
    _broken: "cannot be read",
    _sound_only: "has no pictures",
    _photo: "is a picture, not a film",
    _animated: "is a picture, not a film",
    _slow: "has 2 pictures a second",
}


def test_what_is_no_film_is_one_message_and_the_take_stays(bench: Bench, tmp_path: Path) -> None:
    window = bench.editing()
    for number, (make, said) in enumerate(NO_FILMS.items()):
        (folder := tmp_path / str(number)).mkdir()
        path = folder / "film.mp4"
        make(path)
        bench.errors.clear()
        bench.answers |= {"film_to_track": path, "save_take": folder / "new.csv"}
        trigger(window, "track_film")
        bench.qtbot.waitUntil(lambda: bool(bench.errors), timeout=30_000)
        assert said in bench.errors[0]
        assert "\n" not in bench.errors[0]
        assert open_path(window) == bench.take
        assert not list(folder.glob("new*"))
        bench.qtbot.waitUntil(lambda: not window.workspace.unfinished.names, timeout=30_000)
    # Where nothing can be written, it says so before the film is looked at.
    bench.errors.clear()
    bench.answers |= {"film_to_track": path, "save_take": tmp_path / "missing" / "new.csv"}
    trigger(window, "track_film")
    assert "new.csv: cannot be written" in bench.errors[0]
    assert not window.workspace.unfinished.names


def test_a_click_on_the_picture_tracks_the_face_there(
    bench: Bench, own: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    faces: list[Any] = []
    real = tracker.track_film

    def noted(*given: Any, **named: Any) -> Any:
        faces.append(given[4])
        return real(*given, **named)

    monkeypatch.setattr(tracking.tracker, "track_film", noted)
    window = bench.window()
    take = own.with_name("face.csv")
    bench.answers |= {"film_to_track": own, "save_take": take}
    trigger(window, "track_film")
    dialog = dialog_of(window)
    assert not dialog.hint.isVisible()
    bench.qtbot.waitUntil(lambda: dialog.bar.value() > 0, timeout=30_000)
    assert dialog.hint.isVisible(), "another one may be clicked"
    picture = dialog.picture
    middle = QPointF(picture.width() / 2, picture.height() / 2).toPoint()
    QTest.mouseClick(picture, Qt.MouseButton.LeftButton, pos=middle)
    tracked(bench, window, take)
    assert faces[0] is None
    if len(faces) > 1:  # else it was done before the click
        np.testing.assert_allclose((faces[1].x, faces[1].y), (0.5, 0.5), atol=0.02)


def test_of_two_faces_the_clicked_one_is_tracked(
    bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The large face speaks; the small one, at the right, keeps still."""
    speaks = face_pictures(speaking(25))
    still = face_pictures(np.zeros((1, len(ARKIT_INDEX)), np.float32), size=240)[0]
    side = np.zeros((SIZE, 240, 3), np.uint8)
    side[:240] = still
    both = [np.concatenate([large, side], axis=1) for large in speaks]
    film = make_face_film(tmp_path / "two.mp4", both)
    clicked = threading.Semaphore(0)
    report = TrackingDialog.report

    def held(dialog: TrackingDialog, progress: Progress) -> None:
        report(dialog, progress)
        if progress.seconds == 2 / RATE:  # until the user has clicked
            assert clicked.acquire(timeout=30)

    monkeypatch.setattr(TrackingDialog, "report", held)
    window, said = bench.window(), list[str]()
    window.workspace.warning.connect(said.append)
    bench.answers |= {"film_to_track": film, "save_take": tmp_path / "two.csv"}
    trigger(window, "track_film")
    dialog = dialog_of(window)
    bench.qtbot.waitUntil(dialog.largest.isVisible, timeout=30_000)
    assert dialog.status.text() == "2 faces: click the one to track"

    def click(x: float, y: float) -> None:
        room = dialog.picture._room()
        place = room.topLeft() + QPointF(x * room.width(), y * room.height())
        QTest.mouseClick(dialog.picture, Qt.MouseButton.LeftButton, pos=place.toPoint())

    right = (SIZE + 120) / (SIZE + 240)
    click(right, 0.95)  # beside both
    assert dialog.largest.isVisible()
    QTest.mouseClick(dialog.largest, Qt.MouseButton.LeftButton)
    assert not dialog.largest.isVisible()
    bench.qtbot.waitUntil(lambda: dialog.bar.value() > 0, timeout=30_000)
    click(right, 0.95)  # below the small face: the large one is followed as before
    clicked.release()
    bench.qtbot.waitUntil(lambda: bool(said), timeout=30_000)
    assert "shows no face at" in said[0]
    click(right, 120 / SIZE)
    clicked.release(10)
    tracked(bench, window, tmp_path / "two.csv")
    opening = session_of(window).achieved[:, CONTROL_INDEX[LIP_OPENING]]
    assert np.ptp(opening) < 2.0


def test_the_name_of_a_take_that_exists_is_not_suggested(tmp_path: Path) -> None:
    assert suggested_take(tmp_path / "me.mov") == tmp_path / "me.csv"
    (tmp_path / "me.csv").touch()
    assert suggested_take(tmp_path / "me.mov") == tmp_path / "me_tracked.csv"


def test_film_and_face_are_exported_side_by_side(
    bench: Bench, own: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[side_by_side.SideBySide] = []

    def noted(output: Path, shown: side_by_side.SideBySide, *_rest: object) -> object:
        made.append(shown)
        return output.with_suffix(".png"), (None, None)

    monkeypatch.setattr(side_by_side, "write_side_by_side", noted)
    window = bench.window()
    take = own.with_name("face.csv")
    bench.answers |= {"film_to_track": own, "save_take": take}
    trigger(window, "track_film")
    tracked(bench, window, take)
    bench.qtbot.waitUntil(lambda: window.media.overlay.stored is not None)
    add = Edit(("mouth_opening",), Op.OFFSET, 0.2, 0.5, 0.1, 4.0)
    session_of(window).add(add)
    for turns in (False, True):
        bench.answers["save_side_by_side"] = own.with_name("both.mp4")
        assert window.editor is not None
        window.editor.face.follow_head(turns)
        trigger(window, "side_by_side")
        bench.qtbot.waitUntil(lambda: "both.mp4" in window.status.currentMessage() and bool(made))
        window.status.clearMessage()
        shown = made.pop()
        assert all((face.turns is not None) == turns for face in shown.faces)
    assert shown.film == own
    assert len(shown.faces) == 2
    for face in shown.faces:
        assert face.rows.tolist() == list(range(25))
        assert face.is_there.all()
    assert shown.places(3) is not None


def test_a_face_that_comes_later_keeps_its_film_in_time(bench: Bench, tmp_path: Path) -> None:
    dark = [np.full((SIZE, SIZE, 3), 60, np.uint8)] * 6
    film = make_face_film(tmp_path / "late.mp4", [*dark, *face_pictures(speaking(14))])
    window = bench.window()
    bench.answers |= {"film_to_track": film, "save_take": tmp_path / "late.csv"}
    trigger(window, "track_film")
    tracked(bench, window, tmp_path / "late.csv")
    assert window.media.film is not None
    assert window.media.film.offset == pytest.approx(-6 / RATE, abs=1e-3)
    assert window.document.is_clean
