"""Marks tests that need the tracker's networks, which `make` fetches."""

from __future__ import annotations

from importlib.util import find_spec

import pytest

from faceedit_app.core.errors import FileError
from faceedit_app.core.resources import shipped
from faceedit_app.tracking.landmarker import TASK


def _lack() -> str:
    """What is missing; empty if nothing is."""
    if find_spec("ai_edge_litert") is None:
        return "LiteRT has no build for this system"
    try:
        shipped(TASK)
    except FileError as error:
        return str(error)
    return ""


needs_tracker = pytest.mark.skipif(bool(_lack()), reason=_lack() or "nothing is missing")
