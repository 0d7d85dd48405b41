"""Sound and film in the real window: added, dropped, found, placed, played, kept."""

from __future__ import annotations

import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget
from support.curves import let_go, move_with, place, surface
from support.faces import random_engine
from support.films import make_broadcast_wav, make_film, make_wav, number_of
from support.takes import make_livelink_csv
from support.windows import Bench, drag_curve, drop, trigger

from faceedit_app.core.errors import Unavailable
from faceedit_app.editing.edits.media import MediaFile, Placement
from faceedit_app.media import output
from faceedit_app.media.sound import Sound
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.page.editor import Editor
from faceedit_app.ui.start.window import MainWindow


class FakeOutput:
    """A sound device that only takes notes."""

    def __init__(self, sound: Sound) -> None:
        self.sound, self.offset, self.volume = sound, 0.0, 1.0
        self.grains: list[float] = []
        self.plays: list[tuple[float, float, object]] = []
        self.seconds, self.is_alive, self.closed, self.stops = 0.0, True, False, 0

    def use(self, sound: Sound | None, offset: float) -> None:
        assert sound is self.sound
        self.offset = offset

    def set_volume(self, volume: float) -> None:
        self.volume = volume

    def play(self, seconds: float, speed: float, loop: object) -> None:
        self.plays.append((seconds, speed, loop))

    def heard(self) -> float:
        return self.seconds

    def grain(self, seconds: float) -> None:
        self.grains.append(seconds)

    def stop(self) -> None:
        self.stops += 1

    def close(self) -> None:
        self.closed = True


@pytest.fixture
def devices(monkeypatch: pytest.MonkeyPatch) -> list[FakeOutput]:
    """The devices that were opened."""
    opened: list[FakeOutput] = []

    def open_output(sound: Sound) -> FakeOutput:
        opened.append(FakeOutput(sound))
        return opened[-1]

    monkeypatch.setattr(output, "open_output", open_output)
    return opened


def editor_of(window: MainWindow) -> Editor:
    assert window.editor is not None
    return window.editor


def settle(bench: Bench, window: MainWindow) -> None:
    bench.qtbot.waitUntil(lambda: window.media.pending == 0, timeout=10_000)
    bench.qtbot.wait(20)


def with_media(bench: Bench, *paths: Path) -> MainWindow:
    window = bench.editing()
    for path in paths:
        window.media.add(path)
        settle(bench, window)
    return window


def mouse(
    widget: QWidget,
    kind: QEvent.Type,
    x: float,
    keys: Qt.KeyboardModifier = Qt.KeyboardModifier.NoModifier,
) -> None:
    at = QPointF(x, widget.height() / 2)
    left, none = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton
    moving = kind == QEvent.Type.MouseMove
    held = none if kind == QEvent.Type.MouseButtonRelease else left
    glob = widget.mapToGlobal(at)
    event = QMouseEvent(kind, at, glob, none if moving else left, held, keys)
    QApplication.sendEvent(widget, event)


def drag(widget: QWidget, first: float, last: float, keys: Qt.KeyboardModifier) -> None:
    mouse(widget, QEvent.Type.MouseButtonPress, first, keys)
    mouse(widget, QEvent.Type.MouseMove, (first + last) / 2, keys)
    mouse(widget, QEvent.Type.MouseMove, last, keys)
    mouse(widget, QEvent.Type.MouseButtonRelease, last, keys)


# --- how they come and go --------------------------------------------------------------------


def test_a_sound_is_added_from_the_menu_and_removed(
    bench: Bench, devices: list[FakeOutput], monkeypatch: pytest.MonkeyPatch
) -> None:
    window = bench.editing()
    editor = editor_of(window)
    assert not editor.sound.isVisible()
    assert not window.actions_["remove_sound"].isEnabled()
    path = make_wav(bench.folder / "voice.wav")
    monkeypatch.setattr(dialogs, "ask_media", lambda *_: path)
    trigger(window, "add_media")
    bench.qtbot.waitUntil(lambda: len(devices) == 1)
    settle(bench, window)
    assert editor.sound.isVisible()
    assert not editor.film.isVisible()
    assert window.status.currentMessage() == "Added voice.wav"
    trigger(window, "remove_sound")
    assert not editor.sound.isVisible()
    assert devices[0].closed
    assert window.media.placement == Placement()


def test_a_film_brings_its_own_sound_and_takes_it_away(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    window = with_media(bench, make_film(bench.folder / "a.mp4", sound=1.0))
    editor = editor_of(window)
    assert editor.film.isVisible()
    assert editor.sound.isVisible()
    assert window.media.sound is not None
    trigger(window, "remove_film")
    assert window.media.sound is None
    assert not editor.film.isVisible()


def test_a_sound_file_is_preferred_to_the_sound_of_a_film(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    sound = make_wav(bench.folder / "clean.wav")
    window = with_media(bench, sound, make_film(bench.folder / "a.mp4", sound=1.0))
    assert window.media.sound is not None
    assert window.media.sound.path == sound
    window.media.remove_film()
    assert window.media.sound is not None


def test_another_film_brings_another_sound_or_none(bench: Bench, devices: list[FakeOutput]) -> None:
    first = make_film(bench.folder / "a.mp4", sound=1.0)
    second = make_film(bench.folder / "b.mp4", sound=0.5)
    window = with_media(bench, first, second)
    assert window.media.sound is not None
    assert window.media.sound.path == second
    window.media.add(make_film(bench.folder / "c.mp4"))
    settle(bench, window)
    assert window.media.film is not None
    assert window.media.sound is None


def test_a_film_without_sound(bench: Bench, devices: list[FakeOutput]) -> None:
    window = with_media(bench, make_film(bench.folder / "a.mp4"))
    assert editor_of(window).film.isVisible()
    assert not editor_of(window).sound.isVisible()
    assert not devices
    assert not bench.errors


def test_files_are_dropped(bench: Bench, devices: list[FakeOutput]) -> None:
    window = bench.editing()
    drop(editor_of(window).curves, make_wav(bench.folder / "voice.wav"))
    settle(bench, window)
    assert window.media.sound is not None
    assert window.document.session is not None


def test_a_take_and_its_film_are_dropped_at_once(bench: Bench, devices: list[FakeOutput]) -> None:
    window = bench.window()
    film = make_film(bench.folder / "other_name.mp4", sound=0.5)
    drop(window, film, bench.take)
    bench.qtbot.waitUntil(lambda: window.media.film is not None, timeout=10_000)
    settle(bench, window)
    assert window.document.path == bench.take


def test_a_film_without_a_take_waits_for_one(bench: Bench) -> None:
    window = bench.window()
    drop(window, make_film(bench.folder / "a.mp4"))
    assert window.status.currentMessage() == "Open a take first, then drop a.mp4 on it"


def test_what_lies_beside_a_take_is_opened_with_it_and_goes_with_it(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    make_film(bench.take.with_suffix(".mov"), sound=0.3)
    window = bench.editing()
    bench.qtbot.waitUntil(lambda: window.media.sound is not None, timeout=10_000)
    settle(bench, window)
    assert window.media.film is not None
    assert window.status.currentMessage() == "Opened take.mov, found beside the take"
    other = make_livelink_csv(bench.folder / "another.csv", seconds=1.0)
    window.commands.file.open(other)
    bench.qtbot.waitUntil(lambda: window.document.path == other)
    assert window.media.film is None
    assert window.media.sound is None


def test_bad_files_are_one_line(bench: Bench, devices: list[FakeOutput]) -> None:
    window = bench.editing()
    bad = bench.folder / "a.mov"
    bad.write_bytes(b"not a film at all" * 10)
    window.media.add(bad)
    settle(bench, window)
    assert len(bench.errors) == 1
    assert "cannot be read as sound or film" in bench.errors[0]
    assert "\n" not in bench.errors[0]


def test_a_bad_file_beside_the_take_does_not_get_in_the_way(bench: Bench) -> None:
    window = bench.editing()
    other = make_livelink_csv(bench.folder / "another.csv", seconds=1.0)
    other.with_suffix(".wav").write_bytes(b"RIFF nonsense")
    window.commands.file.open(other)
    bench.qtbot.waitUntil(lambda: window.document.path == other)
    settle(bench, window)
    assert not bench.errors
    assert window.banner.isVisible()
    assert "another.wav" in window.banner.text.text()


# --- the waveform ----------------------------------------------------------------------------


@pytest.mark.parametrize("width", [1280, 1777])
def test_the_waveform_is_under_the_plots_to_the_pixel(
    bench: Bench, devices: list[FakeOutput], width: int
) -> None:
    window = with_media(bench, make_wav(bench.folder / "voice.wav"))
    editor = editor_of(window)
    window.resize(width, 760)
    bench.qtbot.wait(30)
    window.timeline.show_range(0.31, 1.57)
    plot, wave = editor.curves.plots[0], editor.sound.waveform
    left = plot.viewport().mapTo(window, place(plot, 0.31)).x()
    assert wave.mapTo(window, QPoint(0, 0)).x() == left
    assert wave.width() == plot.current_scale.width
    for seconds in (0.31, 0.5, 1.57):
        there = editor.curves.plots[0].current_scale.x_of(seconds)
        assert wave.scale.x_of(seconds) == pytest.approx(there, abs=0.01)


def test_the_burst_is_drawn_where_it_is_heard(bench: Bench, devices: list[FakeOutput]) -> None:
    window = with_media(bench, make_wav(bench.folder / "voice.wav", at=0.5))
    wave = editor_of(window).sound.waveform
    for offset in (0.0, 0.75):
        window.media.move_sound(offset)
        image = wave.grab().toImage()
        row = round(0.25 * image.height())
        dark = image.pixelColor(round(wave.scale.x_of(0.3 + offset)), row)
        lit = [
            x
            for x in range(image.width())
            if image.pixelColor(x, row).green() > dark.green() + 40
            and abs(x - wave.scale.x_of(window.timeline.time)) > 2
        ]
        assert lit[0] == pytest.approx(wave.scale.x_of(0.5 + offset), abs=2)
        assert lit[-1] == pytest.approx(wave.scale.x_of(0.6 + offset), abs=2)


def test_alt_drag_moves_the_sound_and_esc_takes_it_back(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    window = with_media(bench, make_wav(bench.folder / "voice.wav"))
    wave, row = editor_of(window).sound.waveform, editor_of(window).sound
    per_pixel = wave.scale.seconds_per_pixel
    alt, shift = Qt.KeyboardModifier.AltModifier, Qt.KeyboardModifier.ShiftModifier
    drag(wave, 100, 160, alt)
    assert window.media.sound is not None
    assert window.media.sound.offset == pytest.approx(60 * per_pixel, abs=1e-3)
    assert row.offset.value() == pytest.approx(60 * per_pixel, abs=1e-3)
    assert devices[0].offset == window.media.sound.offset
    drag(wave, 100, 160, alt | shift)
    assert window.media.sound.offset == pytest.approx(66 * per_pixel, abs=1e-3)
    mouse(wave, QEvent.Type.MouseButtonPress, 50, alt)
    mouse(wave, QEvent.Type.MouseMove, 150, alt)
    assert window.media.is_held
    QTest.keyClick(wave, Qt.Key.Key_Escape)
    assert not window.media.is_held
    assert window.media.sound.offset == pytest.approx(66 * per_pixel, abs=1e-3)
    row.offset.setValue(-0.25)
    assert window.media.sound.offset == -0.25


def test_dragging_the_waveform_scrubs_and_is_heard(bench: Bench, devices: list[FakeOutput]) -> None:
    window = with_media(bench, make_wav(bench.folder / "voice.wav"))
    wave = editor_of(window).sound.waveform
    drag(wave, 100, 300, Qt.KeyboardModifier.NoModifier)
    assert window.timeline.time == pytest.approx(wave.scale.time_at(300), abs=0.02)
    assert devices[0].grains[-1] == window.timeline.time
    assert len(devices[0].grains) == 3
    trigger(window, "back")
    assert len(devices[0].grains) == 4


# --- the film --------------------------------------------------------------------------------


def shown(bench: Bench, window: MainWindow) -> int:
    """The number that the picture on screen carries."""
    screen = editor_of(window).film.screen_
    bench.qtbot.waitUntil(lambda: screen.index == screen.wanted, timeout=10_000)
    assert screen._picture is not None
    return number_of(screen._picture)


def test_the_film_shows_the_picture_of_the_frame(bench: Bench, devices: list[FakeOutput]) -> None:
    window = with_media(bench, make_film(bench.folder / "a.mp4", 60, 30))
    for seconds in (0.0, 1.0, 0.5, 0.499, 1.95, 0.7, 0.02):
        window.timeline.go_to_time(seconds)
        expected = int((window.timeline.time + 5e-4) * 30)
        assert shown(bench, window) == expected
    window.timeline.go_to_time(1.0)
    editor_of(window).film.offset.setValue(0.4)
    assert shown(bench, window) == 18


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
    steps = window.document.session.state
    trigger(window, "mirror_film")
    assert window.actions_["mirror_film"].isChecked()
    mirrored = screen.grab().toImage()
    assert mirrored != plain
    differ = [
        abs(a - b)
        for y in range(0, plain.height(), 7)
        for x in range(0, plain.width(), 3)
        for a, b in zip(
            mirrored.pixelColor(x, y).getRgb(),
            plain.pixelColor(plain.width() - 1 - x, y).getRgb(),
            strict=True,
        )
    ]
    assert np.mean(differ) < 3.0
    assert window.document.session.state == steps, "no step: it is a way to look"
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


@pytest.mark.parametrize(
    ("timecode", "offset"), [("{}", 0.0), ("{}:15", 0.5), ("03:00:00:00", 0.0), ("", 0.0)]
)
def test_a_film_with_timecode_is_placed_by_it(
    bench: Bench, devices: list[FakeOutput], timecode: str, offset: float
) -> None:
    window = bench.editing()
    session = window.document.session
    assert session is not None
    assert session.take.clip.timecodes is not None
    first = session.take.clip.timecodes[0]
    whole_second = first[:8]
    spelled = timecode.format(whole_second if ":15" in timecode else whole_second + ":00")
    film = make_film(bench.folder / "b.mov", 60, 30, sound=1.0, timecode=spelled)
    window.media.add(film)
    settle(bench, window)
    begun = float(first[9:]) / 60  # seconds within the take's first second
    assert window.media.film is not None
    expected = offset - begun if spelled and "03:" not in spelled else 0.0
    assert window.media.film.offset == pytest.approx(expected, abs=1e-3)
    assert window.media.sound is not None
    assert window.media.sound.offset == window.media.film.offset


@pytest.mark.parametrize(("later", "offset"), [(0.5, 0.5), (-0.25, -0.25), (3600.0, 0.0)])
@pytest.mark.parametrize("beside", [False, True])
def test_a_broadcast_wav_is_placed_by_its_clock(
    bench: Bench, devices: list[FakeOutput], later: float, offset: float, beside: bool
) -> None:
    began = 12 * 3600.0  # the take's first timecode
    path = bench.take.with_suffix(".wav") if beside else bench.folder / "boom.wav"
    make_broadcast_wav(path, began + later)
    window = bench.editing()
    if not beside:
        window.media.add(path)
    bench.qtbot.waitUntil(lambda: window.media.sound is not None, timeout=10_000)
    assert window.media.sound is not None
    assert window.media.sound.offset == pytest.approx(offset, abs=0.02)
    assert window.isWindowModified() is not beside
    if not beside:  # moved by hand, it stays there
        window.media.move_sound(1.0)
        trigger(window, "undo")
        assert window.media.sound.offset == pytest.approx(offset, abs=0.02)


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
    bench.qtbot.waitUntil(lambda: "is not there" in screen._note, timeout=10_000)


# --- playing ---------------------------------------------------------------------------------


def test_the_playhead_and_the_film_follow_what_is_heard(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    window = with_media(bench, make_film(bench.folder / "a.mp4", 60, 30, sound=1.0))
    bench.qtbot.waitUntil(lambda: len(devices) == 1)
    bench.qtbot.wait(20)
    device = devices[0]
    trigger(window, "play")
    assert device.plays == [(0.0, 1.0, None)]
    bench.qtbot.wait(60)
    assert window.timeline.time == 0.0  # nothing has been heard yet
    for seconds in (0.4, 1.2, 1.25):
        device.seconds = seconds
        window.playback.tick()
        assert window.timeline.time == pytest.approx(seconds, abs=0.011)
        assert shown(bench, window) == int((window.timeline.time + 5e-4) * 30)
    trigger(window, "play")
    assert device.stops == 1
    assert not device.grains


def test_mute_and_volume(bench: Bench, devices: list[FakeOutput]) -> None:
    window = with_media(bench, make_wav(bench.folder / "voice.wav"))
    bench.qtbot.waitUntil(lambda: len(devices) == 1)
    bench.qtbot.wait(20)
    trigger(window, "mute")
    assert devices[0].volume == 0.0
    assert window.actions_["mute"].isChecked()
    trigger(window, "mute")
    assert devices[0].volume == 1.0
    window.sound_player.set_volume(0.5)
    assert devices[0].volume == 0.25
    trigger(window, "mute")
    assert bench.preferences().volume() == (0.5, True)
    again = bench.window()
    assert (again.sound_player.volume, again.sound_player.muted) == (0.5, True)


def test_without_a_device_the_take_is_played_in_silence(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    def none(_: Sound) -> Any:
        raise Unavailable("No sound: no device")

    monkeypatch.setattr(output, "open_output", none)
    window = with_media(bench, make_wav(bench.folder / "voice.wav"))
    bench.qtbot.waitUntil(lambda: window.sound_player.problem == "No sound: no device")
    trigger(window, "play")
    bench.qtbot.wait(200)
    assert window.timeline.frame > 3
    trigger(window, "play")
    assert window.actions_["mute"].toolTip() == "No sound: no device"
    assert not bench.errors


def test_a_device_that_is_unplugged_is_sought_again(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    window = with_media(bench, make_wav(bench.folder / "voice.wav"))
    bench.qtbot.waitUntil(lambda: len(devices) == 1)
    bench.qtbot.wait(20)
    devices[0].is_alive = False
    trigger(window, "play")
    assert window.playback.playing
    bench.qtbot.waitUntil(lambda: len(devices) == 2)
    assert devices[0].closed


class FakeLibrary:
    """In place of sounddevice: takes samples in blocks, as fast as a real device would."""

    class PortAudioError(Exception):
        pass

    class OutputStream:
        def __init__(self, samplerate: int, channels: int, callback: Any, **_: object) -> None:
            self.rate, self.channels, self._fill = samplerate, channels, callback
            self.active, self.latency = True, 0.05
            self.blocks: list[np.ndarray] = []
            FakeLibrary.streams.append(self)

        def start(self) -> None:
            threading.Thread(target=self._run, daemon=True).start()

        def _run(self) -> None:
            began, count = time.perf_counter(), round(0.01 * self.rate)
            while self.active:
                block = np.empty((count, self.channels), np.float32)
                now = time.perf_counter()
                times = type("Times", (), {"outputBufferDacTime": 0.05, "currentTime": 0.0})
                self._fill(block, count, times, None)
                self.blocks.append(block)
                time.sleep(max(0.0, began + len(self.blocks) * 0.01 - now))

        def close(self) -> None:
            self.active = False

    streams: list[OutputStream]


def test_what_is_played_is_heard_when_the_playhead_is_there(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Through the real loudspeaker, to a device that is only a thread."""
    FakeLibrary.streams = []
    monkeypatch.setattr(output, "_library", FakeLibrary)
    window = with_media(bench, make_wav(bench.folder / "voice.wav", at=0.5))
    bench.qtbot.waitUntil(lambda: window.sound_player.start(0.0, 1.0, None))
    window.sound_player.stop()
    bench.qtbot.wait(50)
    stream = FakeLibrary.streams[0]
    before = len(stream.blocks)
    seen: list[tuple[int, float]] = []  # blocks taken, and the playhead then
    window.timeline.playhead_moved.connect(
        lambda _: seen.append((len(stream.blocks), window.timeline.time))
    )
    trigger(window, "play")
    bench.qtbot.waitUntil(lambda: window.timeline.time > 0.9, timeout=10_000)
    trigger(window, "play")
    sounds = np.concatenate(stream.blocks[before:])[:, 0]
    taken = np.argmax(np.abs(sounds) > 0.1) / stream.rate  # when the burst was taken
    heard = before + (taken + stream.latency) / 0.01  # the block during which it was heard
    blocks, playheads = np.array(seen).T
    at = float(np.interp(heard, blocks, playheads))
    assert at == pytest.approx(0.5, abs=0.06)  # a busy machine may be late by some frames


# --- kept in projects ------------------------------------------------------------------------


def test_a_placement_is_shown_again(bench: Bench, devices: list[FakeOutput]) -> None:
    film = make_film(bench.folder / "a.mp4", sound=0.5)
    window = with_media(bench, film, make_wav(bench.folder / "voice.wav"))
    window.media.move_film(0.25)
    window.media.move_sound(-0.125)
    placement = window.media.placement
    assert placement == Placement(
        MediaFile(bench.folder / "voice.wav", -0.125),
        MediaFile(film, 0.25),
    )
    window.media.clear()
    window.media.show(placement)
    assert window.media.placement == placement  # while it is still being read, too
    settle(bench, window)
    assert window.media.placement == placement
    assert window.media.film is not None


def test_a_placement_whose_files_are_gone_is_kept_for_when_they_are_back(bench: Bench) -> None:
    window = bench.editing()
    gone = Placement(MediaFile(bench.folder / "gone.wav", 1.0))
    window.media.show(gone)
    assert "gone.wav" in window.banner.text.text()
    assert window.media.placement == gone
    window.media.show(Placement())
    settle(bench, window)
    assert window.media.placement == Placement()
    assert not bench.errors


# --- undone and redone -----------------------------------------------------------------------


def step_back_and_forward(bench: Bench, window: MainWindow, *places: Placement) -> None:
    """Undo through all places, the last first, and redo through them again."""
    session = window.document.session
    assert session is not None
    assert window.media.placement == places[-1]
    for way, expected in (("undo", places[-2::-1]), ("redo", places[1:])):
        for placed in expected:
            trigger(window, way)
            assert window.media.placement == placed
            settle(bench, window)
            assert window.media.placement == place
            for kind in ("sound", "film"):
                there, wanted = getattr(window.media, kind), getattr(place, kind)
                assert (there and there.path) == (wanted and wanted.path)
    assert not bench.errors


def test_adding_moving_and_removing_are_one_step_each(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    window = bench.editing()
    assert not window.isWindowModified()
    assert not window.actions_["undo"].isEnabled()
    film = make_film(bench.folder / "a.mp4", sound=1.0)
    window.media.add(film)
    settle(bench, window)
    assert window.isWindowModified()
    added = Placement(MediaFile(film), MediaFile(film))
    assert window.media.placement == added
    row = editor_of(window).sound
    for _ in range(5):  # the arrows of the number
        QTest.keyClick(row.offset, Qt.Key.Key_Up)
    moved = Placement(MediaFile(film, 0.05), MediaFile(film, 0.05))
    assert window.media.placement == moved
    trigger(window, "undo")
    assert window.media.placement == added, "five presses are one step"
    trigger(window, "redo")
    drag(row.waveform, 100, 160, Qt.KeyboardModifier.AltModifier)
    dragged = window.media.placement
    assert dragged != moved
    trigger(window, "remove_film")
    step_back_and_forward(bench, window, Placement(), added, moved, dragged, Placement())
    assert not window.actions_["redo"].isEnabled()


def test_a_dropped_drag_of_the_sound_is_no_step(bench: Bench, devices: list[FakeOutput]) -> None:
    window = with_media(bench, make_wav(bench.folder / "voice.wav"))
    session = window.document.session
    assert session is not None
    before, wave = session.state, editor_of(window).sound.waveform
    mouse(wave, QEvent.Type.MouseButtonPress, 50, Qt.KeyboardModifier.AltModifier)
    mouse(wave, QEvent.Type.MouseMove, 150, Qt.KeyboardModifier.AltModifier)
    session.use_engine(random_engine(3))  # the networks are loaded meanwhile: the drag goes on
    assert window.media.placement.sound != MediaFile(bench.folder / "voice.wav")
    QTest.keyClick(wave, Qt.Key.Key_Escape)
    assert session.state == before
    assert window.media.placement == before.media


def test_what_lies_beside_the_take_is_no_step_until_it_is_moved(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    make_wav(bench.take.with_suffix(".wav"))
    window = bench.editing()
    settle(bench, window)
    found = Placement(MediaFile(bench.take.with_suffix(".wav")))
    assert window.media.placement == found
    assert not window.isWindowModified()
    assert not window.actions_["undo"].isEnabled()
    editor_of(window).sound.offset.setValue(0.5)
    QTest.keyClick(editor_of(window).sound.offset, Qt.Key.Key_Return)
    assert window.isWindowModified()
    step_back_and_forward(bench, window, found, replace_sound(found, 0.5))
    trigger(window, "undo")
    assert not window.isWindowModified()


def replace_sound(placement: Placement, offset: float) -> Placement:
    assert placement.sound is not None
    return Placement(MediaFile(placement.sound.path, offset), placement.film)


def test_steps_of_sound_and_of_curves_are_undone_in_their_order(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    window = with_media(bench, make_wav(bench.folder / "voice.wav"))
    session = window.document.session
    assert session is not None
    drag_curve(window, 0, 1.0, 20)
    editor_of(window).sound.offset.setValue(0.2)
    drag_curve(window, 0, 2.0, 20)  # while the number may still be turned
    assert len(session.edits) == 2
    places = []
    while session.can_undo:
        trigger(window, "undo")
        places.append((len(session.edits), window.media.placement.sound))
    voice = bench.folder / "voice.wav"
    assert places[-1] == (0, None)
    assert set(places[:-1]) >= {(1, MediaFile(voice)), (0, MediaFile(voice))}
    while session.can_redo:
        trigger(window, "redo")
    assert (len(session.edits), window.media.placement.sound) == (2, MediaFile(voice, 0.2))


def test_a_sound_that_arrives_during_a_drag_leaves_the_drag_alone(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    window = bench.editing()
    session, editor = window.document.session, editor_of(window)
    assert session is not None
    plot = editor.curves.plots[0]
    start = plot.rect().center()
    QTest.mousePress(surface(plot), Qt.MouseButton.LeftButton, pos=start)
    move_with(plot, start - QPoint(0, 30))
    bench.qtbot.waitUntil(lambda: session.is_previewing)
    window.media.add(make_wav(bench.folder / "voice.wav"))
    settle(bench, window)
    assert window.media.sound is not None
    assert session.is_previewing
    assert not session.can_undo
    let_go(plot, start - QPoint(0, 30))
    assert len(session.edits) == 1
    assert session.state.media == window.media.placement
    trigger(window, "undo")
    assert (len(session.edits), window.media.sound) == (1, None)


def test_an_export_keeps_no_sound_and_a_project_does(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    window = with_media(bench, make_wav(bench.folder / "voice.wav"))
    bench.answers["export"] = bench.folder / "out.csv"
    trigger(window, "export")
    assert window.isWindowModified()
    editor_of(window).sound.offset.setValue(0.75)
    bench.answers["save_project"] = bench.folder / "p.faceedit"
    trigger(window, "save")
    assert not window.isWindowModified()
    again = bench.window(bench.folder / "p.faceedit")
    settle(bench, again)
    assert again.media.placement == Placement(MediaFile(bench.folder / "voice.wav", 0.75))
    assert not again.isWindowModified()
    assert not again.actions_["undo"].isEnabled()
    editor_of(again).sound.offset.setValue(0.5)
    trigger(again, "undo")
    assert again.media.placement == Placement(MediaFile(bench.folder / "voice.wav", 0.75))


def test_after_a_crash_the_sound_is_back_where_it_was(
    bench: Bench, devices: list[FakeOutput], monkeypatch: pytest.MonkeyPatch
) -> None:
    window = with_media(bench, make_wav(bench.folder / "voice.wav"))
    editor_of(window).sound.offset.setValue(0.3)
    bench.qtbot.waitUntil(lambda: window.document.session.state.media.sound.offset == 0.3)
    journal = next((bench.folder / "journals").glob("*.jsonl"))
    content = journal.read_bytes()
    window.leave()
    journal.with_name("crashed.jsonl").write_bytes(content)
    monkeypatch.setattr(dialogs, "ask_recover", lambda *_: dialogs.Recover.RECOVER)
    again = bench.window(bench.take)
    settle(bench, again)
    assert again.media.placement == Placement(MediaFile(bench.folder / "voice.wav", 0.3))
    assert again.media.sound is not None
    assert again.isWindowModified()
    message = "Recovered 2 steps of take.csv; Undo takes all back at once"
    assert again.status.currentMessage() == message
    trigger(again, "undo")
    assert again.media.placement == Placement()
    assert not again.actions_["undo"].isEnabled()


def test_a_late_answer_for_an_earlier_take_is_dropped(bench: Bench) -> None:
    window = bench.editing()
    window.media.add(make_wav(bench.folder / "voice.wav"))
    window.media.clear()
    settle(bench, window)
    assert window.media.sound is None
