"""Asking for a file to open or to write: the system's own dialog, or Qt's where it has none."""

from __future__ import annotations

import re
from mimetypes import MimeTypes
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFileDialog, QHeaderView, QMessageBox, QTreeView, QWidget

from faceedit_app.core import on_disk
from faceedit_app.ui.look.widgets import resize_on_screen, shown_once

_SIZE = (860, 540)  # pixels of Qt's dialog


def open_name(parent: QWidget, title: str, folder: Path, kinds: str) -> Path | None:
    """Which file to open; None if the user cancels.

    Args:
        title: of the dialog.
        folder: where it looks first.
        kinds: the filters, as in `file_kinds`.
    """
    with shown_once(_file_dialog(parent, title, folder, kinds)) as dialog:
        dialog.setFileMode(QFileDialog.FileMode.ExistingFile)
        # The endings would fill the list of kinds.
        dialog.setOption(QFileDialog.Option.HideNameFilterDetails)
        return _chosen(dialog)


def save_name(
    parent: QWidget, title: str, suggestion: Path, kinds: str, any_ending: bool = False
) -> Path | None:
    """Where to write a file; None if the user cancels.

    Args:
        title: of the dialog.
        suggestion: the folder and the name that are offered; its ending is added if one is missing,
            also to a name such as “take v1.2”, whose “.2” is no ending.
        kinds: the filters, as in `file_kinds`.
        any_ending: whether another ending can be typed, because it means another format; if not,
            the ending is added to it, as no program would open a picture that is named like a CSV.
    """
    with shown_once(_file_dialog(parent, title, suggestion.parent, kinds)) as dialog:
        dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
        # Added before Qt asks whether to replace a file, so that it asks about the right one.
        dialog.setDefaultSuffix(suggestion.suffix)
        dialog.selectFile(suggestion.name)
        while (chosen := _chosen(dialog)) is not None:
            path = with_ending(chosen, suggestion.suffix, kinds, any_ending)
            if path == chosen or not on_disk.exists(path) or _may_replace(parent, path):
                return path
    return None


def with_ending(path: Path, ending: str, kinds: str, any_ending: bool = False) -> Path:
    """The path, with the ending added if it has none of those that it may have.

    Args:
        ending: the usual one, "" for folders.
        kinds, any_ending: as of `save_name`.
    """
    allowed = {found.lower() for found in re.findall(r"\*(\.\w+)", kinds)} | {ending.lower()}
    if any_ending:
        allowed.update(MimeTypes().types_map[1])
    if not ending or path.suffix.lower() in allowed:
        return path
    return path.with_name(path.name + ending)


def _may_replace(parent: QWidget, path: Path) -> bool:
    """Whether the user lets a file be replaced; Qt has asked about the name without its ending."""
    buttons = QMessageBox.StandardButton
    box = QMessageBox(
        QMessageBox.Icon.Warning,
        "FaceEdit",
        f"{path.name} exists. Replace it?",
        buttons.Yes | buttons.No,
        parent,
    )
    box.setTextFormat(Qt.TextFormat.PlainText)
    box.setDefaultButton(buttons.No)
    with shown_once(box):
        return box.exec() == buttons.Yes


def _file_dialog(parent: QWidget, title: str, folder: Path, kinds: str) -> QFileDialog:
    """A dialog in which names, sizes and dates have room."""
    dialog = QFileDialog(parent, title, str(folder), kinds)
    for files in dialog.findChildren(QTreeView):  # none if it is the system's own
        header = files.header()
        header.setStretchLastSection(False)
        header.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        header.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
    resize_on_screen(dialog, *_SIZE)
    return dialog


def _chosen(dialog: QFileDialog) -> Path | None:
    return Path(dialog.selectedFiles()[0]) if dialog.exec() else None
