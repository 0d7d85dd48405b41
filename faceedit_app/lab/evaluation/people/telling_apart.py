"""Real or edited: can a small classifier tell edited stretches from a performance?

Windows of 64 frames at 25 a second, half of them edited in the middle; people are never shared
between learning and testing. A real stretch of the same person, spliced in, is the reference: an
edit need not be harder to tell than that.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from faceedit_app.core.arkit import ARKIT_INDEX, mirrored_channel
from faceedit_app.core.arrays import Bools, Doubles, Floats, Indices, Times
from faceedit_app.core.controls import CONTROL_INDEX, CONTROLS
from faceedit_app.core.regions import MODELLED_CHANNELS
from faceedit_app.core.resample import GRID_RATE, grid_length, to_grid
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.formats.take import Take
from faceedit_app.lab.evaluation.people.opened import SPLICE, Opened
from faceedit_app.lab.evaluation.people.places import frames, gaps, random_for
from faceedit_app.lab.evaluation.people.references import References
from faceedit_app.lab.evaluation.people.restoration import swapped
from faceedit_app.lab.evaluation.people.sources import TakeSource
from faceedit_app.lab.evaluation.systems import Systems

FIGURE = "real_or_edited.accuracy"
WINDOW = 64  # grid frames
WINDOWS = 240  # of a source
ROUNDS = 8  # through a source's takes, at most
HOLD, FALLOFF = 0.5, 0.2  # seconds of an edit
SPLICED = 0.8  # seconds of a splice
STILL_MM = 0.2  # a curve that spreads less is not edited
PENALTY = 0.01  # of the logistic regression, per window
UNUSED = 0.02  # a channel that moves less in a take is not used there

_COLUMNS = [ARKIT_INDEX[c] for c in MODELLED_CHANNELS]
_PAIRS = [
    (i, MODELLED_CHANNELS.index(mirrored_channel(c)))
    for i, c in enumerate(MODELLED_CHANNELS)
    if c.endswith("Left")
]
_STEADY = 0.003  # a weight's least spread and roughness: below it trackers only tremble


@dataclass(frozen=True)
class Seen:
    """Windows of one source as the classifier sees them.

    Attributes:
        take: (N,) the number of the take that each is from.
        real: (N, F) features of windows as tracked.
        edited: (N, F) of the same windows with an edit, by system.
    """

    take: Indices
    real: Doubles
    edited: Mapping[str, Doubles]

    def of_takes(self, odd: bool) -> Seen:
        """The windows of every second take."""
        rows = self.take % 2 == int(odd)
        edited = {system: features[rows] for system, features in self.edited.items()}
        return Seen(self.take[rows], self.real[rows], edited)


def accuracies(seen: Mapping[str, Seen]) -> dict[str, dict[str, float]]:
    """The accuracy by source and system.

    Each source is tested by a classifier that learned from all others. A single source is tested
    on every second take by one that learned from the rest, which may be the same person.
    """
    if len(seen) == 1:
        ((name, only),) = seen.items()
        odd, even = only.of_takes(odd=True), only.of_takes(odd=False)
        if not len(odd.real) or not len(even.real):
            return {}
        return {
            name: {
                system: 0.5 * (accuracy(odd, [even], system) + accuracy(even, [odd], system))
                for system in only.edited
            }
        }
    return {
        name: {
            system: accuracy(mine, [s for other, s in seen.items() if other != name], system)
            for system in mine.edited
        }
        for name, mine in seen.items()
    }


def accuracy(tested: Seen, learned: Sequence[Seen], system: str) -> float:
    """The share of windows that a classifier gets right, real and edited alike; 0.5 is chance.

    The classifier knows that half of the windows are edited: it says so of those with the higher
    scores. What differs between two trackers as a whole can then not hide an edit.
    """
    real = np.concatenate([seen.real for seen in learned])
    edited = np.concatenate([seen.edited[system] for seen in learned])
    classifier = Classifier.fit(
        np.concatenate([real, edited]), np.repeat([False, True], [len(real), len(edited)])
    )
    scores = classifier(np.concatenate([tested.real, tested.edited[system]]))
    count = len(tested.real)
    side = np.sign(scores - np.median(scores))  # 0: on the line, which is half right
    right = np.concatenate([-side[:count], side[count:]])
    return float(0.5 + 0.5 * right.mean())


@dataclass(frozen=True)
class Classifier:
    """Logistic regression with an L2 penalty on standardised features."""

    mean: Doubles
    spread: Doubles
    slopes: Doubles

    @classmethod
    def fit(cls, features: Doubles, positive: Bools) -> Classifier:
        """Learn from features (N, F) and the right answers (N,)."""
        mean, spread = features.mean(axis=0), features.std(axis=0) + 1e-6
        inputs = _with_one((features - mean) / spread)
        sign = np.where(positive, 1.0, -1.0)

        def loss(slopes: Doubles) -> tuple[float, Doubles]:
            margin = sign * (inputs @ slopes)
            penalty = PENALTY * np.append(slopes[:-1], 0.0)
            pull = -sign / (1.0 + np.exp(np.clip(margin, -50, 50)))
            value = np.logaddexp(0.0, -margin).mean() + 0.5 * float(penalty @ slopes)
            return float(value), inputs.T @ pull / len(inputs) + penalty

        start = np.zeros(inputs.shape[1])
        found = minimize(loss, start, jac=True, method="L-BFGS-B", options={"maxiter": 200})
        return cls(mean, spread, found.x)

    def __call__(self, features: Doubles) -> Doubles:
        """(N, F) -> (N,) scores: above 0, it takes them for positive ones."""
        near = np.clip((features - self.mean) / self.spread, -5.0, 5.0)
        scores: Doubles = _with_one(near) @ self.slopes
        return scores


def _with_one(inputs: Doubles) -> Doubles:
    return np.concatenate([inputs, np.ones((len(inputs), 1))], axis=1)


def see(source: TakeSource, rig: Rig, systems: Systems, learned: References) -> Seen:
    """Edit windows of a source by every system, and describe them."""
    numbers: list[int] = []
    real: list[Doubles] = []
    edited: dict[str, list[Doubles]] = {}
    takes = [Opened(take, rig, systems, learned) for take in source.takes]
    features = [Features(_grid(opened.take, opened.weights)) for opened in takes]
    share = max(1, round(WINDOWS / len(takes)))
    for number in range(ROUNDS):
        if len(real) >= WINDOWS:
            break
        for place, (opened, describe) in enumerate(zip(takes, features, strict=True)):
            random = random_for(opened.take, f"window {number}")
            begins = _begins(len(describe.take), share, random)
            begins = [begin for begin in begins if not _has_gap(opened.times, begin)]
            made = [_edits(opened, begin, random) for begin in begins]
            windows = [(begin, some) for begin, some in zip(begins, made, strict=True) if some]
            if not windows:
                continue
            numbers += [place] * len(windows)
            edits = [edit for _, some in windows for edit in some]
            real += [describe(describe.take, begin) for begin, _ in windows]
            answers = {name: opened.edited(name, edits) for name in opened.editors}
            answers[SPLICE] = spliced(opened, [begin for begin, _ in windows], random)
            for name, weights in answers.items():
                grid = _grid(opened.take, weights)
                edited.setdefault(name, []).extend(describe(grid, begin) for begin, _ in windows)
    return Seen(
        np.array(numbers), np.array(real), {name: np.array(rows) for name, rows in edited.items()}
    )


def _begins(length: int, most: int, random: np.random.Generator) -> list[int]:
    """The first grid frames of windows that do not overlap."""
    count = min(length // WINDOW, most)
    if not count:
        return []
    spare = length - count * WINDOW
    cuts = np.sort(random.integers(0, spare + 1, count))
    return [int(cut) + WINDOW * number for number, cut in enumerate(cuts)]


def _has_gap(times: Times, begin: int) -> bool:
    first, last = begin / GRID_RATE, (begin + WINDOW) / GRID_RATE
    return any(before < last and after > first for before, after in gaps(times))


def _middle(begin: int) -> float:
    return (begin + 0.5 * WINDOW) / GRID_RATE


def _edits(opened: Opened, begin: int, random: np.random.Generator) -> list[Edit]:
    """A drag of one curve, or of a pair, by 1 to 2 times its spread in the take."""
    spreads = opened.tracked.std(axis=0)
    groups = [
        (c.id, c.mirror) if c.mirror else (c.id,)
        for c in CONTROLS
        if not c.optional and spreads[CONTROL_INDEX[c.id]] > STILL_MM
    ]
    if not groups:
        return []
    group = groups[int(random.integers(len(groups)))]
    by = float(random.choice([-1.0, 1.0]) * random.uniform(1.0, 2.0))
    at = _middle(begin) + float(random.uniform(-0.3, 0.3))
    value = by * float(spreads[CONTROL_INDEX[group[0]]])
    return [Edit(group, Op.OFFSET, at - 0.5 * HOLD, at + 0.5 * HOLD, FALLOFF, value)]


def spliced(opened: Opened, begins: Sequence[int], random: np.random.Generator) -> Floats:
    """(T, 52): the take with another of its stretches in the middle of some windows."""
    weights = opened.weights.copy()
    for begin in begins:
        at = _middle(begin)
        rows = frames(opened.times, at - 0.5 * SPLICED, at + 0.5 * SPLICED)
        weights[rows] = swapped(opened.weights, rows, opened.times, random)
    return weights


def _grid(take: Take, weights: Floats) -> Doubles:
    times = take.clip.times
    return to_grid(times, weights, 0, grid_length(times))[:, _COLUMNS].astype(np.float64)


class Features:
    """Describes windows by how they differ from the whole take.

    Relative to the take, so that what is learned from one person and tracker says something about
    another one: where each channel lies and how much it moves and shakes, whether left and right
    part, whether channels move that the take never uses, and how many weights are exactly 0.

    Args:
        take: (N, K) modelled channels of the take as tracked, on the grid.
    """

    def __init__(self, take: Doubles) -> None:
        self.take = take
        self._middle, self._spread = np.median(take, axis=0), take.std(axis=0) + _STEADY
        self._shake = _shake(take)
        self._sides = _shake(_sides(take))
        self._low, self._high = np.percentile(take, [0.5, 99.5], axis=0)
        self._unused = np.ptp(take, axis=0) < UNUSED
        self._zeros = (take == 0.0).mean()

    def __call__(self, weights: Doubles, begin: int) -> Doubles:
        """(F,) of the window of `weights` (N, K) that begins at a grid frame."""
        window = weights[begin : begin + WINDOW]
        beyond = np.maximum(window - self._high, self._low - window).max(axis=0)
        moves = np.ptp(window, axis=0)
        return np.concatenate(
            [
                np.clip((window.mean(axis=0) - self._middle) / self._spread, -4.0, 4.0),
                np.log((window.std(axis=0) + _STEADY) / self._spread),
                np.log(_shake(window) / self._shake),
                np.log1p(np.maximum(beyond, 0.0) / _STEADY),
                np.log(_shake(_sides(window)) / self._sides),
                [
                    np.log1p(float(moves[self._unused].max(initial=0.0)) / _STEADY),
                    float((moves[self._unused] > UNUSED).sum()),
                    float((window == 0.0).mean() - self._zeros),
                ],
            ]
        )


def _shake(weights: Doubles) -> Doubles:
    """(K,) rms second difference."""
    rough: Doubles = np.sqrt((np.diff(weights, 2, axis=0) ** 2).mean(axis=0)) + 0.3 * _STEADY
    return rough


def _sides(weights: Doubles) -> Doubles:
    left, right = (list(side) for side in zip(*_PAIRS, strict=True))
    apart: Doubles = weights[:, left] - weights[:, right]
    return apart
