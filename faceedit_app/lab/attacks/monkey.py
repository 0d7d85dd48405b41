"""Uses the window at random, with mouse and keys and by its commands, as no user would."""

from __future__ import annotations

import contextlib
import random
import sys
import threading
from collections.abc import Callable, Iterator
from enum import Enum
from types import TracebackType
from typing import Any

from PySide6.QtCore import QCoreApplication, QEvent, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractScrollArea, QApplication, QDialog, QWidget

from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.tools import Tool

# They open another take, or end the window.
_LEFT_OUT = frozenset(("open", "open_demo", "quit"))
_KEYS = (
    *(Qt.Key.Key_Escape, Qt.Key.Key_Return, Qt.Key.Key_Tab, Qt.Key.Key_Space, Qt.Key.Key_Delete),
    *(Qt.Key.Key_Left, Qt.Key.Key_Right, Qt.Key.Key_Up, Qt.Key.Key_Down, Qt.Key.Key_F2),
    *(Qt.Key.Key_7, Qt.Key.Key_Period, Qt.Key.Key_B, Qt.Key.Key_Home, Qt.Key.Key_PageUp),
)
_HELD = (
    *(Qt.KeyboardModifier.NoModifier,) * 4,
    *(Qt.KeyboardModifier.ShiftModifier, Qt.KeyboardModifier.ControlModifier),
    Qt.KeyboardModifier.AltModifier,
)
_LEFT, _NONE = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton
_WILD = 0.05  # of the drags leave the window far behind


class Monkey:
    """Acts on a window with an open take.

    Attributes:
        last: what it did last, for messages.
    """

    def __init__(self, window: MainWindow, chance: random.Random) -> None:
        assert window.editor is not None
        self._window, self._editor, self._chance = window, window.editor, chance
        self._commands = [
            command.id
            for menu, _ in window.commands.menus()
            for command in menu.commands
            if command.id not in _LEFT_OUT and command.fills is None
        ]
        self.last = ""

    def act(self) -> None:
        """Do one thing that a user can do."""
        doing: tuple[Callable[[], None], ...] = (
            *(self.command,) * 6,
            *(self.drag_curve,) * 5,
            *(self.drag_strip, self.choose_edit, self.set_strength, self.press_key, self.zoom),
        )
        one = self._chance.choice(doing)
        self.last = one.__name__
        one()
        for dialog in self._window.findChildren(QDialog):
            if dialog.isVisible() and self._chance.random() < 0.5:
                dialog.close()

    def command(self) -> None:
        """Choose a command from the menus, if it is enabled."""
        name = self._chance.choice(self._commands)
        self.last = f"command {name}"
        if self._window.actions_[name].isEnabled():
            self._window.actions_[name].trigger()

    def drag_curve(self) -> None:
        """Drag a curve with some tool, now and then far too far, or give up with Esc."""
        self._window.tools.choose(self._chance.choice(list(Tool)))
        plots = [plot for plot in self._editor.curves.plots if plot.isVisible()]
        if not plots:
            return
        plot = self._chance.choice(plots)
        seconds = self._chance.uniform(*self._window.timeline.view)
        x = plot.view.mapToScene(QPointF(plot.current_scale.x_of(seconds), 0.0)).x()
        far = 100_000 if self._chance.random() < _WILD else 40
        by = QPointF(self._chance.randint(-far, far), self._chance.randint(-far, far))
        self._drag(plot, QPointF(x, self._chance.uniform(0, plot.height())), by)

    def drag_strip(self) -> None:
        """Drag on the ruler, the range bar or the picture of the face."""
        curves = self._editor.curves
        widget = self._chance.choice((curves.ruler, curves.range_bar, self._editor.face.viewport))
        start, stop = (
            QPointF(
                self._chance.uniform(0, widget.width()), self._chance.uniform(0, widget.height())
            )
            for _ in range(2)
        )
        self._drag(widget, start, stop - start)

    def choose_edit(self) -> None:
        """Choose an edit in the list."""
        count = len(self._editor.edits.model.edits)
        if count:
            self._editor.edits.select(self._chance.randrange(count))

    def set_strength(self) -> None:
        """Move the slider of an edit's strength, or the one from natural to exact."""
        sliders = (self._editor.edits.strength, self._editor.settings_bar.exactness)
        slider = self._chance.choice(sliders)
        if slider.isEnabled():
            slider.setSliderDown(True)
            slider.setSliderPosition(self._chance.randint(slider.minimum(), slider.maximum()))
            slider.setSliderDown(False)

    def press_key(self) -> None:
        """Press a key where the focus is."""
        key, held = self._chance.choice(_KEYS), self._chance.choice(_HELD)
        self.last = f"key {key.name}"
        QTest.keyClick(QApplication.focusWidget() or self._window, key, held)

    def zoom(self) -> None:
        """Show another part of the take."""
        end = self._window.timeline.duration
        first, last = sorted(self._chance.uniform(0, end) for _ in range(2))
        self._window.timeline.show_range(first, last)

    def _drag(self, widget: QWidget, start: QPointF, by: QPointF) -> None:
        on = widget.viewport() if isinstance(widget, QAbstractScrollArea) else widget
        held = self._chance.choice(_HELD)
        _send(on, QEvent.Type.MouseButtonPress, start, _LEFT, held)
        for step in range(1, 5):
            _send(on, QEvent.Type.MouseMove, start + by * (step / 4), _NONE, held)
            QCoreApplication.processEvents()
        if self._chance.random() < 0.1:
            QTest.keyClick(self._window, Qt.Key.Key_Escape)
        _send(on, QEvent.Type.MouseButtonRelease, start + by, _LEFT, held)


def _send(
    widget: QWidget,
    kind: QEvent.Type,
    at: QPointF,
    button: Qt.MouseButton,
    held: Qt.KeyboardModifier,
) -> None:
    down = _NONE if kind == QEvent.Type.MouseButtonRelease else _LEFT
    place = QPointF(widget.mapToGlobal(at))
    QApplication.sendEvent(widget, QMouseEvent(kind, at, place, button, down, held))


@contextlib.contextmanager
def dialogs_cancelled() -> Iterator[list[str]]:
    """Answer every dialog as a user does who cancels; yields the errors that are shown."""
    before = {name: getattr(dialogs, name) for name in dir(dialogs) if name.startswith("ask_")}
    shown: list[str] = []
    show_error = dialogs.show_error
    for name, ask in before.items():
        answer = _cancelled(ask)
        setattr(dialogs, name, lambda *_args, _answer=answer, **_more: _answer)
    setattr(dialogs, "show_error", lambda _parent, error: shown.append(str(error)))  # noqa: B010
    try:
        yield shown
    finally:
        for name, ask in before.items():
            setattr(dialogs, name, ask)
        dialogs.show_error = show_error


def _cancelled(ask: Callable[..., Any]) -> Enum | None:
    """What a question returns if it is cancelled."""
    kind = getattr(dialogs, str(ask.__annotations__.get("return", "")), None)
    if isinstance(kind, type) and issubclass(kind, Enum):
        members = kind.__members__
        return members.get("CANCEL") or members["LATER"]
    return None


@contextlib.contextmanager
def exceptions_noted() -> Iterator[list[str]]:
    """Collect what would reach the user as an unexpected error."""
    found: list[str] = []
    before, before_in_threads = sys.excepthook, threading.excepthook

    def note(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        before(kind, error, trace)
        found.append(f"{kind.__name__}: {error}")

    sys.excepthook = note
    threading.excepthook = lambda args: found.append(f"{args.exc_type.__name__}: {args.exc_value}")
    try:
        yield found
    finally:
        sys.excepthook, threading.excepthook = before, before_in_threads
