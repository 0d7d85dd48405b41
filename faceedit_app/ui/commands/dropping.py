"""What becomes of files that are dropped on the window."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from faceedit_app.formats.timing import counted
from faceedit_app.media import is_film, is_media
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.commands.menus import Commands
from faceedit_app.ui.commands.workspace import Workspace


def take_files(workspace: Workspace, commands: Commands, paths: Sequence[Path]) -> None:
    """Open a take or a character, load edits, add sound or film, or track a film."""
    media = [path for path in paths if is_media(path)]
    path = next((path for path in paths if path not in media), None)
    film = next((path for path in media if is_film(path)), None)
    is_open = workspace.session is not None
    if path is None and film is not None and not is_open:
        commands.file.track(film)
        return
    commands.take.drop(media, opens_take=path is not None)
    if path is None:
        return
    others = len(paths) - len(media) - 1
    left = f"not {counted(others, 'file')} dropped with it" if others else ""
    begun: list[str] = []

    def note(reading: str) -> None:
        begun.append(reading)

    workspace.opener.reading.connect(note)
    is_loaded = _open(workspace, commands, path)
    workspace.opener.reading.disconnect(note)
    if left and (is_loaded or any(begun)):
        text = f"Of what was dropped, {path.name} was opened, {left}: drop one at a time"
        _warn_when_read(workspace, text, is_read=is_loaded or not begun[-1])


def _open(workspace: Workspace, commands: Commands, path: Path) -> bool:
    """Open a take, a project or a character, or load edits; whether they are loaded at once."""
    from faceedit_app.characters.registry import is_character
    from faceedit_app.formats.registry import is_take  # not needed before the window is up

    as_what = dialogs.OpenAs.TAKE
    if is_character(path):
        as_what = dialogs.OpenAs.CHARACTER
        if is_take(path):
            as_what = dialogs.ask_take_or_character(workspace.window, path.name)
    elif path.suffix.lower() == ".json" and workspace.session is not None and not is_take(path):
        commands.file.load_edits(path)
        return True
    if as_what is dialogs.OpenAs.TAKE:
        commands.file.open_if_saved(path)
    elif as_what is dialogs.OpenAs.CHARACTER:
        commands.file.character.open_if_saved(path)
    return False


def _warn_when_read(workspace: Workspace, text: str, is_read: bool) -> None:
    """Show a warning, once what is being read is open: opening takes warnings away."""

    def warn(reading: str) -> None:
        if not reading:
            workspace.opener.reading.disconnect(warn)
            workspace.warning.emit(text)

    if is_read:
        workspace.warning.emit(text)
    else:
        workspace.opener.reading.connect(warn)
