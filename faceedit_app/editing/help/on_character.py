"""Find where the user's character leaves open what FaceEdit's own closes, and propose to close it.

The proposed edits ask for nothing: they scale curves by 1. What an edit reaches is closed on the
user's character (`solving/closing.py`), so they close lips and lids and leave our curves as they are.
"""

from __future__ import annotations

import numpy as np

from faceedit_app.characters.closure import ARE_LIPS, CLOSING, SHUT, Gaps
from faceedit_app.core.arrays import Bools, Doubles
from faceedit_app.core.clip import Clip
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.help.problems import TOGETHER, Kind, Problem, runs
from faceedit_app.editing.session import EditSession

_FALLOFF = 0.1  # seconds
_SHORTEST = 0.05  # seconds; shorter gaps are not noticed
NAME = "Close on the character"


def character_problems(session: EditSession) -> list[Problem]:
    """The problems on the user's character, in order of time; none if ours is shown."""
    if session.shown_rig is session.rig:
        return []
    weights = session.weights
    ours = Gaps.of(session.rig).measure(weights)
    theirs = Gaps.of(session.shown_rig).measure(weights)
    are_open = (ours < SHUT) & (theirs > SHUT)
    clip = session.take.clip
    lips = _problems(clip, are_open, theirs, ARE_LIPS, Kind.LIPS, "lips")
    lids = _problems(clip, are_open, theirs, ~ARE_LIPS, Kind.BLINK, "lids")
    return sorted([*lips, *lids], key=lambda problem: problem.start)


def close_everywhere(start: float, end: float) -> Edit:
    """The edit that closes lips and lids on the character from `start` to `end` seconds."""
    return Edit(CLOSING, Op.SCALE, start, end, 0.0, 1.0, name=NAME)


def _problems(
    clip: Clip, are_open: Bools, gaps: Doubles, columns: Bools, kind: Kind, what: str
) -> list[Problem]:
    found = []
    mine = are_open & columns
    for first, last in runs(mine.any(axis=1), round(TOGETHER * clip.rate)):
        start, end = (round(float(clip.times[frame]), 4) for frame in (first, last))
        if end - start < _SHORTEST:
            continue
        here = np.where(mine[first : last + 1], gaps[first : last + 1], 0.0)
        ids = tuple(CLOSING[i] for i in np.flatnonzero(mine[first : last + 1].any(axis=0)))
        message = f"On your character the {what} stay {here.max():.1f} mm apart"
        fix = Edit(ids, Op.SCALE, start, end, _FALLOFF, 1.0, name=NAME)
        found.append(Problem(kind, start, end, ids, message, (fix,)))
    return found
