"""Dialogs on a screen with less room than they would like."""

from __future__ import annotations

import pytest
from PySide6.QtCore import QSize
from PySide6.QtGui import QScreen
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot

from faceedit_app.ui.character.checklist import CharacterChecklist
from faceedit_app.ui.commands.help import about_dialog


@pytest.mark.parametrize("kind", ["checklist", "about"])
def test_a_dialog_is_no_larger_than_the_screen(
    kind: str, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(QScreen, "availableSize", lambda _: QSize(500, 480))
    parent = QWidget()
    qtbot.addWidget(parent)
    dialog = CharacterChecklist(parent) if kind == "checklist" else about_dialog(parent, "")
    assert dialog.width() <= 500
    assert dialog.height() < 480
