"""What commands act on: the state of the window, and the page with the open take."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QWidget

from faceedit_app.core.resources import is_demo_take
from faceedit_app.ui.media.sound_player import SoundPlayer
from faceedit_app.ui.media.take_media import TakeMedia
from faceedit_app.ui.media.undo import MediaSteps
from faceedit_app.ui.state.background import Background
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.playback import Playback
from faceedit_app.ui.state.preferences import Preferences
from faceedit_app.ui.state.take_opener import TakeOpener
from faceedit_app.ui.state.timeline import Timeline
from faceedit_app.ui.state.tools import Tools

if TYPE_CHECKING:  # the window is there before the solver, and before pyqtgraph with the page
    from faceedit_app.core.rig import Rig
    from faceedit_app.editing.edits.edit import Edit
    from faceedit_app.editing.session import EditSession
    from faceedit_app.ui.page.editor import Editor


class Workspace(QObject):
    """All state of one window.

    Attributes:
        window: questions are asked over it.
        page: what shows the open take; None until it is built, after the first paint.

    Signals:
        message(str): something went well, or why nothing was done: for the status bar.
        warning(str): something the user should know, for the banner.
    """

    message = Signal(str)
    warning = Signal(str)

    def __init__(self, window: QWidget, preferences: Preferences) -> None:
        super().__init__(window)
        self.window, self.preferences = window, preferences
        self.background = Background(self)
        self.document = Document(self)
        self.timeline = Timeline(self)
        self.playback = Playback(self.timeline, parent=self)
        self.tools = Tools(self)
        self.media = TakeMedia(self.background, self)
        self.media_steps = MediaSteps(self.document, self.media)
        self.sound_player = SoundPlayer(self.media, self.timeline, self.playback, self.background)
        self.opener = TakeOpener(self.document, self.background, self)
        self.page: Editor | None = None
        self._keep_volume()

    def _keep_volume(self) -> None:
        """Sound is as loud as it was last."""
        player, (volume, muted) = self.sound_player, self.preferences.volume()
        player.set_volume(volume)
        player.set_muted(muted)
        player.settled.connect(lambda: self.preferences.set_volume(player.volume, player.muted))

    @property
    def session(self) -> EditSession | None:
        """The open take's."""
        return self.document.session

    @property
    def rig(self) -> Rig | None:
        """The character, once it is loaded."""
        return self.opener.rig

    def suggest(self, kind: str, tail: str, ending: str) -> Path:
        """A file name beside the take; the demo's folder belongs to the installation.

        Args:
            kind: of the file, see `Preferences.folder`.
            tail, ending: what follows the take's own name.
        """
        take = self.document.path
        assert take is not None
        folder = self.preferences.folder(kind) if is_demo_take(take) else take.parent
        return folder / f"{take.stem}{tail}{ending}"

    def add_edits(self, edits: tuple[Edit, ...], name: str, step: str = "") -> None:
        """Make edits as one step. They are selected, ready to be weakened.

        Args:
            name: theirs, and the step's if that has none of its own.
            step: what Undo and Redo call it.
        """
        self.document.act(lambda session: session.add(*edits, name=step or name))
        if self.page is not None:
            self.page.edits.select_new(len(edits))
        start, end = min(e.start for e in edits), max(e.end for e in edits)
        self.message.emit(f"{name}: {start:.2f} to {end:.2f} s; its strength is beside the list")

    # --- gestures in progress ----------------------------------------------------------------

    def drop_gesture(self) -> bool:
        """Drop a drag in progress, else hints or a proposal; False if there was none of them."""
        if self.page is None:
            return False
        if self.page.curves.is_dragging:
            self.page.curves.cancel_drag()
            return True
        return self.page.drop()

    def settle(self) -> None:
        """Bring gestures outside of the curves to their end."""
        self.media_steps.settle()
        if self.page is not None:
            self.page.settle()

    def finish(self) -> None:
        """Drop a drag in progress and bring other gestures to their end."""
        self.drop_gesture()
        self.settle()

    def close(self) -> None:
        """Stop what is running and free the graphics memory."""
        self.playback.pause()
        self.sound_player.close()
        self.media.clear()
        self.background.close()
        self.document.close_journal()
        if self.page is not None:
            self.page.face.viewport.close_renderer()
