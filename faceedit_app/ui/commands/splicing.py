"""What the Edit menu does to a take's length: a new take without some time, or with more."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from faceedit_app.core.atomic import said_of
from faceedit_app.ui.commands import dialogs, places
from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.commands.writing import Advance, IsStopped, Writing
from faceedit_app.ui.edits.splice_dialog import SpliceDialog
from faceedit_app.ui.look.texts import sentence

if TYPE_CHECKING:  # the window is there before the solver
    from faceedit_app.editing.edits.splice import Splice
    from faceedit_app.editing.session import EditSession
    from faceedit_app.editing.splicing import Written
    from faceedit_app.words.transcript import Transcript

_FIRST = 0.5  # seconds that are inserted at first
_PARTS = 1000  # of the progress bar


class SpliceCommands:
    """Writes shorter and longer copies of the open take, one at a time.

    Args:
        may_close: asks about edits that would be lost if another take were opened.
    """

    def __init__(self, workspace: Workspace, may_close: Callable[[], bool]) -> None:
        self._workspace, self._may_close = workspace, may_close
        self._timeline = workspace.timeline
        self._writing = Writing(workspace, "New take")

    def shorten(self) -> None:
        """Cut the selection out of take, sound and film."""
        self._workspace.end_gestures()
        selection, clip = self._timeline.selection, self._timeline.clip
        if clip is None:
            return
        if selection is None or selection[1] <= selection[0]:
            self._workspace.message.emit("Select the range to cut out first")
            return
        from faceedit_app.editing.edits.splice import Splice

        start, end = selection
        shown = self._workspace.shown_range(start, end)
        left = max(clip.duration - (end - start), 0.0)
        self._ask(
            "Cut out and shorten",
            f"{shown} is cut out; the take becomes {left:.2f} s long.",
            None,
            lambda _: Splice(start, end),
        )

    def lengthen(self) -> None:
        """Insert time at the playhead into take, sound and film."""
        self._workspace.end_gestures()
        if self._timeline.clip is None:
            return
        from faceedit_app.editing.edits.splice import LONGEST_INSERT, Splice

        at = self._timeline.time
        shown = self._workspace.shown_time(at)
        self._ask(
            "Insert time and lengthen",
            f"At {shown} the face holds still, without sound; everything after it moves later.",
            (_FIRST, LONGEST_INSERT),
            lambda seconds: Splice(at, at, seconds),
        )

    def _ask(
        self,
        title: str,
        text: str,
        seconds: tuple[float, float] | None,
        wanted: Callable[[float], Splice],
    ) -> None:
        session, media = self._workspace.session, self._workspace.media
        if session is None or self._writing.is_busy:
            return
        pairs = (("sound", media.sound), ("film", media.film))
        has = tuple(name for name, there in pairs if there is not None)

        def make(length: float, has_film: bool) -> None:
            if self._workspace.session is session:
                self._write(session, wanted(length), has_film)

        unit = self._workspace.length_unit
        SpliceDialog(self._workspace.window, title, text, seconds, unit, has, make).open()

    def _write(self, session: EditSession, wanted: Splice, has_film: bool) -> None:
        from faceedit_app.editing.splicing import ending_for, free_name, write_spliced

        tail = "_longer" if wanted.seconds else "_shorter"
        suggestion = self._workspace.suggest("export", tail, ending_for(session.take))
        path = places.ask_where(self._workspace, dialogs.ask_export, free_name(suggestion))
        if path is None:
            return
        self._workspace.document.work_off()
        take, shown, words = session.take, session.edited_clip(), session.words
        placement, filled = self._workspace.media.placement, session.filled_rows()

        def write(advance: Advance, stopped: IsStopped) -> Written:
            def progress(share: float) -> bool:
                advance(round(_PARTS * share), _PARTS)
                return not stopped()

            return write_spliced(
                take, shown, [wanted], path, placement, has_film, progress, filled=filled
            )

        self._writing.start(
            path.name,
            "Writing",
            write,
            lambda written: self._offer(written, wanted, words),
            self._failed,
        )

    def _offer(self, written: Written, wanted: Splice, words: Transcript | None) -> None:
        """Say what was written, and offer to open it."""
        self._workspace.preferences.set_folder("export", written.path.resolve().parent)
        wrote = f"Wrote {written.names}{said_of(written.backup, *written.backups)}"
        text = " ".join(map(sentence, (wrote, *written.remarks)))
        self._workspace.message.emit(text)

        def open_it() -> None:
            if self._may_close():
                self._open(written, wanted, words)
            else:
                self._workspace.offer.emit(text, "Open it", open_it)

        self._workspace.offer.emit(text, "Open it", open_it)

    def _failed(self, error: Exception) -> None:
        dialogs.report_failure(self._workspace.window, error)

    def _open(self, written: Written, wanted: Splice, words: Transcript | None) -> None:
        """Open the new take with its words; inserted time is selected, ready to be filled."""
        new = written.words(words)

        def prepare(again: EditSession) -> None:
            if new is not None and new.words:
                again.say(new)

        def select() -> None:
            self._timeline.go_to_time(wanted.start)
            if wanted.seconds:
                self._timeline.select((wanted.start, wanted.start + wanted.seconds))

        self._workspace.opener.open(written.path, prepare, select)
