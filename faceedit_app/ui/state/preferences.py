"""Settings that FaceEdit remembers."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QByteArray, QSettings

from faceedit_app.core import on_disk

if TYPE_CHECKING:  # the attacks read settings where there is no window
    from PySide6.QtWidgets import QMainWindow, QSplitter

RECENT = 8


class Preferences:
    """The user's settings; tests and headless runs pass their own QSettings."""

    def __init__(self, settings: QSettings | None = None) -> None:
        self._settings = settings or QSettings("FaceEdit", "FaceEdit")

    def problem(self) -> str:
        """Why settings cannot be saved, in one line; empty if they can."""
        self._settings.sync()
        if self._settings.status() == QSettings.Status.NoError:
            return ""
        return (
            f"{self._settings.fileName()}: recent files and the window's layout cannot be saved;"
            " check the folder's permissions or free some space"
        )

    def recent(self) -> list[Path]:
        """Recent takes, newest first, without those that are gone."""
        value = self._settings.value("recent", [])
        names = [value] if isinstance(value, str) else value if isinstance(value, list) else []
        return [path for path in map(Path, names) if on_disk.is_file(path)]

    def add_recent(self, path: Path) -> None:
        """Remember that a take was opened."""
        path = path.resolve()
        others = [old for old in self.recent() if old != path]
        self._settings.setValue("recent", [str(p) for p in [path, *others][:RECENT]])

    def clear_recent(self) -> None:
        """Forget all takes."""
        self._settings.remove("recent")

    def recent_characters(self) -> list[Path]:
        """Recent characters, newest first, without those that are gone."""
        value = self._settings.value("recent_characters", [])
        names = [value] if isinstance(value, str) else value if isinstance(value, list) else []
        return [path for path in map(Path, names) if on_disk.exists(path)]

    def add_recent_character(self, path: Path) -> None:
        """Remember that a character was opened."""
        path = path.resolve()
        others = [old for old in self.recent_characters() if old != path]
        self._settings.setValue("recent_characters", [str(p) for p in [path, *others][:RECENT]])

    def folder(self, kind: str) -> Path:
        """Where a kind of file dialog was last used, else where takes are, else the home folder."""
        for known in (kind, "take"):
            text = str(self._settings.value(f"folder/{known}", ""))
            if text and on_disk.is_folder(folder := Path(text)):
                return folder
        return Path.home()

    def set_folder(self, kind: str, folder: Path) -> None:
        """Remember where a kind of file dialog was used."""
        self._settings.setValue(f"folder/{kind}", str(folder))

    def volume(self) -> tuple[float, bool]:
        """The last volume, 0..1, and whether sound was muted."""
        try:
            loud = float(str(self._settings.value("volume", 1.0)))
        except ValueError:
            loud = 1.0
        if math.isnan(loud):
            loud = 1.0
        return min(max(loud, 0.0), 1.0), str(self._settings.value("muted", "false")) == "true"

    def set_volume(self, volume: float, muted: bool) -> None:
        """Remember the volume."""
        self._settings.setValue("volume", volume)
        self._settings.setValue("muted", "true" if muted else "false")

    def difference(self) -> bool:
        """Whether the face was last tinted by its distance from the tracked one."""
        return str(self._settings.value("difference", "false")) == "true"

    def set_difference(self, shown: bool) -> None:
        """Remember whether the face is tinted."""
        self._settings.setValue("difference", "true" if shown else "false")

    def follows_head(self) -> bool:
        """Whether the head last turned as it was recorded."""
        return str(self._settings.value("follows_head", "false")) == "true"

    def set_follows_head(self, follows: bool) -> None:
        """Remember whether the head turns."""
        self._settings.setValue("follows_head", "true" if follows else "false")

    def unfolds_curves(self) -> bool:
        """Whether the optional curves were last shown."""
        return str(self._settings.value("optional_curves", "false")) == "true"

    def set_unfolds_curves(self, unfolded: bool) -> None:
        """Remember whether the optional curves are shown."""
        self._settings.setValue("optional_curves", "true" if unfolded else "false")

    def film_place(self) -> str:
        """Where the user wants the film: beside, above or below the face; "" = as it fits."""
        return str(self._settings.value("film_place", ""))

    def set_film_place(self, place: str) -> None:
        """Remember where the film is shown."""
        self._settings.setValue("film_place", place)

    def hints_wanted(self) -> bool:
        """Whether the first steps have not been shown yet."""
        return self._settings.value("hints_seen") is None

    def set_hints_seen(self) -> None:
        """Do not show the first steps again."""
        self._settings.setValue("hints_seen", 1)

    def save_layout(self, window: QMainWindow, *splitters: QSplitter) -> None:
        """Remember position and size of the window, and the sizes of its panes."""
        self._settings.setValue("window", window.saveGeometry())
        for number, splitter in enumerate(splitters):
            self._settings.setValue(f"panes/{number}", splitter.saveState())

    def restore_window(self, window: QMainWindow) -> bool:
        """Restore position and size of the window; False the first time."""
        geometry = self._settings.value("window")
        return isinstance(geometry, QByteArray) and window.restoreGeometry(geometry)

    def restore_panes(self, *splitters: QSplitter) -> None:
        """Restore the sizes of the panes."""
        for number, splitter in enumerate(splitters):
            state = self._settings.value(f"panes/{number}")
            if isinstance(state, QByteArray):
                splitter.restoreState(state)
