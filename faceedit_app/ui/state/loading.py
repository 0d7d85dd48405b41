"""Loading in the background while the window is open: a take, the character, the model.

The functions import what they need themselves, because importing is what takes long.
"""

from __future__ import annotations

import importlib
import threading
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from faceedit_app.characters.fitted import FittedCharacter
    from faceedit_app.core.rig import Rig
    from faceedit_app.editing.session import EditSession
    from faceedit_app.networks.engine import Engine
    from faceedit_app.render import FaceRenderer

_reading = threading.Lock()


def load_character() -> Rig:
    """The shipped character, read once.

    Raises:
        FileError: it is missing or damaged.
    """
    with _reading:
        return _shipped()


@cache
def _shipped() -> Rig:
    from faceedit_app.editing import opening

    return opening.shipped_rig()


def load_own_character(path: Path) -> FittedCharacter:
    """A character of the user's, with the map beside it.

    Raises:
        FileError: it cannot be read, or is not a face.
    """
    from faceedit_app.characters.fitted import open_character

    return open_character(path)


def open_session(path: Path, rig: Rig, fps: float | None = None) -> EditSession:
    """Read a take; it is edited without the model until that is loaded.

    Args:
        fps: its frame rate, if its file gives none or a wrong one.

    Raises:
        RateNeeded: its file does not give its frame rate, and `fps` is None.
        FileError: it is not a take, or damaged.
    """
    from faceedit_app.editing import opening

    return opening.open_session(path, rig, fps=fps)


def prepare_renderer() -> FaceRenderer | None:
    """Open a renderer for the shipped character.

    Returns:
        The renderer, or None if the window has to open it, or to say why it cannot: what drawing
        needs is imported all the same, so that it does not block the window.
    """
    from faceedit_app.render import contexts, open_ahead

    try:
        backend = contexts.choose_backend()  # before OpenGL is imported
        importlib.import_module("faceedit_app.render.studio")
        contexts.platform_class(backend)
        return open_ahead(load_character())
    except Exception:  # drivers and PyOpenGL raise all kinds
        return None  # opening it again raises it where it can be shown


def load_engine(rig: Rig) -> Engine:
    """The shipped model.

    Raises:
        FileError: it is missing, damaged, or for another character.
    """
    from faceedit_app.editing import opening

    return opening.load_engine(rig)
