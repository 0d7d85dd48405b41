"""Asking for a file to open or to write: the system's own dialog, or Qt's where it has none."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtWidgets import QFileDialog, QHeaderView, QTreeView, QWidget

from faceedit_app.ui.look.widgets import resize_on_screen

_SIZE = (860, 540)  # pixels of Qt's dialog


def open_name(parent: QWidget, title: str, folder: Path, kinds: str) -> Path | None:
    """Which file to open; None if the user cancels.

    Args:
        title: of the dialog.
        folder: where it looks first.
        kinds: the filters, as in `file_kinds`.
    """
    dialog = _file_dialog(parent, title, folder, kinds)
    dialog.setFileMode(QFileDialog.FileMode.ExistingFile)
    # The endings would fill the list of kinds.
    dialog.setOption(QFileDialog.Option.HideNameFilterDetails)
    return _chosen(dialog)


def save_name(parent: QWidget, title: str, suggestion: Path, kinds: str) -> Path | None:
    """Where to write a file; None if the user cancels.

    Args:
        title: of the dialog.
        suggestion: the folder and the name that are offered; its ending is added if one is missing.
        kinds: the filters, as in `file_kinds`.
    """
    dialog = _file_dialog(parent, title, suggestion.parent, kinds)
    dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
    # Added before Qt asks whether to replace a file, so that it asks about the right one.
    dialog.setDefaultSuffix(suggestion.suffix)
    dialog.selectFile(suggestion.name)
    return _chosen(dialog)


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
