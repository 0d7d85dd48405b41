"""Mouse and keys on a window, and what becomes of its dialogs and errors meanwhile."""

from __future__ import annotations

import contextlib
import random
import sys
import threading
import traceback
from collections.abc import Callable, Iterator
from enum import Enum
from types import TracebackType
from typing import Any

from PySide6.QtCore import (
    QCoreApplication,
    QEvent,
    QMessageLogContext,
    QPoint,
    QPointF,
    Qt,
    QtMsgType,
    qInstallMessageHandler,
)
from PySide6.QtGui import QContextMenuEvent, QKeyEvent, QMouseEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractScrollArea, QApplication, QMenu, QWidget

from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.start.window import MainWindow

# They open another take, end the window, or turn on a camera, if there is one.
LEFT_OUT = frozenset(("open", "open_demo", "record_webcam", "quit"))
HELD = (
    *(Qt.KeyboardModifier.NoModifier,) * 4,
    *(Qt.KeyboardModifier.ShiftModifier, Qt.KeyboardModifier.ControlModifier),
    Qt.KeyboardModifier.AltModifier,
)
_LEFT, _NONE = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton
_GIVES_UP, _INTERRUPTS = 0.1, 0.08  # of the drags: Esc, or a command, before the release
_WITHOUT_A_SCREEN = "This plugin does not support"
_NOTCH = 120  # of a wheel


class Hands:
    """What a user's hands do; chance decides what nobody says.

    Attributes:
        window, editor: what they are on; a take is open.
        chance: decides.
        character: the user's, if the window showed it at first.
        unused: commands of the menus that have not been used yet.
    """

    def __init__(self, window: MainWindow, chance: random.Random) -> None:
        assert window.editor is not None
        self.window, self.editor, self.chance = window, window.editor, chance
        self.character = window.document.character
        self._commands = [
            command.id
            for menu, _ in window.commands.menus()
            for command in menu.commands
            if command.id not in LEFT_OUT and command.fills is None
        ]
        self.unused = set(self._commands)

    def run_command(self) -> str:
        """Choose a command from the menus, if it is enabled; returns its name."""
        return self._run(self.chance.choice(self._commands))

    def run_unused_command(self) -> str:
        """Choose a command that has not been used yet, if one is enabled; returns its name."""
        can = [name for name in sorted(self.unused) if self.window.actions_[name].isEnabled()]
        return self._run(self.chance.choice(can)) if can else self.run_command()

    def _run(self, name: str) -> str:
        if self.window.actions_[name].isEnabled():
            self.unused.discard(name)
            self.window.actions_[name].trigger()
        return name

    def place_on(self, widget: QWidget) -> QPointF:
        """Some place on a widget."""
        across, down = (self.chance.uniform(0, n) for n in (widget.width(), widget.height()))
        return QPointF(across, down)

    def press(self, widget: QWidget, at: QPointF) -> None:
        """Press the left button."""
        held = Qt.KeyboardModifier.NoModifier
        _send(receiver(widget), QEvent.Type.MouseButtonPress, at, _LEFT, held)

    def move(self, widget: QWidget, at: QPointF) -> None:
        """Move with the left button down."""
        held = Qt.KeyboardModifier.NoModifier
        _send(receiver(widget), QEvent.Type.MouseMove, at, _NONE, held)

    def drag(self, widget: QWidget, start: QPointF, by: QPointF) -> None:
        """Drag; now and then give up with Esc, or choose a command before the release."""
        on, held = receiver(widget), self.chance.choice(HELD)
        _send(on, QEvent.Type.MouseButtonPress, start, _LEFT, held)
        for step in range(1, 5):
            _send(on, QEvent.Type.MouseMove, start + by * (step / 4), _NONE, held)
            QCoreApplication.processEvents()
        if self.chance.random() < _GIVES_UP:
            QTest.keyClick(self.window, Qt.Key.Key_Escape)
        elif self.chance.random() < _INTERRUPTS:
            self.run_command()
            _send(on, QEvent.Type.MouseMove, start + by * 0.7, _NONE, held)
        _send(on, QEvent.Type.MouseButtonRelease, start + by, _LEFT, held)

    def double_click(self, widget: QWidget, at: QPointF) -> None:
        """Click twice."""
        on, held = receiver(widget), Qt.KeyboardModifier.NoModifier
        for kind in (
            QEvent.Type.MouseButtonPress,
            QEvent.Type.MouseButtonRelease,
            QEvent.Type.MouseButtonDblClick,
            QEvent.Type.MouseButtonRelease,
        ):
            _send(on, kind, at, _LEFT, held)

    def turn_wheel(self, widget: QWidget, at: QPointF) -> None:
        """Turn the wheel a few notches, up or down."""
        on, notches = receiver(widget), self.chance.choice((-3, -1, 1, 3))
        place, held = QPointF(on.mapToGlobal(at)), self.chance.choice(HELD)
        no_phase = Qt.ScrollPhase.NoScrollPhase
        turned = QPoint(0, notches * _NOTCH)
        event = QWheelEvent(at, place, QPoint(), turned, _NONE, held, no_phase, False)
        QApplication.sendEvent(on, event)

    def choose_from_menu(self, widget: QWidget, at: QPointF) -> None:
        """Open a context menu, and choose something from it, or nothing."""
        on, right = receiver(widget), Qt.MouseButton.RightButton
        held = Qt.KeyboardModifier.NoModifier
        for kind in (QEvent.Type.MouseButtonPress, QEvent.Type.MouseButtonRelease):
            _send(on, kind, at, right, held)
        place = on.mapToGlobal(at.toPoint())
        reason = QContextMenuEvent.Reason.Mouse
        QApplication.sendEvent(on, QContextMenuEvent(reason, at.toPoint(), place))
        menu = QApplication.activePopupWidget()
        if isinstance(menu, QMenu):
            can = [one for one in menu.actions() if one.isEnabled() and one.menu() is None]
            chosen = self.chance.choice([None, *can])
            menu.close()
            if chosen is not None and not chosen.isSeparator():
                chosen.trigger()

    def type_into(self, field: QWidget, text: str) -> None:
        """Replace what a field says, and press Enter."""
        QTest.keyClick(field, Qt.Key.Key_A, Qt.KeyboardModifier.ControlModifier)
        for letter in text:  # `QTest.keyClicks` types only ASCII
            for kind in (QEvent.Type.KeyPress, QEvent.Type.KeyRelease):
                event = QKeyEvent(kind, 0, Qt.KeyboardModifier.NoModifier, letter)
                QApplication.sendEvent(field, event)
        QTest.keyClick(field, Qt.Key.Key_Return)


def receiver(widget: QWidget) -> QWidget:
    """What gets the mouse events on a widget."""
    return widget.viewport() if isinstance(widget, QAbstractScrollArea) else widget


def _send(
    widget: QWidget,
    kind: QEvent.Type,
    at: QPointF,
    button: Qt.MouseButton,
    held: Qt.KeyboardModifier,
) -> None:
    """Send a mouse event; a move is a drag with the left button."""
    down = button if button != _NONE else _LEFT
    if kind == QEvent.Type.MouseButtonRelease:
        down = _NONE
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
def qt_warnings_noted() -> Iterator[list[str]]:
    """Collect what Qt warns of: a program that uses it rightly hears of nothing.

    What its platform without a screen cannot do is no fault of the window's, and is not printed.
    """
    found: list[str] = []

    def note(kind: QtMsgType, context: QMessageLogContext, text: str) -> None:
        if text.startswith(_WITHOUT_A_SCREEN):
            return
        print(f"Qt: {text}", *traceback.format_stack(limit=6), sep="\n", file=sys.stderr)
        if kind in (QtMsgType.QtWarningMsg, QtMsgType.QtCriticalMsg):
            found.append(f"Qt: {text}")

    before = qInstallMessageHandler(note)
    try:
        yield found
    finally:
        qInstallMessageHandler(before)


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
