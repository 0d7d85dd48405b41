"""Asking the user. Each function is one question, so that tests answer it by replacing it."""

from __future__ import annotations

from enum import Enum, auto
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFileDialog, QInputDialog, QMessageBox, QWidget

from faceedit_app.media import ENDINGS

TAKES = "Takes (*.csv);;All files (*)"
MEDIA = f"Sound and film ({' '.join(f'*{e} *{e.upper()}' for e in ENDINGS)});;All files (*)"
EDITS = "Edits (*.json);;All files (*)"


class Unsaved(Enum):
    """What to do about edits that are not exported."""

    EXPORT = auto()
    SAVE = auto()
    DISCARD = auto()
    CANCEL = auto()


def ask_open(parent: QWidget, folder: Path) -> Path | None:
    """Which take to open."""
    return _chosen(QFileDialog.getOpenFileName(parent, "Open a take", str(folder), TAKES))


def ask_export(parent: QWidget, suggestion: Path) -> Path | None:
    """Where to write the edited take."""
    return _save_name(parent, "Export the edited take", suggestion, TAKES)


def ask_save_edits(parent: QWidget, suggestion: Path) -> Path | None:
    """Where to save the list of edits."""
    return _save_name(parent, "Save edits", suggestion, EDITS)


def ask_load_edits(parent: QWidget, folder: Path) -> Path | None:
    """Which edits to load."""
    return _chosen(QFileDialog.getOpenFileName(parent, "Load edits", str(folder), EDITS))


def ask_media(parent: QWidget, folder: Path) -> Path | None:
    """Which sound or film to add."""
    return _chosen(QFileDialog.getOpenFileName(parent, "Add sound or film", str(folder), MEDIA))


def ask_preset_name(parent: QWidget) -> str | None:
    """What a preset is to be called."""
    name, ok = QInputDialog.getText(
        parent, "Save as preset", "Name of the preset, as it stands in the menu:"
    )
    return name.strip() if ok and name.strip() else None


def ask_unsaved(parent: QWidget, name: str) -> Unsaved:
    """What to do about edits before their take is closed."""
    box = QMessageBox(parent)
    box.setIcon(QMessageBox.Icon.Question)
    box.setWindowTitle("FaceEdit")
    box.setTextFormat(Qt.TextFormat.PlainText)
    box.setText(f"The edits of {name} are neither exported nor saved.")
    box.setInformativeText("They are lost if you discard them.")
    role = QMessageBox.ButtonRole
    choices = {
        box.addButton("Export…", role.AcceptRole): Unsaved.EXPORT,
        box.addButton("Save edits…", role.AcceptRole): Unsaved.SAVE,
        box.addButton("Discard", role.DestructiveRole): Unsaved.DISCARD,
    }
    box.setEscapeButton(box.addButton(QMessageBox.StandardButton.Cancel))
    box.exec()
    clicked = box.clickedButton()
    return next((what for button, what in choices.items() if button is clicked), Unsaved.CANCEL)


def show_error(parent: QWidget | None, error: Exception | str) -> None:
    """Tell the user what went wrong, in one line."""
    box = QMessageBox(QMessageBox.Icon.Warning, "FaceEdit", "", parent=parent)
    box.setTextFormat(Qt.TextFormat.PlainText)  # a path may look like a tag
    box.setText(str(error))
    box.exec()


def _save_name(parent: QWidget, title: str, suggestion: Path, kinds: str) -> Path | None:
    dialog = QFileDialog(parent, title, str(suggestion.parent), kinds)
    dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
    # Added before the question whether to replace a file, so that it asks about the right one.
    dialog.setDefaultSuffix(suggestion.suffix)
    dialog.selectFile(suggestion.name)
    return Path(dialog.selectedFiles()[0]) if dialog.exec() else None


def _chosen(answer: tuple[str, str]) -> Path | None:
    return Path(answer[0]) if answer[0] else None
