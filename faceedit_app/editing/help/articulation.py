"""Say it clearly: more or less articulation of a stretch of speech, with its closures kept.

Each phoneme moves on the line between a mouth at rest and what the face does there: a wide vowel
opens wider, a rounded one rounds more, and lips that touch for an m, b or p, or touch the teeth
for an f, still touch.
"""

from __future__ import annotations

import numpy as np

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.controls import (
    CONTROL_INDEX,
    CONTROLS,
    LIP_OPENING,
    MOUTH_CORNERS,
    control_named,
)
from faceedit_app.editing.edits.edit import Edit, Op, fade
from faceedit_app.editing.help.spoken import LipGap, dip_at
from faceedit_app.editing.session import EditSession
from faceedit_app.editing.solving.filled_frames import AllFrames
from faceedit_app.words.speech_sounds import Lips, lips_of
from faceedit_app.words.transcript import Transcript

MOST = 0.6  # of the movement, added or taken away at the ends of the slider
_FALLOFF = 0.1  # seconds at the ends of the stretch
_HELD = 0.04  # seconds on either side of a closure that stay as they are
_KEPT = 0.06  # seconds beside that over which the change fades in
_NEGLIGIBLE = 0.05  # mm; curves that would move less are left alone
# The corners follow the width; the mouth smiles no more for being clear.
_MOVED = tuple(
    c.id
    for c in CONTROLS
    if c.region == control_named(LIP_OPENING).region and c.id not in MOUTH_CORNERS
)


def articulate(
    session: EditSession, words: Transcript, span: tuple[float, float], amount: float
) -> tuple[Edit, ...]:
    """Edits for more (`amount` up to 1) or less (down to -1) articulation; the session stays.

    Args:
        words: in seconds of the take.
        span: first and last second.
    """
    frames = session.all_frames()
    times = frames.times
    where = np.flatnonzero((times >= span[0]) & (times <= span[1]))
    if not len(where) or not amount:
        return ()
    free = 1.0 - _touching(words, frames, session)[where]
    made = []
    for control in _MOVED:
        if control in session.lacks:
            continue
        curve = frames.achieved[:, CONTROL_INDEX[control]].astype(np.float64)
        is_opening = control == LIP_OPENING
        rest = LipGap.of(session.rig).touching if is_opening else float(np.median(curve))
        # Where lips meet, the other curves stay too: lips that rise and drop would part them.
        change = MOST * amount * (curve[where] - rest) * free
        if np.abs(change).max() < _NEGLIGIBLE:
            continue
        points = tuple(
            (round(float(t), 4), round(float(mm), 3))
            for t, mm in zip(times[where], change, strict=True)
        )
        name = "Say it clearly" if amount > 0 else "Mumble"
        edges = (points[0][0], points[-1][0])
        made.append(Edit((control,), Op.ADD, *edges, _FALLOFF, name=name, points=points))
    return tuple(made)


def _touching(words: Transcript, frames: AllFrames, session: EditSession) -> Doubles:
    """(N,) 1 where lips touch each other or the teeth for a phoneme, fading to 0."""
    curves: dict[Lips | None, Doubles] = {
        Lips.CLOSE: LipGap.of(session.rig).measure(frames.weights),  # as closures are found
        Lips.TEETH: frames.achieved[:, CONTROL_INDEX[LIP_OPENING]].astype(np.float64),
    }
    times = frames.times
    touching = np.zeros(len(times))
    for _, phoneme in words.phonemes():
        curve = curves.get(lips_of(phoneme.symbol))
        frame = dip_at(times, curve, phoneme) if curve is not None else None
        if frame is not None:
            np.maximum(touching, fade(np.abs(times - times[frame]) - _HELD, _KEPT), touching)
    return touching
