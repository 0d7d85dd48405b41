"""Recording from a webcam in the window; a film stands in for the webcam."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import av
import pytest
from av import VideoFrame
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from support.films import make_film
from support.windows import Bench, open_path, trigger

from faceedit_app.core.errors import FaceEditError, Unavailable
from faceedit_app.media import webcam
from faceedit_app.media.film import Film
from faceedit_app.media.webcam import Webcam
from faceedit_app.ui.commands.webcam import suggested_film
from faceedit_app.ui.media import webcam_dialog
from faceedit_app.ui.media.webcam_dialog import WebcamDialog
from faceedit_app.ui.start.window import MainWindow


class Webcams:
    """Webcams that show a film again and again.

    Attributes:
        found: those that are connected.
        ends: whether they end with the film, as if they were unplugged.
    """

    def __init__(self, film: Path) -> None:
        self.film, self.ends = film, False
        self.found = [Webcam("Desk", "desk"), Webcam("Window", "window")]
        self.opened: list[str] = []

    def frames(self, chosen: Webcam) -> Looping:
        self.opened.append(chosen.name)
        return Looping(self)


class Looping:
    """The pictures of `pictures_of`, about as fast as a webcam sends them."""

    def __init__(self, webcams: Webcams) -> None:
        self._webcams, self._pace = webcams, threading.Event()

    def __enter__(self) -> Looping:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def __iter__(self) -> Iterator[VideoFrame]:
        begun = 0
        while not self._webcams.ends:
            with av.open(str(self._webcams.film)) as container:
                for frame in container.decode(video=0):
                    self._pace.wait(0.003)  # else the thread would leave the window no time
                    frame.pts = (frame.pts or 0) + begun
                    yield frame
            begun += 600


@pytest.fixture
def webcams(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Webcams:
    film = make_film(tmp_path / "source.mp4", 10, stamps=list(range(0, 600, 60)))
    made = Webcams(film)
    monkeypatch.setattr(webcam, "webcams", lambda: made.found)
    monkeypatch.setattr(webcam, "pictures_of", made.frames)
    monkeypatch.setattr(webcam_dialog, "_SECOND_MS", 10)
    monkeypatch.setattr(webcam_dialog, "Microphone", no_microphone)
    return made


def no_microphone() -> object:
    raise Unavailable("No microphone can be used")


def opened(bench: Bench, window: MainWindow, film: Path) -> WebcamDialog:
    """The dialog, once it shows a picture."""
    bench.answers["record_name"] = film
    trigger(window, "record_webcam")
    found: list[WebcamDialog] = []

    def shows() -> bool:
        found[:] = window.findChildren(WebcamDialog)
        return bool(found) and found[-1].button.isEnabled()

    bench.qtbot.waitUntil(shows, timeout=20_000)
    return found[-1]


def recording(bench: Bench, dialog: WebcamDialog, seconds: float = 0.3) -> None:
    """Press Record, and wait for some of the film."""
    QTest.mouseClick(dialog.button, Qt.MouseButton.LeftButton)
    bench.qtbot.waitUntil(lambda: dialog.is_recording, timeout=20_000)
    bench.qtbot.waitUntil(lambda: dialog.status.text().startswith("Recording"))
    recorder = dialog._recorder
    assert recorder is not None
    bench.qtbot.waitUntil(lambda: recorder.seconds > seconds, timeout=20_000)


@pytest.fixture
def tracked(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """The films that were handed on to be tracked."""
    from faceedit_app.ui.commands.file import FileCommands

    films: list[Path] = []
    monkeypatch.setattr(FileCommands, "track", lambda _self, film: films.append(film))
    return films


Stop = Callable[[WebcamDialog], None]


@pytest.mark.parametrize(
    "stop",
    [
        lambda dialog: QTest.mouseClick(dialog.button, Qt.MouseButton.LeftButton),
        lambda dialog: QTest.keyClick(dialog, Qt.Key.Key_Escape),
    ],
    ids=["Stop", "Esc"],
)
def test_a_performance_is_counted_in_recorded_and_tracked(
    bench: Bench, webcams: Webcams, tracked: list[Path], tmp_path: Path, stop: Stop
) -> None:
    window = bench.window()
    dialog = opened(bench, window, tmp_path / "me.mp4")
    assert dialog.choice.isVisible()
    recording(bench, dialog)
    assert "No microphone" in dialog.status.text()
    stop(dialog)
    bench.qtbot.waitUntil(lambda: bool(tracked))
    assert tracked == [tmp_path / "me.mp4"]
    assert not dialog.isVisible()
    assert Film(tmp_path / "me.mp4").duration > 0.3
    assert not bench.errors


def test_cancel_before_recording_leaves_nothing(
    bench: Bench, webcams: Webcams, tracked: list[Path], tmp_path: Path
) -> None:
    window = bench.editing()
    dialog = opened(bench, window, tmp_path / "me.mp4")
    QTest.keyClick(dialog, Qt.Key.Key_Escape)
    bench.qtbot.waitUntil(lambda: not dialog.isVisible())
    assert not tracked
    assert not (tmp_path / "me.mp4").exists()
    assert open_path(window) == bench.take


def test_another_webcam_can_be_chosen(bench: Bench, webcams: Webcams, tmp_path: Path) -> None:
    dialog = opened(bench, bench.window(), tmp_path / "me.mp4")
    dialog.choice.setCurrentIndex(1)
    bench.qtbot.waitUntil(lambda: dialog.button.isEnabled() and webcams.opened[-1] == "Window")
    dialog.reject()


def test_a_webcam_that_is_unplugged_leaves_the_film(
    bench: Bench, webcams: Webcams, tracked: list[Path], tmp_path: Path
) -> None:
    dialog = opened(bench, bench.window(), tmp_path / "me.mp4")
    recording(bench, dialog)
    webcams.ends = True
    bench.qtbot.waitUntil(lambda: bool(tracked) and bool(bench.errors), timeout=20_000)
    assert "Desk was disconnected" in bench.errors[0]
    assert len(Film(tracked[0])) > 2


def test_without_a_webcam_one_line_says_what_to_do(bench: Bench, webcams: Webcams) -> None:
    webcams.found = []
    window = bench.editing()
    trigger(window, "record_webcam")
    bench.qtbot.waitUntil(lambda: bool(bench.errors))
    assert bench.errors[0].startswith("No webcam was found")
    assert open_path(window) == bench.take


def test_a_film_that_is_there_is_not_recorded_over(
    bench: Bench, webcams: Webcams, tmp_path: Path
) -> None:
    (tmp_path / "me.mp4").write_bytes(b"mine")
    bench.answers["record_name"] = tmp_path / "me.mp4"
    trigger(bench.window(), "record_webcam")
    bench.qtbot.waitUntil(lambda: bool(bench.errors))
    assert "exists" in bench.errors[0]
    assert (tmp_path / "me.mp4").read_bytes() == b"mine"


def test_closing_the_window_keeps_what_was_recorded(
    bench: Bench, webcams: Webcams, tracked: list[Path], tmp_path: Path
) -> None:
    window = bench.window()
    recording(bench, opened(bench, window, tmp_path / "me.mp4"))
    window.close()
    assert len(Film(tmp_path / "me.mp4")) > 2
    assert not tracked


def test_a_webcam_that_is_busy_says_so(
    bench: Bench, webcams: Webcams, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def busy(chosen: Webcam) -> object:
        raise FaceEditError(f"{chosen.name} cannot be opened (device or resource busy)")

    webcams.found = webcams.found[:1]
    monkeypatch.setattr(webcam, "pictures_of", busy)
    bench.answers["record_name"] = tmp_path / "me.mp4"
    window = bench.editing()
    trigger(window, "record_webcam")
    bench.qtbot.waitUntil(lambda: bool(bench.errors), timeout=20_000)
    assert "busy" in bench.errors[0]
    assert open_path(window) == bench.take


def test_the_name_of_a_film_that_exists_is_not_suggested(tmp_path: Path) -> None:
    assert suggested_film(tmp_path).name == "performance.mp4"
    (tmp_path / "performance.mp4").touch()
    assert suggested_film(tmp_path).name == "performance2.mp4"
