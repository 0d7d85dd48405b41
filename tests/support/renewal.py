"""A window that an earlier test has left, made as new: opening one takes three times as long.

It is used again only if nothing that `facts_of` sees tells it from a new one; else it is closed.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor

import pyqtgraph as pg
from PySide6.QtCore import QCoreApplication, QEvent, QPointF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QDialog, QDockWidget, QWidget
from shiboken6 import isValid

from faceedit_app.ui.curves import CurvesPanel
from faceedit_app.ui.edits.delegate import EditsDelegate
from faceedit_app.ui.face.resolution import Quality
from faceedit_app.ui.media.parts import Name
from faceedit_app.ui.page.editor import Editor
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.background import Background
from faceedit_app.ui.state.preferences import Preferences
from faceedit_app.ui.state.time_display import Unit
from faceedit_app.ui.state.tools import DEFAULT_SMOOTH, Tool
from support.facts import Facts, Files


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
        release_mouse(window)
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


def release_mouse(window: QWidget) -> None:
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
    workspace.drafts.clear()
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
    choose_as_at_first(page.curves)
    _forget_gestures(window, page)
    page._take = None
    page.lists.setCurrentIndex(0)
    page._fits_film, page.face.viewport.draws = True, 0
    page.face.viewport.quality = Quality()
    page.face._tracked = page.face._both = page.face._difference = page.face._follows = False
    page.face._glancing = page.curves.legend._has_character = False


def choose_as_at_first(panel: CurvesPanel) -> None:
    """Choose tools, unit and curves as in a new panel."""
    panel.tools.choose(Tool.MOVE)
    panel.tools.link(True)
    panel.tools.set_smooth(DEFAULT_SMOOTH)
    panel.timeline.display.choose(Unit.SECONDS)
    panel.shown.show_all()
    if panel.shown.is_unfolded:
        panel.shown.unfold(False)


def forget_drags(panel: CurvesPanel) -> None:
    """Forget what the last gestures on the curves were."""
    line, mouse, fields = panel.timeline, panel._mouse, panel.fields
    line._edits_falloffs, line._before, line.can_fade = (0.0, 0.0), None, True
    mouse.focused, mouse.plot, mouse.chosen = None, None, frozenset()
    mouse._x, mouse._shown, mouse._came_from = 0.0, 0.0, 0
    mouse._timer.setInterval(0)  # as long as the last preview had to wait
    panel.hand._held = ""
    fields._setting, fields._made = None, None
    fields._typed.clear()
    panel.range_bar._before = panel.range_bar._hovered = None


def forget_mouse(widget: QWidget) -> None:
    """Forget where the mouse was last, and what it clicked, in all plots of a widget."""
    for scene in widget.findChildren(pg.GraphicsScene):
        if (held := scene.mouseGrabberItem()) is not None:
            held.ungrabMouse()
        scene.clickEvents, scene.dragButtons = [], []
        scene.dragItem = scene.lastDrag = scene.lastHoverEvent = None
        scene.hoverItems.clear()


def _forget_gestures(window: MainWindow, page: Editor) -> None:
    """Forget what the last gestures were."""
    forget_drags(page.curves)
    forget_mouse(window)
    window.playback._came_from, window.playback._shuttle = 0, 1.0
    window.sound_player.problem = page.film.screen_._note = ""
    window.commands.edit._undone = window.commands.edit._said = ""
    window.commands.edit._clipboard = window.commands.file.character._saved = None
    handles = page.face.handles
    handles._drop()
    handles._hover(None, False)
    handles._from, handles._last, handles._pulled = QPointF(), QPointF(), 0.0
    for name in window.findChildren(Name):
        name._name = ""
    for delegate in window.findChildren(EditsDelegate):
        vars(delegate).pop("edits", None)
    page.edits._is_new, page.hints.step = False, 0
    page.transport.entry.hide()
    page.transport.entry._go = None
    proposal = page.proposal
    proposal._name, proposal.problem, proposal.is_for_all = "", None, False
    proposal.variation, proposal._variations, proposal.text.short = 0, (), ""


def close(windows: Iterable[MainWindow]) -> None:
    """Close them without being asked about edits, or the map of a character."""
    for window in windows:
        if isValid(window):
            window.document.session = window.document.character = None
            window.close()
            window.deleteLater()
