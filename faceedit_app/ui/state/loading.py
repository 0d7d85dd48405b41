"""What is loaded in a thread while the window is already up: a take, the character, the networks.

The imports stand inside the functions because importing is what takes long.
"""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from faceedit_app.core.rig import Rig
    from faceedit_app.editing.session import EditSession
    from faceedit_app.networks.engine import Engine


def load_character() -> Rig:
    """The shipped character.

    Raises:
        FileError: it is missing or damaged.
    """
    from faceedit_app.editing import opening

    return opening.shipped_rig()


def open_session(path: Path, rig: Rig, fps: float | None = None) -> EditSession:
    """Read a take, to be edited without networks until they are loaded.

    Args:
        fps: its frame rate, if its file does not tell it or is not believed.

    Raises:
        RateNeeded: its file does not tell its frame rate, and there is no `fps`.
        FileError: it is no take, or a damaged one.
    """
    from faceedit_app.editing import opening

    return opening.open_session(path, rig, fps=fps)


def prepare_renderer() -> None:
    """Import what drawing needs, so that the first picture does not stop the window for long."""
    from faceedit_app.render import contexts

    try:
        backend = contexts.choose_backend()  # before OpenGL is imported
        importlib.import_module("faceedit_app.render.studio")
        contexts.platform_class(backend)
    except Exception:  # drivers and PyOpenGL raise all kinds
        return  # opening the renderer meets it again, and says so where it can be shown


def load_engine(rig: Rig) -> Engine:
    """The shipped networks.

    Raises:
        FileError: they are missing or damaged, or for another character.
    """
    from faceedit_app.editing import opening

    return opening.load_engine(rig)
