"""Offers to recover what a crash left behind, when the window opens."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.commands.workspace import Workspace


def offer_recovery(
    workspace: Workspace, instead_of: Path | None = None, keeps_character: bool = False
) -> bool:
    """Ask about the newest session that ended in a crash; True if it is being opened.

    Args:
        instead_of: the file that is opened otherwise.
        keeps_character: as for `projects.open_project`.
    """
    # They import the solver; the window appears first.
    from faceedit_app.editing.files.pending import pending_journals
    from faceedit_app.ui.commands import projects

    def ask(message: str, likely: Sequence[Path]) -> Path | None:
        folder = pending[0].take.parent
        return dialogs.ask_take_of_project(workspace.window, message, likely, folder)

    pending = pending_journals()
    if pending:
        match dialogs.ask_recover(workspace.window, pending[0]):
            case dialogs.Recover.RECOVER:
                projects.recover(workspace, pending[0], ask, instead_of, keeps_character)
                return True
            case dialogs.Recover.DISCARD:
                pending[0].discard()
    return False
