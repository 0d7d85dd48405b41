"""What the loudspeaker is sent, and the clock that it gives."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from faceedit_app.core.errors import Unavailable
from faceedit_app.media.output import FADE, GRAIN, DeviceClock, Mixer, open_output
from faceedit_app.media.sound import FULL, Sound, extremes_of

RATE = 1000


def rising(seconds: float = 4.0, rate: int = RATE, channels: int = 1) -> Sound:
    """A sound whose samples are their own numbers, so that what is heard says from when it is."""
    samples = np.repeat(np.arange(round(seconds * rate), dtype=np.int16)[:, None], channels, 1)
    return Sound(Path("x.wav"), rate, samples, 0.0, extremes_of(samples))


def heard(mixer: Mixer, count: int) -> list[int]:
    """The numbers of the next samples, in blocks as a device asks for them."""
    blocks = []
    while count > 0:
        block = np.empty((min(count, 64), mixer.channels), np.float32)
        mixer.fill(block)
        blocks.append(block[:, 0])
        count -= len(block)
    return [int(value) for value in np.round(np.concatenate(blocks) * FULL)]


@pytest.fixture
def mixer() -> Mixer:
    mixer = Mixer(RATE, 1)
    mixer.use(rising(), 0.0)
    return mixer


SOFT = round(FADE * RATE) + 1  # samples that are still becoming loud


def test_playing_begins_where_the_playhead_is(mixer: Mixer) -> None:
    mixer.play(1.5, 1.0, None)
    assert heard(mixer, 200)[SOFT:] == list(range(1500 + SOFT, 1700))
    assert mixer.played == 200


def test_an_offset_moves_the_sound_in_the_take(mixer: Mixer) -> None:
    mixer.use(mixer._sound, 0.25)
    mixer.play(1.5, 1.0, None)
    assert heard(mixer, 100)[SOFT:] == list(range(1250 + SOFT, 1350))
    mixer.use(mixer._sound, 1.6)
    mixer.play(1.5, 1.0, None)
    sounds = heard(mixer, 300)
    assert sounds[SOFT:100] == [0] * (100 - SOFT)
    assert sounds[100:] == list(range(200))


def test_a_loop_is_repeated_to_the_sample(mixer: Mixer) -> None:
    mixer.play(1.1, 1.0, (1.0, 1.15))
    expected = [*range(1100, 1150), *range(1000, 1150), *range(1000, 1150)]
    assert heard(mixer, 350)[SOFT:] == expected[SOFT:350]


@pytest.mark.parametrize("device", [RATE, 2 * RATE])
def test_slow_playing_is_low_but_in_time(device: int) -> None:
    mixer = Mixer(device, 1)
    mixer.use(rising(), 0.0)
    mixer.play(1.0, 0.5, None)
    sounds = heard(mixer, device)  # one second of the device's is half a second of the sound
    assert sounds[-1] == pytest.approx(1500, abs=2)
    assert sounds[device // 2] == pytest.approx(1250, abs=2)


def test_a_grain_is_short_and_soft_at_both_ends(mixer: Mixer) -> None:
    mixer.grain(2.0)
    sounds = np.array(heard(mixer, 200))
    assert 0 < sounds[0] < 1000
    assert sounds[40] == 2040
    assert np.count_nonzero(sounds) == pytest.approx(GRAIN * RATE, abs=3)
    assert not any(heard(mixer, 50)), "and nothing follows"
    assert mixer.played == 0


def test_a_new_grain_takes_over_without_a_click() -> None:
    samples = np.full((4000, 1), 16384, np.int16)
    mixer = Mixer(RATE, 1)
    mixer.use(Sound(Path("x.wav"), RATE, samples, 0.0, extremes_of(samples)), 0.0)
    mixer.grain(2.0)
    heard(mixer, 30)
    mixer.grain(1.0)
    sounds = np.array(heard(mixer, 30)) / FULL
    assert np.abs(np.diff(sounds)).max() <= 0.5 / (FADE * RATE) + 0.01
    assert sounds.min() > 0.3


def test_stopping_and_volume_fade(mixer: Mixer) -> None:
    mixer.play(1.0, 1.0, None)
    heard(mixer, 64)
    mixer.set_volume(0.5)
    heard(mixer, 64)
    assert heard(mixer, 64) == pytest.approx([n / 2 for n in range(1128, 1192)], abs=1)
    mixer.stop()
    sounds = heard(mixer, 64)
    assert 0 < sounds[1] < sounds[0]
    assert sounds[SOFT:] == [0] * (64 - SOFT)


def test_stereo_goes_to_a_mono_device_and_back() -> None:
    for channels, device in ((2, 1), (1, 2), (2, 2)):
        mixer = Mixer(RATE, device)
        mixer.use(rising(channels=channels), 0.0)
        mixer.play(1.0, 1.0, None)
        assert heard(mixer, 100)[-1] == 1099


def test_without_a_sound_nothing_is_heard() -> None:
    mixer = Mixer(RATE, 2)
    mixer.play(0.0, 1.0, (0.0, 1.0))
    mixer.grain(1.0)
    assert heard(mixer, 100) == [0] * 100


# --- the clock -------------------------------------------------------------------------------


class Wall:
    now = 50.0

    def __call__(self) -> float:
        return self.now


def test_nothing_has_been_heard_before_the_device_begins() -> None:
    wall = Wall()
    clock = DeviceClock(wall)
    clock.restart()
    wall.now += 0.03
    clock.block(0.0, 0.1)  # 0.1 s from now
    wall.now += 0.05
    assert clock() == 0.0
    wall.now += 0.06
    assert clock() == pytest.approx(0.01)


def test_the_clock_follows_the_device_through_its_wavering() -> None:
    """Blocks of 20 ms come up to 8 ms early or late, from a device that is 0.1 % fast."""
    wall, rng = Wall(), np.random.default_rng(0)
    clock = DeviceClock(wall)
    clock.restart()
    began, read = wall.now, []
    for block in range(1000):
        wall.now = began + block * 0.02 / 1.001 + rng.uniform(-0.008, 0.008)
        clock.block(block * 0.02, 0.1)
        read.append(clock())
        truth = (wall.now - began - 0.1) * 1.001
        if block > 30:
            assert read[-1] == pytest.approx(truth, abs=0.01)
    assert (np.diff(read) >= 0).all()


def test_a_device_that_falls_silent_does_not_hold_the_playhead() -> None:
    wall = Wall()
    clock = DeviceClock(wall)
    clock.restart()
    wall.now += 5.0
    assert clock() == pytest.approx(4.6)
    clock.restart()
    clock.block(0.0, 0.0)
    wall.now += 3.0
    assert clock() == pytest.approx(3.0)


def test_after_a_dropout_the_picture_waits_for_the_sound() -> None:
    wall = Wall()
    clock = DeviceClock(wall)
    clock.restart()
    clock.block(0.0, 0.0)
    wall.now += 1.0
    assert clock() == pytest.approx(1.0)
    clock.block(0.5, 0.0)  # half a second was not delivered
    assert clock() == pytest.approx(1.0)
    wall.now += 0.4
    assert clock() == pytest.approx(1.0)
    wall.now += 0.2
    assert clock() == pytest.approx(1.1)


# --- no device -------------------------------------------------------------------------------


def test_without_a_library_or_a_device_one_line_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "sounddevice", None)
    with pytest.raises(Unavailable) as caught:
        open_output(rising())
    assert str(caught.value).startswith("No sound")
    assert "\n" not in str(caught.value)


def test_a_device_that_refuses_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    class Broken:
        class PortAudioError(Exception):
            pass

        def OutputStream(self, **_: object) -> None:
            raise self.PortAudioError("Error querying device -1\nmore")

        def query_devices(self, kind: str) -> None:
            raise self.PortAudioError("Error querying device -1")

    monkeypatch.setitem(sys.modules, "sounddevice", Broken())
    with pytest.raises(Unavailable, match="Error querying device -1"):
        open_output(rising())
