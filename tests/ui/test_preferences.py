"""Settings that are damaged keep no window from starting."""

from __future__ import annotations

from pathlib import Path

import pytest
from PySide6.QtCore import QSettings

from faceedit_app.ui.state.preferences import Preferences

LONG = "a" * 5000


@pytest.mark.parametrize("volume", ["nan", "loud", "@ByteArray(x)", "1e999"])
def test_damaged_settings_are_as_if_they_were_not_there(tmp_path: Path, volume: str) -> None:
    file, take = tmp_path / "settings.ini", tmp_path / "take.csv"
    take.write_text("")
    lists = f"recent=/{LONG}, {take}\nrecent_characters=/{LONG}, {take}\n"
    folders = f"[folder]\ntake=/{LONG}\n"
    file.write_text(f"[General]\nvolume={volume}\n{lists}{folders}")
    preferences = Preferences(QSettings(str(file), QSettings.Format.IniFormat))
    assert preferences.recent() == preferences.recent_characters() == [take]
    assert preferences.folder("take") == Path.home()
    assert preferences.volume() == (1.0, False)
