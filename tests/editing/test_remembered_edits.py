"""What the solver remembers of edits stays small, however long a drag or a take is."""

from __future__ import annotations

import gc
import weakref
from functools import partial

import numpy as np
from support.faces import talking_clip

from faceedit_app.core.arrays import Doubles
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.settings import Settings
from faceedit_app.editing.solving.chunks import REMEMBERED, Chunks
from faceedit_app.editing.solving.fills import ROOM, Fills
from faceedit_app.editing.solving.recent import Recent

RATE, FRAMES = 25.0, 500


def test_the_edits_of_past_drags_are_forgotten() -> None:
    chunks = Chunks(talking_clip(FRAMES, RATE), FRAMES)
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


def test_results_that_take_too_much_room_are_forgotten() -> None:
    made: list[int] = []

    def result(numbers: int) -> Doubles:
        made.append(numbers)
        return np.zeros(numbers)

    recent = Recent[Doubles](most=3, room=80)
    for numbers in (4, 5, 4, 1, 4):  # of 8 bytes
        recent.to(numbers, partial(result, numbers))
    assert made == [4, 5, 1], "what fits is kept"
    assert recent.bytes == 8 * (4 + 5 + 1)
    recent.to(2, lambda: result(2))  # one too many
    assert (len(recent), recent.bytes, 5 in recent) == (3, 8 * (4 + 1 + 2), False)
    recent.to(20, lambda: result(20))  # larger than the room
    assert (len(recent), recent.bytes) == (1, 8 * 20)
    recent.to(3, lambda: result(3))
    assert (len(recent), recent.bytes) == (1, 8 * 3)


def test_past_drags_over_a_long_take_leave_little() -> None:
    clip = talking_clip(20_000)
    weights = clip.arkit_weights()
    fills = Fills(clip, weights, np.zeros(len(clip), np.float32), lambda changed: changed)
    for step in range(8):  # of 4 MB each
        reset = Edit(("mouth_opening",), Op.RESET, 1.0, 2.0 + step, 0.0)
        fills.applied([reset], slice(0, len(clip)))
    assert weights.nbytes < fills._starts.bytes <= ROOM < 8 * weights.nbytes
