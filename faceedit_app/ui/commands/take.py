"""The Take menu: the frame rate, sound and film of the open take."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from pathlib import Path

from faceedit_app.core.atomic import said_of
from faceedit_app.editing.edits.media import Placement
from faceedit_app.formats.take import Take
from faceedit_app.formats.timecode import start_of_day
from faceedit_app.formats.timing import RateNeeded
from faceedit_app.ui.commands import conditions as c
from faceedit_app.ui.commands import dialogs, places
from faceedit_app.ui.commands.frame_rate import FrameRate
from faceedit_app.ui.commands.retime import RetimeCommands
from faceedit_app.ui.commands.words import WordCommands
from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.commands.writing import Advance, IsStopped, Writing
from faceedit_app.ui.state.actions import Command, Menu


class TakeCommands:
    """Asks for frame rates; adds and removes sound and film, including dropped files."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace, self._media = workspace, workspace.media
        self.words = WordCommands(workspace)
        self.retime = RetimeCommands(workspace)
        self.rate = FrameRate(workspace)
        self._side_by_side = Writing(workspace, "Export side by side")
        self._dropped: list[Path] = []  # to be added once the take dropped with them is open
        workspace.opener.rate_needed.connect(self._ask_needed_rate)

    def _ask_needed_rate(self, needed: RateNeeded, open_at: Callable[..., None]) -> None:
        """Ask for the rate of a take that cannot be opened without one."""
        question = f"{needed.path.name} {needed.problem}. What is its frame rate?"
        window, rate = self._workspace.window, needed.rate
        chosen = dialogs.ask_rate(window, question, needed.frames, rate)
        if chosen is not None:
            open_at(fps=chosen)
            return
        self._dropped = []

    # --- sound and film ------------------------------------------------------------------------

    def ask_add(self) -> None:
        """Add a sound or a film that the user chooses."""
        preferences = self._workspace.preferences
        path = dialogs.ask_media(self._workspace.window, self._workspace.beside("media"))
        if path is not None:
            preferences.set_folder("media", path.resolve().parent)
            self._media.add(path)

    @property
    def has_sound(self) -> bool:
        """Whether the take has sound."""
        return self._media.sound is not None

    @property
    def has_film(self) -> bool:
        """Whether the take has a film."""
        return self._media.film is not None

    def remove_sound(self) -> None:
        """Remove the sound from the take."""
        self._media.remove_sound()

    def remove_film(self) -> None:
        """Remove the film from the take, with its sound."""
        self._media.remove_film()

    @property
    def is_mirrored(self) -> bool:
        """Whether the film is mirrored."""
        return self._media.mirrored

    def mirror_film(self) -> None:
        """Mirror the film, or show it as it is."""
        self._media.mirror(not self._media.mirrored)

    @property
    def has_landmarks(self) -> bool:
        """Whether the take was tracked in its film, which is the one that is open."""
        film, stored = self._media.film, self._media.overlay.stored
        return film is not None and stored is not None and stored.film == film.path.name

    @property
    def shows_landmarks(self) -> bool:
        """Whether landmarks are shown over the film."""
        return self._media.overlay.is_shown

    def toggle_landmarks(self) -> None:
        """Show the landmarks over the film, or hide them."""
        self._media.overlay.toggle()

    def export_side_by_side(self) -> None:
        """Write film, tracked face and edited face side by side, in the background."""
        if self._side_by_side.is_busy or not self.has_landmarks:
            return
        placed, stored = self._media.film, self._media.overlay.stored
        session, rig = self._workspace.session, self._workspace.rig
        if placed is None or stored is None or session is None or rig is None:
            return
        self._workspace.end_gestures()
        suggestion = self._workspace.suggest("media", "_side_by_side", ".mp4")
        output = places.ask_where(self._workspace, dialogs.ask_save_side_by_side, suggestion)
        if output is None:
            return
        from faceedit_app.editing.filming import with_fills

        film, take, edited = placed, session.take, with_fills(session)
        page = self._workspace.page
        follows = page is not None and page.face.follows_head

        def work(advance: Advance, stopped: IsStopped) -> tuple[Path, tuple[Path | None, ...]]:
            from faceedit_app.media.film import Film
            from faceedit_app.tracking.side_by_side import (
                SideBySide,
                check_names,
                write_side_by_side,
            )

            check_names(output, (film.path, take.path))
            with closing(Film(film.path)) as opened:
                clips = take.clip, edited
                shown = SideBySide.of_take(opened, stored, *clips, film.offset, follows)
            return write_side_by_side(output, shown, rig, advance, stopped)

        def done(written: tuple[Path, tuple[Path | None, ...]]) -> None:
            picture, backups = written
            text = f"Wrote {output} and {picture.name}{said_of(*backups)}"
            self._workspace.message.emit(text)

        def failed(error: Exception) -> None:
            dialogs.report_failure(self._workspace.window, error)

        self._side_by_side.start(output.name, "Writing", work, done, failed)

    # --- with a take -------------------------------------------------------------------------

    def follow(self, take: Take, placement: Placement | None) -> None:
        """A take is open: add what belongs to it, then what was dropped with it.

        Args:
            placement: the project's; None: the files found beside the take.
        """
        codes = take.clip.timecodes
        began = start_of_day(codes) if codes else None
        self._media.follow(take.path, began, placement, take.lead)
        dropped, self._dropped = self._dropped, []
        for path in dropped:
            self._media.add(path)

    def drop(self, paths: list[Path], opens_take: bool) -> None:
        """Sounds and films were dropped on the window.

        Args:
            opens_take: a take was dropped with them and is being opened.
        """
        self._dropped = paths if opens_take else []
        if opens_take or not paths:
            return
        if self._workspace.session is None:
            name = paths[0].name
            self._workspace.message.emit(f"Open a take first, then drop {name} on it")
            return
        for path in paths:
            self._media.add(path)


# fmt: off
MENU: Menu[TakeCommands] = Menu("&Take", (
    Command("frame_rate", "&Frame rate…", lambda do: do.rate.change(), (),
            "Set the take's frame rate, if the file does not give it or gives a wrong one"),
    Command("add_media", "&Add sound or film…", TakeCommands.ask_add, ("Ctrl+Shift+O",),
            "Add sound or film to the take: WAV, MP3, M4A, MOV, MP4…", starts_group=True),
    Command("mirror_film", "&Mirror film", TakeCommands.mirror_film,
            tip="Flip the film, if its left and right do not match the face",
            enabled=c.HAS_FILM, checked=lambda do: do.is_mirrored),
    Command("film_landmarks", "Show &landmarks over the film", TakeCommands.toggle_landmarks,
            tip="Show where the tracker saw lips and lids, in the colours of their curves",
            enabled=c.HAS_LANDMARKS,
            checked=lambda do: do.has_landmarks and do.shows_landmarks),
    Command("side_by_side", "Export film and face side by s&ide…",
            TakeCommands.export_side_by_side,
            tip="Write the film with its landmarks, the tracked and the edited face as MP4 and PNG",
            enabled=c.HAS_LANDMARKS),
    Command("remove_sound", "Remove &sound", TakeCommands.remove_sound,
            tip="Remove the sound from the take", enabled=c.HAS_SOUND,
            starts_group=True),
    Command("remove_film", "R&emove film", TakeCommands.remove_film,
            tip="Remove the film from the take", enabled=c.HAS_FILM),
    Command("words", "&Words…", lambda do: do.words.ask(),
            tip="Say which words are spoken; they appear under the waveform",
            starts_group=True),
    Command("find_word", "Find a wo&rd", lambda do: do.words.find(), ("Ctrl+F",),
            "Find a word and select its time", enabled=c.HAS_WORDS),
    Command("match_sound", "Match another so&und…", lambda do: do.retime.match_sound(),
            tip="Retime the take so that it says its words when another sound does",
            enabled=c.HAS_WORDS),
    Command("remove_words", "Remove w&ords", lambda do: do.words.remove(),
            tip="Remove the words from the take; edits stay",
            enabled=c.HAS_WORDS),
))
# fmt: on
