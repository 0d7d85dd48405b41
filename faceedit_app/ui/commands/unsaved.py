"""What is asked about changes that no project holds: which they are, and what holds what."""

from __future__ import annotations

from faceedit_app.core.texts import listed
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
    more = "If you discard them, they are lost."
    if project is not None:
        message = f"Your latest changes to {name} are not saved in {project.name}."
        if not document.is_in_project:
            message = (
                f"{project.name} does not hold your work on {name} any more: another window, or "
                "another program, has changed it or taken it away."
            )
            more = "If you discard it, it is lost."
        save = "save the project"
    else:
        what = "edits to" if parts == (EDITS,) else f"{listed(parts)} of"
        message = f"Your {what} {name} are not saved in a project."
        if parts in ((SOUND,), (FILM,)):
            message = f"The {what} {name} is not saved in a project."
            more = "If you discard it, it is lost."
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
