"""A talking clip, and retimes of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX, LIP_OPENING
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.session import EditSession
from support.sessions import demo_take

LIPS = CONTROL_INDEX[LIP_OPENING]
STRETCH = Edit(CONTROL_IDS, Op.RETIME, 2.0, 6.0, 0.0, pins=((3.0, 2.5), (4.0, 4.5)))
CUT = Edit(CONTROL_IDS, Op.RETIME, 2.9, 5.0, 0.0, pins=((3.0, 3.0), (3.5, 3.0)))
PAUSE = Edit(CONTROL_IDS, Op.RETIME, 2.9, 5.0, 0.0, pins=((3.0, 3.0), (3.0, 3.5)))
ALL = (STRETCH, CUT, PAUSE)
MADE = Edit((LIP_OPENING,), Op.SET, 3.2, 3.4, 0.1, 1.0)  # an edit that may follow them


def clip_of(rate: float = 60.0, seconds: float = 8.0) -> Clip:
    """A talking mouth and blinking eyes, with a turning head."""
    take = demo_take().clip
    times = np.arange(round(rate * seconds)) / rate
    at = np.minimum(np.round(times * take.rate).astype(int), len(take) - 1)
    assert take.rotations is not None
    rotations, weights = take.rotations[at], take.weights[at]
    return replace(take, weights=weights, times=times, rate=rate, rotations=rotations, timecodes=())


def outside_of(session: EditSession, edit: Edit) -> Bools:
    """(T,) the frames that a retime must leave."""
    times = session.take.clip.times
    outside: Bools = (times <= edit.start) | (times >= edit.end)
    return outside


def speeds(edit: Edit) -> Doubles:
    """The mean speed between pins, except for cuts and holds."""
    pinned = np.array([(edit.start, edit.start), *edit.pins, (edit.end, edit.end)])
    was, now = np.diff(pinned, axis=0).T
    rates: Doubles = was[(now > 0) & (was > 0)] / now[(now > 0) & (was > 0)]
    return rates
