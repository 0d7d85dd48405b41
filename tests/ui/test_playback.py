"""Playing by the clock on the wall."""

from __future__ import annotations

import time

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from faceedit_app.core.clip import Clip
from faceedit_app.ui.state.playback import Playback
from faceedit_app.ui.state.timeline import Timeline


class Clock:
    """Seconds that pass when a test says so."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def playback(qtbot: QtBot, clock: Clock) -> Playback:
    """Two seconds at 50 fps; time passes by `pass_time` only."""
    timeline = Timeline()
    weights = np.zeros((100, 1), np.float32)
    timeline.open(Clip(weights, ("jawOpen",), np.arange(100) / 50, 50.0))
    playback = Playback(timeline, clock)
    timeline.setParent(playback)
    playback._timer.setInterval(3_600_000)
    return playback


def frame(playback: Playback) -> int:
    return playback._timeline.frame


def pass_time(playback: Playback, clock: Clock, seconds: float) -> None:
    clock.now += seconds
    playback.tick()


def test_frames_follow_the_clock_however_late_a_tick_is(playback: Playback, clock: Clock) -> None:
    playback.play()
    pass_time(playback, clock, 0.02)
    assert frame(playback) == 1
    pass_time(playback, clock, 0.5)
    assert frame(playback) == 26
    pass_time(playback, clock, 0.001)
    assert frame(playback) == 26


def test_playing_ends_at_the_last_frame_and_starts_over(playback: Playback, clock: Clock) -> None:
    playback.play()
    pass_time(playback, clock, 5.0)
    assert not playback.playing
    assert frame(playback) == 99
    playback.toggle()
    assert playback.playing
    assert frame(playback) == 0


def test_half_speed(playback: Playback, clock: Clock) -> None:
    playback.set_speed(0.5)
    playback.play()
    pass_time(playback, clock, 1.0)
    assert frame(playback) == 25
    playback.set_speed(1.0)
    pass_time(playback, clock, 0.5)
    assert frame(playback) == 50


def test_the_loop_keeps_the_beat(playback: Playback, clock: Clock) -> None:
    playback._timeline.select((0.4, 0.8))
    playback.set_loop(True)
    playback.play()
    assert frame(playback) == 20
    pass_time(playback, clock, 0.45)
    assert frame(playback) in (22, 23)  # 0.05 s into the second round
    pass_time(playback, clock, 0.4)
    assert frame(playback) in (22, 23)
    assert playback.playing


def test_without_a_selection_the_take_is_looped(playback: Playback, clock: Clock) -> None:
    playback.set_loop(True)
    playback.play()
    pass_time(playback, clock, 2.5)
    assert frame(playback) == 25


def test_scrubbing_while_playing_goes_on_from_there(playback: Playback, clock: Clock) -> None:
    playback.play()
    pass_time(playback, clock, 0.2)
    playback._timeline.go_to_frame(70)
    pass_time(playback, clock, 0.1)
    assert frame(playback) == 75


def test_pause_stays_where_it_is(playback: Playback, clock: Clock) -> None:
    playback.play()
    pass_time(playback, clock, 0.2)
    playback.pause()
    clock.now += 10
    playback.play()
    pass_time(playback, clock, 0.1)
    assert frame(playback) == 15


def test_nothing_is_played_without_a_take(qtbot: QtBot) -> None:
    playback = Playback(Timeline())
    playback.toggle()
    assert not playback.playing


def test_what_one_goes_to_has_room_on_both_sides() -> None:
    timeline = Timeline()
    timeline.open(Clip(np.zeros((600, 1), np.float32), ("jawOpen",), np.arange(600) / 60, 60.0))
    for seconds, first in ((3.0, 2.0), (5.0, 4.0), (3.95, 2.95), (2.05, 1.05), (0.0, 0), (9.9, 8)):
        timeline.show_range(2.0, 4.0)
        timeline.visit(seconds)
        assert timeline.time == pytest.approx(seconds)
        assert timeline.view == pytest.approx((first, first + 2.0))


def test_real_time(qtbot: QtBot) -> None:
    timeline = Timeline()
    times = np.arange(600) / 60
    timeline.open(Clip(np.zeros((600, 1), np.float32), ("jawOpen",), times, 60.0))
    read: list[float] = []

    def clock() -> float:
        read.append(time.perf_counter())
        return read[-1]

    playback = Playback(timeline, clock)
    playback.play()
    qtbot.waitUntil(lambda: timeline.time > 0.2)
    assert timeline.time == pytest.approx(read[-1] - read[0], abs=1 / 60)
    playback.pause()


# --- with sound ------------------------------------------------------------------------------


class FakeVoice:
    """A sound device whose clock a test moves."""

    def __init__(self) -> None:
        self.starts: list[tuple[float, float, tuple[float, float] | None]] = []
        self.stops = 0
        self.seconds = 0.0
        self.works = True

    def start(self, seconds: float, speed: float, loop: tuple[float, float] | None) -> bool:
        self.starts.append((seconds, speed, loop))
        self.seconds = 0.0
        return self.works

    def heard(self) -> float:
        return self.seconds

    def stop(self) -> None:
        self.stops += 1


@pytest.fixture
def voice(playback: Playback) -> FakeVoice:
    voice = FakeVoice()
    playback.voice = voice
    return voice


def test_the_playhead_shows_what_is_heard_not_what_the_wall_says(
    playback: Playback, clock: Clock, voice: FakeVoice
) -> None:
    playback._timeline.go_to_frame(10)
    playback.play()
    assert voice.starts == [(0.2, 1.0, None)]
    pass_time(playback, clock, 5.0)  # the device has not begun yet
    assert frame(playback) == 10
    voice.seconds = 0.1
    pass_time(playback, clock, 0.0)
    assert frame(playback) == 15
    voice.seconds = 0.62  # the window was busy: pictures are dropped
    pass_time(playback, clock, 0.0)
    assert frame(playback) == 41
    playback.pause()
    assert voice.stops == 1


def test_slow_playing_with_sound(playback: Playback, clock: Clock, voice: FakeVoice) -> None:
    playback.set_speed(0.25)
    playback.play()
    assert voice.starts == [(0.0, 0.25, None)]
    voice.seconds = 2.0
    pass_time(playback, clock, 0.0)
    assert frame(playback) == 25


def test_picture_and_sound_repeat_together(
    playback: Playback, clock: Clock, voice: FakeVoice
) -> None:
    """The sound repeats its loop by itself; after many rounds the picture is where it is."""
    playback._timeline.select((0.4, 0.8))
    playback.set_loop(True)
    playback.play()
    assert voice.starts == [(0.4, 1.0, (0.4, 0.8))]
    for tick in range(1, 700):
        voice.seconds = tick * 0.0137
        pass_time(playback, clock, 0.0)
        heard = 0.4 + voice.seconds % 0.4
        assert playback._timeline.time == pytest.approx(heard, abs=0.0101)
    assert len(voice.starts) == 1


def test_the_sound_begins_again_where_the_playhead_is_put(
    playback: Playback, clock: Clock, voice: FakeVoice
) -> None:
    playback.play()
    voice.seconds = 0.3
    pass_time(playback, clock, 0.0)
    playback._timeline.go_to_frame(70)
    assert voice.starts[-1] == (1.4, 1.0, None)
    voice.seconds = 0.1
    pass_time(playback, clock, 0.0)
    assert frame(playback) == 75
    playback._timeline.select((1.0, 1.9))
    assert len(voice.starts) == 2
    playback.set_loop(True)
    assert voice.starts[-1] == (1.5, 1.0, (1.0, 1.9))
    playback._timeline.select((1.1, 1.9))
    assert voice.starts[-1] == (1.5, 1.0, (1.1, 1.9))


def test_without_a_device_the_wall_clock_plays(
    playback: Playback, clock: Clock, voice: FakeVoice
) -> None:
    voice.works = False
    playback.play()
    pass_time(playback, clock, 0.5)
    assert frame(playback) == 25
    playback.pause()
    assert voice.stops == 0


def test_backwards_from_the_end_to_the_start(playback: Playback, clock: Clock) -> None:
    playback._timeline.go_to_frame(99)
    playback.shuttle(-1)
    pass_time(playback, clock, 0.5)
    assert frame(playback) == 74
    playback.shuttle(-1)
    pass_time(playback, clock, 0.5)
    assert frame(playback) == 24
    pass_time(playback, clock, 9.0)
    assert frame(playback) == 0
    assert not playback.playing


def test_faster_and_faster(playback: Playback, clock: Clock) -> None:
    for pace in (1, 2, 4, 4):
        playback.shuttle(1)
        assert playback.pace == pace
    pass_time(playback, clock, 0.25)
    assert frame(playback) == 50
    playback.pause()
    playback.play()
    assert playback.pace == 1


def test_around_the_selection_and_back(playback: Playback, clock: Clock) -> None:
    playback._timeline.select((0.8, 1.0))
    playback._timeline.go_to_frame(5)
    playback.play_around()
    assert frame(playback) == 15
    pass_time(playback, clock, 1.1)
    assert frame(playback) == 70
    pass_time(playback, clock, 0.2)
    assert not playback.playing
    assert frame(playback) == 5
    playback.play_around()
    playback._timeline.go_to_frame(40)  # the user goes elsewhere
    playback.pause()
    assert frame(playback) == 40
