"""What the solver remembers of edits stays small, however many steps a drag has."""

from __future__ import annotations

import gc
import weakref

import numpy as np

from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.settings import Settings
from faceedit_app.editing.solving.chunks import REMEMBERED, Chunks

RATE, FRAMES = 25.0, 500


def test_the_edits_of_past_drags_are_forgotten() -> None:
    chunks = Chunks(np.arange(FRAMES) / RATE, RATE, FRAMES)
    kept = Edit(("mouth_opening",), Op.OFFSET, 1.0, 2.0, 0.2, 3.0)
    past: list[weakref.ref[Edit]] = []
    expected = chunks.tasks([kept], Settings(), {})
    for step in range(3 * REMEMBERED):
        dragged = Edit(("mouth_opening",), Op.OFFSET, 10.0, 11.0, 0.2, 0.01 * step)
        past.append(weakref.ref(dragged))
        chunks.tasks([kept, dragged], Settings(), {})
    del dragged
    gc.collect()  # an edit may be its own effect
    assert sum(edit() is not None for edit in past) <= REMEMBERED + 2
    assert chunks.tasks([kept], Settings(), {}) == expected
