"""What single gestures do: closures, smiles, wild drags and Smooth, beside what people do.

`real` is the same figure of the takes themselves.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX, mirrored_channel
from faceedit_app.core.arrays import Bools, Doubles, Floats, Indices
from faceedit_app.core.controls import (
    CONTROL_INDEX,
    LIDS,
    LIP_OPENING,
    MAIN_CONTROLS,
    MOUTH_CORNERS,
    MOUTH_WIDTH,
)
from faceedit_app.core.regions import MODELLED_CHANNELS, REGIONS
from faceedit_app.core.resample import GRID_RATE, grid_length, to_grid
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.lab.evaluation.people.opened import REAL, Opened
from faceedit_app.lab.evaluation.people.places import frames, inside, pick, random_for, runs
from faceedit_app.lab.evaluation.people.tally import Tally
from faceedit_app.lab.training.data import mirrored
from faceedit_app.networks.engine import Engine

OPENING = CONTROL_INDEX[LIP_OPENING]
CORNERS = [CONTROL_INDEX[c] for c in MOUTH_CORNERS]

# Closures.
NEAR_MM = 0.5
SHUT_MM = 2.0  # lips that come nearer than this are closing
OWN_MM = 1.15  # the closed opening of a take that never closes
ASKED_MM = 0.5
OPEN_MM = 3.0  # above its own closure: where a closure is asked for
LONGEST_CLOSURE, AROUND = 0.6, 0.2  # seconds, of real ones and of the frames around them
_FEWEST = 3  # closures that say what a take's own is

# Smiles.
SMILE_MM = 3.0
SMILING_MM = 1.0  # above the median: where a take may smile
SMILING = 0.3  # of mouthSmile
SMILE_STEMS = ("mouthSmile", "mouthStretch", "cheekSquint", "eyeSquint", "mouthDimple")

SMOOTH_SECONDS = (0.04, 0.1)
MOST = 6  # places of a take
APART = 1.8  # seconds between places: no edit reaches the next one

SIDES = [
    (ARKIT_INDEX[c], ARKIT_INDEX[mirrored_channel(c)])
    for c in ARKIT_CHANNELS
    if c.endswith("Left") and not c.startswith(("eyeLook", "jaw", "mouthLeft"))
]
"""Channels of the left side and of the right: a symmetric face has the same in both."""


@dataclass(frozen=True)
class RepeatedEdit:
    """An edit made at several places of a take.

    Attributes:
        edits: all of them.
        holds: the frames in which each acts in full.
    """

    edits: tuple[Edit, ...]
    holds: tuple[slice, ...]


Wild = tuple[tuple[tuple[str, ...], float], ...]
"""Curves, and by how many mm each group of them is dragged."""

WILD: dict[str, Wild] = {
    "torn open": (((LIP_OPENING,), 40.0),),
    "corners apart": (((MOUTH_CORNERS[0],), 15.0), ((MOUTH_CORNERS[1],), -15.0)),
    "puckered smile": (((MOUTH_WIDTH,), -25.0), (MOUTH_CORNERS, 12.0)),
    "shut and wide": (((LIP_OPENING,), -40.0), ((MOUTH_WIDTH,), 25.0), (LIDS, 15.0)),
}
"""Requests that no face can meet."""


def repeated(
    opened: Opened, where: Bools, make: Callable[[float, float], Sequence[Edit]], hold: float,
    purpose: str,
) -> RepeatedEdit:  # fmt: skip
    """The same gesture at up to `MOST` places.

    Args:
        where: (T,) bool: frames at which it may begin.
        make: the edits from a first to a last second.
        hold: seconds.
        purpose: names the random places.
    """
    times = opened.times
    room = inside(times, 0.6 + hold)
    starts = pick(random_for(opened.take, purpose), times, where & room, APART, MOST)
    edits = tuple(edit for start in starts for edit in make(start, start + hold))
    return RepeatedEdit(edits, tuple(frames(times, start, start + hold) for start in starts))


def own_closure(opening: Floats) -> float:
    """How near a take's lips come when they close, mm: the median over its closures."""
    lowest = [float(opening[rows].min()) for rows in runs(opening < SHUT_MM)]
    return float(np.median(lowest)) if len(lowest) >= _FEWEST else OWN_MM


def closed(opening: Floats, own: float) -> Bools:
    """(T,) whether the lips are closed, as near as the take closes them."""
    result: Bools = opening < own + NEAR_MM
    return result


def _closure(start: float, end: float) -> list[Edit]:
    return [Edit((LIP_OPENING,), Op.SET, start, end, 0.15, ASKED_MM)]


def _smile(start: float, end: float) -> list[Edit]:
    return [Edit(MOUTH_CORNERS, Op.OFFSET, start, end, 0.3, SMILE_MM)]


def _blink(start: float, end: float) -> list[Edit]:
    return [Edit(LIDS, Op.SET, start, end, 0.15, ASKED_MM)]


def measure_closures(opened: Opened, source: str, tally: Tally) -> None:
    """Closures asked for where the mouth is open: reached or not, and with which channels.

    `closures.met` is 1 for each one whose mean opening in the hold is at most `NEAR_MM` above the
    take's own closure. `closures.frown` is what it adds to mouthFrown in the hold, because some
    people frown all the time; `closures.mouth_close` is the weight there. `real`: the take's own
    short closures, and what they add to the open frames around them.
    """
    opening = opened.tracked[:, OPENING]
    own = own_closure(opening)
    frown, close = _both("mouthFrown"), ARKIT_INDEX["mouthClose"]
    for rows, around in short_closures(closed(opening, own), opened.take.clip.rate):
        added = opened.weights[rows][:, frown].mean() - opened.weights[around][:, frown].mean()
        tally.add("closures.frown", REAL, source, float(added))
        tally.add("closures.mouth_close", REAL, source, float(opened.weights[rows, close].mean()))
    asked = repeated(opened, opening > own + OPEN_MM, _closure, 0.2, "closure")
    for system in opened.editors if asked.holds else ():
        weights = opened.edited(system, asked.edits)
        change = weights - opened.edited(system, ())
        reached = opened.controls(weights)[:, OPENING]
        for rows in asked.holds:
            met = float(reached[rows].mean()) <= own + NEAR_MM
            tally.add("closures.met", system, source, float(met))
            tally.add("closures.frown", system, source, float(change[rows][:, frown].mean()))
            tally.add("closures.mouth_close", system, source, float(weights[rows, close].mean()))


def short_closures(shut: Bools, rate: float) -> list[tuple[slice, Indices]]:
    """The closures of speech: their frames, and the open frames around them.

    Args:
        shut: (T,) where the lips are closed.
        rate: frames per second.
    """
    near = round(AROUND * rate)
    out = []
    for rows in runs(shut):
        if rows.stop - rows.start > LONGEST_CLOSURE * rate:
            continue
        first, last = max(rows.start - near, 0), min(rows.stop + near, len(shut))
        around = np.arange(first, last)[~shut[first:last]]
        if len(around) >= near:
            out.append((rows, around))
    return out


def measure_smiles(
    opened: Opened, source: str, captures: Callable[..., bool], tally: Tally
) -> None:
    """What `SMILE_MM` of both corners add to the channels of a smile.

    Only channels that the source captures are counted. `real`: how much more of a channel the
    take has where it smiles, for as many mm.
    """
    corners = opened.tracked[:, CORNERS].mean(axis=1)
    rest = float(np.median(corners))
    smiling = smiles(opened.weights, opened.tracked)
    stems = [stem for stem in SMILE_STEMS if captures(f"{stem}Left", f"{stem}Right")]
    if smiling.sum() >= 10:
        by = SMILE_MM / (float(corners[smiling].mean()) - rest)
        for stem in stems:
            channel = opened.weights[:, _both(stem)].mean(axis=1)
            added = by * (float(channel[smiling].mean()) - float(np.median(channel)))
            tally.add(f"smile.{stem}", REAL, source, added)
    asked = repeated(opened, np.abs(corners - rest) < 1.0, _smile, 0.5, "smile")
    if not asked.holds:
        return
    for system in opened.editors:
        change = opened.edited(system, asked.edits) - opened.edited(system, ())
        for stem in stems:
            added_here = [float(change[rows][:, _both(stem)].mean()) for rows in asked.holds]
            tally.add(f"smile.{stem}", system, source, added_here)


def smiles(weights: Floats, controls: Floats) -> Bools:
    """(T,) clear smiles: of the corners, more than a stretch, without the jaw.

    Args:
        weights: (T, 52).
        controls: (T, C) mm.
    """
    smile, stretch = (
        weights[:, _both(f"mouth{name}")].mean(axis=1) for name in ("Smile", "Stretch")
    )
    corners, opening = controls[:, CORNERS].mean(axis=1), controls[:, OPENING]
    result: Bools = (
        (smile > SMILING)
        & (smile > 1.5 * stretch)
        & (corners > np.median(corners) + SMILING_MM)
        & (opening < np.median(opening) + OPEN_MM)
    )
    return result


def measure_asymmetry(opened: Opened, symmetric: Opened, source: str, tally: Tally) -> None:
    """The largest difference of left and right that a symmetric request makes.

    Args:
        opened: the take; `real` is the difference in its own closures and smiles.
        symmetric: the take with both sides alike, in which a difference can only be made up.
    """
    opening = opened.tracked[:, OPENING]
    smiling = smiles(opened.weights, opened.tracked)
    for where in (closed(opening, own_closure(opening)), smiling):
        if where.any():
            tally.add("asymmetry", REAL, source, _apart(opened.weights[where]))
    everywhere = np.ones(len(opened.times), bool)
    for make, hold, name in (
        (_closure, 0.2, "closure"),
        (_smile, 0.5, "smile"),
        (_blink, 0.1, "blink"),
    ):
        asked = repeated(symmetric, everywhere, make, hold, f"symmetric {name}")
        if not asked.holds:
            continue
        for system in symmetric.editors:
            weights = symmetric.edited(system, asked.edits)
            tally.add("asymmetry", system, source, [_apart(weights[rows]) for rows in asked.holds])


def symmetric_weights(weights: Floats) -> Floats:
    """(T, 52): the mean of a face and its mirror image."""
    result: Floats = (0.5 * (weights + mirrored(weights))).astype(np.float32)
    return result


def _apart(weights: Floats) -> float:
    """Frames (T, 52) -> the largest channel's mean difference of left and right."""
    left, right = (list(side) for side in zip(*SIDES, strict=True))
    return float(np.abs(weights[:, left] - weights[:, right]).mean(axis=0).max())


def measure_smooth(opened: Opened, source: str, tally: Tally) -> None:
    """The largest rise of a channel's rms second difference when all curves are smoothed."""
    for seconds in SMOOTH_SECONDS:
        everything = Edit(MAIN_CONTROLS, Op.SMOOTH, 0.0, opened.take.clip.duration, 0.0, seconds)
        for system in opened.editors:
            before = _roughness(opened.weights)
            after = _roughness(opened.edited(system, [everything]))
            tally.add("smooth_roughness", system, source, float((after - before).max()))


def _roughness(weights: Floats) -> Doubles:
    """(K,) rms second difference of the modelled channels."""
    columns = [ARKIT_INDEX[c] for c in MODELLED_CHANNELS]
    rough: Doubles = np.sqrt((np.diff(weights[:, columns].astype(np.float64), 2, 0) ** 2).mean(0))
    return rough


def measure_wild(opened: Opened, engine: Engine, source: str, tally: Tally) -> None:
    """How far from natural motion wild requests lead, through the session as in the window.

    1 is the 99.9th percentile of recorded takes; the largest over regions and frames of each
    request. `real`: the 99.9th percentile of the take's own frames.
    """
    if all(model.description.natural is None for model in engine.models.values()):
        return
    own = np.percentile(_distance(opened, opened.weights, engine), 99.9)
    tally.add("wild.distance", REAL, source, float(own))
    everywhere = np.ones(len(opened.times), bool)
    for name, curves in WILD.items():
        asked = repeated(opened, everywhere, partial(_drags, curves), 0.3, f"wild {name}")
        for system in opened.editors:
            far = _distance(opened, opened.edited(system, asked.edits), engine)
            for rows in asked.holds:
                first, last = GRID_RATE * opened.times[[rows.start, rows.stop - 1]]
                largest = far[int(first) : int(last) + 2].max()
                tally.add("wild.distance", system, source, float(largest))


def _drags(curves: Wild, start: float, end: float) -> list[Edit]:
    return [Edit(controls, Op.OFFSET, start, end, 0.1, mm) for controls, mm in curves]


def _distance(opened: Opened, weights: Floats, engine: Engine) -> Doubles:
    """(N,) the distance from natural motion on the grid, the largest over the regions."""
    times = opened.times
    grid = to_grid(times, weights, 0, grid_length(times)).astype(np.float64)
    far = []
    for region in REGIONS:
        natural = engine.models[region.id].description.natural
        if natural is not None:
            columns = [ARKIT_INDEX[c] for c in region.channels]
            far.append(natural.distance(grid[:, columns]) / natural.limit)
    most: Doubles = np.max(far, axis=0)
    return most


def _both(stem: str) -> list[int]:
    return [ARKIT_INDEX[f"{stem}{side}"] for side in ("Left", "Right")]
