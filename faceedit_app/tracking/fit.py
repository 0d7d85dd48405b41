"""From landmarks to weights: all pictures of a film together, by maximum a posteriori.

The weights w of all pictures minimise

    sum of |seen - (rest + moves w)|² over landmarks, lips and lids  (what the film shows)
  + the depth between the lips, but for what an open jaw makes it  (what it does not)
  + |w|² + |w|                                   (few channels and small weights are likely)
  + sum of a robust loss of each weight's acceleration               (faces move smoothly)

with 0 <= w <= 1 and mouthClose <= jawOpen, by L-BFGS-B (Zhu, Byrd, Lu and Nocedal, "Algorithm
778", 1997). The loss is pseudo-Huber (Charbonnier et al., 1997): quadratic for the shaking of
landmarks, so that it is smoothed away, and linear for what is faster, so that blinks and closures
stay. It looks both ways in time, and so it has no lag.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import Bounds, minimize

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.arrays import Doubles, Times
from faceedit_app.core.controls import CONTROL_INDEX, LIDS, LIP_OPENING
from faceedit_app.tracking.face_model import FaceModel
from faceedit_app.tracking.person import Person, gap_of
from faceedit_app.tracking.pose import Poses, fit_poses

_BLOCK, _MARGIN = 1500, 50  # pictures fitted at once, and what is fitted with them on either side
_ROUNDS = 3  # of pose and weights in turn
_JAW, _CLOSE = ARKIT_INDEX["jawOpen"], ARKIT_INDEX["mouthClose"]
# Landmarks do not show these; noise would puff the cheeks of a head that is turned.
_SEEN = ~np.isin(ARKIT_CHANNELS, ("cheekPuff", "tongueOut"))
_TURNED = np.radians((5.0, 20.0))
_OTHERS = 0.3  # how much skin that moves shows of the pose, once it is known how it moves


@dataclass(frozen=True)
class FitSettings:
    """How the weights are found.

    Attributes:
        landmark: mm, how far a landmark is off.
        rows: how many landmarks tell as much as one, since their errors are alike.
        gap, lid: mm, how far the distance between shut lips, and between lids, is off.
        gap_share: what is added to that for lips, as a share of the distance.
        depth: mm, how far the depth between the lips, which a film does not show, is from what an
            open jaw makes it.
        across: mm, how far a lip is to a side of the other, for a head that looks at the camera and
            for one that is turned, where a film does not tell it from depth.
        sparse: how likely a channel is unused, in standard deviations of `weight`.
        weight: how large weights are.
        acceleration: 1/s² above which a change of a weight is meant, and not shaking.
        smoothness: weight of the smooth prior; 0 fits each picture by itself.
    """

    landmark: float = 0.6
    rows: float = 8.0
    gap: float = 0.12
    lid: float = 0.15
    gap_share: float = 0.05
    depth: float = 0.2
    across: tuple[float, float] = (2.0, 0.1)
    sparse: float = 1.0
    weight: float = 0.25
    acceleration: float = 40.0
    smoothness: float = 40.0


DEFAULT = FitSettings()


@dataclass(frozen=True)
class Fit:
    """What a fit found.

    Attributes:
        weights: (T, 52) in ARKit's order, 0..1.
        poses: of the head.
        residuals: (T,) mm, root mean square over the landmarks.
    """

    weights: Doubles
    poses: Poses
    residuals: Doubles


def fit_weights(
    model: FaceModel,
    person: Person,
    seen: Doubles,
    times: Times,
    trust: Doubles,
    settings: FitSettings = DEFAULT,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> Fit:
    """Fit the weights of all pictures, in blocks that overlap.

    Args:
        model, person: the landmarks on the rig and of this person.
        seen: (T, n, 3) pixels, see `fit_poses`.
        times: (T,) seconds.
        trust: (T,) 0..1, how much each picture counts.
        settings: the priors.
        progress: called before each block with the pictures done and all; may raise to stop.
    """
    parts = []
    for start in range(0, len(seen), _BLOCK):
        progress(start, len(seen))
        first, last = max(start - _MARGIN, 0), start + _BLOCK + _MARGIN
        some = slice(first, last)
        fit = _fit_block(model, person, seen[some], times[some], trust[some], settings)
        own = slice(start - first, start - first + _BLOCK)
        poses = Poses(fit.poses.turns[own], fit.poses.scales[own], fit.poses.shifts[own])
        parts.append(Fit(fit.weights[own], poses, fit.residuals[own]))
    if len(parts) == 1:
        return parts[0]
    poses = Poses(
        np.concatenate([part.poses.turns for part in parts]),
        np.concatenate([part.poses.scales for part in parts]),
        np.concatenate([part.poses.shifts for part in parts]),
    )
    return Fit(
        np.concatenate([part.weights for part in parts]),
        poses,
        np.concatenate([part.residuals for part in parts]),
    )


def _fit_block(
    model: FaceModel,
    person: Person,
    seen: Doubles,
    times: Times,
    trust: Doubles,
    settings: FitSettings,
) -> Fit:
    problem = _Problem(model, times, trust, settings)
    poses = fit_poses(seen, person.rest, model.steady)
    flat = seen
    weights = np.zeros((len(seen), len(ARKIT_INDEX)))
    every = model.steady + _OTHERS * (model.weights == 1.0)
    for turn in range(_ROUNDS):
        shape = person.rest + np.einsum("tk,knx->tnx", weights, model.moves)
        for _ in range(2):
            flat = person.lens.flatten(seen, poses, shape)
            poses = fit_poses(flat, shape, every if turn else model.steady)
        placed = poses.on_face(flat[..., :2], shape[..., 2])
        moved, gaps = placed - person.rest[:, :2], _gaps(model, person, placed)
        weights = problem.solve(moved, gaps, np.abs(poses.angles[:, 0]), weights)
    shape = person.rest + np.einsum("tk,knx->tnx", weights, model.moves)
    away = poses.on_face(flat[..., :2], shape[..., 2]) - shape[..., :2]
    share = model.weights / model.weights.sum()
    return Fit(weights, poses, np.sqrt(np.einsum("n,tnx->t", share, away**2)))


def _gaps(model: FaceModel, person: Person, placed: Doubles) -> Doubles:
    """(T, 3) mm: how far apart lips and lids are to be on the rig."""
    offsets = np.abs(model.controls.offsets[:, 1])
    columns = []
    for control in (LIP_OPENING, *LIDS):
        index = CONTROL_INDEX[control]
        gap = gap_of(model, placed, control)
        if control == LIP_OPENING:
            columns.append(offsets[index] + np.maximum(gap - person.touch, 0.0))
        else:
            shut, rest = person.lids[LIDS.index(control)]
            # Half of what their eyes are larger than the rig's is a person's own, half how wide
            # they hold them: a film cannot show which.
            open_ = offsets[index] + np.clip(0.5 * (rest - offsets[index]), -1.0, 1.0)
            columns.append(open_ * np.clip((gap - shut) / (rest - shut), 0.0, 1.5))
    return np.stack(columns, axis=1)


def _joined(rows: Doubles) -> Doubles:
    """What variables move, from what channels move, (52, ...).

    mouthClose is never above jawOpen. Therefore the variable of mouthClose moves both by as much,
    and that of jawOpen is what it is above mouthClose.
    """
    joined = rows.copy()
    joined[_CLOSE] += rows[_JAW]
    return joined


def _parted(weights: Doubles) -> Doubles:
    """The variables (T, 52) of weights, see `_joined`."""
    parted = weights.copy()
    parted[:, _JAW] -= weights[:, _CLOSE]
    return parted


class _Problem:
    """The objective, with all that does not change from round to round."""

    def __init__(
        self, model: FaceModel, times: Times, trust: Doubles, settings: FitSettings
    ) -> None:
        self._settings, self._trust = settings, trust
        scale = np.sqrt(model.weights / settings.rows) / settings.landmark
        self._scale = np.repeat(scale, 2)
        rows = _joined(model.moves[..., :2].reshape(len(ARKIT_INDEX), -1)) * self._scale
        controls = [CONTROL_INDEX[control] for control in (LIP_OPENING, *LIDS)]
        upward = np.sign(model.controls.offsets[controls, 1]).astype(np.float64)
        rest = np.abs(model.controls.offsets[controls, 1]).astype(np.float64)
        self._rest = np.append(rest, 0.0)
        gradients = model.controls.gradients[:, controls].astype(np.float64)
        across = gradients[:, :1, 0]
        self._gap_rows = _joined(np.concatenate([gradients[..., 1] * upward, across], axis=1))
        _, up, forward = gradients[ARKIT_INDEX["jawOpen"], 0].tolist()
        self._depth_row = _joined(gradients[:, 0, 2] - forward / up * gradients[:, 0, 1])
        self._rows = rows
        self._hessian = rows @ rows.T
        self._hessian = (
            self._hessian + np.outer(self._depth_row, self._depth_row) / settings.depth**2
        )
        stiff = (self._gap_rows[:, 0] / settings.gap) ** 2
        stiff = stiff + ((self._gap_rows[:, 1:3] / settings.lid) ** 2).sum(axis=1)
        self._ridge = 1.0 / settings.weight**2
        # Preconditions: a unit of each variable costs the same.
        self._unit = 1.0 / np.sqrt(np.diag(self._hessian) + stiff + self._ridge)
        before, after = np.diff(times)[:-1, None], np.diff(times)[1:, None]
        self._before, self._after = before, after
        self._span = (before + after) / 2.0

    def solve(self, moved: Doubles, gaps: Doubles, turned: Doubles, start: Doubles) -> Doubles:
        """The weights (T, 52) from moved landmarks (T, n, 2) and gaps (T, 3), mm.

        Args:
            turned: (T,) radians, how far the head is turned to a side.
        """
        pull = (moved.reshape(len(moved), -1) * self._scale) @ self._rows.T
        spread = np.array([self._settings.gap, self._settings.lid, self._settings.lid])
        spread = spread + gaps * (self._settings.gap_share, 0.0, 0.0)
        across = np.interp(turned, _TURNED, self._settings.across)
        exact = self._trust[:, None] / np.column_stack([spread, across]) ** 2
        wanted = np.column_stack([gaps, np.zeros(len(gaps))]) - self._rest
        unit, shape = self._unit, start.shape
        sparse = self._settings.sparse / self._settings.weight

        def cost(flat: Doubles) -> tuple[float, Doubles]:
            weights = flat.reshape(shape) * unit
            bent = weights @ self._hessian
            value = float(self._trust @ ((0.5 * bent - pull) * weights).sum(axis=1))
            slope = self._trust[:, None] * (bent - pull) + self._ridge * weights + sparse
            value += 0.5 * self._ridge * float((weights**2).sum()) + sparse * float(weights.sum())
            off = weights @ self._gap_rows - wanted
            value += 0.5 * float((exact * off**2).sum())
            slope += (exact * off) @ self._gap_rows.T
            smooth, bend = self._smoothness(weights)
            return value + smooth, ((slope + bend) * unit).ravel()

        bounds = Bounds(0.0, np.tile(np.where(_SEEN, 1.0 / unit, 0.0), len(start)))
        found = minimize(
            cost,
            (_parted(start) / unit).ravel(),
            jac=True,
            method="L-BFGS-B",
            bounds=bounds,
            options={"maxiter": 400, "maxcor": 12, "ftol": 1e-9, "gtol": 1e-4},
        )
        weights: Doubles = np.clip(found.x.reshape(shape) * unit, 0.0, 1.0)
        weights[:, _JAW] = np.minimum(weights[:, _JAW] + weights[:, _CLOSE], 1.0)
        return weights

    def _smoothness(self, weights: Doubles) -> tuple[float, Doubles]:
        """The prior on accelerations, and its gradient."""
        bend = np.zeros_like(weights)
        strength = self._settings.smoothness
        if len(weights) < 3 or strength == 0.0:
            return 0.0, bend
        steps = np.diff(weights, axis=0)
        curve = (steps[1:] / self._after - steps[:-1] / self._before) / self._span
        limit = self._settings.acceleration
        root = np.sqrt(1.0 + (curve / limit) ** 2)
        value = strength * float((self._span * (root - 1.0)).sum())
        slope = strength * curve / (limit**2 * root)  # times span, divided by it below
        bend[2:] += slope / self._after
        bend[:-2] += slope / self._before
        bend[1:-1] -= slope * (1.0 / self._after + 1.0 / self._before)
        return value, bend
