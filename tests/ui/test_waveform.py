"""The waveform under the curves: drawn where it is heard, dragged, scrubbed."""

from __future__ import annotations

import pytest
from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtTest import QTest
from support.curves import place
from support.films import make_wav
from support.media import FakeOutput, drag, mouse, with_media
from support.waiting import run_events
from support.windows import Bench, editor_of, trigger


@pytest.mark.parametrize("width", [1280, 1777])
def test_the_waveform_is_under_the_plots_to_the_pixel(
    bench: Bench, devices: list[FakeOutput], width: int
) -> None:
    window = with_media(bench, make_wav(bench.folder / "voice.wav"))
    editor = editor_of(window)
    window.resize(width, 760)
    run_events()
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
    wave, strip = editor_of(window).sound.waveform, editor_of(window).sound
    per_pixel = wave.scale.seconds_per_pixel
    alt, shift = Qt.KeyboardModifier.AltModifier, Qt.KeyboardModifier.ShiftModifier
    drag(wave, 100, 160, alt)
    assert window.media.sound is not None
    assert window.media.sound.offset == pytest.approx(60 * per_pixel, abs=1e-3)
    assert strip.offset.value() == pytest.approx(60 * per_pixel, abs=1e-3)
    assert devices[0].offset == window.media.sound.offset
    drag(wave, 100, 160, Qt.KeyboardModifier.ControlModifier | shift)  # desktops may take Alt
    assert window.media.sound.offset == pytest.approx(66 * per_pixel, abs=1e-3)
    mouse(wave, QEvent.Type.MouseButtonPress, 50, alt)
    mouse(wave, QEvent.Type.MouseMove, 150, alt)
    assert window.media.is_held
    QTest.keyClick(wave, Qt.Key.Key_Escape)
    assert not window.media.is_held
    assert window.media.sound.offset == pytest.approx(66 * per_pixel, abs=1e-3)
    strip.offset.setValue(-0.25)
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
