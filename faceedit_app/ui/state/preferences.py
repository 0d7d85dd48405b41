"""What FaceEdit remembers between two starts."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QByteArray, QSettings
from PySide6.QtWidgets import QMainWindow, QSplitter

RECENT = 8


class Preferences:
    """The user's settings; pass another QSettings to keep tests and headless runs apart."""

    def __init__(self, settings: QSettings | None = None) -> None:
        self._settings = settings or QSettings("FaceEdit", "FaceEdit")

    def problem(self) -> str:
        """Why settings cannot be kept, as one line; empty if all is well."""
        self._settings.sync()
        if self._settings.status() == QSettings.Status.NoError:
            return ""
        return (
            f"{self._settings.fileName()}: recent files and the window's layout cannot be kept;"
            " check the folder's permissions or free some space"
        )

    def recent(self) -> list[Path]:
        """The takes that were opened last, newest first; those that are gone are left out."""
        value = self._settings.value("recent", [])
        names = [value] if isinstance(value, str) else value if isinstance(value, list) else []
        return [path for path in map(Path, names) if path.is_file()]

    def add_recent(self, path: Path) -> None:
        """Remember that a take was opened."""
        path = path.resolve()
        others = [old for old in self.recent() if old != path]
        self._settings.setValue("recent", [str(p) for p in [path, *others][:RECENT]])

    def clear_recent(self) -> None:
        """Forget all takes."""
        self._settings.remove("recent")

    def folder(self, kind: str) -> Path:
        """Where a kind of file dialog was last used, else the home folder."""
        folder = Path(str(self._settings.value(f"folder/{kind}", Path.home())))
        return folder if folder.is_dir() else Path.home()

    def set_folder(self, kind: str, folder: Path) -> None:
        """Remember where a kind of file dialog was used."""
        self._settings.setValue(f"folder/{kind}", str(folder))

    def volume(self) -> tuple[float, bool]:
        """How loud sound was last, 0..1, and whether it was muted."""
        try:
            loud = float(str(self._settings.value("volume", 1.0)))
        except ValueError:
            loud = 1.0
        return min(max(loud, 0.0), 1.0), str(self._settings.value("muted", "false")) == "true"

    def set_volume(self, volume: float, muted: bool) -> None:
        """Remember how loud sound is."""
        self._settings.setValue("volume", volume)
        self._settings.setValue("muted", "true" if muted else "false")

    def difference(self) -> bool:
        """Whether the face was last tinted where it differs from the tracked one."""
        return str(self._settings.value("difference", "false")) == "true"

    def set_difference(self, shown: bool) -> None:
        """Remember whether the face is tinted."""
        self._settings.setValue("difference", "true" if shown else "false")

    def hints_wanted(self) -> bool:
        """Whether the first steps were never shown."""
        return self._settings.value("hints_seen") is None

    def set_hints_seen(self) -> None:
        """Do not show the first steps again."""
        self._settings.setValue("hints_seen", 1)

    def save_layout(self, window: QMainWindow, *splitters: QSplitter) -> None:
        """Remember the window's place and how its panes share it."""
        self._settings.setValue("window", window.saveGeometry())
        for number, splitter in enumerate(splitters):
            self._settings.setValue(f"panes/{number}", splitter.saveState())

    def restore_window(self, window: QMainWindow) -> bool:
        """Put the window where it was; False if it is the first time."""
        geometry = self._settings.value("window")
        return isinstance(geometry, QByteArray) and window.restoreGeometry(geometry)

    def restore_panes(self, *splitters: QSplitter) -> None:
        """Share the window among its panes as last time."""
        for number, splitter in enumerate(splitters):
            state = self._settings.value(f"panes/{number}")
            if isinstance(state, QByteArray):
                splitter.restoreState(state)
