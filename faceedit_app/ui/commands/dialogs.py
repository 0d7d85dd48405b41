"""Questions to the user. Each is one function, so that a test can answer by replacing it."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum, auto
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QDateTime, Qt
from PySide6.QtWidgets import QFileDialog, QInputDialog, QMessageBox, QWidget

from faceedit_app.editing.files import PROJECT_SUFFIX
from faceedit_app.media import ENDINGS
from faceedit_app.ui.look.texts import plain_entry, plain_tip
from faceedit_app.ui.page.rate_dialog import RateDialog

if TYPE_CHECKING:
    from faceedit_app.editing.files.journal import Pending

PROJECTS = "Projects (*.faceedit);;All files (*)"
MEDIA = f"Sound and film ({' '.join(f'*{e} *{e.upper()}' for e in ENDINGS)});;All files (*)"
EDITS = "Edits (*.json);;All files (*)"
PICTURES = "Pictures (*.png);;All files (*)"


class Unsaved(Enum):
    """What to do with edits that are neither saved nor exported."""

    EXPORT = auto()
    SAVE = auto()
    DISCARD = auto()
    CANCEL = auto()


class Changed(Enum):
    """What to do if another program has changed a file that is about to be replaced."""

    REPLACE = auto()
    ELSEWHERE = auto()
    CANCEL = auto()


class Recover(Enum):
    """What to do with edits that a crash left behind."""

    RECOVER = auto()
    DISCARD = auto()
    LATER = auto()


def takes_pattern() -> str:
    """File name patterns of all take formats, for a file dialog."""
    from faceedit_app.formats.registry import endings  # not needed before the window is up

    return " ".join(f"*{ending} *{ending.upper()}" for ending in endings())


def ask_rate(parent: QWidget, question: str, frames: int, rate: float) -> float | None:
    """The frame rate of a take.

    Args:
        frames: how many it has.
        rate: what is likely.
    """
    dialog = RateDialog(parent, question, frames, rate)
    return dialog.rate if dialog.exec() else None


def ask_open(parent: QWidget, folder: Path) -> Path | None:
    """Which take to open."""
    kinds = f"Takes and projects ({takes_pattern()} *{PROJECT_SUFFIX});;All files (*)"
    return _chosen(
        QFileDialog.getOpenFileName(parent, "Open a take or a project", str(folder), kinds)
    )


def ask_export(parent: QWidget, suggestion: Path) -> Path | None:
    """Where to write the edited take."""
    kinds = f"Takes (*{suggestion.suffix});;All files (*)"
    return _save_name(parent, "Export the edited take", suggestion, kinds)


def ask_save_project(parent: QWidget, suggestion: Path) -> Path | None:
    """Where to save the project."""
    return _save_name(parent, "Save the project", suggestion, PROJECTS)


def ask_take_of_project(
    parent: QWidget, message: str, choices: Sequence[Path], folder: Path
) -> Path | None:
    """Which take a project's edits apply to, if its own has changed or is gone."""
    box = _question(parent, message, "Which take should the edits be applied to?")
    role = QMessageBox.ButtonRole
    paths = {
        box.addButton(plain_entry(f"Use {path.name}"), role.AcceptRole): path
        for path in choices[:3]
    }
    for button, path in paths.items():
        button.setToolTip(plain_tip(str(path)))
    look = box.addButton("Look for it…", role.ActionRole)
    box.setEscapeButton(box.addButton(QMessageBox.StandardButton.Cancel))
    box.exec()
    if box.clickedButton() is look:
        kinds = f"Takes ({takes_pattern()});;All files (*)"
        return _chosen(
            QFileDialog.getOpenFileName(parent, "The project's take", str(folder), kinds)
        )
    return next((path for button, path in paths.items() if button is box.clickedButton()), None)


def ask_recover(parent: QWidget, pending: Pending) -> Recover:
    """What to do with the edits of a session that ended in a crash."""
    one = pending.gestures == 1
    steps = "1 unsaved step" if one else f"{pending.gestures} unsaved steps"
    when = QDateTime.fromSecsSinceEpoch(int(pending.when)).toString("yyyy-MM-dd HH:mm")
    box = _question(
        parent,
        f"FaceEdit closed unexpectedly while you were editing {pending.take.name}.",
        f"{steps}, up to {when}, can be recovered."
        + ("" if one else " A single Undo then takes them all back."),
    )
    role = QMessageBox.ButtonRole
    choices = {
        box.addButton("Recover", role.AcceptRole): Recover.RECOVER,
        box.addButton("Discard", role.DestructiveRole): Recover.DISCARD,
    }
    later = box.addButton("Ask later", role.RejectRole)
    box.setEscapeButton(later)
    box.exec()
    clicked = box.clickedButton()
    return next((what for button, what in choices.items() if button is clicked), Recover.LATER)


def ask_save_edits(parent: QWidget, suggestion: Path) -> Path | None:
    """Where to save the list of edits."""
    return _save_name(parent, "Save edits", suggestion, EDITS)


def ask_load_edits(parent: QWidget, folder: Path) -> Path | None:
    """Which edits file to load."""
    return _chosen(QFileDialog.getOpenFileName(parent, "Load edits", str(folder), EDITS))


def ask_media(parent: QWidget, folder: Path) -> Path | None:
    """Which sound or film to add."""
    return _chosen(QFileDialog.getOpenFileName(parent, "Add sound or film", str(folder), MEDIA))


def ask_save_picture(parent: QWidget, suggestion: Path) -> Path | None:
    """Where to save the picture of the face."""
    return _save_name(parent, "Save picture", suggestion, PICTURES)


def ask_preset_name(parent: QWidget) -> str | None:
    """A name for a preset."""
    name, ok = QInputDialog.getText(parent, "Save as preset", "Name of the preset in the menu:")
    return name.strip() if ok and name.strip() else None


def ask_unsaved(parent: QWidget, name: str) -> Unsaved:
    """What to do with edits before their take is closed."""
    message = f"Your edits to {name} are neither saved nor exported."
    box = _question(parent, message, "If you discard them, they are lost.")
    role = QMessageBox.ButtonRole
    choices = {
        box.addButton("Export…", role.AcceptRole): Unsaved.EXPORT,
        box.addButton("Save project…", role.AcceptRole): Unsaved.SAVE,
        box.addButton("Discard", role.DestructiveRole): Unsaved.DISCARD,
    }
    box.setEscapeButton(box.addButton(QMessageBox.StandardButton.Cancel))
    box.exec()
    clicked = box.clickedButton()
    return next((what for button, what in choices.items() if button is clicked), Unsaved.CANCEL)


def ask_changed(parent: QWidget, name: str) -> Changed:
    """What to do if another program, or window, has changed a file since it was read."""
    message = f"{name} has been changed by another program, or in another window."
    box = _question(parent, message, "If you replace it, those changes are lost.")
    role = QMessageBox.ButtonRole
    choices = {
        box.addButton("Save under another name…", role.AcceptRole): Changed.ELSEWHERE,
        box.addButton("Replace", role.DestructiveRole): Changed.REPLACE,
    }
    box.setEscapeButton(box.addButton(QMessageBox.StandardButton.Cancel))
    box.exec()
    clicked = box.clickedButton()
    return next((what for button, what in choices.items() if button is clicked), Changed.CANCEL)


def show_error(parent: QWidget | None, error: Exception | str) -> None:
    """Show an error, in one line."""
    box = QMessageBox(QMessageBox.Icon.Warning, "FaceEdit", "", parent=parent)
    box.setTextFormat(Qt.TextFormat.PlainText)  # a path may look like a tag
    box.setText(str(error))
    box.exec()


def _question(parent: QWidget, message: str, more: str) -> QMessageBox:
    """A question without its buttons."""
    box = QMessageBox(parent)
    box.setIcon(QMessageBox.Icon.Question)
    box.setWindowTitle("FaceEdit")
    box.setTextFormat(Qt.TextFormat.PlainText)  # a path may look like a tag
    box.setText(message)
    box.setInformativeText(more)
    return box


def _save_name(parent: QWidget, title: str, suggestion: Path, kinds: str) -> Path | None:
    dialog = QFileDialog(parent, title, str(suggestion.parent), kinds)
    dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
    # Added before Qt asks whether to replace a file, so that it asks about the right one.
    dialog.setDefaultSuffix(suggestion.suffix)
    dialog.selectFile(suggestion.name)
    return Path(dialog.selectedFiles()[0]) if dialog.exec() else None


def _chosen(answer: tuple[str, str]) -> Path | None:
    return Path(answer[0]) if answer[0] else None
