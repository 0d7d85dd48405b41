"""Playing by the clock on the wall."""

from __future__ import annotations

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from faceedit_app.core.clip import Clip
from faceedit_app.ui.playback import Playback
from faceedit_app.ui.timeline import Timeline


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


def test_real_time(qtbot: QtBot) -> None:
    timeline = Timeline()
    times = np.arange(600) / 60
    timeline.open(Clip(np.zeros((600, 1), np.float32), ("jawOpen",), times, 60.0))
    playback = Playback(timeline)
    playback.play()
    qtbot.wait(300)
    playback.pause()
    assert 10 <= timeline.frame <= 60
