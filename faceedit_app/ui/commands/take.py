"""The Take menu: the sound and the film that belong to the open take."""

from __future__ import annotations

from pathlib import Path

from faceedit_app.editing.edits.media import Placement
from faceedit_app.formats.take import Take
from faceedit_app.formats.timecode import derive_base, parse_timecodes, time_of_day
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.state.actions import Command, Menu


class TakeCommands:
    """Adds and removes sound and film, including files dropped on the window."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace, self._media = workspace, workspace.media
        self._dropped: list[Path] = []  # to be added once the take dropped with them is open

    def ask_add(self) -> None:
        """Add a sound or a film that the user chooses."""
        preferences = self._workspace.preferences
        path = dialogs.ask_media(self._workspace.window, preferences.folder("media"))
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

    # --- with a take -------------------------------------------------------------------------

    def follow(self, take: Take, placement: Placement | None) -> None:
        """A take is open: add what belongs to it, then what was dropped with it.

        Args:
            placement: the project's; None: the files found beside the take.
        """
        codes, began = take.clip.timecodes, None
        if codes:
            began = time_of_day(codes[0], derive_base(parse_timecodes(codes))[0])
        self._media.follow(take.path, began, placement)
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
MENU: Menu[TakeCommands] = Menu("Take", (
    Command("add_media", "&Add sound or film…", TakeCommands.ask_add, ("Ctrl+Shift+O",),
            "Add sound or film to the take: WAV, MP3, M4A, MOV, MP4…"),
    Command("mirror_film", "&Mirror film", TakeCommands.mirror_film,
            tip="Flip the film, if its left and right do not match the face",
            enabled=lambda do: do.has_film, checked=lambda do: do.is_mirrored),
    Command("remove_sound", "Remove &sound", TakeCommands.remove_sound,
            tip="Remove the sound from the take", enabled=lambda do: do.has_sound,
            starts_group=True),
    Command("remove_film", "Remove &film", TakeCommands.remove_film,
            tip="Remove the film from the take", enabled=lambda do: do.has_film),
))
# fmt: on
