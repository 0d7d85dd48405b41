"""Sound and film in the real window, with a sound device that only takes notes."""

from __future__ import annotations

from pathlib import Path

import pytest
from PySide6.QtCore import QEvent, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QApplication, QWidget

from faceedit_app.media import output
from faceedit_app.media.sound import Sound
from faceedit_app.ui.start.window import MainWindow
from support.films import number_of
from support.waiting import wait_for_background
from support.windows import Bench, editor_of


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


def settle(bench: Bench, window: MainWindow) -> None:
    """Wait until files are read and the sound device is open."""
    bench.qtbot.waitUntil(lambda: window.media.pending == 0, timeout=10_000)
    wait_for_background(window.workspace.background)  # the device is open


def with_media(bench: Bench, *paths: Path) -> MainWindow:
    """A window with the usual take, and sounds and films added to it."""
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
    """A mouse event in the middle of a strip."""
    at = QPointF(x, widget.height() / 2)
    left, none = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton
    moving = kind == QEvent.Type.MouseMove
    held = none if kind == QEvent.Type.MouseButtonRelease else left
    glob = widget.mapToGlobal(at)
    event = QMouseEvent(kind, at, glob, none if moving else left, held, keys)
    QApplication.sendEvent(widget, event)


def drag(widget: QWidget, first: float, last: float, keys: Qt.KeyboardModifier) -> None:
    """Press, move twice, and release, with keys held."""
    mouse(widget, QEvent.Type.MouseButtonPress, first, keys)
    mouse(widget, QEvent.Type.MouseMove, (first + last) / 2, keys)
    mouse(widget, QEvent.Type.MouseMove, last, keys)
    mouse(widget, QEvent.Type.MouseButtonRelease, last, keys)


def shown(bench: Bench, window: MainWindow) -> int:
    """The number that the picture on screen carries."""
    screen = editor_of(window).film.screen_
    bench.qtbot.waitUntil(lambda: screen.index == screen.wanted, timeout=10_000)
    assert screen._picture is not None
    return number_of(screen._picture)
