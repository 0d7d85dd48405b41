"""Open a session: read the take, the character and the model, and put them together."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from faceedit_app.characters.glb import read_rig
from faceedit_app.core.resources import shipped
from faceedit_app.core.rig import Rig
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.opening import open_take
from faceedit_app.formats.take import Take

if TYPE_CHECKING:
    from faceedit_app.networks.engine import Engine


def shipped_rig() -> Rig:
    """Read the character that ships with FaceEdit.

    Raises:
        FileError: it is missing or damaged.
    """
    return read_rig(shipped("assets/character.glb"))


def load_engine(rig: Rig, models: Path | None = None) -> Engine:
    """Load a model for a rig.

    Args:
        rig: the character; the model must be made for it.
        models: the folder of the model; None = the one that ships.

    Raises:
        FileError: the model is missing or damaged, or made for another character.
    """
    from faceedit_app.networks.engine import Engine  # ONNX Runtime; the take does not wait for it

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
        engine: answers edits; None = the rig alone answers them.
        fps: frames per second, if the file does not give them or is wrong.

    Raises:
        RateNeeded: the file does not give its frame rate, and `fps` is None.
        FileError: the take or the character cannot be read.
    """
    if not isinstance(take, Take):
        take = open_take(take, fps)
    return EditSession(take, rig if rig is not None else shipped_rig(), engine)
