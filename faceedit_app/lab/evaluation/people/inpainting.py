"""In-painting: stretches of a take are lost, and filled from what is around them.

No answer is right: a face may have done many things there. Therefore three figures: how it joins,
how far it is from what the face did, and how much it moves. The mean of all motion is near
everything and moves like nothing.
"""

from __future__ import annotations

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Bools, Doubles, Floats
from faceedit_app.core.controls import MAIN_CONTROLS
from faceedit_app.core.regions import REGIONS
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.opening import open_session
from faceedit_app.formats.take import Take
from faceedit_app.lab.evaluation.people.opened import FACEEDIT, REAL, SPLICE
from faceedit_app.lab.evaluation.people.places import frames, inside, pick, random_for
from faceedit_app.lab.evaluation.people.sources import TakeSource, with_weights
from faceedit_app.lab.evaluation.people.tally import Tally

SECONDS = (0.5, 1.0, 2.0)  # of the stretches that are lost
SHARE = 5.0  # a take is at least so many times as long
MARGIN = 0.4  # seconds between a stretch and an end of the take
APART = 4.0  # seconds between two of them
MOST = 8  # of a take
LINEAR, HOLD, NEAREST = "linear", "hold", "nearest"
JUMP, RESTORATION, MOVEMENT = (
    f"inpainting.{name}" for name in ("boundary_jump", "restoration", "movement")
)


def measure_inpainting(source: TakeSource, rig: Rig, tally: Tally) -> None:
    """Add the figures of each stretch of each take to a tally."""
    channels = [c for region in REGIONS for c in region.channels if source.captures(c)]
    columns = [ARKIT_INDEX[c] for c in channels]
    if not columns:
        return
    for take in source.takes:
        weights = take.clip.arkit_weights()
        stretches = lost_stretches(take)
        for system, answer in _answers(take, rig, stretches, columns).items():
            curves = rig.arkit_distances.measure(answer).astype(np.float64)
            for rows in stretches:
                tally.add(JUMP, system, source.name, jump(curves, rows))
                tally.add(MOVEMENT, system, source.name, movement(answer, rows, columns))
                if system != REAL:
                    away = (answer - weights)[rows][:, columns].astype(np.float64)
                    tally.add(RESTORATION, system, source.name, float((away**2).mean()))


def lost_stretches(take: Take) -> list[slice]:
    """The stretches of a take that are lost, of different lengths, in order of time."""
    times, random = take.clip.times, random_for(take, "in-painting")
    fits = [seconds for seconds in SECONDS if SHARE * seconds < times[-1]] or SECONDS[:1]
    starts = pick(random, times, inside(times, max(fits) + MARGIN), APART, MOST)
    lengths = [fits[int(i)] for i in random.integers(0, len(fits), len(starts))]
    return [
        frames(times, start, start + length) for start, length in zip(starts, lengths, strict=True)
    ]


def _answers(take: Take, rig: Rig, stretches: list[slice], columns: list[int]) -> dict[str, Floats]:
    """(T, 52) by system: the take with the lost stretches filled."""
    weights, times = take.clip.arkit_weights(), take.clip.times
    out = {name: weights.copy() for name in (FACEEDIT, LINEAR, HOLD, NEAREST, SPLICE, REAL)}
    random = random_for(take, "in-painting, splice")
    usable = _usable(len(weights), stretches)
    for rows in stretches:
        first, last = weights[rows.start - 1], weights[rows.stop]
        span = times[rows.start - 1 : rows.stop + 1]
        share = ((span - span[0]) / (span[-1] - span[0]))[1:-1, None]
        out[LINEAR][rows] = first + share * (last - first)
        out[HOLD][rows] = first
        length = rows.stop - rows.start
        starts = _starts(usable, length)
        if not len(starts):  # too short a take for a stretch like this
            starts = np.array([rows.start])
        errors = [
            float(np.square((weights[i : i + length] - weights[rows])[:, columns]).mean())
            for i in starts.tolist()
        ]
        nearest, other = int(starts[int(np.argmin(errors))]), int(random.choice(starts))
        out[NEAREST][rows] = weights[nearest : nearest + length]
        out[SPLICE][rows] = weights[other : other + length]
    out[FACEEDIT] = _filled(with_weights(take, out[HOLD]), rig, stretches)
    return out


def _filled(take: Take, rig: Rig, stretches: list[slice]) -> Floats:
    """(T, 52): Fill on a take that is still where its face was lost, through the session."""
    session, times = open_session(take, rig), take.clip.times
    session.put(
        [
            Edit(MAIN_CONTROLS, Op.FILL, float(times[rows.start]), float(times[rows.stop - 1]), 0.0)
            for rows in stretches
        ]
    )
    session.live.work()
    return session.weights.copy()


def _usable(count: int, stretches: list[slice]) -> Bools:
    """(T,) the frames that are not lost."""
    usable = np.ones(count, np.bool_)
    for rows in stretches:
        usable[rows] = False
    return usable


def _starts(usable: Bools, length: int) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """The first frames of all unbroken stretches of a length."""
    lost = np.concatenate([[0], np.cumsum(~usable)])
    return np.flatnonzero(lost[length:] == lost[:-length])


def jump(curves: Doubles, rows: slice) -> float:
    """mm: the change of velocity at both ends of a stretch, of the curve with the largest."""
    ends = [rows.start - 1, rows.start, rows.stop - 1, rows.stop]
    second = [curves[i + 1] - 2 * curves[i] + curves[i - 1] for i in ends]
    return float(np.abs(second).max(axis=1).mean())


def movement(weights: Floats, rows: slice, columns: list[int]) -> float:
    """The mean change of a weight between two frames of a stretch."""
    moves = np.diff(weights[rows][:, columns].astype(np.float64), axis=0)
    return float(np.abs(moves).mean()) if len(moves) else 0.0
