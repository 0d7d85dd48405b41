"""What is asked about changes that no project holds: which they are, and what holds what."""

from __future__ import annotations

from collections.abc import Sequence

from faceedit_app.core.texts import listed
from faceedit_app.editing.edits.media import Placement
from faceedit_app.editing.history import EDITS, FILM, RATE, SOUND
from faceedit_app.ui.state.document import Document


def question_about(document: Document, left_out: bool = False) -> tuple[str, str]:
    """What to ask before the open take is closed.

    Args:
        document: with a take that has changes which are not saved, or no longer.
        left_out: whether a proposal was open, which is not among them.

    Returns:
        What is not saved, and what happens to it if it is discarded.
    """
    session, project, exported = document.session, document.project, document.exported
    assert session is not None
    name, parts = session.take.path.name, session.unsaved or (EDITS,)
    if project is not None:
        more = "If you discard them, they are lost."
        message = f"Your latest changes to {name} are not saved in {project.name}."
        if not document.is_in_project:
            message = (
                f"{project.name} does not hold your work on {name} any more: another window, or "
                "another program, has changed it or taken it away."
            )
            more = "If you discard it, it is lost."
        save = "save the project"
    else:
        message, more = _in_no_project(name, parts, session.state.media or session.beside())
        save = "save them in a project"
    if parts == (RATE,) and document.is_in_project:
        message = f"The frame rate that you gave {name} is not saved in a project."
        more = "If you discard it, the take opens as before."
    if EDITS in parts and exported is not None:
        if document.export_is_current:
            more = (
                f"{exported.name} holds the edited take, but the edits themselves can only be "
                f"changed later if you {save}."
            )
        else:
            more += f" {exported.name} holds the take as you exported it, not as it is now."
    if left_out:
        more += " The proposal that you did not accept is not among them."
    return message, more


def may_be_exported(document: Document) -> bool:
    """Whether an export would hold some of what is not saved: not sound, film and words."""
    assert document.session is not None
    parts = document.session.unsaved
    return not parts or EDITS in parts or RATE in parts


def _in_no_project(name: str, parts: Sequence[str], placed: Placement) -> tuple[str, str]:
    """What to ask about a take that has no project.

    Args:
        name: of the take.
        parts: what has changed, as in `EditHistory.unsaved`.
        placed: its sound and film; of those that have changed, what is not there was removed.
    """
    gone = {part for part, file in ((SOUND, placed.sound), (FILM, placed.film)) if file is None}
    one = parts[0] if len(parts) == 1 else ""
    files = [part for part in parts if part in (SOUND, FILM) and part not in gone]
    if gone.issuperset(parts):
        message = f"You removed the {listed(parts)} of {name}; that is not saved in a project."
        return message, f"If you discard that, {'it comes' if one else 'they come'} back."
    if one in files:
        message = f"The {one} of {name} is not saved in a project."
        return message, "If you discard it, FaceEdit forgets which file it is; the file stays."
    named = listed(f"removed {part}" if part in gone else part for part in parts)
    what = "edits to" if one == EDITS else f"{named} of"
    message = f"Your {what} {name} are not saved in a project."
    if len(files) == len(parts):
        more = "If you discard them, FaceEdit forgets which files they are; the files stay."
    elif files:
        stay = "file stays" if len(files) == 1 else "files stay"
        more = f"If you discard them, they are lost; the {listed(files)} {stay}."
    else:
        more = "If you discard them, they are lost."
    return message, more
