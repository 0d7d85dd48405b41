"""Webcams: a film stands in for one, and sounds for a microphone."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import av
import numpy as np
import pytest
from support.films import SIZE, make_film, number_of

from faceedit_app.core.arrays import Floats, Pixels
from faceedit_app.core.errors import FaceEditError, FileError, Unavailable
from faceedit_app.media import microphone, webcam
from faceedit_app.media.film import Film
from faceedit_app.media.growing_film import GrowingFilm
from faceedit_app.media.sound import read_sound
from faceedit_app.media.webcam import Webcam, WebcamRecorder, webcams

STAMPS = [0, 20, 40, 80, 100, 130, 150, 170, 190, 210]  # 1/600 s, as webcams in the dark


@pytest.fixture
def source(tmp_path: Path) -> Path:
    return make_film(tmp_path / "source.mp4", 10, stamps=STAMPS)


def frames_of(film: Path) -> list[av.VideoFrame]:
    with av.open(str(film)) as container:
        return list(container.decode(video=0))


def device(name: str, said: str, media: list[str], default: bool = False) -> SimpleNamespace:
    return SimpleNamespace(name=name, description=said, media_types=media, is_default=default)


def listing(monkeypatch: pytest.MonkeyPatch, *devices: SimpleNamespace) -> None:
    monkeypatch.setattr(av, "enumerate_input_devices", lambda _kind: list(devices))


@pytest.mark.parametrize(
    ("system", "address"),
    [("linux", "two"), ("win32", "video=two"), ("darwin", "two:none")],
)
def test_webcams_are_listed_for_each_system(
    monkeypatch: pytest.MonkeyPatch, system: str, address: str
) -> None:
    listing(
        monkeypatch,
        device("one", "Inside", ["video"]),
        device("mic", "Microphone", ["audio"]),
        device("two", "Outside", ["video"], default=True),
    )
    monkeypatch.setattr(sys, "platform", system)
    found = webcams()
    assert [one.name for one in found] == ["Outside", "Inside"]
    assert found[0].address == address


def test_a_system_without_webcams_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    def none(_kind: str) -> Any:
        raise ValueError("no such input format")

    monkeypatch.setattr(av, "enumerate_input_devices", none)
    with pytest.raises(Unavailable, match="Track a film"):
        webcams()


def test_a_webcam_that_cannot_be_opened_is_one_line(tmp_path: Path) -> None:
    said: list[FaceEditError] = []
    recorder = WebcamRecorder(Webcam("Desk", str(tmp_path / "none"), "v4l2"), print, said.append)
    wait(lambda: bool(said))
    recorder.close()
    assert str(said[0]).startswith("Desk cannot be ")
    assert "close other programs" in str(said[0])


def wait(done: Callable[[], bool]) -> None:
    """Until the recorder's thread has done something."""
    ends = time.monotonic() + 20
    event = threading.Event()
    while not done():
        assert time.monotonic() < ends
        event.wait(0.005)


class Gate:
    """Holds a webcam back until it may send its pictures."""

    def __init__(self) -> None:
        self.shown: list[Pixels] = []
        self.first, self.more = threading.Event(), threading.Event()

    def __call__(self, picture: Pixels) -> None:
        self.shown.append(picture)
        if len(self.shown) == 3:
            self.first.set()
            assert self.more.wait(20)


def test_a_recording_begins_when_asked_and_keeps_the_times(source: Path, tmp_path: Path) -> None:
    gate, said, film = Gate(), list[FaceEditError](), tmp_path / "film.mp4"
    recorder = WebcamRecorder(Webcam("Film", str(source)), gate, said.append)
    assert gate.first.wait(20)
    recorder.begin(film)
    gate.more.set()
    wait(lambda: bool(said))  # the film is over
    assert "was disconnected" in str(said[0])
    assert recorder.end()
    recorder.close()
    recorded = Film(film)
    np.testing.assert_allclose(recorded.times, (np.array(STAMPS[3:]) - STAMPS[3]) / 600, atol=1e-3)
    assert [number_of(recorded.picture(i)[..., :3]) for i in range(7)] == list(range(3, 10))
    recorded.close()
    assert len(gate.shown) == 10
    assert gate.shown[0].shape == (SIZE[1], SIZE[0], 4)


def test_closing_while_recording_keeps_the_film(source: Path, tmp_path: Path) -> None:
    gate, film = Gate(), tmp_path / "film.mp4"
    recorder = WebcamRecorder(Webcam("Film", str(source)), gate, lambda error: None)
    assert gate.first.wait(20)
    recorder.begin(film)
    gate.more.set()
    wait(lambda: recorder.seconds > 0.1)
    recorder.close()
    assert len(Film(film)) >= 2


def test_a_recording_without_a_picture_leaves_no_file(source: Path, tmp_path: Path) -> None:
    said, film = list[FaceEditError](), tmp_path / "film.mp4"
    recorder = WebcamRecorder(Webcam("Film", str(source)), lambda picture: None, said.append)
    wait(lambda: bool(said))
    recorder.begin(film)
    assert not recorder.end()
    recorder.close()
    assert not film.exists()


def test_a_film_is_never_overwritten(tmp_path: Path) -> None:
    film = tmp_path / "film.mp4"
    film.write_bytes(b"mine")
    with pytest.raises(FileError, match="exists"):
        GrowingFilm(film)
    with pytest.raises(FileError, match="cannot be written"):
        GrowingFilm(tmp_path / "nowhere" / "film.mp4")
    assert film.read_bytes() == b"mine"


def test_what_was_recorded_before_a_crash_can_be_read(tmp_path: Path) -> None:
    """The process ends without closing the film."""
    source, film = make_film(tmp_path / "long.mp4", 100, b_frames=0), tmp_path / "film.mp4"
    script = f"""
import av, os
from pathlib import Path
from faceedit_app.media.growing_film import GrowingFilm
film = GrowingFilm(Path({str(film)!r}))
with av.open({str(source)!r}) as container:
    for frame in container.decode(video=0):
        film.add(frame)
os._exit(1)
"""
    subprocess.run([sys.executable, "-c", script], check=False, timeout=60)
    assert len(Film(film)) >= 60


class FakeStream:
    """Stands in for a microphone: the test says what it hears."""

    def __init__(self, callback: Callable[..., None], **_: object) -> None:
        self.hear, self.is_open = callback, True

    def start(self) -> None:
        pass

    def close(self) -> None:
        self.is_open = False


def fake_microphone(monkeypatch: pytest.MonkeyPatch) -> tuple[microphone.Microphone, FakeStream]:
    made: list[FakeStream] = []

    def stream(**options: Any) -> FakeStream:
        made.append(FakeStream(**options))
        return made[-1]

    library = SimpleNamespace(InputStream=stream, PortAudioError=OSError)
    monkeypatch.setattr(microphone, "sound_library", lambda: library)
    return microphone.Microphone(), made[0]


NOW = SimpleNamespace(currentTime=0.1, inputBufferAdcTime=0.1)


def block(level: float, count: int = 4800) -> Floats:
    return np.full((count, 1), level, np.float32)


def test_sound_begins_with_the_first_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = SimpleNamespace(now=5.0)
    clock.monotonic = lambda: clock.now
    monkeypatch.setattr(microphone, "time", clock)
    heard, stream = fake_microphone(monkeypatch)
    stream.hear(block(0.1), 4800, NOW, None)  # 5.0 to 5.1 s
    clock.now = 5.05
    heard.begin()
    clock.now = 5.1
    stream.hear(block(0.2), 4800, NOW, None)
    clock.now = 5.6  # 0.4 s were lost
    stream.hear(block(0.3), 4800, NOW, None)
    starts, blocks = zip(*heard.blocks(), strict=True)
    assert list(starts) == [0, 2400, 7200]
    whole = np.concatenate(blocks)
    assert len(whole) == round((5.6 + 0.1 - 5.05) * 48_000)
    np.testing.assert_allclose(whole[[0, 2399, 2400, 7199, 7200, 26399, 26400, -1]],
                               [0.1, 0.1, 0.2, 0.2, 0, 0, 0.3, 0.3], atol=1e-6)  # fmt: skip


def test_a_film_has_the_sound_of_the_microphone(
    monkeypatch: pytest.MonkeyPatch, source: Path, tmp_path: Path
) -> None:
    heard, stream = fake_microphone(monkeypatch)
    film = GrowingFilm(tmp_path / "film.mp4", heard)
    tone = np.sin(np.arange(4800) * 0.06).astype(np.float32)[:, None]
    for number, frame in enumerate(frames_of(source)):
        if number:
            stream.hear(0.5 * tone, 4800, NOW, None)
        film.add(frame)
    assert film.finish()
    assert not stream.is_open
    sound = read_sound(tmp_path / "film.mp4")
    assert sound is not None
    assert 0.8 < sound.end < 1.2
    assert len(Film(tmp_path / "film.mp4")) == 10


def test_without_a_microphone_one_line_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    def stream(**_: object) -> None:
        raise OSError("Error querying device -1")

    library = SimpleNamespace(InputStream=stream, PortAudioError=OSError)
    monkeypatch.setattr(microphone, "sound_library", lambda: library)
    with pytest.raises(Unavailable, match="No microphone"):
        microphone.Microphone()


def test_the_address_of_a_webcam_is_not_a_file(monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[Any] = []

    def open_(address: str, **options: Any) -> Any:
        opened.append((address, options))
        raise OSError("busy")

    monkeypatch.setattr(av, "open", open_)
    with pytest.raises(FaceEditError, match="busy"), webcam.pictures_of(Webcam("W", "/d", "v4l2")):
        pass
    assert [address for address, _ in opened] == ["/d"] * 4
    assert opened[0][1]["options"]["input_format"] == "mjpeg"
    assert opened[-1][1]["options"] == {}
