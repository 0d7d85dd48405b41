"""The files that ship with FaceEdit: next to the code in a wheel, else in the checkout."""

from __future__ import annotations

import os
from pathlib import Path

from faceedit_app.core import on_disk
from faceedit_app.core.errors import FileError

DEMO_TAKE = "assets/demo_take.csv"
# The character that edits are made on, and where the tracker's landmarks are on it.
CHARACTER = "assets/character.glb"
LANDMARKS_OF_CHARACTER = "assets/character.landmarks.json"
_PACKAGE = Path(__file__).resolve().parent.parent


def shipped(name: str) -> Path:
    """The path of a shipped file or folder, such as `CHARACTER` or `models`.

    Raises:
        FileError: it is missing from this installation.
    """
    for root in (_PACKAGE / "shipped", _PACKAGE.parent):
        if on_disk.exists(root / name):
            return root / name
    raise FileError(_PACKAGE.parent / name, "missing from this installation", "reinstall FaceEdit")


def is_demo_take(path: Path) -> bool:
    """Whether a file is the demo take; its folder belongs to the installation."""
    try:
        # Path.resolve() raises if links go round in a circle.
        return os.path.realpath(path) == os.path.realpath(shipped(DEMO_TAKE))
    except FileError:
        return False
