"""What the Edit and Take menus do to the time of the take: stretch, move, cut, pause, match."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from faceedit_app.core.errors import FaceEditError
from faceedit_app.editing.edits.edit import LONGEST_FILL, Edit
from faceedit_app.editing.edits.media import MediaFile
from faceedit_app.media import is_media
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.edits.retime_dialog import Asked, Number, RetimeDialog

if TYPE_CHECKING:  # the window is there before the solver, and before sounds can be read
    from faceedit_app.core.clip import Clip
    from faceedit_app.media.sound import Sound
    from faceedit_app.words.transcript import Transcript

_FIRST_PAUSE = 0.3  # seconds
_LONGEST_PAUSE = 10.0


class RetimeCommands:
    """Asks how far, previews and makes retimes; matches the take to another sound."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace = workspace
        self._document, self._timeline = workspace.document, workspace.timeline

    # --- by hand -----------------------------------------------------------------------------

    def stretch(self) -> None:
        """Make the selection longer or shorter."""
        from faceedit_app.editing.help.retime import FASTEST, SLOWEST, stretched

        found = self._selected("stretch")
        if found is None:
            return
        clip, span = found
        length = Number("Length", "%", 100.0, 100.0 / FASTEST, 100.0 / SLOWEST, 5.0, 1)
        shown = self._workspace.shown_range(*span)
        asked = Asked("Stretch", f"How long {shown} becomes; what follows makes up for it.", length)
        self._ask(asked, lambda percent: stretched(clip, span, percent / 100))

    def move(self) -> None:
        """Show the selection earlier or later."""
        from faceedit_app.editing.help.retime import moved

        found = self._selected("move")
        if found is None:
            return
        clip, span = found
        later = self._length("Later by", 0.0, (-clip.duration, clip.duration), 1.0 / clip.rate, 3)
        per_second = self._workspace.length_unit[1]
        shown = self._workspace.shown_range(*span)
        asked = Asked("Move in time", f"How much later {shown} is shown; below 0: earlier.", later)
        self._ask(asked, lambda length: moved(clip, span, length / per_second))

    def cut(self) -> None:
        """Leave out the selection; what follows plays slower until it has caught up."""
        from faceedit_app.editing.help.retime import cut

        found = self._selected("cut")
        if found is None:
            return
        try:
            edit = cut(*found)
        except FaceEditError as error:
            self._workspace.message.emit(str(error))
            return
        self._make((edit,))

    def pause(self) -> None:
        """Insert a pause at the playhead; what follows plays faster until it has caught up."""
        from faceedit_app.editing.help.fill import fill_edit
        from faceedit_app.editing.help.retime import pause

        session, clip = self._document.session, self._timeline.clip
        if session is None or clip is None:
            return
        self._workspace.end_gestures()
        at, per_second = self._timeline.time, self._workspace.length_unit[1]

        def edits(length: float, filled: bool) -> tuple[Edit, ...]:
            seconds = length / per_second
            edit = pause(clip, at, seconds)
            (_, start), (_, end) = edit.pins[:2]
            if not filled:
                return (edit,)
            if seconds > LONGEST_FILL:
                raise FaceEditError(f"Other motion fills up to {LONGEST_FILL:.0f} s")
            return edit, fill_edit(session, start, end)

        shown = self._workspace.shown_time(at)
        asked = Asked(
            "Insert a pause",
            f"How long the face pauses at {shown}; what follows makes room.",
            self._length("Pause", _FIRST_PAUSE, (0.02, _LONGEST_PAUSE), 0.05, 2),
            option="&Fill it with other motion of the take",
        )
        self._show(asked, edits)

    def _length(
        self, label: str, value: float, ends: tuple[float, float], step: float, decimals: int
    ) -> Number:
        """A length of time in seconds, to be typed in the unit in which times are shown."""
        unit, per_second = self._workspace.length_unit
        if unit != "s":
            step, decimals = 1.0 / per_second, 1
        first, low, high, each = (per_second * seconds for seconds in (value, *ends, step))
        return Number(label, unit, first, low, high, each, decimals)

    def _selected(self, what: str) -> tuple[Clip, tuple[float, float]] | None:
        """The take and the selection, after any gesture in progress; None without either."""
        clip = self._timeline.clip
        if clip is None:
            return None
        self._workspace.end_gestures()
        selection = self._timeline.selection
        if selection is None or selection[1] <= selection[0]:
            self._workspace.message.emit(f"Select the range to {what} first")
            return None
        return clip, selection

    def _ask(self, asked: Asked, edit_for: Callable[[float], Edit]) -> None:
        """Ask for a number that leaves the take as it is at first."""

        def edits(value: float, _ticked: bool) -> tuple[Edit, ...]:
            return () if value == asked.number.value else (edit_for(value),)

        self._show(asked, edits)

    def _show(self, asked: Asked, edits: Callable[[float, bool], tuple[Edit, ...]]) -> None:
        workspace = self._workspace
        RetimeDialog(
            workspace.window, self._document, asked, edits, workspace.shown_range, self._make
        ).show()

    def _make(self, edits: tuple[Edit, ...]) -> None:
        from faceedit_app.editing.edits.describe import describe

        name = describe(edits[0])
        self._workspace.add_edits(edits, name)
        first, last = edits[0].start, edits[0].end
        self._workspace.message.emit(
            f"{name}; changes {self._workspace.shown_range(first, last)}, "
            "all that follows keeps its time"
        )

    # --- another sound -----------------------------------------------------------------------

    def match_sound(self) -> None:
        """Retime the take so that its words are said when another sound, or a file, says them."""
        session = self._document.session
        if session is None:
            return
        self._workspace.end_gestures()
        if session.words is None:
            self._workspace.message.emit("Enter what is said first: Take > Words…")
            return
        path = dialogs.ask_match(self._workspace.window, self._workspace.beside("words"))
        if path is None:
            return
        self._workspace.preferences.set_folder("words", path.resolve().parent)
        if is_media(path):
            self._read_sound(path)
            return
        from faceedit_app.words.files import read_words
        from faceedit_app.words.imported import spread

        try:
            said = read_words(path)
        except FaceEditError as error:
            dialogs.show_error(self._workspace.window, error)
            return
        if said.transcript is not None:
            self._match(said.transcript, None)
        elif all(line.end is not None for line in said.lines):
            self._match(spread(said.lines, 0.0), None)
        else:
            self._workspace.message.emit(
                f"{path.name} does not say when its words are said; open the sound instead"
            )

    def _read_sound(self, path: Path) -> None:
        def read() -> Sound | None:
            from faceedit_app.media.sound import read_sound

            return read_sound(path)

        reading = self._workspace.opener.reading

        def done(sound: Sound | None) -> None:
            reading.emit("")
            if sound is None:
                self._workspace.message.emit(f"{path.name} has no sound; choose another file")
            else:
                self._ask_their_words(sound)

        def failed(error: Exception) -> None:
            reading.emit("")
            dialogs.report_failure(self._workspace.window, error)

        reading.emit(f"Reading {path.name}…")
        self._workspace.background.run(read, done, failed)

    def _ask_their_words(self, sound: Sound) -> None:
        """Ask what the other sound says; at first what the take says."""
        from faceedit_app.ui.media.words_dialog import SearchScope, WordsDialog

        session = self._document.session
        if session is None:
            return

        def choose() -> Path | None:
            return dialogs.ask_words(self._workspace.window, sound.path.parent)

        def make(words: Transcript) -> None:
            self._match(words, sound)

        dialog = WordsDialog(
            self._workspace.window,
            self._workspace.background,
            lambda: SearchScope(sound, 0.0, (sound.start, sound.end), None),
            session.words,
            choose,
            None,
            make,
            self._workspace.drafts,
            sound.path,
        )
        dialog.setWindowTitle(f"Words of {sound.path.name}")
        dialog.open()

    def _match(self, theirs: Transcript, sound: Sound | None) -> None:
        """Retime the take, and play the other sound with it from now on."""
        from faceedit_app.editing.help.dubbing import MATCH, keep, match

        session = self._document.session
        if session is None or session.words is None:
            return
        try:
            found = match(session.take.clip, session.words, theirs)
        except FaceEditError as error:
            dialogs.show_error(self._workspace.window, error)
            return
        placement = self._workspace.media.placement
        keep(session, found, placement, None if sound is None else MediaFile(sound.path))
        page = self._workspace.page
        if page is not None:
            page.list_edits()
            page.edits.select_new()
        self._workspace.message.emit(found.message)
        if found.limited or found.unmatched:
            self._workspace.doubt.emit(found.message, lambda: MATCH in session.history[0])
