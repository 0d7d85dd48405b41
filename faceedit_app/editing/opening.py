"""From files to an edit session: a take, the character and the networks, put together here only."""

from __future__ import annotations

from pathlib import Path

from faceedit_app.characters.glb import read_rig
from faceedit_app.core.resources import shipped
from faceedit_app.core.rig import Rig
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.opening import open_take
from faceedit_app.formats.take import Take
from faceedit_app.networks.engine import Engine


def shipped_rig() -> Rig:
    """The character that ships with FaceEdit.

    Raises:
        FileError: it is missing or damaged.
    """
    return read_rig(shipped("assets/character.glb"))


def load_engine(rig: Rig, models: Path | None = None) -> Engine:
    """The networks of a folder, by default of those that ship, which must be made for the rig.

    Raises:
        FileError: they are missing or damaged, or for another character.
    """
    return Engine.load(models if models is not None else shipped("models"), rig)


def open_session(
    take: Take | Path | str,
    rig: Rig | None = None,
    engine: Engine | None = None,
    fps: float | None = None,
) -> EditSession:
    """Open a take for editing.

    Args:
        take: the take, or its file.
        rig: the character; None = the one that ships.
        engine: the networks; None = edits are answered by the rig alone.
        fps: the take's frame rate, if its file does not tell it or is not believed.

    Raises:
        RateNeeded: the file does not tell its frame rate, and there is no `fps`.
        FileError: the take or the character cannot be read.
    """
    if not isinstance(take, Take):
        take = open_take(take, fps)
    return EditSession(take, rig if rig is not None else shipped_rig(), engine)
