"""Saving and opening project files, for the File menu and for recovery."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from faceedit_app.core import on_disk
from faceedit_app.core.atomic import is_same_file
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.fields import FieldError, Fields
from faceedit_app.editing.edits.media import Placement
from faceedit_app.editing.files import is_kept_project
from faceedit_app.editing.files.fingerprint import KnownFile, known
from faceedit_app.editing.files.pending import Pending
from faceedit_app.editing.files.project import (
    CharacterFile,
    Located,
    Project,
    ViewState,
    Whereabouts,
    locate,
    locate_character,
    locate_take,
    read_project,
)
from faceedit_app.editing.session import EditSession
from faceedit_app.editing.steps import EditState, Origin
from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.state.time_display import Unit


def save(workspace: Workspace, path: Path) -> Path | None:
    """Save take, edits, view, sound and film as one project.

    Returns:
        The copy that was kept of a file that is not this window's project; None if there was none.

    Raises:
        FileError: it cannot be written; an existing file is then untouched.
    """
    media = workspace.media.placement
    return workspace.document.save_project(path, view_of(workspace), media)


def view_of(workspace: Workspace) -> ViewState:
    """The current view of the take."""
    line = workspace.timeline
    window = {
        "falloff_out": line.own_falloffs[1],
        "unit": line.display.chosen.value,
        "mirror_film": workspace.media.mirrored,
    }
    return ViewState(line.time, line.view, line.own_selection, line.own_falloffs[0], window)


def restore_view(workspace: Workspace, view: ViewState) -> None:
    """Restore the view of the open take."""
    line = workspace.timeline
    try:
        fade_out = Fields(view.ui).number("falloff_out", view.falloff, 0.0)
    except FieldError:
        fade_out = view.falloff
    line.set_falloffs(view.falloff, fade_out)
    if view.visible is not None:
        line.show_range(*view.visible)
    line.select(view.selection)
    line.go_to_time(view.playhead)
    unit = view.ui.get("unit")
    if unit in list(Unit):
        line.display.choose(Unit(str(unit)))
    workspace.media.mirror(view.ui.get("mirror_film") is True)


def open_project(
    workspace: Workspace,
    path: Path,
    ask: Callable[[str, Sequence[Path]], Path | None],
    failed: Callable[[FaceEditError], None],
    keeps_character: bool = False,
) -> None:
    """Read a project in the background, find its take, and open it.

    The copy of a project that was replaced opens as well, and nothing is saved over it.

    Args:
        ask: which file is the take, where that is in doubt; given why it is, and likely ones.
        failed: is given the error of a project that cannot be read.
        keeps_character: the user asked for the character that is shown or being read: it stays.
    """

    def read() -> tuple[Project, KnownFile, Located]:
        file = known(path)
        project = read_project(path)
        return project, file, locate_take(project, path)

    def found(result: tuple[Project, KnownFile, Located]) -> None:
        project, file, located = result
        take = _chosen_take(located, ask)
        if take is None:
            workspace.opener.reading.emit("")
            return
        # Where the take was found, it is found again: without a choice there is nothing to save.
        was_found = located.where in (Whereabouts.FOUND, Whereabouts.MOVED)
        _open_take(workspace, project, file, take, was_found, _note_of(located), keeps_character)
        if not is_kept_project(path):
            workspace.preferences.add_recent(path)

    def report(error: Exception) -> None:
        workspace.opener.reading.emit("")
        if not isinstance(error, FaceEditError):
            raise error
        failed(error)

    workspace.opener.reading.emit(f"Opening {path.name}…")
    workspace.background.run(read, found, report)


def _chosen_take(
    located: Located, ask: Callable[[str, Sequence[Path]], Path | None]
) -> Path | None:
    """The take that edits are applied to; the user decides where that is in doubt."""
    match located.where:
        case Whereabouts.FOUND | Whereabouts.MOVED:
            return located.path
        case _:
            # The unchanged take first: the other one may contain the edits already.
            likely = [*located.others, *([located.path] if located.path is not None else [])]
            return ask(located.message, likely)


def _note_of(located: Located) -> str:
    """What to say once the take is open: that it was found elsewhere, without a question."""
    return located.message if located.where is Whereabouts.MOVED else ""


def _open_take(
    workspace: Workspace,
    project: Project,
    file: KnownFile,
    take: Path,
    was_found: bool,
    note: str,
    keeps_character: bool,
) -> None:
    """Open the take of a project that has been read.

    Args:
        file: the project's file.
        take: the file that its edits are applied to.
        was_found: the take is as the project knows it, and nobody had to choose it: opening the
            project leaves nothing to save.
        note: a warning once it is open; "" for none.
        keeps_character: as for `open_project`.
    """

    def prepare(session: EditSession) -> None:
        # What stands beside the take by chance is not the project's.
        media = Placement(project.audio, project.film)
        session.begin_with(replace(project.state, media=media))
        if take == project.take:
            session.exported_over = project.exported_over
        if was_found:
            session.mark_saved()

    def opened() -> None:
        if is_kept_project(file.path):
            workspace.message.emit(f"{file.path.name} is open as a copy: Save asks for its name")
        if note:
            workspace.warning.emit(note)
        restore_view(workspace, project.view)
        if not keeps_character:
            _open_character(workspace, project.character, file.path)

    workspace.opener.open(take, prepare, opened, file, project.fps)


def _open_character(workspace: Workspace, wanted: CharacterFile | None, path: Path) -> None:
    """Show the character that was shown with the project or take at `path`.

    If it is gone, say so and show ours.
    """
    if wanted is None:
        workspace.show_own_character()
        return
    found = locate_character(wanted, path)
    if found is None:
        workspace.show_own_character()
        workspace.warning.emit(
            f"{wanted.path} is missing, so FaceEdit's own character is shown; open yours with "
            "File > Character > Open"
        )
        return
    workspace.open_character(found, workspace.warning.emit)


def recover(
    workspace: Workspace,
    pending: Pending,
    ask: Callable[[str, Sequence[Path]], Path | None],
    instead_of: Path | None = None,
    keeps_character: bool = False,
) -> None:
    """Open the take of a session that ended in a crash, with its edits.

    Its journal stays until that has succeeded.

    Args:
        ask: as for `open_project`.
        instead_of: the file that was to be opened; it is found under the recent ones.
        keeps_character: as for `open_project`.
    """

    def look() -> Located:
        home = [pending.project.path.parent] if pending.project is not None else []
        return locate(pending.take, pending.fingerprint, pending.exported_over, home)

    def found(located: Located) -> None:
        take = _chosen_take(located, ask)
        workspace.opener.reading.emit("")
        if take is None:
            return
        notes = [_note_of(located)]
        own = [take, *([pending.project.path] if pending.project is not None else [])]
        if (
            instead_of is not None
            and on_disk.exists(instead_of)
            and not _is_one_of(instead_of, own)
        ):
            workspace.preferences.add_recent(instead_of)
            notes.append(f"{instead_of.name} is not open yet: choose it in File > Open recent")
        _open_recovered(workspace, pending, take, list(filter(None, notes)), keeps_character)

    workspace.opener.reading.emit(f"Looking for {pending.take.name}…")
    workspace.background.run(look, found, workspace.opener.failed.emit)


def _is_one_of(path: Path, others: Sequence[Path]) -> bool:
    return any(is_same_file(path, other) for other in others)


def _open_recovered(
    workspace: Workspace,
    pending: Pending,
    take: Path,
    notes: Sequence[str],
    keeps_character: bool,
) -> None:
    """Open a take with the edits of a session that crashed; then show warnings."""

    def prepare(session: EditSession) -> None:
        opened, origin = session.take, pending.origin or Origin(is_saved=False)
        if origin.rate is None and opened.own_rate is None:  # such a take is never without a rate
            origin = replace(origin, rate=opened.fps)
        session.recover(pending.state, origin)
        if take == pending.take:
            session.exported_over = pending.exported_over

    def opened() -> None:
        pending.discard()
        for note in notes:
            workspace.warning.emit(note)
        recovered = f"Recovered your work on {pending.take.name}{pending.counted_edits}"
        workspace.message.emit(f"{recovered}{_undone_by_one(workspace, pending)}")
        if pending.character is not None and not keeps_character:
            _open_character(workspace, CharacterFile(pending.character), take)
        session = workspace.session
        if session is not None and session.fingerprint != pending.fingerprint:
            workspace.warning.emit(f"{take.name} is not the take that these edits were made on")

    workspace.opener.open(take, prepare, opened, pending.project, pending.fps)


def _undone_by_one(workspace: Workspace, pending: Pending) -> str:
    """Where Undo leads after a recovery, to be added to a sentence."""
    session = workspace.session
    if session is None or not session.can_undo:
        return ""
    if session.origin.state == EditState() or pending.project is None:
        return "; a single Undo takes it all back"
    return f"; a single Undo goes back to {pending.project.path.name}"
