"""Restoration: a take is damaged for 0.8 s, its true curves are drawn, and the error is measured.

The one benchmark of edits in which the right answer is known.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Doubles, Floats, Times
from faceedit_app.core.controls import CONTROL_INDEX, LIDS, LIP_OPENING
from faceedit_app.core.regions import EYELIDS, LOWER, Region
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.lab.evaluation.people.opened import DAMAGED, Opened
from faceedit_app.lab.evaluation.people.places import frames, inside, pick, random_for
from faceedit_app.lab.evaluation.people.references import References, columns_of
from faceedit_app.lab.evaluation.people.sources import TakeSource, with_weights
from faceedit_app.lab.evaluation.people.tally import Tally
from faceedit_app.lab.evaluation.systems import Systems

SECONDS = 0.8
EASE = 0.12  # seconds over which the damage begins and ends
APART = 2.0  # seconds between damaged stretches: no edit reaches the next one
MOST = 8  # stretches of a take
FALLOFF = 0.1  # seconds of the drawn edit; there the take is undamaged


@dataclass(frozen=True)
class Damage:
    """A way to damage a take, and what is drawn to restore it.

    Attributes:
        figure: name of the figure.
        region: where the error is measured.
        controls: the curves that are drawn.
        halves: halve the distance from the take's median, instead of swapping content.
    """

    figure: str
    region: Region
    controls: tuple[str, ...]
    halves: bool = False


DAMAGES = (
    Damage("restoration.six", LOWER, LOWER.own),
    Damage("restoration.opening", LOWER, (LIP_OPENING,)),
    Damage("restoration.half", LOWER, LOWER.own, halves=True),
    Damage("restoration.lids", EYELIDS, LIDS),
)


def measure_restoration(
    source: TakeSource, rig: Rig, systems: Systems, learned: References, tally: Tally
) -> None:
    """Add the mean squared error of each stretch, over the region's channels, to a tally.

    `damaged` is the error of the damaged take itself, as if nothing were done.
    """
    for damage in DAMAGES:
        if not any(source.captures(c) for c in damage.region.channels):
            continue
        for take in source.takes:
            weights, times = take.clip.arkit_weights(), take.clip.times
            controls = rig.arkit_distances.measure(weights)
            # One name for the swaps of the mouth: all curves and one curve restore the same.
            random = random_for(take, f"{damage.region.id} {damage.halves}")
            starts = pick(random, times, inside(times, SECONDS + 0.3), APART, MOST)
            stretches = [frames(times, start, start + SECONDS) for start in starts]
            damaged = weights.copy()
            for rows in stretches:
                damaged[rows] = (
                    halved(weights, rows, times)
                    if damage.halves
                    else swapped(weights, rows, times, random)
                )
            edits = restoring(times, controls, stretches, damage.controls)
            opened = Opened(with_weights(take, damaged), rig, systems, learned)
            channels = columns_of(damage.region)

            def error(
                answer: Floats,
                truth: Floats = weights,
                stretches: Sequence[slice] = stretches,
                channels: Sequence[int] = channels,
            ) -> list[float]:
                away = (answer - truth).astype(np.float64)[:, channels]
                return [float((away[rows] ** 2).mean()) for rows in stretches]

            tally.add(damage.figure, DAMAGED, source.name, error(damaged))
            for system in opened.editors:
                answer = opened.edited(system, edits)
                tally.add(damage.figure, system, source.name, error(answer))


def restoring(
    times: Times, controls: Floats, stretches: Sequence[slice], which: Sequence[str]
) -> list[Edit]:
    """Draw curves (T, C) mm as they are in some stretches."""
    out = []
    for rows in stretches:
        start, end = float(times[rows.start]), float(times[rows.stop - 1])
        around = frames(times, start - 2 * FALLOFF, end + 2 * FALLOFF)
        for control in which:
            curve = controls[around, CONTROL_INDEX[control]].tolist()
            points = tuple(zip(times[around].tolist(), curve, strict=True))
            out.append(Edit((control,), Op.DRAW, start, end, FALLOFF, points=points))
    return out


def eased(times: Times, rows: slice) -> Doubles:
    """(N, 1): how much of the damage applies in a stretch, 0..1; it eases in and out."""
    mine = times[rows]
    away = np.minimum(mine - mine[0], mine[-1] - mine) / EASE
    ease: Doubles = 0.5 - 0.5 * np.cos(np.pi * np.clip(away, 0.0, 1.0)[:, None])
    return ease


def halved(weights: Floats, rows: slice, times: Times) -> Floats:
    """(N, 52): a stretch at half its distance from the take's median."""
    half = 0.5 * (np.median(weights, axis=0) - weights[rows])
    result: Floats = (weights[rows] + eased(times, rows) * half).astype(np.float32)
    return result


def swapped(weights: Floats, rows: slice, times: Times, random: np.random.Generator) -> Floats:
    """(N, 52): a stretch with the content of another stretch of the same take."""
    length = rows.stop - rows.start
    others = [
        begin
        for begin in range(len(weights) - length + 1)
        if begin + length <= rows.start or begin >= rows.stop
    ]
    begin = int(random.choice(others)) if others else rows.start
    ease = eased(times, rows)
    mixed = ease * weights[begin : begin + length] + (1 - ease) * weights[rows]
    result: Floats = mixed.astype(np.float32)
    return result
