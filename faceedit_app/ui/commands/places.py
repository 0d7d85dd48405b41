"""Where the window writes a file: over none that it reads, and a copy is kept of another kind."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtWidgets import QWidget

from faceedit_app.core.atomic import is_same_file, keep_inputs
from faceedit_app.core.errors import FileError
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.commands.workspace import Workspace

Ask = Callable[[QWidget, Path], Path | None]


def open_files(workspace: Workspace) -> dict[Path, str]:
    """What the window has open: what each file is, as a phrase that follows its name.

    Files that are missing, or still being read, count: a project refers to them.
    """
    document, placed = workspace.document, workspace.media.placement
    files: dict[Path, str] = {}
    if document.character is not None:
        from faceedit_app.characters.map_file import map_path

        path = document.character.character.path
        files[map_path(path)] = "is the map of the open character"
        files[path] = "is the open character"  # of a folder of shapes, any file in it
    if placed.sound is not None:
        files[placed.sound.path] = "is the sound of the open take"
    if placed.film is not None:
        files[placed.film.path] = "is the film of the open take"
    if workspace.words_file is not None:
        files[workspace.words_file] = "is where the words of the open take were read"
    if document.project is not None:
        files[document.project] = "is the open project"
    if document.path is not None:
        files[document.path] = "is the open take"
    return files


def refuse_open(workspace: Workspace, path: Path, allowed: Path | None = None) -> None:
    """Make sure that a file that the window has open is not written over.

    Args:
        path: the file that will be written.
        allowed: the one of the open files that may be: the project by a project.

    Raises:
        FileError: it is an open one.
    """
    if allowed is None or not is_same_file(path, allowed):
        keep_inputs([path], open_files(workspace))


def ask_where(
    workspace: Workspace, ask: Ask, suggestion: Path, allowed: Path | None = None
) -> Path | None:
    """Ask where to write a file, and say so if the window has that one open; then ask again.

    Args:
        ask: shows the dialog.
        suggestion: the first name to offer.
        allowed: as of `refuse_open`.

    Returns:
        None if the user cancels, or insists on the same file.
    """
    refused: Path | None = None
    while (path := ask(workspace.window, suggestion)) is not None:
        try:
            refuse_open(workspace, path, allowed)
        except FileError as error:
            dialogs.show_error(workspace.window, error)
            if path == refused:
                return None
            refused = path
        else:
            return path
    return None
