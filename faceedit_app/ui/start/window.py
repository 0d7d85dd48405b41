"""The main window: creates the parts, connects them, and starts slow work in the background."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QSize, QTimer, Signal
from PySide6.QtGui import QCloseEvent, QShowEvent
from PySide6.QtWidgets import QStackedWidget, QStyle, QVBoxLayout, QWidget

from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.resources import DEMO_TAKE, shipped
from faceedit_app.ui.commands import dialogs, dropping
from faceedit_app.ui.commands.menus import Commands
from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.look.icons import app_icon
from faceedit_app.ui.page.banner import Banner
from faceedit_app.ui.page.keys import KeyArbiter
from faceedit_app.ui.page.start_page import StartPage
from faceedit_app.ui.page.status_bar import StatusBar
from faceedit_app.ui.start.recovery import offer_recovery
from faceedit_app.ui.start.window_base import WindowBase
from faceedit_app.ui.state import loading
from faceedit_app.ui.state.actions import Actions
from faceedit_app.ui.state.preferences import Preferences

if TYPE_CHECKING:  # these import a lot; the window appears first
    from faceedit_app.core.rig import Rig
    from faceedit_app.networks.engine import Engine
    from faceedit_app.render import FaceRenderer
    from faceedit_app.ui.page.editor import Editor

_FIRST_SIZE, _SMALLEST = QSize(1440, 900), QSize(1000, 600)
_SLOW_MS = 400  # of reading, after which the take on the screen is cleared


class MainWindow(WindowBase):
    """FaceEdit's window.

    Signals:
        settled(): start-up is over: the face and the model are loaded, or have failed to load.
    """

    settled = Signal()

    def __init__(self, preferences: Preferences) -> None:
        super().__init__()
        self.workspace = workspace = Workspace(self, preferences)
        self.document, self.timeline = workspace.document, workspace.timeline
        self.playback, self.tools = workspace.playback, workspace.tools
        self.media, self.sound_player = workspace.media, workspace.sound_player
        self._preferences, self._background = preferences, workspace.background
        self._can_draw = False  # once the renderer is prepared
        self._ready: FaceRenderer | None = None  # opened in the background, not used yet
        self._draws = False  # once a face has been opened
        self._awaited = 2  # until start-up is over: the face and the model
        self._slow_reading = QTimer(self, singleShot=True, interval=_SLOW_MS)
        self._slow_reading.timeout.connect(self._clear)
        self._journal_note = ""  # as last shown
        self._lacking: set[str] = set()  # what edits of the open take ask for in vain
        self._warned: set[str] = set()  # and what of it was shown
        self.commands = Commands(workspace)
        self.actions_ = Actions(self, self.document, self.commands.menus())
        self.start_page = StartPage(self.actions_)
        self.banner = Banner()
        self.status = StatusBar()
        self.keys = KeyArbiter(self, self.actions_, self.workspace.message.emit)
        self._lay_out()
        self._connect()
        self._refresh_actions()

    def _show_error(self, error: Exception) -> None:
        dialogs.show_error(self, error)

    def _lay_out(self) -> None:
        self.setWindowTitle("FaceEdit[*]")  # a take may be recovered before its title is shown
        self.setWindowIcon(app_icon())
        self._pages = QStackedWidget()
        self._pages.addWidget(self.start_page)
        central = QWidget()
        column = QVBoxLayout(central)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.banner)
        column.addWidget(self._pages, 1)
        self.setCentralWidget(central)
        self.setStatusBar(self.status)
        self.setMinimumSize(_SMALLEST.boundedTo(self._room))
        if not self._preferences.restore_window(self):
            self.resize(_FIRST_SIZE.boundedTo(self._room))
        self.start_page.show_recent(self._preferences.recent())

    @property
    def _room(self) -> QSize:
        """The screen less the title bar; 960 x 540 if 1920 x 1080 are shown at twice the size."""
        bar = self.style().pixelMetric(QStyle.PixelMetric.PM_TitleBarHeight)
        return self.screen().availableSize() - QSize(0, bar)

    def _connect(self) -> None:
        workspace, opener, media = self.workspace, self.workspace.opener, self.media
        self.document.opened.connect(self._opened)
        self.document.changed.connect(self._mark_modified)
        self.document.changed.connect(self._warn_of_lacks)
        self.document.saved.connect(self._mark_modified)
        self.document.character_changed.connect(self._show_character)
        opener.reading.connect(self._show_reading)
        opener.character_loaded.connect(self._load_model)
        for message in (workspace.message, media.message):
            message.connect(self.status.say)
        workspace.retracted.connect(self.status.retract)
        media.found.connect(self.status.say_if_idle)
        workspace.warning.connect(self.banner.show_message)
        workspace.doubt.connect(lambda text, holds: self.banner.show_message(text, holds=holds))
        workspace.offer.connect(self.banner.offer)
        media.failed.connect(self._show_error)
        media.missed.connect(lambda error: self.banner.show_message(str(error), str(error)))
        self.start_page.chosen.connect(self.commands.file.open_if_saved)
        self.commands.file.live.changed.connect(self.status.set_live)
        self.commands.file.live.changed.connect(self.actions_.refresh)
        self.keys.glancing.connect(self.commands.view.glance)

    def _refresh_actions(self) -> None:
        """Keep menus and buttons up to date: which are enabled, and which are on."""
        media = self.media
        for changed in (
            self.document.opened,
            self.document.changed,
            self.tools.changed,
            self.timeline.display.changed,
            self.playback.loop_changed,
            media.sound_changed,
            media.film_changed,
            media.turned,
            media.overlay.changed,
            self.sound_player.changed,
            self.workspace.unfinished.changed,
        ):
            changed.connect(self.actions_.refresh)

    # --- start -------------------------------------------------------------------------------

    @property
    def editor(self) -> Editor | None:
        """The page, once it is built."""
        return self.workspace.page

    def start(
        self, take: Path | None = None, demo: bool = False, character: Path | None = None
    ) -> None:
        """Start loading; call it once the window is on the screen."""
        self._background.run(loading.prepare_renderer, self._use_renderer, self._show_error)
        self.document.keeps_journal = self.document.awaits_engine = True
        self.workspace.opener.load_character()  # before a question, which may wait for long
        if not offer_recovery(self.workspace, take, character is not None):
            if take is not None:
                self.commands.file.open(take, character is not None)
            elif demo:
                self.commands.file.open_demo()
        if character is not None:
            self.commands.file.character.open(character)
        self.build_editor()

    def open_demo_now(self) -> None:
        """Open the demo take and everything that belongs to it before returning.

        Raises:
            FileError: a shipped file is missing or damaged.
        """
        rig = loading.load_character()
        try:
            self.document.engine = loading.load_engine(rig)
            self.status.set_networks("ready")
        except FaceEditError as error:
            self._continue_without_engine(error)
        self.document.adopt(loading.open_session(shipped(DEMO_TAKE), rig))
        self._draws = True
        self.build_editor().face.viewport.open(rig)

    def build_editor(self) -> Editor:
        """The page, created when it is first needed."""
        if self.workspace.page is not None:
            return self.workspace.page
        with self.actions_.held():
            return self._built()

    def _built(self) -> Editor:
        from faceedit_app.ui.page.editor import Editor  # pyqtgraph; after the first paint

        page = self.workspace.page = Editor(
            self.actions_,
            self.document,
            self.timeline,
            self.playback,
            self.tools,
            self.media,
            self.sound_player,
            self._pages,
        )
        self._pages.addWidget(page)
        self.keys.back.home = page.curves
        self._preferences.restore_panes(page.panes, page.side)
        page.problems.picked.connect(self.commands.fix.go_to)
        for refused in (page.proposal.dropped, *(plot.refused for plot in page.curves.plots)):
            refused.connect(self.workspace.message)
        page.hints.closed.connect(page.curves.setFocus)
        page.hints.began.connect(self.commands.file.character.make_room_for_hints)
        page.hints.closed.connect(self.commands.file.character.hints_closed)
        page.solving.advanced.connect(self.status.show_work)
        page.solving.finished.connect(self.status.show_work)
        self.status.cancelled.connect(page.solving.cancel)
        page.face.show_difference(self._preferences.difference())
        page.face.follow_head(self._preferences.follows_head())
        page.curves.shown.unfold(self._preferences.unfolds_curves())
        page.curves.shown.unfolded.connect(self._preferences.set_unfolds_curves)
        page.curves.shown.changed.connect(self.actions_.refresh)
        self.commands.view.restore_film_place()
        return page

    def _load_model(self, rig: Rig) -> None:
        """The character is loaded: load the model that was made for it."""
        if rig.missing_note:
            self.banner.show_message(rig.missing_note, lasts=True)
        self._background.run(
            lambda: loading.load_engine(rig), self._use_engine, self._continue_without_engine
        )

    def _use_renderer(self, ready: FaceRenderer | None) -> None:
        self._can_draw, self._ready = True, ready
        self._open_face()
        self._settle()

    def _settle(self) -> None:
        """One of what start-up waits for is there, or has failed."""
        self._awaited -= 1
        if not self._awaited:
            self.settled.emit()

    def _open_face(self) -> None:
        """Start drawing the face as soon as a take is open."""
        session = self.document.session
        if self._can_draw and session is not None:
            self._can_draw, self._draws = False, True
            ready, self._ready = self._ready, None
            self.build_editor().face.viewport.open(session.shown_rig, ready)

    def _show_character(self) -> None:
        """Draw another character, if one is drawn."""
        session = self.document.session
        if self._draws and session is not None:
            page = self.build_editor()
            page.face.viewport.open(session.shown_rig)
            page.face.refresh()
            page.curves.show_character(session.shown_rig is not session.rig)
        self.actions_.refresh()

    def _use_engine(self, engine: Engine) -> None:
        self.document.use_engine(engine)
        self.status.set_networks("ready")
        self._settle()

    def _continue_without_engine(self, error: Exception) -> None:
        self.document.settle_engine()
        self.status.set_networks("missing", str(error))
        text = f"The face model could not be loaded, so edits look less natural. {error}"
        self.banner.show_message(text, str(error), lasts=True)
        self._settle()

    # --- following the document --------------------------------------------------------------

    def _opened(self) -> None:
        with self.actions_.held():
            self._show_opened()

    def _show_opened(self) -> None:
        session = self.document.session
        assert session is not None
        self.hold_title()
        self._warned.clear()
        self.banner.leave_take()
        self.playback.pause()
        page = self.build_editor()
        page.open()
        self.status.set_take(session.take)
        self._pages.setCurrentWidget(page)
        page.curves.setFocus()
        self._warn_of_lacks()
        self._open_face()
        if self.document.keeps_journal and self._preferences.hints_wanted():
            self._preferences.set_hints_seen()
            QTimer.singleShot(0, page.hints.begin)  # after the layout
        self.commands.take.follow(session.take, session.state.media)
        if not self.commands.fix.calibration.offer_neutral():
            self.commands.file.character.offer(session.take.path)
        if (other := self.document.open_elsewhere) is not None:
            also = "also" if other.name == session.take.path.name else "a copy of this take, and"
            self.banner.show_message(
                f"{other.name} is {also} open in another window. "
                "Each window has its own edits: close the one that you do not need"
            )
        if problem := self._preferences.problem():
            self.banner.show_message(problem, problem, lasts=True)
        self._mark_modified()

    def _warn_of_lacks(self) -> None:
        """Warn of edits that the take's channels cannot show, while there are any.

        A warning that the user dismissed does not come back.
        """
        self._lacking = lacking = self._lacks()
        self._warned -= self.banner.review()
        for text in sorted(lacking - self._warned):
            self.banner.show_message(text, holds=partial(self._is_lacking, text))
        self._warned |= lacking

    def _is_lacking(self, text: str) -> bool:
        return text in self._lacking

    def _lacks(self) -> set[str]:
        """What the edits of the open take ask for in vain, a line each."""
        session = self.document.session
        if session is None:
            return set()
        from faceedit_app.editing.solving.answerable import lacks_of
        from faceedit_app.editing.solving.channel_edits import missing_channels

        edits, lacks = session.edits, session.lacks
        lines = {str(lack) for edit in edits for lack in lacks_of(edit, lacks)}
        if missing := missing_channels(edits, session.take.clip):
            lines.add(f"Some edits are left out: {missing}")
        return lines

    def _mark_modified(self) -> None:
        self.entitle(self.document.project or self.document.path)
        before, self._journal_note = self._journal_note, self.document.journal_note
        if self._journal_note and self._journal_note != before:
            self.banner.show_message(self._journal_note, self._journal_note, lasts=True)
        elif before and not self._journal_note:
            self.banner.remove(before)
        self.setWindowModified(not self.document.is_clean)

    def _clear(self) -> None:
        """Reading takes long: show that instead of the take that it replaces."""
        self._pages.setCurrentWidget(self.start_page)
        self.banner.put_aside(True)
        self.status.put_aside(True)

    def _show_reading(self, text: str) -> None:
        self.actions_.refresh()
        self.start_page.show_loading(text or None)
        if self.document.session is not None and self.editor is not None:
            # The take comes back if it was cleared for one that fails; a character clears none.
            self._pages.setCurrentWidget(self.editor)
            self.banner.put_aside(False)
            self.status.put_aside(False)
            self._slow_reading.stop()
            if text and self.workspace.opener.is_reading:
                self._slow_reading.start()
        self.status.showMessage(text)  # nothing clears it

    # --- window events -----------------------------------------------------------------------

    def mouse_lost(self) -> None:
        """Another window took the mouse: end the drag in progress and keep it."""
        if self.editor is not None:
            self.editor.mouse_lost()

    def show_drop(self, active: bool) -> None:
        """Show whether a file hovers over the window."""
        self.start_page.show_drop(active)

    def take_files(self, paths: list[Path]) -> None:
        """Open or add files that were dropped; see `commands.dropping`."""
        dropping.take_files(self.workspace, self.commands, paths)

    def showEvent(self, event: QShowEvent) -> None:
        """Take the keyboard from the start."""
        super().showEvent(event)
        self.setFocus()

    def closeEvent(self, event: QCloseEvent) -> None:
        """Ask about unsaved edits, remember the layout, stop everything."""
        event.ignore()  # until all is asked: after an unexpected error the window stays
        if not self.commands.file.may_quit():
            return
        if self.editor is not None:
            self.editor.settle_layout()
            self._preferences.save_layout(self, self.editor.panes, self.editor.side)
        self.leave()
        super().closeEvent(event)

    def leave(self) -> None:
        """Stop everything and free the graphics memory."""
        self.commands.file.stop()
        self.workspace.close()
        if self._ready is not None:
            self._ready.close()
