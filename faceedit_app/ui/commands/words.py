"""What the Take and Fix menus do with the words of the take."""

from __future__ import annotations

from pathlib import Path

from faceedit_app.core.atomic import said_of
from faceedit_app.core.errors import FaceEditError
from faceedit_app.formats.timing import counted
from faceedit_app.ui.commands import dialogs, places
from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.edits.slider_dialog import End, SliderDialog
from faceedit_app.words.transcript import Transcript


class WordCommands:
    """Asks for the words, writes them, and fixes lips where words say what they should do."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace = workspace
        self._document, self._timeline = workspace.document, workspace.timeline

    @property
    def has_words(self) -> bool:
        """Whether the take has words."""
        return self._words is not None

    @property
    def _words(self) -> Transcript | None:
        session = self._document.session
        return session.words if session is not None else None

    @property
    def _offset(self) -> float:
        """When the take's sound begins, also if its file is missing; seconds."""
        placed = self._workspace.media.placement.sound
        return placed.offset if placed is not None else 0.0

    # --- the Take menu -----------------------------------------------------------------------

    def ask(self) -> None:
        """Ask for the words, and find when they are said."""
        from faceedit_app.ui.media.words_dialog import SearchScope, WordsDialog

        self._workspace.end_gestures()
        session = self._document.session
        if session is None:
            return

        def place() -> SearchScope:
            media, line = self._workspace.media, self._timeline
            sound, selection = media.sound, line.own_selection
            return SearchScope(
                sound.item if sound is not None else None,
                self._offset,
                (0.0, line.duration),
                selection,
                self._workspace.shown_range(*selection) if selection is not None else "",
                sound is not None or media.placement.sound is None or not media.pending,
            )

        dialog = WordsDialog(
            self._workspace.window,
            self._workspace.background,
            place,
            self._words,
            self._choose,
            self.export,
            self._set,
            self._workspace.drafts,
            session.take.path,
        )
        dialog.open()

    def _choose(self) -> Path | None:
        preferences = self._workspace.preferences
        path = dialogs.ask_words(self._workspace.window, self._workspace.beside("words"))
        if path is not None:
            preferences.set_folder("words", path.resolve().parent)
            self._workspace.words_file = path
        return path

    def _set(self, words: Transcript) -> None:
        session = self._document.session
        if session is None:
            return
        session.say(words, self._workspace.media.placement)
        from faceedit_app.words.aligning import NOISY

        self._workspace.message.emit(f"Found {counted(len(words.words), 'word')}")
        if words.noise is not None and words.noise < NOISY:
            self._workspace.doubt.emit(
                f"The sound is noisy ({words.noise:.0f} dB above the noise): "
                "check the times of the words under the waveform",
                lambda: self._words is not None and self._words.noise == words.noise,
            )

    def export(self) -> None:
        """Write the words to a file that the user chooses; times count from the sound's start."""
        words = self._words
        if words is None:
            return
        from faceedit_app.words.files import write_words

        suggestion = self._workspace.suggest("words", "", ".TextGrid")
        path = places.ask_where(self._workspace, dialogs.ask_save_words, suggestion)
        if path is None:
            return
        sound = self._workspace.media.sound
        seconds = sound.item.end if sound is not None else self._timeline.duration
        try:
            backup = write_words(path, words.shifted(-self._offset), seconds)
        except FaceEditError as error:
            dialogs.show_error(self._workspace.window, error)
            return
        self._workspace.message.emit(f"Wrote {path.name}{said_of(backup)}")

    def find(self) -> None:
        """Go to the field to search a word."""
        page = self._workspace.page
        if page is not None:
            if not page.words.isVisible():
                self._workspace.message.emit("The words have no room: make the window higher")
            page.words.search.setFocus()
            page.words.search.selectAll()

    def remove(self) -> None:
        """Remove the words; the edits that they made stay."""
        self._workspace.end_gestures()
        self._document.act(lambda session: session.say(None))

    # --- the Fix menu ------------------------------------------------------------------------

    def close_lips(self) -> None:
        """Close the lips at each m, b and p that stays open, as one step."""
        from faceedit_app.editing.help.spoken import closing_edits

        session = self._document.session
        if session is None:
            return
        self._workspace.end_gestures()
        edits = closing_edits(session, self._timeline.own_selection)
        if edits:
            self._workspace.add_edits(edits, "Close lips", counted(len(edits), "closure"))
        else:
            self._workspace.message.emit(f"The lips meet at each m, b and p {self._where}")

    def shape_lips(self) -> None:
        """Shape the lips at f, w, oo, sh and ch as far as they fall short, as one step."""
        from faceedit_app.editing.help.spoken import shaping_edits

        session = self._document.session
        if session is None:
            return
        self._workspace.end_gestures()
        edits = shaping_edits(session, self._timeline.own_selection)
        if edits:
            self._workspace.add_edits(edits, "Shape lips", counted(len(edits), "lip shape"))
        else:
            self._workspace.message.emit(f"The lips have their shapes at f, w and sh {self._where}")

    @property
    def _where(self) -> str:
        return "in the selection" if self._timeline.own_selection is not None else "of the take"

    def say_clearly(self) -> None:
        """Show the slider from mumbled to clear."""
        from faceedit_app.editing.help.articulation import articulate

        session, words = self._document.session, self._words
        if session is None or words is None:
            return
        self._workspace.end_gestures()
        meant = self._timeline.own_selection
        span = meant or (0.0, self._timeline.duration)
        where = f"from {self._workspace.shown_range(*meant)}" if meant else "in the whole take"
        left = End("mumbled", "calm", articulate(session, words, span, -1.0))
        right = End("clearer", "exaggerate", articulate(session, words, span, 1.0))
        SliderDialog(
            self._workspace.window,
            self._document,
            "Say it clearly",
            f"How clearly the words are said {where}:",
            left,
            right,
            lambda edits: self._workspace.add_edits(edits, edits[0].name),
        ).show()
