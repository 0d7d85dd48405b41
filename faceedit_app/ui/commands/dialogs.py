"""Questions to the user. Each is one function, so that a test can answer by replacing it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import Enum, auto
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from PySide6.QtCore import QDateTime, Qt
from PySide6.QtWidgets import (
    QAbstractButton,
    QInputDialog,
    QMainWindow,
    QMessageBox,
    QPushButton,
    QWidget,
)

from faceedit_app.core.atomic import where_kept
from faceedit_app.core.errors import FaceEditError
from faceedit_app.ui.commands import file_kinds
from faceedit_app.ui.commands.file_dialogs import open_name, save_name
from faceedit_app.ui.look.texts import name_entry, plain_tip, sentence
from faceedit_app.ui.look.widgets import shown_once
from faceedit_app.ui.page.rate_dialog import RateDialog

if TYPE_CHECKING:
    from faceedit_app.editing.exporting import Options, OutFormat
    from faceedit_app.editing.files.pending import Pending
    from faceedit_app.editing.filming import Shot
    from faceedit_app.formats.take import Take
    from faceedit_app.live.protocols import Protocol
    from faceedit_app.media.film_writer import FilmFormat

Picked = TypeVar("Picked")


class Unsaved(Enum):
    """What to do with edits that no project holds."""

    EXPORT = auto()
    SAVE = auto()
    DISCARD = auto()
    CANCEL = auto()


class Changed(Enum):
    """What to do if a file that is about to be replaced holds more than this take's work."""

    REPLACE = auto()
    ELSEWHERE = auto()
    CANCEL = auto()


class OpenAs(Enum):
    """What to open of a file that is both a take and a character."""

    TAKE = auto()
    CHARACTER = auto()
    CANCEL = auto()


class Recover(Enum):
    """What to do with edits that a crash left behind."""

    RECOVER = auto()
    DISCARD = auto()
    LATER = auto()


def ask_rate(parent: QWidget, question: str, frames: float, rate: float) -> float | None:
    """The frame rate of a take.

    Args:
        frames: its duration in frames, with those of its gaps.
        rate: what is likely.
    """
    with shown_once(RateDialog(parent, question, frames, rate)) as dialog:
        return dialog.rate if dialog.exec() else None


def ask_open(parent: QWidget, folder: Path) -> Path | None:
    """Which take to open."""
    return open_name(parent, "Open a take or a project", folder, file_kinds.all_that_opens())


def ask_export(parent: QWidget, suggestion: Path) -> Path | None:
    """Where to write the take; a suggestion without an ending is a new folder."""
    kinds = file_kinds.like(suggestion.suffix)
    return save_name(parent, "Export", suggestion, kinds, any_ending=True)


def ask_export_as(
    parent: QWidget, take: Take, character: Path | None
) -> tuple[OutFormat, Options] | None:
    """How to export a take.

    Args:
        character: the file of the character on screen; None = FaceEdit's own.
    """
    from faceedit_app.ui.page.export_dialog import ExportDialog  # brings the formats' writers

    with shown_once(ExportDialog(parent, take, character)) as dialog:
        return (dialog.chosen, dialog.options) if dialog.exec() else None


def ask_film(
    parent: QWidget, rate: float, has_sound: bool, has_film: bool
) -> tuple[FilmFormat, Shot] | None:
    """How to film a take of so many frames per second, which may have sound and a film."""
    from faceedit_app.ui.page.film_dialog import FilmDialog  # brings PyAV's wrappers

    with shown_once(FilmDialog(parent, rate, has_sound, has_film)) as dialog:
        return (dialog.chosen, dialog.shot) if dialog.exec() else None


def ask_live(parent: QWidget) -> tuple[Protocol, str, int] | None:
    """Where to send the face: protocol, address and port."""
    from faceedit_app.ui.page.live_dialog import LiveDialog

    with shown_once(LiveDialog(parent)) as dialog:
        return dialog.chosen if dialog.exec() else None


def ask_record(parent: QWidget) -> tuple[Protocol, str, int] | None:
    """What to record: protocol, the phone's address, and the port to listen on."""
    from faceedit_app.ui.page.live_dialog import RecordDialog

    with shown_once(RecordDialog(parent)) as dialog:
        return dialog.chosen if dialog.exec() else None


def ask_record_name(
    parent: QWidget, suggestion: Path, kinds: str = file_kinds.RECORDINGS
) -> Path | None:
    """Where to write a recording, a take or a film."""
    return save_name(parent, "Record to", suggestion, kinds)


def ask_stop_writing(parent: QWidget, names: Sequence[str]) -> bool:
    """Whether to give up files that are being written."""
    are, them = ("is", "it") if len(names) == 1 else ("are", "them")
    message = f"{' and '.join(names)} {are} still being written."
    more = f"If you stop now, nothing of {them} is kept."
    return _insists(parent, message, more, "&Stop and close", "&Keep writing")


def show_exported(parent: QWidget, path: Path, lines: Sequence[str]) -> None:
    """Show what to do with an exported file; the window need not wait for the answer."""
    box = QMessageBox(QMessageBox.Icon.Information, "Exported", "", parent=parent)
    box.setTextFormat(Qt.TextFormat.PlainText)
    box.setText(f"Exported {path.name}")
    box.setInformativeText("\n\n".join(map(sentence, lines)))
    box.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
    box.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    box.open()


def ask_overwrite(parent: QWidget, path: Path, reason: str) -> Changed:
    """Whether to replace a recording, or to ask for another name.

    Args:
        reason: why it should be kept, as a phrase that follows its name.
    """
    more = f"If you overwrite it, the recording is kept {where_kept(path)}."
    box = _question(parent, f"{path.name} {reason}.", more)
    other = box.addButton("&Choose another name…", QMessageBox.ButtonRole.AcceptRole)
    overwrite = box.addButton("&Overwrite recording", QMessageBox.ButtonRole.DestructiveRole)
    box.setDefaultButton(other)
    choices = {other: Changed.ELSEWHERE, overwrite: Changed.REPLACE}
    return _choice(box, choices, Changed.CANCEL)


def ask_save_project(parent: QWidget, suggestion: Path) -> Path | None:
    """Where to save the project."""
    return save_name(parent, "Save the project", suggestion, file_kinds.PROJECTS)


def ask_take_of_project(
    parent: QWidget, message: str, choices: Sequence[Path], folder: Path
) -> Path | None:
    """Which take a project's edits apply to, if its own has changed or is gone."""
    box = _question(parent, message, "Which take should the edits be applied to?")
    role = QMessageBox.ButtonRole
    paths = {
        box.addButton(f"{use} {name_entry(path.name)}", role.AcceptRole): path
        for use, path in zip(("&Use", "U&se", "Us&e"), choices, strict=False)
    }
    for button, path in paths.items():
        button.setToolTip(plain_tip(str(path)))
    look = box.addButton("&Look for it…", role.ActionRole)
    box.setEscapeButton(box.addButton(QMessageBox.StandardButton.Cancel))
    clicked = _clicked(box)
    if clicked is look:
        return open_name(parent, "The project's take", folder, file_kinds.takes())
    return next((path for button, path in paths.items() if button is clicked), None)


def ask_recover(parent: QWidget, pending: Pending) -> Recover:
    """What to do with the edits of a session that ended in a crash."""
    when = QDateTime.fromSecsSinceEpoch(int(pending.when)).toString("yyyy-MM-dd HH:mm")
    project = f" in {pending.project.path.name}" if pending.project is not None else ""
    box = _question(
        parent,
        f"FaceEdit closed unexpectedly while you were editing {pending.take.name}{project}.",
        f"Your work until {when} can be recovered{pending.counted_edits}. "
        "A single Undo then takes it all back.",
    )
    role = QMessageBox.ButtonRole
    choices = {
        box.addButton("&Recover", role.AcceptRole): Recover.RECOVER,
        box.addButton("&Discard", role.DestructiveRole): Recover.DISCARD,
    }
    box.setEscapeButton(box.addButton("&Ask later", role.RejectRole))
    clicked = _clicked(box)
    return next((what for button, what in choices.items() if button is clicked), Recover.LATER)


def ask_save_edits(parent: QWidget, suggestion: Path) -> Path | None:
    """Where to save the list of edits."""
    return save_name(parent, "Save edits", suggestion, file_kinds.EDITS)


def ask_load_edits(parent: QWidget, folder: Path) -> Path | None:
    """Which edits file to load."""
    return open_name(parent, "Load edits", folder, file_kinds.EDITS)


def ask_media(parent: QWidget, folder: Path) -> Path | None:
    """Which sound or film to add."""
    return open_name(parent, "Add sound or film", folder, file_kinds.MEDIA)


def ask_words(parent: QWidget, folder: Path) -> Path | None:
    """Which file says what is said."""
    return open_name(parent, "Open words", folder, file_kinds.WORDS)


def ask_match(parent: QWidget, folder: Path) -> Path | None:
    """Which sound, or file with the times of its words, the take is matched to."""
    title = "Match another sound, or words with times"
    return open_name(parent, title, folder, file_kinds.SOUND_OR_WORDS)


def ask_save_words(parent: QWidget, suggestion: Path) -> Path | None:
    """Where to write the words; the ending says as what."""
    return save_name(parent, "Export words", suggestion, file_kinds.WRITTEN_WORDS)


def ask_character(parent: QWidget, folder: Path) -> Path | None:
    """Which character to open."""
    return open_name(parent, "Open a character", folder, file_kinds.characters())


def ask_scan(parent: QWidget, folder: Path) -> Path | None:
    """Which scan to make a character from."""
    return open_name(parent, "A head without blendshapes", folder, file_kinds.SCANS)


def ask_save_character(parent: QWidget, suggestion: Path) -> Path | None:
    """Where to save a character."""
    return save_name(parent, "Save the character", suggestion, file_kinds.WRITTEN_CHARACTERS)


def ask_take_or_character(parent: QWidget, name: str) -> OpenAs:
    """How to open a file that has both a face and an animation."""
    box = _question(parent, f"{name} has a face and an animation.", "What should be opened?")
    role = QMessageBox.ButtonRole
    choices = {
        box.addButton("The &animation, as a take", role.AcceptRole): OpenAs.TAKE,
        box.addButton("The &face, as your character", role.AcceptRole): OpenAs.CHARACTER,
    }
    return _choice(box, choices, OpenAs.CANCEL)


def ask_film_to_track(parent: QWidget, folder: Path) -> Path | None:
    """Which film to track."""
    return open_name(parent, "Track a film", folder, file_kinds.FILMS)


def ask_save_take(parent: QWidget, suggestion: Path) -> Path | None:
    """Where to write the take of a film."""
    return save_name(parent, "Save the tracked take as", suggestion, file_kinds.TRACKED_TAKES)


def ask_save_side_by_side(parent: QWidget, suggestion: Path) -> Path | None:
    """Where to write film and face side by side."""
    title = "Export film and face side by side"
    return save_name(parent, title, suggestion, file_kinds.MP4)


def ask_save_picture(parent: QWidget, suggestion: Path) -> Path | None:
    """Where to save the picture of the face."""
    return save_name(parent, "Save picture", suggestion, file_kinds.PICTURES)


def ask_preset_name(parent: QWidget, current: str = "") -> str | None:
    """A name for a preset; `current` is the one that it has, if it is to be renamed."""
    title = "Rename preset" if current else "Save as preset"
    name, ok = QInputDialog.getText(parent, title, "Name of the preset in the menu:", text=current)
    return name.strip() if ok and name.strip() else None


def ask_delete_preset(parent: QWidget, name: str) -> bool:
    """Whether to delete a preset."""
    message = f"Delete the preset “{name}”?"
    return _insists(parent, message, "It cannot be brought back.", "&Delete", "&Keep")


def ask_unsaved(
    parent: QWidget, message: str, more: str = "", *, asks: bool = True, exports: bool = True
) -> Unsaved:
    """What to do with unsaved changes: saving `asks` for a name; an export may hold some."""
    box = _question(parent, message, more)
    role = QMessageBox.ButtonRole
    save = box.addButton("&Save project" + "…" * asks, role.AcceptRole)
    choices = {save: Unsaved.SAVE}
    if exports:
        choices[box.addButton("&Export…", role.AcceptRole)] = Unsaved.EXPORT
    choices[box.addButton("&Discard", role.DestructiveRole)] = Unsaved.DISCARD
    box.setDefaultButton(save)
    return _choice(box, choices, Unsaved.CANCEL)


def ask_unsaved_map(parent: QWidget, name: str) -> Unsaved:
    """What to do with choices in a character's checklist before it is closed."""
    message = f"What you changed in the checklist of {name} is not saved."
    box = _question(parent, message, "A project does not hold it: a map beside the character does.")
    role = QMessageBox.ButtonRole
    save = box.addButton("&Save map", role.AcceptRole)
    choices = {save: Unsaved.SAVE, box.addButton("&Discard", role.DestructiveRole): Unsaved.DISCARD}
    box.setDefaultButton(save)
    return _choice(box, choices, Unsaved.CANCEL)


def ask_changed(parent: QWidget, path: Path) -> Changed:
    """What to do if another program, or window, has changed a file since it was read."""
    message = f"{path.name} has been changed by another program, or in another window."
    box = _question(parent, message, f"If you replace it, a copy of it is kept {where_kept(path)}.")
    role = QMessageBox.ButtonRole
    choices = {
        box.addButton("&Save under another name…", role.AcceptRole): Changed.ELSEWHERE,
        box.addButton("&Replace", role.DestructiveRole): Changed.REPLACE,
    }
    return _choice(box, choices, Changed.CANCEL)


def show_error(parent: QWidget | None, error: Exception | str) -> None:
    """Show an error, in one line; what the window says it is doing has ended in it."""
    if isinstance(parent, QMainWindow) and parent.statusBar().currentMessage().endswith("…"):
        parent.statusBar().clearMessage()
    box = QMessageBox(QMessageBox.Icon.Warning, "FaceEdit", "", parent=parent)
    box.setTextFormat(Qt.TextFormat.PlainText)  # a path may look like a tag
    box.setText(str(error))
    _clicked(box)


def report_failure(parent: QWidget | None, error: Exception) -> None:
    """Show why something failed; raise what is no fault of a file or the user."""
    if not isinstance(error, FaceEditError):
        raise error
    show_error(parent, error)


def _question(parent: QWidget, message: str, more: str) -> QMessageBox:
    """A question without its buttons."""
    box = QMessageBox(parent)
    box.setIcon(QMessageBox.Icon.Question)
    box.setWindowTitle("FaceEdit")
    box.setTextFormat(Qt.TextFormat.PlainText)  # a path may look like a tag
    box.setText(message)
    box.setInformativeText(more)
    return box


def _insists(parent: QWidget, message: str, more: str, risky: str, safe: str) -> bool:
    """Whether the user chooses what loses something; Enter and Esc do not."""
    box = _question(parent, message, more)
    button = box.addButton(risky, QMessageBox.ButtonRole.DestructiveRole)
    keep = box.addButton(safe, QMessageBox.ButtonRole.RejectRole)
    box.setDefaultButton(keep)
    box.setEscapeButton(keep)
    return _clicked(box) is button


def _choice(box: QMessageBox, choices: Mapping[QPushButton, Picked], cancel: Picked) -> Picked:
    """What the clicked button stands for; `cancel` for Cancel, which is added, and Esc."""
    box.setEscapeButton(box.addButton(QMessageBox.StandardButton.Cancel))
    clicked = _clicked(box)
    return next((what for button, what in choices.items() if button is clicked), cancel)


def _clicked(box: QMessageBox) -> QAbstractButton:
    """The answer to a question, which is shown once."""
    with shown_once(box):
        box.exec()
        return box.clickedButton()
