"""A real window for tests: quick to open, with the slow parts replaced and dialogs answered."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QMimeData, QPoint, QPointF, QSettings, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent, QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QSlider, QWidget
from pytestqt.qtbot import QtBot

from faceedit_app import render
from faceedit_app.core.errors import FileError, Unavailable
from faceedit_app.core.resources import shipped
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.files import fingerprint, journal
from faceedit_app.editing.help import presets
from faceedit_app.editing.session import EditSession
from faceedit_app.media import output
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.look import guard
from faceedit_app.ui.page.editor import Editor
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state import loading
from faceedit_app.ui.state.preferences import Preferences
from support import curves, renewal
from support.curves import place
from support.faces import shipped_rig
from support.facts import Facts, facts_of, files_of
from support.takes import make_livelink_csv
from support.theme import themed

# Modules whose functions are looked up when they are called, never when a window is made.
_LATER = (dialogs, guard, output)


class FakeRenderer:
    """Paints the jaw's height as grey: enough to see that another face was drawn."""

    def __init__(self, rig: object, width: int, height: int) -> None:
        self.rig = rig
        self.size = (width, height)
        self.calls: list[tuple[tuple[int, int], render.Camera, bool]] = []
        self.tints: list[Any] = []  # one a call, None where nothing is tinted
        self.open = True
        self.picture: Any = None
        self.prepared = 0

    def resize(self, width: int, height: int) -> None:
        self.size = (width, height)

    def draw(
        self, vertices: Any, camera: render.Camera, smooth: bool = True, tint: Any = None
    ) -> Any:
        self.begin(vertices, camera, smooth, tint)
        return self.finish()

    def begin(
        self, vertices: Any, camera: render.Camera, smooth: bool = True, tint: Any = None
    ) -> None:
        self.calls.append((self.size, camera, smooth))
        self.tints.append(tint)
        width, height = self.size
        shade = int(abs(float(vertices[:, 1].sum()))) % 256
        self.picture = np.full((height, width, 4), shade, np.uint8)

    def finish(self) -> Any:
        finished, self.picture = self.picture, None
        return finished

    def prepare(self) -> None:
        assert self.picture is None, "the picture that was begun would be lost"
        self.prepared += 1

    def close(self) -> None:
        self.open = False


class Bench:
    """Opens windows, and knows how the user answers and what is shown to the user.

    Attributes:
        errors: what `show_error` said.
        exported: the file and the lines of each `show_exported`.
        answers: what the user answers to each `dialogs.ask_…`; none is asked unexpectedly.
    """

    def __init__(
        self, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch, folder: Path, shelf: renewal.Shelf
    ) -> None:
        self.qtbot, self.folder = qtbot, folder
        self._monkeypatch, self._shelf = monkeypatch, shelf
        self._was_plain = not self._patches()  # nothing was replaced before
        self._windows: list[MainWindow] = []
        self.errors: list[str] = []
        self.exported: list[Any] = []
        self.answers: dict[str, Any] = {}
        self.renderers: list[FakeRenderer] = []
        self.take = make_livelink_csv(folder / "take.csv", seconds=3.0)
        monkeypatch.setattr(dialogs, "show_error", lambda _w, e: self.errors.append(str(e)))
        monkeypatch.setattr(dialogs, "show_exported", lambda _w, *said: self.exported.append(said))
        self.forget_preferences()
        monkeypatch.setattr(journal, "journal_folder", lambda: folder / "journals")
        monkeypatch.setattr(fingerprint, "SEARCH_SECONDS", 60.0)  # also on a busy machine
        for name in dir(dialogs):
            if name.startswith("ask_"):
                monkeypatch.setattr(dialogs, name, self._answer(name.removeprefix("ask_")))
        monkeypatch.setattr(loading, "load_character", shipped_rig)
        monkeypatch.setattr(loading, "prepare_renderer", lambda: None)
        monkeypatch.setattr(loading, "load_engine", self._no_engine)
        monkeypatch.setattr(render, "open_renderer", self._renderer)
        monkeypatch.setattr(presets, "own_folder", lambda: folder / "presets")
        self._own_patches = self._patches()

    def _answer(self, name: str) -> Callable[..., Any]:
        def answer(_parent: QWidget, *_: object, **_named: object) -> Any:
            assert name in self.answers, f"asked for {name} unexpectedly"
            return self.answers.pop(name)

        return answer

    @staticmethod
    def _no_engine(_rig: object) -> Any:
        raise FileError("models/lower.onnx", "is missing", "train the networks")

    def _renderer(self, rig: object, width: int, height: int) -> FakeRenderer:
        self.renderers.append(FakeRenderer(rig, width, height))
        return self.renderers[-1]

    @staticmethod
    def no_gl(*_: object) -> Any:
        """In place of `open_renderer` on a machine without OpenGL."""
        raise Unavailable("The face cannot be drawn: no OpenGL; install it")

    def preferences(self) -> Preferences:
        """Settings that no other test and no user sees."""
        return Preferences(QSettings(str(self.folder / "settings.ini"), QSettings.Format.IniFormat))

    def forget_preferences(self) -> None:
        """Forget all that was remembered but that the first steps were seen."""
        preferences = self.preferences()
        preferences._settings.clear()
        preferences.set_hints_seen()

    def _patches(self) -> int:
        """How much is replaced that a window may use when it is made."""
        replaced = [target for target, *_ in self._monkeypatch._setattr if target not in _LATER]
        return len(replaced) + len(self._monkeypatch._setitem)

    @property
    def _is_plain(self) -> bool:
        """Whether the next window is the first, and nothing can make it differ from others."""
        settings = self.preferences()._settings.allKeys()
        replaced = self._patches() > self._own_patches or not self._was_plain
        return not (self._windows or replaced) and settings == ["hints_seen"]

    def window(self, take: Path | None = None, start: bool = True) -> MainWindow:
        """A new window on the screen; with a take, one in which it is open and all is settled."""
        window = MainWindow(self.preferences())
        self._windows.append(window)
        self._show(window)
        if start:
            self._start(window, take)
        return window

    def _show(self, window: MainWindow) -> None:
        window.resize(1280, 720)
        with self.qtbot.waitExposed(window):
            window.show()

    def _start(self, window: MainWindow, take: Path | None) -> None:
        with self.qtbot.waitSignal(window.settled, timeout=15_000):
            window.start(take)
        if take is not None:
            document = window.document
            self.qtbot.waitUntil(lambda: document.session is not None and not window._holds_title)

    def editing(self, take: Path | None = None) -> MainWindow:
        """A window with a take open, the usual one if none is given.

        It may be one that an earlier test has left, if nothing tells it from a new one. A test that
        replaces something before gets a new one: the constructors may use what it replaces.
        """
        take, known = take or self.take, self._shelf.known
        if not self._is_plain:
            return self.window(take)
        files = files_of(take)
        if files in known and (window := self._renewed(take, known[files])) is not None:
            return window
        window = self.window(take)
        known[files] = facts_of(window)
        return window

    def _renewed(self, take: Path, wanted: Facts) -> MainWindow | None:
        """The window that an earlier test has left, with a take; None if it is not as new."""
        window = self._shelf.take()
        if window is None:
            return None
        self.renew(window, take)
        if facts_of(window) == wanted:
            self._windows.append(window)
            return window
        renewal.close([window])
        self.renderers.clear()
        self.forget_preferences()  # that a take was opened
        return None

    def renew(self, window: MainWindow, take: Path) -> None:
        """Open a take in a window that was emptied, as if it were a new one."""
        renewal.prepare(window, self.preferences())
        self._show(window)
        QApplication.setActiveWindow(window)
        self._start(window, take)

    def leave(self) -> None:
        """Close the windows; the next test may get one of them."""
        renewal.close(window for window in self._windows if not self._shelf.put(window))


@pytest.fixture(scope="session")
def shelf(qapp: QApplication) -> Iterator[renewal.Shelf]:
    """The window of the last test."""
    shelf = renewal.Shelf()
    yield shelf
    if (window := shelf.take()) is not None:
        renewal.close([window])


@pytest.fixture
def bench(
    qtbot: QtBot, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, shelf: renewal.Shelf
) -> Iterator[Bench]:
    """What opens windows."""
    themed()
    bench = Bench(qtbot, monkeypatch, tmp_path, shelf)
    yield bench
    bench.leave()


def drag_curve(window: MainWindow, row: int, seconds: float, pixels: int) -> None:
    """Drag the curve in a row up by `pixels` at a time, with a real mouse."""
    assert window.editor is not None
    plot = window.editor.curves.plots[row]
    start = place(plot, seconds, plot.height() / 2)
    curves.drag(plot, start, start - QPoint(0, pixels))


def _move(widget: QWidget, to: QPoint, button: Qt.MouseButton = Qt.MouseButton.LeftButton) -> None:
    """QTest.mouseMove forgets the button that is held."""
    event = QMouseEvent(
        QEvent.Type.MouseMove,
        QPointF(to),
        QPointF(widget.mapToGlobal(to)),
        Qt.MouseButton.NoButton,
        button,
        Qt.KeyboardModifier.NoModifier,
    )
    QApplication.sendEvent(widget, event)


def drag(widget: QWidget, by: QPoint, button: Qt.MouseButton) -> None:
    """Press in the middle of a widget, move, release."""
    start = widget.rect().center()
    QTest.mousePress(widget, button, pos=start)
    _move(widget, start + by, button)
    QTest.mouseRelease(widget, button, pos=start + by)


def session_of(window: MainWindow) -> EditSession:
    """The session of the take that is open."""
    assert window.document.session is not None
    return window.document.session


def add_edit(window: MainWindow, value: float = 6.0) -> None:
    """An edit as a drag would leave it."""
    session_of(window).add(Edit(("mouth_opening",), Op.OFFSET, 1.0, 1.4, 0.2, value))


def trigger(window: MainWindow, command: str) -> None:
    """Choose a command from the menus."""
    window.actions_[command].trigger()


def trigger_enabled(window: MainWindow, *commands: str) -> None:
    """Choose commands one after the other, each of which must be enabled by then."""
    for command in commands:
        assert window.actions_[command].isEnabled(), command
        trigger(window, command)


def step_names(session: EditSession) -> tuple[str, str]:
    """What Undo and Redo would take back and repeat."""
    return session.undo_name, session.redo_name


def with_problems(bench: Bench, monkeypatch: pytest.MonkeyPatch, folder: Path) -> MainWindow:
    """With the demo take: it has a half blink and lips that nearly meet.

    Presets of the user's are kept in a folder of the test's.
    """
    window = bench.editing(shipped("assets/demo_take.csv"))
    editor_of(window).problems.search()
    return window


def await_trial(bench: Bench, window: MainWindow) -> None:
    """Wait until the fixes of the problems in the list have been tried."""
    bench.qtbot.waitUntil(lambda: not editor_of(window).trials.is_trying)


def double_click(slider: QSlider) -> None:
    """At its right end, as Qt reports it: the first click is one of its own."""
    end = QPoint(slider.width() - 3, slider.height() // 2)
    for click in (QTest.mouseClick, QTest.mouseDClick):
        click(slider, Qt.MouseButton.LeftButton, pos=end)


def with_undone_slider(bench: Bench) -> MainWindow:
    """With a take with one edit, and a step of its slider that was taken back."""
    window = bench.editing()
    add_edit(window)
    press_key(editor_of(window).settings_bar.exactness, Qt.Key.Key_Left)
    trigger(window, "undo")
    return window


def drop(target: QWidget, *paths: Path) -> None:
    """Drop files on a widget, and let the window handle them once the drop is over.

    What the widget does not want goes to the widgets around it.
    """
    assert drop_only(target, *paths)
    QApplication.sendPostedEvents(target.window(), QEvent.Type.MetaCall.value)


def drop_only(target: QWidget, *paths: Path) -> bool:
    """Drop files on a widget, without what the window does with them later.

    Returns:
        Whether they were accepted.
    """
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(path)) for path in paths])
    buttons, keys = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
    enter = QDragEnterEvent(QPoint(9, 9), Qt.DropAction.CopyAction, data, buttons, keys)
    enter.ignore()  # as the window system sends it
    QApplication.sendEvent(target, enter)
    event = QDropEvent(QPointF(9, 9), Qt.DropAction.CopyAction, data, buttons, keys)
    event.ignore()
    QApplication.sendEvent(target, event)
    assert event.isAccepted() == enter.isAccepted()
    return event.isAccepted()


def open_path(window: MainWindow) -> Path:
    """The take that is open."""
    assert window.document.path is not None
    return window.document.path


def editor_of(window: MainWindow) -> Editor:
    """The page of the take that is open."""
    assert window.editor is not None
    return window.editor


def press_key(widget: QWidget, key: Qt.Key, times: int = 1) -> None:
    widget.setFocus()  # arrows would move the playhead
    for _ in range(times):
        QTest.keyClick(widget, key)
