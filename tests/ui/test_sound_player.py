"""Sound in the real window: what is heard leads the playhead; volume; devices that fail."""

from __future__ import annotations

from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from support.films import make_film, make_wav
from support.media import FakeOutput, shown, with_media
from support.windows import Bench, double_click, editor_of, trigger

from faceedit_app.core.errors import Unavailable
from faceedit_app.media import output
from faceedit_app.media.output import DeviceClock
from faceedit_app.media.sound import Sound
from faceedit_app.ui.look.gesture_slider import Slider


def test_the_playhead_and_the_film_follow_what_is_heard(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    window = with_media(bench, make_film(bench.folder / "a.mp4", 60, 30, sound=1.0))
    assert len(devices) == 1
    device = devices[0]
    trigger(window, "play")
    assert device.plays == [(0.0, 1.0, None)]
    window.playback.tick()
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
    assert len(devices) == 1
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
    window.sound_player.set_volume(0.3)
    double_click(editor_of(window).transport.findChildren(Slider)[0])
    assert devices[0].volume == 1.0


def test_without_a_device_the_take_is_played_in_silence(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    def none(_: Sound) -> Any:
        raise Unavailable("No sound: no device")

    monkeypatch.setattr(output, "open_output", none)
    window = with_media(bench, make_wav(bench.folder / "voice.wav"))
    bench.qtbot.waitUntil(lambda: window.sound_player.problem == "No sound: no device")
    trigger(window, "play")
    bench.qtbot.waitUntil(lambda: window.timeline.frame > 3)
    trigger(window, "play")
    assert window.actions_["mute"].toolTip() == "No sound: no device"
    assert not bench.errors


def test_a_device_that_is_unplugged_is_sought_again(
    bench: Bench, devices: list[FakeOutput]
) -> None:
    window = with_media(bench, make_wav(bench.folder / "voice.wav"))
    assert len(devices) == 1
    devices[0].is_alive = False
    trigger(window, "play")
    assert window.playback.playing
    bench.qtbot.waitUntil(lambda: len(devices) == 2)
    assert devices[0].closed


BLOCK = 0.01  # seconds


class FakeLibrary:
    """In place of sounddevice: a device that takes a block of samples when the test says so."""

    class PortAudioError(Exception):
        pass

    class OutputStream:
        def __init__(self, samplerate: int, channels: int, callback: Any, **_: object) -> None:
            self.rate, self.channels, self._fill = samplerate, channels, callback
            self.active, self.latency = False, 0.05
            self.blocks: list[np.ndarray] = []
            FakeLibrary.streams.append(self)

        def start(self) -> None:
            self.active = True

        def take(self) -> None:
            """One block, and the time that it lasts goes by."""
            count = round(BLOCK * self.rate)
            block = np.empty((count, self.channels), np.float32)
            times = SimpleNamespace(outputBufferDacTime=self.latency, currentTime=0.0)
            self._fill(block, count, times, None)
            self.blocks.append(block)
            FakeLibrary.now += BLOCK

        def close(self) -> None:
            self.active = False

    streams: list[OutputStream]
    now: float


def test_what_is_played_is_heard_when_the_playhead_is_there(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Through the real loudspeaker, to a device whose clock the test moves."""
    FakeLibrary.streams, FakeLibrary.now = [], 100.0
    monkeypatch.setattr(output, "sound_library", FakeLibrary)
    monkeypatch.setattr(output, "DeviceClock", partial(DeviceClock, lambda: FakeLibrary.now))
    window = with_media(bench, make_wav(bench.folder / "voice.wav", at=0.5))
    (stream,) = FakeLibrary.streams
    trigger(window, "play")
    playheads: list[float] = []  # after each block
    while window.timeline.time < 0.9 and len(playheads) < 200:
        stream.take()
        window.playback.tick()
        playheads.append(window.timeline.time)
    trigger(window, "play")
    sounds = np.concatenate(stream.blocks)[:, 0]
    taken = np.argmax(np.abs(sounds) > 0.1) / stream.rate  # when the burst was taken
    heard = (taken + stream.latency) / BLOCK  # the block during which it was heard
    at = float(np.interp(heard, np.arange(1, len(playheads) + 1), playheads))
    assert at == pytest.approx(0.5, abs=0.02)  # a frame
