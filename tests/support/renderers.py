"""The real renderer, for tests that look at pictures."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

import pytest

from faceedit_app.core.rig import Rig
from faceedit_app.render import contexts, open_renderer
from faceedit_app.render.renderer import FaceRenderer


def need_opengl() -> None:
    """Skip the test on a computer without OpenGL; where there is one, a face must be drawn."""
    if missing := _missing():
        pytest.skip(missing)


@lru_cache
def _missing() -> str:
    """Why this computer opens no OpenGL context; "" if it does."""
    try:
        contexts.open_platform(contexts.choose_backend(), 8, 8).delete_context()
    except Exception as error:  # drivers and PyOpenGL raise all kinds
        return f"no OpenGL: {error}"
    return ""


def opened_renderer(rig: Rig, size: int) -> Iterator[FaceRenderer]:
    """For a fixture: a renderer of square pictures, closed in the end; skips without OpenGL."""
    need_opengl()
    opened = open_renderer(rig, size, size)
    yield opened
    opened.close()
