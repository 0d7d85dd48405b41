"""The take's own last layer: what the networks' answer lacks for this face and this tracker.

The networks know faces in general. The take shows what *this* face does with its channels, and it
shows it for every frame: the curves and the weights of the same moment. So their answer N(c) is
corrected by a small regression R, fitted in closed form to W - N(c), the weights that the networks
did not foresee:

    answer to an edit = N(asked) - N(tracked) + R(asked) - R(tracked)

R is linear in the curves, their products, and in radial functions around poses of the take, which
know its single gestures. This is ridge regression (Hoerl and Kennard, "Ridge regression: biased
estimation for nonorthogonal problems", 1970) towards the networks: a take of a second hardly
changes their answer, and one of a minute nearly replaces it. It depends on nothing but the take.

Brows have no curve of their own. Where eyes shut in a grimace they are down, and that is not what a
blink does to them. So their R is linear and fitted to movements: to how W - N(c) and the curves
change within `MOVEMENT` seconds. A blink then moves brows as blinks of this face do.

What R leaves is the residual of a pose, see `residual.py`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property, partial

import numpy as np

from faceedit_app.core.arrays import Doubles, Indices
from faceedit_app.core.resample import GRID_RATE
from faceedit_app.editing.solving.filters import smoothed
from faceedit_app.editing.solving.recent import Recent

# How firmly the coefficients of the curves, of their products and of the radial functions are kept
# near 0, in frames at 25 fps.
LINEAR, QUADRATIC, RADIAL = 20.0, 200.0, 10.0
# The most poses of the take with a radial function, spread evenly over it, and how far one reaches,
# in standard deviations of each curve.
POSES, REACHES = 48, 1.5
# mm added to each curve's standard deviation: a curve that hardly moves says little.
LEAST_SPREAD = 0.3
# Seconds of standard deviation of the Gaussian below which curves and weights move; about a blink.
MOVEMENT = 0.15
# Standard deviations beyond the take's own range within which the correction still grows.
BEYOND = 0.5
# Variance added to each standardised curve in the length of a change.
_JITTER = 0.05


@dataclass(frozen=True)
class LastLayer:
    """A correction to the answers for C curves, of K channels.

    Attributes:
        mean, spread: (C,) mm, the take's curves.
        low, high: (C,) the range of the standardised curves in which the take knows.
        poses: (P, C) standardised curves of poses of the take.
        precision: (C, C) of its standardised curves.
        coefficients: (F, K) of the functions of the curves.
        constant: (K,) added to them.
        recent: keeps the functions of the last curves; layers of the same take share it.
    """

    mean: Doubles
    spread: Doubles
    low: Doubles
    high: Doubles
    poses: Doubles
    precision: Doubles
    coefficients: Doubles
    constant: Doubles
    recent: Recent[Doubles] = field(default_factory=partial(Recent, 1), repr=False)

    @classmethod
    def fit(
        cls,
        curves: Doubles,
        lacking: Doubles,
        mirror: Indices,
        mirrored_curves: Indices,
        moving: Sequence[int] = (),
    ) -> LastLayer:
        """Fit the correction: what a face does on one side it may do on the other.

        Args:
            curves: (T, C) mm.
            lacking: (T, K) the weights less the networks' answer to the curves.
            mirror: (K,) the position of each channel's mirror image.
            mirrored_curves: (C,) the same of each curve.
            moving: if it is to be fitted to movements, the lengths of the stretches of frames in
                a row that `curves` consists of.
        """
        both = np.concatenate([curves, curves[:, mirrored_curves]])
        lacks = np.concatenate([lacking, lacking[:, mirror]])
        mean, spread = both.mean(axis=0), both.std(axis=0) + LEAST_SPREAD
        standard = (both - mean) / spread
        low, high = standard.min(axis=0) - BEYOND, standard.max(axis=0) + BEYOND
        count = len(curves)
        chosen = np.linspace(0, count - 1, min(POSES, count)).round().astype(np.intp)
        poses = standard[np.concatenate([chosen, count + chosen])]
        functions = _functions(standard, poses, _squares(poses))
        size = curves.shape[1]
        penalty = np.full(functions.shape[1], QUADRATIC)
        penalty[:size], penalty[-len(poses) :] = LINEAR, RADIAL
        centre, level = functions.mean(axis=0), lacks.mean(axis=0)
        offset, away, used = functions - centre, lacks - level, len(penalty)
        if moving:
            used = size
            offset, away = (_movements(each, 2 * [*moving]) for each in (offset[:, :used], away))
        # Each frame is there twice, and counts half.
        system = offset.T @ offset + 2.0 * np.diag(penalty[:used])
        coefficients = np.zeros((len(penalty), lacks.shape[1]))
        coefficients[:used] = np.linalg.solve(system, offset.T @ away)
        covariance = standard.T @ standard / len(standard) + _JITTER * np.eye(size)
        precision = np.asarray(np.linalg.inv(covariance), np.float64)
        constant = level - centre @ coefficients
        return cls(mean, spread, low, high, poses, precision, coefficients, constant)

    def towards(self, other: LastLayer, share: float) -> LastLayer:
        """The layer between this and another of the same take, fitted to the same mix."""
        mixed = self.coefficients + share * (other.coefficients - self.coefficients)
        constant = self.constant + share * (other.constant - self.constant)
        return replace(self, coefficients=mixed, constant=constant)

    def __call__(self, curves: Doubles) -> Doubles:
        """(N, K) the correction for curves (N, C)."""
        within = np.minimum(np.maximum((curves - self.mean) / self.spread, self.low), self.high)
        # Brows and lids hear the same curves: what one asked for, the other asks for next.
        key = within.tobytes(), self._poses_key
        functions = self.recent.to(key, lambda: _functions(within, self.poses, self._lengths))
        answer: Doubles = self.coefficients.T @ functions.T
        answer += self.constant[:, None]
        return answer.T

    @cached_property
    def _poses_key(self) -> bytes:
        return self.poses.tobytes()

    @cached_property
    def _lengths(self) -> Doubles:
        return _squares(self.poses)

    def change(self, curves: Doubles, to: Doubles, known: Doubles) -> Doubles:
        """(N, K) how the correction changes from curves (N, C) to others.

        Args:
            known: (N, K) the correction for `curves`.
        """
        moved = (curves != to).any(axis=1)
        if moved.all():
            return self(to) - known
        change = np.zeros_like(known)
        if moved.any():
            change[moved] = self(to[moved]) - known[moved]
        return change

    def distance(self, change: Doubles) -> Doubles:
        """(N,) the length of changes (N, C), mm, in standard deviations of the take's curves."""
        moved = change / self.spread
        square: Doubles = ((moved @ self.precision) * moved).sum(axis=1)
        return np.sqrt(square)


class Correction:
    """How the correction of a region changes with its curves.

    The last one is kept: a drag asks for the correction of the same tracked curves again, and for
    the same changes of the regions that it does not move.
    """

    def __init__(self) -> None:
        self._last: _Change | None = None

    def change(self, layer: LastLayer, curves: Doubles, by: Doubles) -> Doubles:
        """(N, K) how the correction changes with curves (N, C), mm, by (N, C)."""
        last = self._last
        if last is None or last.layer is not layer or not np.array_equal(last.curves, curves):
            known = layer(curves)
        elif np.array_equal(last.by, by):
            return last.change
        else:
            known = last.known
        change = layer.change(curves, curves + by, known)
        self._last = _Change(layer, curves, known, by, change)
        return change


@dataclass(frozen=True)
class _Change:
    """A change of a correction.

    Attributes:
        layer: the last layer.
        curves, known: (N, C) mm, and (N, K) the correction for them.
        by, change: (N, C) mm by which they change, and (N, K) by which the correction does.
    """

    layer: LastLayer
    curves: Doubles
    known: Doubles
    by: Doubles
    change: Doubles


def _movements(values: Doubles, stretches: Sequence[int]) -> Doubles:
    """(T, V) values at 25 fps, less what lasts longer than a movement.

    Args:
        stretches: the lengths of the stretches that the frames are from.
    """
    parts = np.split(values, np.cumsum(stretches)[:-1])
    return np.concatenate([part - smoothed(part, MOVEMENT * GRID_RATE) for part in parts])


@cache
def _pairs(curves: int) -> tuple[Indices, Indices]:
    first, second = np.triu_indices(curves)
    return first, second


def _squares(poses: Doubles) -> Doubles:
    """(P, 1) half the square of the length of each pose (P, C), as `_functions` needs it."""
    squares: Doubles = 0.5 * REACHES**-2 * (poses**2).sum(axis=1)[:, None]
    return squares


def _functions(standard: Doubles, poses: Doubles, squares: Doubles) -> Doubles:
    """(N, C) -> (N, F): the curves, their products, and how near they are to poses (P, C).

    Column by column in memory, as curves are; `squares` are those of the poses, see `_squares`.
    """
    first, second = _pairs(standard.shape[1])
    size, pairs = standard.shape[1], len(first)
    rows = np.ascontiguousarray(standard.T)
    functions = np.empty((size + pairs + len(poses), len(standard)))
    functions[:size] = rows
    np.multiply(rows[first], rows[second], out=functions[size : size + pairs])
    # exp(-|x - p|² / 2 R²), with the square multiplied out.
    narrow = REACHES**-2
    near = (narrow * poses) @ rows
    near -= 0.5 * narrow * (rows**2).sum(axis=0)
    near -= squares
    np.exp(np.minimum(near, 0.0, out=near), out=functions[size + pairs :])
    return functions.T
