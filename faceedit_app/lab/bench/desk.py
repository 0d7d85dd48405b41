"""A real window without a display, with a simulated mouse."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path

import numpy as np
from PySide6.QtCore import QEvent, QPointF, QSettings, Qt, QTimer
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QApplication, QWidget

from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.core.resources import DEMO_TAKE, shipped
from faceedit_app.core.rig import Rig
from faceedit_app.editing.opening import open_session
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.opening import open_take
from faceedit_app.formats.take import Take
from faceedit_app.networks.engine import Engine
from faceedit_app.ui.curves.interaction import PREVIEW_INTERVAL
from faceedit_app.ui.curves.plot import CurvePlot
from faceedit_app.ui.page.editor import Editor
from faceedit_app.ui.start.application import keep_for_good
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.preferences import Preferences

RATE = 25.0  # the paper's: each frame is one of the networks' own
VIEW = 8.0  # seconds of curves on screen
_LEFT, _NONE = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton


def long_take(frames: int, rate: float = RATE) -> Take:
    """The demo take, repeated to a number of frames."""
    demo = _demo()
    rows = np.arange(frames) % len(demo.clip)
    times = np.arange(frames) / rate
    clip = Clip(demo.clip.weights[rows], demo.clip.channels, times, rate)
    return Take(Path(f"{frames}.csv"), demo.format, clip, (), (), demo.source)


@lru_cache
def _demo() -> Take:
    return open_take(shipped(DEMO_TAKE))


class Desk:
    """The window, with the face in a square of a given size.

    Args:
        folder: for the window's settings, to leave the user's alone.
        rig, engine: the character and the networks.
        rest: share of the usual time in which it comes to rest between measurements, and of the
            usual steps that warm it up.
    """

    def __init__(
        self, app: QApplication, folder: Path, rig: Rig, engine: Engine, rest: float = 1.0
    ) -> None:
        self.app, self.rig, self.engine, self._rest = app, rig, engine, rest
        settings = QSettings(str(folder / "settings.ini"), QSettings.Format.IniFormat)
        self.window = MainWindow(Preferences(settings))
        self.window.document.engine = engine
        self.window.resize(1440, 900)
        self.window.show()
        self.editor: Editor = self.window.build_editor()
        self._drawn: Rig | None = None
        self.worked = 0.0  # ms of processor time for the last step of a drag

    @property
    def session(self) -> EditSession:
        """The open take's."""
        session = self.window.document.session
        assert session is not None
        return session

    def open(self, take: Take, size: int = 640, rig: Rig | None = None) -> EditSession:
        """Open a take, with its middle in view.

        Args:
            take: the take.
            size: pixels across the face.
            rig: a version of the character with other vertices.
        """
        rig = rig or self.rig
        self.window.document.adopt(open_session(take, rig, self.engine))
        viewport = self.editor.face.viewport
        if rig is not self._drawn:
            viewport.open(rig)
            keep_for_good()
            self._drawn = rig
        viewport.setFixedSize(size, size)
        middle = take.clip.duration / 2
        self.window.timeline.show_range(middle - VIEW / 2, middle + VIEW / 2)
        self.window.timeline.go_to_time(middle)
        self.settle()
        return self.session

    def settle(self, seconds: float = 0.25) -> None:
        """Wait until everything is computed and painted, and the smooth picture drawn."""
        until = time.perf_counter() + self._rest * seconds
        while time.perf_counter() < until or self.editor.solving.is_busy:
            self.app.processEvents()

    def warm_up(self, step: Callable[[], object], times: int) -> None:
        """Do steps that are not measured."""
        for _ in range(round(self._rest * times)):
            step()

    # --- the mouse -----------------------------------------------------------------------------

    def plot(self, control: str) -> CurvePlot:
        """The plot of a control."""
        return self.editor.curves.plots[CONTROL_IDS.index(control)]

    def choose(self, *controls: str) -> None:
        """Choose curves to edit together, or none."""
        curves = self.editor.curves
        for control in {*controls} ^ {*curves.chosen_controls}:
            curves.headers[CONTROL_IDS.index(control)].picked.emit(True)

    def press(self, control: str, seconds: float) -> None:
        """Press on a curve."""
        plot = self.plot(control)
        x = plot.current_scale.x_of(seconds)
        self._held = plot.view.mapToScene(QPointF(x, plot.height() / 2))
        self._at = self._held
        self._send(plot, QEvent.Type.MouseButtonPress, _LEFT)

    def move(self, control: str, pixels: float) -> None:
        """Drag the curve to a number of pixels above the press."""
        self._at = self._held - QPointF(0.0, pixels)
        self._send(self.plot(control), QEvent.Type.MouseMove, _NONE)

    def release(self, control: str) -> None:
        """Release the curve."""
        self._send(self.plot(control), QEvent.Type.MouseButtonRelease, _LEFT)
        self.settle(0.0)

    def cancel(self) -> None:
        """Cancel the drag."""
        self.editor.curves.cancel_drag()
        self.settle(0.0)

    def _send(self, plot: CurvePlot, kind: QEvent.Type, button: Qt.MouseButton) -> None:
        """Send a mouse event; a scene's coordinates are the pixels of its view."""
        widget, keys = plot.viewport(), Qt.KeyboardModifier.NoModifier
        place = QPointF(widget.mapToGlobal(self._at))
        QApplication.sendEvent(widget, QMouseEvent(kind, self._at, place, button, _LEFT, keys))

    def dragged(self, control: str) -> Callable[[], float]:
        """A drag in steps: each call moves the mouse, waits for the picture, returns ms."""
        viewport = self.editor.face.viewport
        step = 0

        def once() -> float:
            nonlocal step
            step += 1
            # At most one preview per screen refresh; the wait for it does not count.
            resume = time.perf_counter() + 1.1 * PREVIEW_INTERVAL
            while time.perf_counter() < resume:
                self.app.processEvents()
            draws, began, worked = viewport.draws, time.perf_counter(), time.process_time()
            self.move(control, 12.0 + step % 24)
            while viewport.draws == draws:
                self.app.processEvents()
            self.worked = 1e3 * (time.process_time() - worked)
            return 1e3 * (time.perf_counter() - began)

        return once


class Heartbeat:
    """The longest time during which the window did not respond."""

    def __init__(self, parent: QWidget) -> None:
        self._timer = QTimer(parent, interval=1)
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self._tick)
        self._last = time.perf_counter()
        self.longest = 0.0
        self._timer.start()

    def _tick(self) -> None:
        now = time.perf_counter()
        self.longest = max(self.longest, now - self._last)
        self._last = now

    def stop(self) -> float:
        """Milliseconds."""
        self._tick()
        self._timer.stop()
        return 1e3 * self.longest
