"""Takes that are damaged, and edits that are not: what completion networks learn from.

An example is a stretch of a take with an edit in it. In some, what is under the edit is damaged:
other content, a jump of the tracker, a frozen face; the curves that are asked for are the true
ones, and the answer is the take before the damage. In the others nothing is wrong but the curve
that is asked for, and everything else has to stay.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles, Floats, Indices
from faceedit_app.core.controls import CONTROL_INDEX, control_named
from faceedit_app.core.regions import Region
from faceedit_app.core.rig import Distances
from faceedit_app.editing.solving.completing import FIRM, ask
from faceedit_app.editing.solving.expectation import Expectation
from faceedit_app.lab.training.data import Performance

# Frames of an edit and of the damage under it, and how far their ends may lie apart.
SHORTEST, LONGEST, ASIDE = 6, 40, 3
# Frames over which damage begins and ends, and an edit fades beyond its hold.
EASES = (1, 5)
FALLOFF = np.array([0.33, 0.66])
# Shares of the examples: those with nothing wrong, and, of the others, those with other content and
# those with a jump; the rest freeze.
SOUND, SWAPPED, JUMPED = 0.5, 0.75, 0.15
# How often the mouth opening alone is asked for: the usual gesture.
USUAL = 0.5
# Standard deviations of a curve by which it is dragged.
DRAGGED = 1.2
# Examples of a take: one for so many of its frames.
EVERY = 16


@dataclass(frozen=True)
class Requests:
    """N requests of W frames, time last, in standard deviations of each take's curves.

    Attributes:
        features: (N, 5 C, W) what the network sees.
        away: (N, C, W) from the residual as it is to that around.
        truth: (N, C, W) from the residual as it is to the true one.
        share: (N, 1, W) in 0..1, how far curves may change.
        other: (N, C, 1) curves that are not asked for.
    """

    features: Floats
    away: Floats
    truth: Floats
    share: Floats
    other: Floats

    def __len__(self) -> int:
        return len(self.features)

    def at(self, rows: Indices) -> Requests:
        """Some of them."""
        parts = (self.features, self.away, self.truth, self.share, self.other)
        return Requests(*(part[rows] for part in parts))


@dataclass(frozen=True)
class Curves:
    """The own curves of a region; some of them are not held.

    Attributes:
        columns: (C,) among all controls.
        mirror: (C,) the position of each curve's mirror image.
        held: (C,) those that change only if they are asked for.
        usual: the position of the one that is asked for most.
        prior: (C, C) mm², their covariance in all takes.
    """

    columns: Indices
    mirror: Indices
    held: Bools
    usual: int
    prior: Doubles

    @classmethod
    def of(cls, region: Region, takes: Sequence[Performance], distances: Distances) -> Curves:
        """Those of a region; `takes` say how they go together."""
        controls = [control_named(name) for name in region.own]
        held = np.array([control.closes is not None for control in controls], np.bool_)
        places = {name: i for i, name in enumerate(region.own)}
        mirror = [places.get(c.mirror or c.id, i) for i, c in enumerate(controls)]
        columns = np.array([CONTROL_INDEX[name] for name in region.own], np.intp)
        curves = np.concatenate([distances.measure(take.weights)[:, columns] for take in takes])
        prior = np.cov(curves.astype(np.float64).T)
        return cls(columns, np.array(mirror, np.intp), held, int(np.argmax(held)), prior)

    def expectation(self, curves: Doubles) -> Expectation:
        """What is known about the curves (T, C) mm of one take."""
        return Expectation(curves, self.prior, self.mirror, self.held)


def requests(
    takes: Sequence[Performance],
    curves: Curves,
    distances: Distances,
    window: int,
    random: np.random.Generator,
) -> Requests:
    """Examples of all takes that are long enough.

    Args:
        window: frames W of each.
    """
    made = []
    for take in takes:
        if len(take.weights) < window + SHORTEST:
            continue
        mine = distances.measure(take.weights)[:, curves.columns].astype(np.float64)
        known = curves.expectation(mine)
        for _ in range(max(1, len(mine) // EVERY)):
            first = int(random.integers(len(mine) - window + 1))
            made.append(_request(mine, first, window, known, curves, random))
    return _stacked(made)


def _request(
    curves: Doubles,
    first: int,
    window: int,
    known: Expectation,
    about: Curves,
    random: np.random.Generator,
) -> tuple[Doubles, ...]:
    true = curves[first : first + window]
    length = int(random.integers(SHORTEST, LONGEST))
    begin = int(random.integers(window - length + 1))
    there = slice(begin, begin + length)
    asked = _asked(about, random)
    given = known.given(np.zeros_like(asked[None], np.float64), asked[None])[0]
    ease = _ease(length, int(random.integers(*EASES)))
    found = true.copy()
    if random.random() < SOUND:
        drag = np.where(asked, random.normal(0.0, DRAGGED) * known.spread, 0.0)
        dragged = ease * np.where(asked, drag * random.choice([1.0, 0.3], p=[0.8, 0.2]), 0.0)
        dragged[:, ~given] = dragged[:, given] @ known.gain(given)
        found[there] += dragged
    else:
        found[there] += ease * (_damaged(curves, true[there], random) - true[there])
    hold = _hold(begin, length, window, random)[:, None] * asked
    trusted = hold.max(axis=1) < FIRM
    question = ask(known, given, found, (true - found) * hold, hold, trusted)
    lacking = (true - found) / known.spread
    gain = known.gain(given) * known.spread[given, None] / known.spread[~given]
    truth = np.zeros_like(lacking)
    truth[:, ~given] = lacking[:, ~given] - lacking[:, given] @ gain
    other = np.broadcast_to(~given, true.shape).astype(np.float64)
    return question.features, question.away, truth, question.share[:, None], other


def _asked(about: Curves, random: np.random.Generator) -> Bools:
    """(C,) the curves that an edit asks for."""
    asked = np.zeros(len(about.held), np.bool_)
    if random.random() < USUAL:
        asked[about.usual] = True
        return asked
    while not asked.any() or (random.random() < 0.25 and not asked.all()):
        one = int(random.integers(len(asked)))
        asked[[one, about.mirror[one]]] = True
    if (asked | about.held).all():  # nothing is left
        asked[:] = False
        asked[about.usual] = True
    return asked


def _damaged(curves: Doubles, true: Doubles, random: np.random.Generator) -> Doubles:
    """(n, C) what a stretch (n, C) is replaced by."""
    kind = random.random()
    if kind < SWAPPED:
        begin = int(random.integers(len(curves) - len(true) + 1))
        return curves[begin : begin + len(true)]
    if kind < SWAPPED + JUMPED:
        one, two = random.integers(len(curves), size=2)
        jumped: Doubles = true + curves[one] - curves[two]
        return jumped
    return np.broadcast_to(true[:1], true.shape)


def _ease(length: int, frames: int) -> Doubles:
    """(length, 1) in 0..1, from 0 at both ends."""
    place = np.arange(length)
    away = np.minimum(place, length - 1 - place) / frames
    ease: Doubles = 0.5 - 0.5 * np.cos(np.pi * np.clip(away, 0.0, 1.0))[:, None]
    return ease


def _hold(begin: int, length: int, window: int, random: np.random.Generator) -> Doubles:
    """(window,) in 0..1, how firmly an edit asks: it lies about where the damage is."""
    aside = random.integers(-ASIDE, ASIDE + 1, 2) * (random.random() < 0.5)
    first, last = begin + aside[0], begin + length + aside[1]
    if last - first < len(FALLOFF):
        first, last = begin, begin + length
    padded = np.zeros(window + 2 * (ASIDE + len(FALLOFF)))
    shift = ASIDE + len(FALLOFF)
    padded[first + shift : last + shift] = 1.0
    padded[first + shift - len(FALLOFF) : first + shift] = FALLOFF
    padded[last + shift : last + shift + len(FALLOFF)] = FALLOFF[::-1]
    return padded[shift : shift + window]


def _stacked(made: Sequence[tuple[Doubles, ...]]) -> Requests:
    parts = (
        np.ascontiguousarray(np.stack(part).transpose(0, 2, 1), np.float32)
        for part in zip(*made, strict=True)
    )
    return Requests(*parts)
