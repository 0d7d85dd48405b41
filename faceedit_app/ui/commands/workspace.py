"""What commands act on: the window's state and its page."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QWidget

from faceedit_app.core import on_disk
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.resources import is_demo_take
from faceedit_app.ui.media.sound_player import SoundPlayer
from faceedit_app.ui.media.take_media import TakeMedia
from faceedit_app.ui.media.undo import MediaSteps
from faceedit_app.ui.state import loading
from faceedit_app.ui.state.background import Background
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.playback import Playback
from faceedit_app.ui.state.preferences import Preferences
from faceedit_app.ui.state.take_opener import TakeOpener
from faceedit_app.ui.state.time_display import Unit, shown_range, shown_time
from faceedit_app.ui.state.timeline import Timeline
from faceedit_app.ui.state.tools import Tools
from faceedit_app.ui.state.unfinished import Unfinished

if TYPE_CHECKING:  # the solver, and the page with pyqtgraph; the window appears first
    from faceedit_app.characters.fitted import FittedCharacter
    from faceedit_app.core.rig import Rig
    from faceedit_app.editing.edits.edit import Edit
    from faceedit_app.editing.session import EditSession
    from faceedit_app.ui.media.words_dialog import Draft
    from faceedit_app.ui.page.editor import Editor


class Workspace(QObject):
    """All state of one window.

    Attributes:
        window: the parent of dialogs.
        page: None until it is built, after the first paint.
        words_file: where the words of the open take were read, if the user has opened a file.
        drafts: words that were typed and not yet timed, by the take or sound that they are of.

    Signals:
        message(str): what was done, or why nothing was, for the status bar.
        retracted(str): a message that is no longer about what is on screen.
        warning(str): something the user should know about the take, for the banner.
        doubt(str, callable): the same about a step; the function tells whether it still holds.
        offer(str, str, callable): something to do about it: the text, the button's, and what it
            does.
    """

    message = Signal(str)
    retracted = Signal(str)
    warning = Signal(str)
    doubt = Signal(str, object)
    offer = Signal(str, str, object)

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
        self.unfinished = Unfinished(self)
        self.opener = TakeOpener(self.document, self.background, self)
        self.page: Editor | None = None
        self.words_file: Path | None = None
        self.drafts: dict[Path, Draft] = {}
        self.document.opened.connect(self._forget_words_file)
        self._wanted_character: Path | None = None  # which is being read
        self._keep_volume()

    def _keep_volume(self) -> None:
        """Restore the volume, and remember changes to it."""
        player, (volume, muted) = self.sound_player, self.preferences.volume()
        player.set_volume(volume)
        player.set_muted(muted)
        player.settled.connect(lambda: self.preferences.set_volume(player.volume, player.muted))

    def _forget_words_file(self) -> None:
        self.words_file = None

    @property
    def session(self) -> EditSession | None:
        """The open take's session."""
        return self.document.session

    @property
    def rig(self) -> Rig | None:
        """The character, once it is loaded."""
        return self.opener.rig

    def beside(self, kind: str) -> Path:
        """The take's folder; for the demo take and without one, where the dialog was last used.

        Args:
            kind: of the dialog, see `Preferences.folder`.
        """
        take = self.document.path
        if take is None or is_demo_take(take) or not on_disk.is_folder(take.parent):
            return self.preferences.folder(kind)
        return take.parent

    def suggest(self, kind: str, tail: str, ending: str) -> Path:
        """A file name beside the take; for the demo take, in another folder.

        Args:
            kind: of the file, see `Preferences.folder`.
            tail, ending: what follows the take's own name.
        """
        take = self.document.path
        assert take is not None
        folder = self.preferences.folder(kind) if is_demo_take(take) else take.parent
        return folder / f"{take.stem}{tail}{ending}"

    def add_edits(self, edits: tuple[Edit, ...], name: str, step: str = "") -> None:
        """Make edits as one step and select them, ready for their strength to be set.

        Args:
            name: of the edits, for the message, and of the step unless `step` is given.
            step: its name in Undo and Redo.
        """
        self.document.act(lambda session: session.add(*edits, name=step or name))
        if self.page is not None:
            self.page.list_edits()
            self.page.edits.select_new(len(edits))
        seen = self.page is None or self.page.lists.currentWidget() is self.page.edits
        where = "above the list of edits" if seen else "under Edits"
        last = self.timeline.duration  # as the list says it
        start, end = max(min(e.start for e in edits), 0.0), min(max(e.end for e in edits), last)
        self.timeline.bring_into_view(start, end)
        self.message.emit(f"{name}: {self.shown_range(start, end)}; set its strength {where}")

    def shown_time(self, seconds: float) -> str:
        """A time in the unit in which times are shown."""
        rows, unit = self.timeline.rows, self.timeline.display.unit
        if rows is None:
            return ""
        shown = shown_time(rows, seconds, unit)
        return f"frame {shown}" if unit is Unit.FRAMES else shown

    @property
    def length_unit(self) -> tuple[str, float]:
        """The unit in which lengths of time are asked for, and how many of it are a second."""
        clip = self.timeline.clip
        if clip is None or not self.timeline.display.counts_frames:
            return "s", 1.0
        return "frames", clip.rate

    def shown_range(self, start: float, end: float) -> str:
        """A time range in the unit in which times are shown."""
        rows, unit = self.timeline.rows, self.timeline.display.unit
        return shown_range(rows, start, end, unit) if rows is not None else ""

    def open_character(
        self,
        path: Path,
        failed: Callable[[str], None],
        done: Callable[[], None] = lambda: None,
    ) -> None:
        """Read a character of the user's in the background and show it; on an error the old stays.

        If another one is chosen before it is read, that one is shown.

        Args:
            failed: is given one line about the error.
            done: called once it is shown.
        """

        def is_wanted() -> bool:
            if self._wanted_character != path:
                return False
            self._forget_wanted()
            return True

        def show(character: FittedCharacter) -> None:
            if not is_wanted():
                return
            self.document.use_character(character)
            self.message.emit(f"Opened the character {path.name}")
            done()

        def report(error: Exception) -> None:
            is_shown = is_wanted()
            if not isinstance(error, FaceEditError):
                raise error
            if is_shown:
                failed(str(error))

        self._wanted_character = path
        self.opener.reading.emit(f"Opening {path.name}…")
        self.background.run(lambda: loading.load_own_character(path), show, report)

    @property
    def opens_character(self) -> bool:
        """Whether a character of the user's is being read."""
        return self._wanted_character is not None

    def show_own_character(self) -> None:
        """Show FaceEdit's own character, also instead of one that is being read."""
        if self.opens_character:
            self._forget_wanted()
        if self.document.character is not None:
            self.document.use_character(None)

    def _forget_wanted(self) -> None:
        self._wanted_character = None
        self.opener.reading.emit("")

    # --- gestures in progress ----------------------------------------------------------------

    def cancel_gesture(self) -> bool:
        """Cancel the drag in progress, or discard a proposal; False if there is none."""
        if self.page is None:
            return False
        if self.page.curves.is_dragging:
            self.page.curves.cancel_drag()
            return True
        return self.page.cancel_gesture()

    def commit_gestures(self) -> None:
        """Commit gestures in progress outside the curves."""
        self.media_steps.settle()
        if self.page is not None:
            self.page.settle()

    def end_gestures(self) -> None:
        """Cancel a drag in progress and commit other gestures."""
        self.cancel_gesture()
        self.commit_gestures()
        self.document.cancel()  # the preview of a dialog that stays open

    @property
    def has_changes(self) -> bool:
        """Whether closing the take would lose changes, or a proposal that is open."""
        proposes = self.page is not None and self.page.proposal.is_open
        return self.document.path is not None and (proposes or self.document.loses_by_closing)

    def end_before_writing(self) -> str:
        """End gestures before a file is written or closed, and say so if one was a proposal.

        Returns:
            What to add to the message about the file; empty if there was no proposal.
        """
        proposes = self.page is not None and self.page.proposal.is_open
        self.end_gestures()
        if not proposes:
            return ""
        self.message.emit("The proposal was discarded; press Enter first to keep one")
        return "; without the proposal, which was not accepted"

    def close(self) -> None:
        """Stop everything and free the graphics memory."""
        self.unfinished.stop()
        self.playback.pause()
        self.sound_player.close()
        self.media.clear()
        self.background.close()
        self.document.close_journal()
        if self.page is not None:
            self.page.trials.close()
            self.page.face.viewport.close_renderer()
