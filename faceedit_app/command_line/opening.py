"""What commands open: a take with its edits, and a character."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from faceedit_app.core.texts import say

if TYPE_CHECKING:
    from faceedit_app.core.rig import Rig
    from faceedit_app.editing.session import EditSession


def edited_session(
    take: Path,
    fps: float | None,
    edits: Path | None,
    models: Path | None,
    character: Path | None = None,
) -> EditSession:
    """Open a take with the edits of a file; the networks are loaded only if there are any.

    Args:
        take: its file.
        fps: frames per second, if the file does not give them.
        edits: the file of its edits.
        models: the folder of the models; None = those that ship.
        character: the file of the user's character.

    Raises:
        FaceEditError: one of them cannot be read.
    """
    from faceedit_app.editing.opening import load_engine, open_session, shipped_rig

    rig = shipped_rig()
    session = open_session(take, rig, load_engine(rig, models) if edits else None, fps)
    if character is not None:
        session.use_character(rig_of(character))
    if edits is not None:
        session.load_edits(edits)
    return session


def rig_of(path: Path) -> Rig:
    """The rig of a user's character; its warnings go to standard error.

    Raises:
        FileError: it cannot be read, or is not a face.
    """
    from faceedit_app.characters.fitted import open_character

    fitted = open_character(path)
    for sentence in (*fitted.checklist.remarks, *fitted.checklist.doubts):
        say(f"{path}: {sentence}", to=sys.stderr)
    return fitted.rig
