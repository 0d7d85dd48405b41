"""A valid file of the settings that the window remembers; reading it needs Qt."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from PySide6.QtCore import QSettings

from faceedit_app.core.errors import FaceEditError
from faceedit_app.lab.attacks.reader import Reader, Wrong
from faceedit_app.ui.state.preferences import Preferences


def setting_readers() -> Iterator[Reader]:
    """The reader of settings."""
    yield Reader("settings", ".ini", _SETTINGS, _read_settings)


_SETTINGS = b"""[General]
recent=/tmp/take.csv, /tmp/other.csv
recent_characters=@Invalid()
volume=0.5
muted=false
difference=true
film_place=below
window=@ByteArray(\\x1\\xd9\\xd0\\xcb\\0\\x3\\0\\0)

[folder]
take=/tmp
"""


def _read_settings(path: Path) -> None:
    """Read what the window remembers; it must start with anything."""
    preferences = Preferences(QSettings(str(path), QSettings.Format.IniFormat))
    preferences.recent()
    preferences.recent_characters()
    preferences.folder("take")
    loud, _ = preferences.volume()
    if not 0.0 <= loud <= 1.0:
        raise Wrong(f"the volume is {loud}")
    for read in (preferences.difference, preferences.follows_head, preferences.unfolds_curves):
        read()
    preferences.film_place()
    preferences.hints_wanted()
    preferences.add_recent(path)
    if preferences.recent()[:1] != [path.resolve()]:
        raise FaceEditError(preferences.problem())
