"""The real renderer, for tests that look at pictures."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from faceedit_app.core.errors import Unavailable
from faceedit_app.core.rig import Rig
from faceedit_app.render import open_renderer
from faceedit_app.render.renderer import FaceRenderer


def opened_renderer(rig: Rig, size: int) -> Iterator[FaceRenderer]:
    """For a fixture: a renderer of square pictures, closed in the end; skips without OpenGL."""
    try:
        opened = open_renderer(rig, size, size)
    except Unavailable as error:
        pytest.skip(str(error))
    yield opened
    opened.close()
