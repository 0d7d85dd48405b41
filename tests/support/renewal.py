"""A window that an earlier test has left, made as new: opening one takes three times as long.

It is used again only if nothing that `facts_of` sees tells it from a new one; else it is closed.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Hashable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from enum import Enum
from pathlib import Path
from typing import Any, cast

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import (
    QCoreApplication,
    QEvent,
    QObject,
    QPoint,
    QPointF,
    QRect,
    QRectF,
    QSize,
    Qt,
    QTimer,
    SignalInstance,
)
from PySide6.QtGui import QAction
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractSlider,
    QApplication,
    QComboBox,
    QDialog,
    QDockWidget,
    QDoubleSpinBox,
    QGraphicsScene,
    QLabel,
    QLineEdit,
    QStackedWidget,
    QStatusBar,
    QTabBar,
    QWidget,
)
from shiboken6 import isValid

from faceedit_app.ui.curves.header import Header
from faceedit_app.ui.curves.plot import CurvePlot
from faceedit_app.ui.curves.time_view import TimeView
from faceedit_app.ui.edits.delegate import EditsDelegate
from faceedit_app.ui.face.resolution import Quality
from faceedit_app.ui.media.parts import Name
from faceedit_app.ui.page.editor import Editor
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.background import Background
from faceedit_app.ui.state.preferences import Preferences
from faceedit_app.ui.state.time_display import Unit
from faceedit_app.ui.state.tools import DEFAULT_SMOOTH, Tool

Facts = dict[str, Hashable]
Files = tuple[tuple[str, bytes], ...]

_PLAIN = (bool, int, float, str, bytes, type(None), Enum)
# A set tells sooner what nearly all values are: plain, or nothing that can be looked into.
_PLAIN_TYPES = frozenset(_PLAIN)
_OPAQUE: set[type] = set()  # those found so far
_FOLDED = (CurvePlot, Header)
_SEEN = (QWidget, QAction, QTimer, QGraphicsScene)
_BOXES = (QPoint, QPointF, QRect, QRectF, QSize)
_DEEPEST = 4  # levels of lists in lists
_OURS = "faceedit_app.ui."
# Attributes of caches, of what is made when it is first needed, of what counts how often something
# happened, and of what the next press or picture sets before it is read.
_PASSING = {
    "__METAOBJECT__", "_job", "draws", "_newest", "_anchor", "_last_preview", "_spans",
    "_extremes", "_numbers", "_painted", "lastMousePos", "_stale", "_smooth", "_picture", "_began",
    "_shown_at", "_measured", "range", "_box", "_backdrop", "_took", "_loudest", "_share",
}  # fmt: skip


# --- what can be told of a window ----------------------------------------------------------------


def facts_of(window: MainWindow) -> Facts:
    """All that its widgets show, and all that its objects hold: the same for the same state."""
    if window.editor is not None and window.editor.problems.is_searched:
        window.editor.problems.restart()  # a slow computer has searched the take by now
    facts: Facts = {"title": window.windowTitle(), "state": window.windowState().value}
    for name, thing in _parts("", window):
        is_ours = type(thing).__module__.startswith(_OURS)
        if not is_ours and not isinstance(thing, _SEEN):
            continue  # what Qt keeps for itself
        if isinstance(thing, QGraphicsScene):
            facts[name] = _seen_in(thing)
        else:
            if (shown := _shown(thing)) is not None:
                facts[name] = shown
            if is_ours:
                _add_held(facts, name, thing)
    return facts


def _parts(above: str, thing: QObject) -> Iterator[tuple[str, QObject]]:
    """It and all below it, by names that do not depend on what lies upon what."""
    if isinstance(thing, _FOLDED) and thing.control.optional and thing.isHidden():
        return  # folded away, it is brought up to date when it is unfolded
    yield above, thing
    counts: dict[str, int] = {}
    for child in thing.children():
        kind = f"{type(child).__name__} {child.objectName()}"
        counts[kind] = counts.get(kind, 0) + 1
        yield from _parts(f"{above}/{kind} {counts[kind]}", child)


def _shown(thing: QObject) -> Hashable:
    """What the user sees of it."""
    if isinstance(thing, QAction):
        return thing.text(), thing.isEnabled(), thing.isChecked(), thing.isVisible()
    if isinstance(thing, QTimer):
        return thing.interval()
    if not isinstance(thing, QWidget) or thing.objectName().startswith("qt_scrollarea_"):
        return None  # what Qt makes when it is first needed
    if not thing.isVisible() and not _is_on_a_page(thing):
        return None  # it is set when it is shown
    place: Hashable = None
    if thing.isVisible():
        place = repr(thing.size()) if thing.isWindow() else repr(thing.geometry())
    common = (
        thing.isHidden(),
        place,
        thing.isEnabled(),
        thing.hasFocus(),
        _anywhere(thing.toolTip()),
    )
    return common, thing.accessibleDescription(), _content(thing)


def _is_on_a_page(widget: QWidget) -> bool:
    """Whether another page hides it, but nothing on its own page."""
    place: QWidget | None = widget
    while place is not None and not isinstance(place.parentWidget(), QStackedWidget):
        if place.isHidden():
            return False
        place = place.parentWidget()
    return place is not None


def _seen_in(scene: QGraphicsScene) -> Hashable:
    """What is seen in a plot or on a strip, from front to back, and at which scale."""
    views = [item for item in scene.items() if isinstance(item, TimeView)]
    ranges = repr([(view.viewRange(), view._is_held) for view in views])
    return ranges, tuple(type(item).__name__ for item in scene.items() if item.isVisible())


def _anywhere(text: str) -> str:
    """A text without the folders in it: each test has one of its own."""
    return re.sub(r"\S*/", "", text)


def _content(widget: QWidget) -> Hashable:
    match widget:
        case QAbstractButton():
            return widget.text(), widget.isChecked()
        case QLabel() | QLineEdit():
            return widget.text()
        case QAbstractSlider():
            return widget.value(), widget.minimum(), widget.maximum(), widget.isSliderDown()
        case QDoubleSpinBox():
            return widget.value(), widget.minimum(), widget.maximum(), widget.text()
        case QComboBox():
            return widget.currentIndex(), widget.count()
        case QTabBar():
            return widget.currentIndex()
        case QStatusBar():
            return widget.currentMessage()
    return None


def _add_held(facts: Facts, name: str, thing: object, depth: int = 0) -> None:
    """Add what the attributes of an object hold, and those of ours that are in them."""
    for attribute, value in getattr(thing, "__dict__", {}).items():
        if attribute in _PASSING or isinstance(value, SignalInstance):
            continue
        facts[f"{name}.{attribute}"] = _plain(value)
        if depth < _DEEPEST and _is_ours(value):
            _add_held(facts, f"{name}.{attribute}", value, depth + 1)


def _is_ours(value: object) -> bool:
    """Whether it is a part of the window that is not among its children."""
    return type(value).__module__.startswith(_OURS) and not isinstance(value, QObject | Enum)


def _plain(value: Any, depth: int = 0) -> Hashable:
    """What can be compared of a value: itself, its parts, or else its type."""
    kind = type(value)
    if kind in _OPAQUE:
        return kind.__qualname__
    if kind in _PLAIN_TYPES or isinstance(value, _PLAIN):
        return cast(Hashable, value)
    if isinstance(value, Path):
        return value.name  # each test has a folder of its own
    if isinstance(value, _BOXES):
        return repr(value)
    if isinstance(value, np.ndarray):
        return value.shape, hash(value.tobytes())
    if depth < _DEEPEST:
        if isinstance(value, tuple | list):
            return tuple(_plain(part, depth + 1) for part in value)
        if isinstance(value, set | frozenset):
            return frozenset(_plain(part, depth + 1) for part in value)
        if isinstance(value, dict):
            pairs = [
                (_plain(key, depth + 1), _plain(part, depth + 1)) for key, part in value.items()
            ]
            return tuple(pairs)
        _OPAQUE.add(kind)
    return kind.__qualname__


def differences(one: Facts, other: Facts) -> list[str]:
    """What tells two windows apart, a line each."""
    return [
        f"{name}: {one.get(name, 'absent')} / {other.get(name, 'absent')}"
        for name in sorted({*one, *other})
        if one.get(name, "absent") != other.get(name, "absent")
    ]


def files_of(take: Path) -> Files:
    """The files from which a take is opened: itself, and sound and film beside it."""
    return tuple((p.name, p.read_bytes()) for p in sorted(take.parent.glob(f"{take.stem}.*")))


# --- leaving it, and beginning again -------------------------------------------------------------


class Shelf:
    """Keeps a window from one test to the next of this process.

    Attributes:
        known: what can be told of a new window, by what `files_of` its take are.
    """

    def __init__(self) -> None:
        self._window: MainWindow | None = None
        self.known: dict[Files, Facts] = {}

    def put(self, window: MainWindow) -> bool:
        """Empty a window and keep it; False if there is one, or it is of no further use."""
        if self._window is not None or not _is_of_use(window):
            return False
        _release_mouse(window)
        _empty(window)
        self._window = window
        return True

    def take(self) -> MainWindow | None:
        """The window, which is then no longer here."""
        window, self._window = self._window, None
        return window


def _is_of_use(window: MainWindow) -> bool:
    """Whether it still works, nothing works for it, and it has no windows of its own."""
    return (
        isValid(window)
        and QApplication.activePopupWidget() is None
        and window.isVisible()
        and window.editor is not None
        and window.document.session is not None
        and not window.findChildren(QDialog)
        and not window.findChildren(QDockWidget)
        and all(map(_is_idle, window.findChildren(Background)))
    )


def _is_idle(background: Background) -> bool:
    pool: ThreadPoolExecutor = background._pool
    threads = [thread.ident for thread in pool._threads]
    return not background._closed and pool._work_queue.empty() and all(map(_waits, threads))


def _waits(thread: int | None) -> bool:
    """Whether a thread of a pool waits for work.

    The pool itself does not know: it counts a thread twice as idle if work had to wait for one.
    """
    frame = sys._current_frames().get(thread or 0)
    if frame is None or frame.f_code.co_name != "_worker":
        return False
    return frame.f_locals.get("work_item") is None


def _release_mouse(window: MainWindow) -> None:
    """Release what a test has left pressed."""
    left, right = Qt.MouseButton.LeftButton, Qt.MouseButton.RightButton
    for button in (left, right, Qt.MouseButton.MiddleButton):
        if button in QApplication.mouseButtons():
            QTest.mouseRelease(window, button)


def _empty(window: MainWindow) -> None:
    """Close the take as closing the window would, and take the window from the screen."""
    workspace, document, page = window.workspace, window.document, window.editor
    assert page is not None
    assert document.session is not None
    workspace.end_gestures()
    window.commands.file.stop()
    for background in window.findChildren(Background):  # deliver nothing any more, as if closed
        QCoreApplication.removePostedEvents(background, QEvent.Type.MetaCall.value)
    workspace.unfinished.stop()
    workspace.playback.pause()
    workspace.media.clear()
    document.close_journal()
    document.session.previewed.disconnect(document._pass_on_preview)
    document.session.changed.disconnect(document._pass_on_change)
    document.session = document.engine = document.character = None
    document.path = document.project_file = document.exported = document._exported_state = None
    page.curves.set_session(None)
    page.face.viewport.close_renderer()
    window.hide()


def prepare(window: MainWindow, preferences: Preferences) -> None:
    """Make a window that was emptied ready for `start`, with the preferences of another test."""
    page, workspace = window.editor, window.workspace
    assert page is not None
    window._preferences._settings = preferences._settings
    window._can_draw = window._draws = False
    window._ready, window._awaited = None, 2
    window._warned.clear()
    window.banner.dismiss()
    window.banner.button.setText("")
    window.start_page.show_recent(preferences.recent())
    window._pages.setCurrentWidget(window.start_page)
    workspace.opener.rig = None
    workspace.tools.choose(Tool.MOVE)
    workspace.tools.set_smooth(DEFAULT_SMOOTH)
    workspace.timeline.display.choose(Unit.SECONDS)
    _forget_gestures(window, page)
    page._take = None
    page.curves.shown.show_all()
    if page.curves.shown.is_unfolded:
        page.curves.shown.unfold(False)
    page.lists.setCurrentIndex(0)
    page._fits_film, page.face.viewport.draws = True, 0
    page.face.viewport.quality = Quality()
    page.face._tracked = page.face._both = page.face._difference = page.face._follows = False
    page.face._glancing = page.curves.legend._has_character = False


def _forget_gestures(window: MainWindow, page: Editor) -> None:
    """Forget what the last gestures were."""
    line, mouse, fields = window.timeline, page.curves._mouse, page.curves.fields
    line._edits_falloffs, line._before, line.can_fade = (0.0, 0.0), None, True
    window.playback._came_from, window.playback._shuttle = 0, 1.0
    window.sound_player.problem = page.film.screen_._note = ""
    window.commands.edit._undone = window.commands.edit._said = ""
    window.commands.edit._clipboard = window.commands.file.character._saved = None
    mouse.focused, mouse.plot, mouse.chosen = None, None, frozenset()
    mouse._x, mouse._shown, mouse._came_from = 0.0, 0.0, 0
    mouse._timer.setInterval(0)  # as long as the last preview had to wait
    page.curves.hand._held = ""
    handles = page.face.handles
    handles._drop()
    handles._hover(None, False)
    handles._from, handles._last, handles._pulled = QPointF(), QPointF(), 0.0
    for name in window.findChildren(Name):
        name._name = ""
    for delegate in window.findChildren(EditsDelegate):
        vars(delegate).pop("edits", None)
    fields._setting, fields._made = None, None
    fields._typed.clear()
    page.curves.range_bar._before = page.curves.range_bar._hovered = None
    page.edits._is_new, page.hints.step = False, 0
    page.transport.entry.hide()
    page.transport.entry._go = None
    proposal = page.proposal
    proposal._name, proposal.problem, proposal.is_for_all = "", None, False
    proposal.variation, proposal._variations, proposal.text.short = 0, (), ""
    for scene in window.findChildren(pg.GraphicsScene):  # where the mouse was last, and clicked
        if (held := scene.mouseGrabberItem()) is not None:
            held.ungrabMouse()
        scene.clickEvents, scene.dragButtons = [], []
        scene.dragItem = scene.lastDrag = scene.lastHoverEvent = None
        scene.hoverItems.clear()


def close(windows: Iterable[MainWindow]) -> None:
    """Close them without being asked about edits, or the map of a character."""
    for window in windows:
        if isValid(window):
            window.document.session = window.document.character = None
            window.close()
            window.deleteLater()
