"""What curves that were not asked for do where the take breaks off inside an edit.

An edit of one curve leaves the others to the most probable change (`expectation.py`), and so keeps
what is special about each moment: a smile stays while its jaw drops. That is right if the take is
right there. If its tracker slipped, or other content was pasted, the other curves are as wrong as
the one that is drawn, and should follow what is around the edit.

Two answers are in closed form: keep what is special about the moment, its residual

    r = other curves - gain * known curves,

or take that which the frames around the edit would have there (simple kriging in time, Matheron
1963). A small network (`networks/completion.py`) sees both, and what was asked for where. It says
on each frame how far to go from one to the other, and by how much faces that open or close their
mouth so far differ from a straight line:

    r += share * (r around - r + further)

It has learned that from takes of people that were damaged. What it answers is always near one of
the two, whatever is asked for.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles, Indices, Times
from faceedit_app.core.resample import GRID_RATE, Resampling
from faceedit_app.editing.solving.expectation import Expectation

if TYPE_CHECKING:  # the window is there before the networks
    from faceedit_app.networks.completion import CompletionNetwork

# Seconds over which residuals resemble each other, and the variance of one frame's own.
RESEMBLE, OWN = 0.6, 0.05
# Grid frames beyond which nothing is taken from the frames around an edit.
FARTHEST = 30
# Standard deviations of the take's curves: a request below this hardly changes other curves.
MOVES = 0.3
# Seconds between two edits over which the answer to one gives way to what the other asks for.
APART = 0.4
# Where an edit asks less firmly than this, it fades, and the take is taken to be right.
FIRM = 0.75
# A share this small is none, but for rounding.
ROUNDING = 1e-9
# Standard deviations by which an answer may leave what is around.
FURTHER = 1.5
# Weights of frames around edits that are kept: the steps of a drag ask for the same, and those of
# a chunk take 150 kB at most.
REMEMBERED = 32


@dataclass(frozen=True)
class Question:
    """What the network is asked about M grid frames, in standard deviations of each curve.

    Attributes:
        features: (M, 5 C) what it sees, see `ask`.
        away: (M, C) from the tracked residual to that around; 0 of curves that are known.
        share: (M,) in 0..1, how far curves may change at all.
    """

    features: Doubles
    away: Doubles
    share: Doubles


def ask(
    expectation: Expectation,
    known: Bools,
    curves: Doubles,
    change: Doubles,
    hold: Doubles,
    trusted: Bools,
) -> Question:
    """Put a request to the network.

    Args:
        expectation: the curves of the take.
        known: (C,) the curves that are asked for or held.
        curves: (M, C) mm at 25 fps, as tracked.
        change: (M, C) mm, what is asked for; that of the other curves does not count.
        hold: (M, C) in 0..1, how firmly each curve is asked for.
        trusted: (M,) the frames that no edit asks for firmly.
    """
    other = ~known
    centred = (curves - expectation.mean) / expectation.spread
    moved = np.where(known, change, 0.0) / expectation.spread
    gain = expectation.gain(known) * expectation.spread[known, None] / expectation.spread[other]
    firm = hold.max(axis=1)
    residual, away = np.zeros_like(centred), np.zeros_like(centred)
    residual[:, other] = centred[:, other] - centred[:, known] @ gain
    around, near = surroundings(residual, trusted)
    away[:, other] = (around - residual)[:, other]
    edited = firm[:, None] > 0
    asked = np.where(known & edited, (centred + moved) * firm[:, None], 0.0)
    features = [residual, away * firm[:, None], moved * edited, hold, asked]
    far = (moved**2).max(axis=1) / (2.0 * MOVES**2)
    share = firm * near * (1.0 - np.exp(-_most_of_each_run(far, trusted)))
    return Question(np.concatenate(features, axis=1), away, share)


def surroundings(residual: Doubles, trusted: Bools) -> tuple[Doubles, Doubles]:
    """The residual (M, C) that the trusted frames (M,) around would have on all others.

    Returns:
        (M, C), and (M,) in 0..1 whether trusted frames are near.
    """
    around, near = residual.copy(), np.ones(len(residual))
    for first, last in _runs(~trusted):
        begin, end = max(first - FARTHEST, 0), min(last + FARTHEST, len(trusted))
        seen = trusted[begin:end]
        if not seen.any():
            near[first:last] = 0.0
            continue
        weights, distance = _kriging(seen.tobytes(), first - begin, last - begin)
        around[first:last] = weights @ residual[begin:end][seen]
        near[first:last] = np.clip(2.0 - 2.0 * distance / FARTHEST, 0.0, 1.0)
    return around, near


@lru_cache(maxsize=REMEMBERED)
def _kriging(trusted: bytes, first: int, last: int) -> tuple[Doubles, Doubles]:
    """(n, S) the weights of S trusted frames on frames `first` to `last`, and (n,) the distance."""
    known = np.flatnonzero(np.frombuffer(trusted, np.bool_))
    wanted = np.arange(first, last)

    def resemblance(others: Indices) -> Doubles:
        away = np.abs(np.subtract.outer(known, others)) / GRID_RATE
        return np.asarray(np.exp(-away / RESEMBLE), np.float64)

    own = resemblance(known) + OWN * np.eye(len(known))
    weights = np.asarray(np.linalg.solve(own, resemblance(wanted)).T, np.float64)
    distance: Doubles = np.abs(np.subtract.outer(wanted, known)).min(axis=1).astype(np.float64)
    return weights, distance


def _runs(where: Bools) -> list[tuple[int, int]]:
    """The runs of frames (M,): the first of each, and the one after its last."""
    ends: list[int] = (np.flatnonzero(where[1:] != where[:-1]) + 1).tolist()
    if where[0]:
        ends.insert(0, 0)
    if where[-1]:
        ends.append(len(where))
    return list(zip(ends[::2], ends[1::2], strict=True))


def _most_of_each_run(values: Doubles, trusted: Bools) -> Doubles:
    """(M,) the largest value of the run of edited frames that a frame belongs to; 0 elsewhere."""
    most = np.zeros_like(values)
    for first, last in _runs(~trusted):
        most[first:last] = values[first:last].max()
    return most


class Completing:
    """Completes the requests of one region.

    Args:
        expectation: the curves of the take.
        network: the region's completion network.
    """

    def __init__(self, expectation: Expectation, network: CompletionNetwork) -> None:
        self._expectation, self._network = expectation, network

    def further(
        self,
        times: Times,
        resampling: Resampling,
        curves: Doubles,
        change: Doubles,
        given: Bools,
        hold: Doubles,
    ) -> Doubles:
        """(N, C) mm, what is added to the most probable change of curves that are not given.

        Args:
            times: (N,) seconds.
            resampling: from them to the grid frames to look at, and back.
            curves: (N, C) mm, as tracked.
            change: (N, C) mm, what is asked for, with the most probable change of the others.
            given: (N, C) the curves whose change is given, see `Expectation.given`.
            hold: (N, C) in 0..1, how firmly each curve is asked for.
        """
        added = np.zeros_like(change)
        edited: Bools = np.any(given, axis=1)
        if edited.all():  # nothing is around
            return added
        patterns = _patterns(given[edited])
        if not len(patterns):
            return added
        rows = [(given == known).all(axis=1, keepdims=True) for known in patterns]
        # All in one go: the places of the grid frames are the same.
        firmly = np.where(hold.any(axis=1), hold.max(axis=1), edited)
        signals = [curves, change, firmly[:, None], *(hold * each for each in rows)]
        grid = resampling.to_grid(np.concatenate(signals, axis=1, dtype=np.float64))
        size = curves.shape[1]
        trusted = grid[:, 2 * size] < FIRM
        for i, (known, where) in enumerate(zip(patterns, rows, strict=True), start=2):
            firm = grid[:, i * size + 1 : (i + 1) * size + 1]
            firm[firm < ROUNDING] = 0.0
            on_grid = grid[:, :size], grid[:, size : 2 * size]
            away = self._away(ask(self._expectation, known, *on_grid, firm, trusted), known)
            if away is not None:
                by = resampling.from_grid(away)
                added += np.where(where & ~known, by, 0.0)
        if len(patterns) > 1:
            added *= _apart(times, given)
        return self._within(curves + change, added)

    def _away(self, question: Question, known: Bools) -> Doubles | None:
        """(M, C) mm, by how much curves that are not known differ; None if they do not."""
        if not question.share.any():
            return None
        share, further = self._network(question.features)
        # Even, as all answers are: a symmetric request leaves a symmetric face.
        further = 0.5 * (further + further[:, self._expectation.mirror])
        further = np.clip(further, -FURTHER, FURTHER) * ~known
        away: Doubles = (question.share * share)[:, None] * (question.away + further)
        away *= self._expectation.spread
        return away

    def _within(self, curves: Doubles, added: Doubles) -> Doubles:
        """What is added to curves (N, C), so that it takes none of them out of the take's range."""
        low = np.minimum(self._expectation.low, curves)
        high = np.maximum(self._expectation.high, curves)
        within: Doubles = np.minimum(np.maximum(curves + added, low), high) - curves
        return np.where(added != 0, within, 0.0)


def _patterns(given: Bools) -> Bools:
    """(P, C) the different rows of (n, C) that leave a curve to be completed."""
    patterns = given[:1]
    if not np.equal(given, patterns).all():
        patterns = np.unique(given, axis=0)
    return patterns[~patterns.all(axis=1)]


def _apart(times: Times, given: Bools) -> Doubles:
    """(N, C) in 0..1, how far a frame is from those on which a curve is given (N, C)."""
    apart = np.ones(given.shape)
    for curve in np.flatnonzero(given.any(axis=0) & ~given.all(axis=0)):
        there = times[given[:, curve]]
        after = np.searchsorted(there, times).clip(0, len(there) - 1)
        before = np.maximum(after - 1, 0)
        away = np.minimum(np.abs(there[after] - times), np.abs(there[before] - times))
        apart[:, curve] = np.minimum(away / APART, 1.0)
    return apart
