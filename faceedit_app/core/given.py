"""Numbers and names of files as they are given in Python, checked before they are used."""

from __future__ import annotations

import math
import os
from numbers import Real
from pathlib import Path
from typing import Any

from faceedit_app.core.errors import FaceEditError


def number(name: str, value: Any) -> float:
    """A finite number.

    Args:
        name: of the argument, for the message.
        value: what was given.

    Raises:
        FaceEditError: it is none.
    """
    if not isinstance(value, Real) or not math.isfinite(value):
        raise FaceEditError(f"{name}={_shown(value)}: must be a number")
    return float(value)


def number_or_none(name: str, value: Any) -> float | None:
    """A finite number, or None for one that was not given; see `number`."""
    return None if value is None else number(name, value)


def file_name(value: Any) -> Path:
    """The path of a file.

    Raises:
        FaceEditError: it is none.
    """
    if not isinstance(value, (str, os.PathLike)) or isinstance(os.fspath(value), bytes):
        raise FaceEditError(f"{_shown(value)}: must be the name of a file")
    return Path(value)


def _shown(value: Any) -> str:
    return repr(value)[:40]
