"""The main window: makes the parts, connects them, and starts what takes long."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QTimer, Signal
from PySide6.QtGui import (
    QCloseEvent,
    QShowEvent,
)
from PySide6.QtWidgets import QStackedWidget, QStyle, QVBoxLayout, QWidget

from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.resources import shipped
from faceedit_app.media import is_media
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.commands.edit import EditCommands
from faceedit_app.ui.commands.file import DEMO, FileCommands
from faceedit_app.ui.commands.fix import FixCommands
from faceedit_app.ui.commands.media import MediaCommands
from faceedit_app.ui.commands.project import ProjectCommands
from faceedit_app.ui.commands.view import ViewCommands
from faceedit_app.ui.look.icons import app_icon
from faceedit_app.ui.media.sound_player import Sounding
from faceedit_app.ui.media.take_media import Media
from faceedit_app.ui.media.undo import MediaSteps
from faceedit_app.ui.page.banner import Banner
from faceedit_app.ui.page.keys import KeyArbiter
from faceedit_app.ui.page.start_page import StartPage
from faceedit_app.ui.page.status_bar import StatusLine
from faceedit_app.ui.start.window_base import WindowBase
from faceedit_app.ui.state import background as loading
from faceedit_app.ui.state.actions import Actions
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.playback import Playback
from faceedit_app.ui.state.preferences import Store
from faceedit_app.ui.state.timeline import Timeline
from faceedit_app.ui.state.tools import Tooling

if TYPE_CHECKING:
    from faceedit_app.core.rig import Rig
    from faceedit_app.networks.engine import Engine
    from faceedit_app.ui.curves import CurvesPanel
    from faceedit_app.ui.page.editor import Editor

_FIRST_SIZE = (1440, 900)
_TOLD_MS = 6000


class MainWindow(WindowBase):
    """FaceEdit's window.

    Signals:
        settled(): the start is over: the face and the networks are there, or it is known why not.
    """

    settled = Signal()

    def __init__(self, store: Store) -> None:
        super().__init__()
        self._store = store
        self._rig: Rig | None = None
        self._face_wanted = False
        self._journal_note = ""  # that was told
        self.editor: Editor | None = None
        self.document = Document(self)
        self.timeline = Timeline(self)
        self.playback = Playback(self.timeline, parent=self)
        self.tooling = Tooling(self)
        self._background = loading.Background(self)
        self.files = FileCommands(self, self.document, store, self._background)
        self.edits = EditCommands(
            self.document,
            self.timeline,
            self.playback,
            self._curves,
            self._settle,
            lambda: self.editor is not None and self.editor.drop(),
        )
        self.fixes = FixCommands(
            self, self.document, self.timeline, lambda: self.editor, self.edits.finish
        )
        self.views = ViewCommands(
            self,
            self.tooling,
            self.timeline.clock,
            lambda: self.editor,
            lambda: self._rig,
            self.edits.finish,
            store,
        )
        self.media = Media(self._background, self)
        self.media_steps = MediaSteps(self.document, self.media)
        self.sounding = Sounding(self.media, self.timeline, self.playback, self._background)
        self.media_commands = MediaCommands(self, self.media, self.sounding, store)
        self.projects = ProjectCommands(
            self, self.document, self.timeline, self.media, self.files, self._background, store
        )
        self.actions_ = Actions(self, self._handlers())
        self.start_page = StartPage(self.actions_)
        self.banner = Banner()
        self.status = StatusLine()
        self.keys = KeyArbiter(self)
        self._show_error = partial(dialogs.show_error, self)
        self._lay_out()
        self._connect()

    def _handlers(self) -> dict[str, Callable[[], None]]:
        files = self.files
        return (
            self.edits.handlers()
            | self.fixes.handlers()
            | self.views.handlers()
            | {
                **self.media_commands.handlers(),
                "open": files.ask_open,
                "open_demo": files.open_demo,
                "export": self._finished(files.ask_export),
                "save": self._finished(self.projects.save),
                "save_as": self._finished(self.projects.save_as),
                "save_edits": self._finished(files.ask_save_edits),
                "load_edits": files.ask_load_edits,
                "quit": self._finished(self.close),
            }
        )

    def _finished(self, work: Callable[[], bool]) -> Callable[[], None]:
        """Something to do when no gesture is in progress any more."""

        def do() -> None:
            self.edits.finish()
            work()

        return do

    def _lay_out(self) -> None:
        self.setWindowTitle("FaceEdit")
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
        self.setMinimumSize(1000, 600)
        if not self._store.restore_window(self):
            self._take_first_size()
        self.start_page.show_recent(self._store.recent())

    def _take_first_size(self) -> None:
        """As large as is useful, or as fits on the screen with the title bar."""
        room, bar = self.screen().availableGeometry(), QStyle.PixelMetric.PM_TitleBarHeight
        height = room.height() - self.style().pixelMetric(bar)
        self.resize(min(_FIRST_SIZE[0], room.width()), min(_FIRST_SIZE[1], height))

    def _connect(self) -> None:
        self.document.opened.connect(self._opened)
        self.document.changed.connect(self._mark_modified)
        self.document.saved.connect(self._mark_modified)
        self.projects.warned.connect(self.banner.say)
        self.files.reading.connect(self._say_reading)
        self.files.character_loaded.connect(self._character_loaded)
        self.media.failed.connect(self._show_error)
        self.media.missed.connect(lambda error: self.banner.say(str(error), str(error)))
        self.media_commands.attach(self.actions_)
        self.start_page.chosen.connect(self.files.open_if_saved)
        menu = self.actions_.recent_menu
        menu.aboutToShow.connect(lambda: self.files.fill_recent(menu))
        show_unit = partial(self.views.show_unit, self.actions_)
        self.timeline.clock.changed.connect(show_unit)
        show_unit()
        presets = self.actions_.presets_menu
        presets.aboutToShow.connect(lambda: self.fixes.fill_presets(presets))
        for teller in (self.files, self.projects, self.media, self.fixes):
            teller.told.connect(lambda text: self.status.showMessage(text, _TOLD_MS))
        self.keys.glancing.connect(self.views.glance)

    # --- start -------------------------------------------------------------------------------

    def start(self, take: Path | None = None, demo: bool = False) -> None:
        """Begin with what takes long; call it when the window is on the screen."""
        self.document.keeps_journal = True

        def open_wanted() -> None:
            if take is not None:
                self.files.open(take)
            elif demo:
                self.files.open_demo()

        self.projects.offer_recovery(open_wanted)
        if not self.files.is_reading:
            self.files.load_character()
        self.build_editor()

    def open_demo_now(self) -> None:
        """Open the demo take with all that belongs to it, and return when it is there.

        Raises:
            FileError: a shipped file is missing or damaged.
        """
        rig = loading.load_character()
        try:
            self.document.engine = loading.load_engine(rig)
            self.status.set_networks("ready")
        except FaceEditError as error:
            self._do_without_engine(error)
        self.document.adopt(loading.open_session(shipped(DEMO), rig))
        self.build_editor().face.viewport.open(rig)

    def build_editor(self) -> Editor:
        """The page with curves and face, made when it is first needed."""
        if self.editor is None:
            from faceedit_app.ui.page.editor import Editor

            self.editor = Editor(
                self.actions_,
                self.document,
                self.timeline,
                self.playback,
                self.tooling,
                self.media,
                self.sounding,
            )
            self._pages.addWidget(self.editor)
            self.editor.problems.picked.connect(self.fixes.go_to)
            self.editor.hints.closed.connect(self.editor.curves.setFocus)
            self._store.restore_panes(self.editor.panes, self.editor.side)
            self.editor.face.show_difference(self._store.difference())
            solving = self.editor.solving
            solving.advanced.connect(self.status.show_work)
            solving.finished.connect(self.status.show_work)
            self.status.cancelled.connect(solving.cancel)
        return self.editor

    def _character_loaded(self, rig: Rig) -> None:
        self._rig = rig
        if rig.missing_note:
            self.banner.say(rig.missing_note)
        self._background.run(
            loading.prepare_renderer, lambda _: self._want_face(rig), self._show_error
        )

    def _want_face(self, rig: Rig) -> None:
        """The face is drawn as soon as there is a take to see it in."""
        self._face_wanted = True
        self._open_face()
        self._background.run(
            lambda: loading.load_engine(rig), self._use_engine, self._do_without_engine
        )

    def _open_face(self) -> None:
        if self._face_wanted and self.document.session is not None and self._rig is not None:
            self._face_wanted = False
            self.build_editor().face.viewport.open(self._rig)

    def _use_engine(self, engine: Engine) -> None:
        self.document.use_engine(engine)
        self.status.set_networks("ready", "Edits are answered by the networks")
        self.settled.emit()

    def _do_without_engine(self, error: Exception) -> None:
        self.status.set_networks("missing", str(error))
        self.banner.say(
            "The networks could not be loaded, so edits are answered by the rig alone:"
            f" {getattr(error, 'problem', error)}.",
            str(error),
        )
        self.settled.emit()

    # --- following the document --------------------------------------------------------------

    def _opened(self) -> None:
        session = self.document.session
        assert session is not None
        self.playback.pause()
        editor = self.build_editor()
        self.actions_.enable_for_take(True)
        editor.open()
        self.status.set_take(session.take)
        self._pages.setCurrentWidget(editor)
        editor.curves.setFocus()
        self._mark_modified()
        self._open_face()
        if self.document.keeps_journal and self._store.hints_wanted():
            self._store.set_hints_seen()
            QTimer.singleShot(0, editor.hints.begin)  # once all has its place
        self.media_commands.follow(session.take, session.state.media)
        if problem := self._store.problem():
            self.banner.say(problem, problem)

    def _mark_modified(self) -> None:
        name = self.document.project or self.document.path
        if name is not None:
            self.setWindowTitle(f"{name.name}[*] – FaceEdit")
        before, self._journal_note = self._journal_note, self.document.journal_note
        if self._journal_note and self._journal_note != before:
            self.banner.say(self._journal_note, self._journal_note)
        elif before and not self._journal_note:
            self.banner.unsay(before)
        self.setWindowModified(not self.document.is_clean)

    def _say_reading(self, text: str) -> None:
        if self.document.session is None:
            self.start_page.show_loading(text or None)
        if text:
            self.status.showMessage(text)
        else:
            self.status.clearMessage()

    def _curves(self) -> CurvesPanel | None:
        return self.editor.curves if self.editor is not None else None

    def _settle(self) -> None:
        self.media_steps.settle()
        if self.editor is not None:
            self.editor.settle()

    # --- window events -----------------------------------------------------------------------

    def let_go(self) -> None:
        """Another window has the mouse now: drags end here."""
        if self.editor is not None:
            self.editor.let_go()

    def show_drop(self, active: bool) -> None:
        """A file hovers over the window, or no longer."""
        self.start_page.show_drop(active)

    def take_files(self, paths: list[Path]) -> None:
        """Open a take, load edits, add sound or film."""
        media = [path for path in paths if is_media(path)]
        path = next((path for path in paths if path not in media), None)
        has_take = self.document.session is not None
        self.media_commands.drop(media, path is not None, has_take)
        if path is None:
            return
        if path.suffix.lower() == ".json" and has_take:
            self.files.load_edits(path)
        else:
            self.files.open_if_saved(path)

    def showEvent(self, event: QShowEvent) -> None:
        """Have the keys arrive somewhere from the start."""
        super().showEvent(event)
        self.setFocus()

    def closeEvent(self, event: QCloseEvent) -> None:
        """Ask about edits, remember the layout, stop what is running."""
        self.edits.finish()
        if not self.files.may_close():
            event.ignore()
            return
        if self.editor is not None:
            self._store.save_layout(self, self.editor.panes, self.editor.side)
        self.leave()
        super().closeEvent(event)

    def leave(self) -> None:
        """Stop what is running and free the graphics memory."""
        self.playback.pause()
        self.sounding.close()
        self.media.clear()
        self._background.close()
        self.document.close_journal()
        if self.editor is not None:
            self.editor.face.viewport.close_renderer()
