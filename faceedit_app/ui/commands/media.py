"""What the user can do with sound and film: add, drop, remove, mute."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QWidget

from faceedit_app.editing.edits.media import Placement
from faceedit_app.formats.take import Take
from faceedit_app.formats.timecode import derive_base, parse_timecodes, time_of_day
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.media.sound_player import SoundPlayer
from faceedit_app.ui.media.take_media import TakeMedia
from faceedit_app.ui.state.actions import Actions
from faceedit_app.ui.state.preferences import Preferences


class MediaCommands(QObject):
    """The commands behind the menus, and the files that are dropped."""

    def __init__(
        self, window: QWidget, media: TakeMedia, sound_player: SoundPlayer, preferences: Preferences
    ) -> None:
        super().__init__(window)
        self._window, self._preferences = window, preferences
        self._media, self._sound_player = media, sound_player
        self._actions: Actions | None = None
        self._dropped: list[Path] = []  # to be added when the take that came with them is open
        volume, muted = preferences.volume()
        sound_player.set_volume(volume)
        sound_player.set_muted(muted)
        media.sound_changed.connect(self._sync)
        media.film_changed.connect(self._sync)
        media.turned.connect(self._sync)
        sound_player.changed.connect(self._sync)
        sound_player.settled.connect(
            lambda: preferences.set_volume(sound_player.volume, sound_player.muted)
        )

    def handlers(self) -> dict[str, Callable[[], None]]:
        """What to do for each command."""
        return {
            "add_media": self.ask_add,
            "remove_sound": self._media.remove_sound,
            "remove_film": self._media.remove_film,
            "mirror_film": lambda: self._media.mirror(not self._media.mirrored),
            "mute": lambda: self._sound_player.set_muted(not self._sound_player.muted),
        }

    def attach(self, actions: Actions) -> None:
        """Keep the commands greyed out while there is nothing to do for them."""
        self._actions = actions
        self._sync()

    def _sync(self) -> None:
        if self._actions is None:
            return
        has_sound = self._media.sound is not None
        self._actions["remove_sound"].setEnabled(has_sound)
        self._actions["remove_film"].setEnabled(self._media.film is not None)
        self._actions["mirror_film"].setEnabled(self._media.film is not None)
        self._actions["mirror_film"].setChecked(self._media.mirrored)
        self._actions["mute"].setEnabled(has_sound)
        self._actions["mute"].setChecked(self._sound_player.muted)

    def ask_add(self) -> None:
        """File > Add sound or film."""
        path = dialogs.ask_media(self._window, self._preferences.folder("media"))
        if path is not None:
            self._preferences.set_folder("media", path.resolve().parent)
            self._media.add(path)

    def follow(self, take: Take, placement: Placement | None) -> None:
        """A take is open: take what belongs to it, then what was dropped with it.

        Args:
            placement: what its project names; None = what lies beside it.
        """
        codes, began = take.clip.timecodes, None
        if codes:
            began = time_of_day(codes[0], derive_base(parse_timecodes(codes))[0])
        self._media.follow(take.path, began, placement)
        dropped, self._dropped = self._dropped, []
        for path in dropped:
            self._media.add(path)
        self._sync()

    def drop(self, paths: list[Path], opens_take: bool, has_take: bool) -> None:
        """Files were dropped on the window.

        Args:
            opens_take: a take was dropped with them and is being opened.
            has_take: a take is open.
        """
        self._dropped = paths if opens_take else []
        if opens_take or not paths:
            return
        if not has_take:
            self._media.told.emit(f"Open a take first, then drop {paths[0].name} on it")
            return
        for path in paths:
            self._media.add(path)
