"""What the solver knows about each region of one take, computed once."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX, mirrored_channel
from faceedit_app.core.arrays import Bools, Doubles, Indices
from faceedit_app.core.controls import (
    CONTROL_IDS,
    CONTROL_INDEX,
    CONTROLS,
    MIRRORED_CONTROL,
    control_named,
)
from faceedit_app.core.regions import OPTIONAL_REGIONS, Region
from faceedit_app.core.rig import Distances
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.solving.accompanying import (
    STAYS_IN_CLOSURES,
    gains,
    stem,
    use,
    with_accompanying,
)
from faceedit_app.editing.solving.answerable import ENOUGH, region_covariance
from faceedit_app.editing.solving.calming import Calmed
from faceedit_app.editing.solving.completing import Completing
from faceedit_app.editing.solving.expectation import Expectation
from faceedit_app.editing.solving.last_layer import LastLayer
from faceedit_app.editing.solving.reach import FREE_MM, HELD_MM, PARTED_MM, Reach
from faceedit_app.editing.solving.reach_frames import limited
from faceedit_app.editing.solving.take_statistics import IDLE, Sample, TakeStatistics

if TYPE_CHECKING:  # the window is there before the networks
    from faceedit_app.networks.engine import Engine

# How far beyond the range seen in training a curve is followed, as a share of that range.
BEYOND = 0.1
# A request this far beyond what the take does, as a share of the range seen in training, may use
# all that a face can do.
_FAR = 0.1
# Standard deviations of the take's curves: a request up to the first is answered as the take would,
# one beyond the second as other faces would.
ALIKE, UNLIKE = 4.0, 7.0
# Channels with a smaller share of a curve's movement are not needed for it.
_NEEDED = 0.02
# mm: how exactly quick changes are answered.
_FAST_MM = 0.1


class TakeRegion:
    """One region of one take.

    Attributes:
        own: ids of the controls that it moves, in columns `own_columns`; the upper face has none.
        listens_to: ids of the controls that its networks or reach answer.
        is_optional: whether its controls are optional, so that no network answers them.
        columns: (K,) its channels among the 52: first those of the networks, then accompanying
            ones that the take uses.
        lips, leaders: positions of its own controls that are of one lip, or that others follow.
        have: positions of the channels that may change, because the take has them.
        have_columns: their columns among the 52.
        is_complete: whether the take has all channels of the networks.
        mirror: (K,) the position of each channel's mirror image.
        sees: columns among the 52 that its result depends on.
        expectation: what its curves do that are not asked for.
        completing: what they do where the take breaks off; None if no network says so.
        frowns: positions in `have` of channels that do not rise while lips are closed.
        reach: brings its own controls to a goal; None if it has none or no channel may change.
        quick: (C, K) how far its channels go with a quick change of its controls, per mm.
    """

    def __init__(
        self,
        region: Region,
        engine: Engine | None,
        distances: Distances,
        may: frozenset[str],
        missing: frozenset[str],
        sample: Sample,
    ) -> None:
        self.region = region
        self.is_optional = region in OPTIONAL_REGIONS
        answered = engine is not None and not self.is_optional
        self._model = engine.models[region.id].description if engine and answered else None
        self.own = tuple(name for name in region.own if name not in missing)
        self.own_columns = np.array([CONTROL_INDEX[name] for name in self.own], np.intp)
        self.leaders = [i for i, name in enumerate(self.own) if control_named(name).leads]
        self.lips = [i for i, name in enumerate(self.own) if control_named(name).expressive]
        self._distances = distances.select(self.own_columns)
        heard = self._model.controls if self._model else region.controls
        self.listens_to = tuple(dict.fromkeys((*heard, *self.own)))
        self.layer_columns = np.array([CONTROL_INDEX[name] for name in heard], np.intp)
        self.heard_columns = np.array([CONTROL_INDEX[name] for name in self.listens_to], np.intp)
        moves: Bools = np.asarray(sample.high - sample.low > IDLE)
        moves |= moves[[ARKIT_INDEX[mirrored_channel(c)] for c in ARKIT_CHANNELS]]
        more = [c for c in region.accompanying if c in may and moves[ARKIT_INDEX[c]]]
        self.channels = (*region.channels, *more)
        self.columns = np.array([ARKIT_INDEX[c] for c in self.channels], np.intp)
        self.have = np.array([i for i, c in enumerate(self.channels) if c in may], np.intp)
        self.have_columns = self.columns[self.have]
        self._has_all = len(self.have) == len(self.columns)
        self.is_complete = may.issuperset(region.channels)
        self.mirror = np.array(
            [self._place(mirrored_channel(c), c) for c in self.channels], np.intp
        )
        self._follow = gains(region.channels, more)
        self._use = use(region.channels)
        covariance = region_covariance(region, engine) * np.outer(self._use, self._use)
        self._prior = with_accompanying(covariance, self._follow)
        slopes = self._slopes(np.zeros(len(ARKIT_INDEX)))
        self._statistics = TakeStatistics.of(
            sample.low[self.columns],
            sample.high[self.columns],
            [block[:, self.columns] for block in sample.weights],
            [block[:, self.columns] for block in sample.frames],
            self._prior,
            self.mirror,
            self._needed(slopes, moves[self.columns]),
            sample.seconds,
        )
        self._sides = self._own_sides(distances)
        self._range = sample.shortest[self.own_columns], sample.longest[self.own_columns]
        self._far = self._far_beyond()
        self.expectation = self._expectation(slopes, sample)
        self.completing = self._completing(engine)
        stays = [i for i in self.have if stem(self.channels[i]) in STAYS_IN_CLOSURES]
        self.frowns = np.flatnonzero(np.isin(self.have, stays))
        moving = np.flatnonzero(self._distances.gradients.any(axis=(1, 2)))
        self.sees = np.union1d(moving, self.columns)
        self.reach: Reach | None = None
        if len(self.own) and len(self.have):
            self.reach = self._new_reach()
            self.quick = self._quick_gain(np.median(np.concatenate(sample.weights), axis=0))

    def _place(self, channel: str, other: str) -> int:
        """The position of a channel, or of another if the take lacks the first."""
        return self.channels.index(channel if channel in self.channels else other)

    def _slopes(self, pose: Doubles) -> Doubles:
        """(C, K) mm per unit of weight, of its own controls."""
        jacobian = self._distances.jacobian(pose[None].astype(np.float32))[1][0]
        slopes: Doubles = jacobian[:, self.columns].astype(np.float64)
        return slopes

    def _needed(self, slopes: Doubles, moves: Bools) -> Bools:
        """(K,) idle channels without which one of its own curves could not be answered."""
        may = np.zeros(len(self.columns), np.bool_)
        may[self.have] = True
        needed = np.zeros(len(self.columns), np.bool_)
        for slope in slopes:
            shares = slope * (self._prior @ slope)
            total = shares[may].sum()
            if total > 0 and shares[may & moves].sum() < ENOUGH * total:
                needed |= shares > _NEEDED * total
        return needed

    def _completing(self, engine: Engine | None) -> Completing | None:
        """What completes requests, if the model has a network that knows just these controls."""
        network = engine.completions.get(self.region.id) if engine else None
        if network is None or network.description.controls != self.own:
            return None
        return Completing(self.expectation, network)

    def _own_sides(self, distances: Distances) -> Bools | None:
        """(K, C) which of the heard controls each channel follows; None = any of them.

        Where every control has a mirror image, a channel follows those that it moves, and one that
        moves none of them follows only what happens on both sides: a wink is one-sided.
        """
        if not all(control_named(name).mirror for name in self.listens_to):
            return None
        rest = np.zeros((1, len(ARKIT_INDEX)), np.float32)
        slopes = distances.jacobian(rest)[1][0][np.ix_(self.heard_columns, self.columns)].T
        moved: Bools = np.abs(slopes) > 0.1 * np.abs(slopes).max(initial=1e-9)
        moved[~moved.any(axis=1)] = True
        return moved

    def influence(self, influence: Doubles) -> Doubles:
        """(N, K) in 0..1, where each channel may answer.

        Args:
            influence: (N, all controls), see `Request`.
        """
        heard = influence[:, self.heard_columns]
        if self._sides is None:
            return np.repeat(heard.max(axis=1)[None], len(self.columns), axis=0).T
        spread: Doubles = np.where(self._sides.T[..., None], heard.T[:, None], 1.0).min(axis=0)
        return spread.T

    def _expectation(self, slopes: Doubles, sample: Sample) -> Expectation:
        curves = np.concatenate(sample.curves)[:, self.own_columns]
        places = {name: i for i, name in enumerate(self.own)}
        mirror = np.array([places.get(MIRRORED_CONTROL[name], i) for name, i in places.items()])
        held = np.array([control_named(name).closes is not None for name in self.own], np.bool_)
        prior = slopes @ self._prior @ slopes.T
        alone = np.array([control_named(name).expressive for name in self.own], np.bool_)
        return Expectation(curves, prior, mirror.astype(np.intp), held, alone)

    def _new_reach(self) -> Reach:
        names = [self.channels[i] for i in self.have]
        both = {"mouthClose", "jawOpen"} <= set(names)
        coupled = (names.index("mouthClose"), names.index("jawOpen")) if both else None
        have = np.ix_(self.have, self.have)
        columns = self.have_columns
        own, wide = self._statistics.covariance[have], self._statistics.wide[have]
        return Reach(self._distances, columns, own, coupled, self._prior[have], wide)

    def _quick_gain(self, pose: Doubles) -> Doubles:
        """(C, K) the most probable quick change of the channels for each millimetre."""
        slopes = self._slopes(pose)
        spread = slopes @ self._statistics.fast
        noise = _FAST_MM**2 * np.eye(len(slopes))
        return np.asarray(np.linalg.solve(spread @ slopes.T + noise, spread), np.float64)

    def control_covariance(self) -> Doubles:
        """(C, C) mm²: the covariance of its own controls in performances, linearised at rest."""
        slopes = self._slopes(np.zeros(len(ARKIT_INDEX)))
        covariance: Doubles = slopes @ self._prior @ slopes.T
        return covariance

    def limits(self) -> tuple[Doubles, Doubles]:
        """(C,) mm: the lowest and highest values to which its controls are followed."""
        low, high = np.full(len(CONTROLS), -np.inf), np.full(len(CONTROLS), np.inf)
        if self._model is not None:
            heard = [CONTROL_INDEX[control] for control in self._model.controls]
            slack = BEYOND * (self._model.high - self._model.low)
            low[heard], high[heard] = self._model.low, self._model.high + slack
        elif self.is_optional:
            low[self.own_columns], high[self.own_columns] = self._farthest()
        return low, high

    def _farthest(self) -> tuple[Doubles, Doubles]:
        """(C,) mm: its controls with all that shortens them, and with all that lengthens them."""
        slopes = self._slopes(np.zeros(len(ARKIT_INDEX)))
        ends = []
        for sign in (-1.0, 1.0):
            weights = np.zeros((len(slopes), len(ARKIT_INDEX)))
            weights[:, self.columns] = sign * slopes > 0
            ends.append(np.diag(self.lengths(self.vectors(weights))))
        return ends[0], ends[1]

    def answered_by(self, settings: Settings) -> Settings:
        """How its controls are answered: optional ones are added to the take, and by reach alone.

        Few takes raise a brow as far as brows go, so that the length of a change says nothing.
        """
        if not self.is_optional:
            return settings
        return replace(settings, mode=Mode.PRESERVE, naturalness=0.0, reach=1.0)

    def free(self, firm: Doubles) -> Doubles:
        """(N, C) mm by which its own controls may give way to those that edits ask for.

        What can touch is held, and so is the other side of the face. But a lip that moves parts
        the lips.

        Args:
            firm: (N, C) in 0..1, how firmly each control is asked for, see `Goal`.
        """
        mirror = self.expectation.mirror
        other = firm[:, mirror] * (mirror != np.arange(len(mirror)))
        free: Doubles = FREE_MM + other * (HELD_MM - FREE_MM)
        by_lips = firm[:, self.lips].max(axis=1, initial=0.0)
        free[:, self.expectation.held] = (HELD_MM + by_lips * (PARTED_MM - HELD_MM))[:, None]
        return free

    def beyond(self, wanted: Doubles, hold: Doubles) -> Doubles:
        """(N,) in 0..1: how far a request leaves what the take does, see `TakeStatistics.bounds`.

        Args:
            wanted: (N, C) mm of its own controls.
            hold: (N, C) in 0..1, how firmly they are asked for.
        """
        if not len(self.own):
            return np.zeros(len(wanted))
        low, high = self._range
        excess = np.maximum(low - wanted, wanted - high)
        excess /= self._far
        excess[hold <= 0] = 0.0
        return limited(excess.max(axis=1))

    def _far_beyond(self) -> Doubles:
        """(C,) mm: how far beyond the take's range a request may use all that a face can do."""
        low, high = self._range
        far = _FAR * np.maximum(high - low, 10.0)
        if self._model is not None:
            places = [i for i, c in enumerate(self._model.controls) if c in self.own]
            names = [self.own.index(self._model.controls[i]) for i in places]
            far[names] = _FAR * (self._model.high - self._model.low)[places]
        return far

    def bounds(self, beyond: Doubles) -> tuple[Doubles, Doubles]:
        """The smallest and largest weights of the channels that it has, (N, K) or (1, K) each."""
        lower, upper = self._statistics.bounds(beyond)
        return self.of_take(lower), self.of_take(upper)

    def of_take(self, values: NDArray[Any]) -> NDArray[Any]:
        """Values (N, K) of all its channels -> those of the channels that it has."""
        return values if self._has_all else values[:, self.have]

    def vectors(self, weights: Doubles) -> Doubles:
        """(N, C, 3) mm: its own controls with weights (N, 52), see `Distances.vectors`.

        Column by column in memory.
        """
        offsets, moves = self._moves
        vectors: Doubles = (moves @ weights.T).reshape(3, len(self.own), len(weights))
        vectors += offsets
        return vectors.T

    @cached_property
    def _moves(self) -> tuple[Doubles, Doubles]:
        """(3, C, 1) mm, its own vectors, and (3 C, 52) how weights move them."""
        gradients = self._distances.gradients.T.reshape(3 * len(self.own), len(ARKIT_INDEX))
        offsets = self._distances.offsets.T[:, :, None]
        return offsets.astype(np.float64), np.ascontiguousarray(gradients, np.float64)

    def signed(self, vectors: Doubles) -> Doubles:
        """(N, C) mm: its own controls, of vectors (N, C, 3); see `Distances.lengths`."""
        signed: Doubles = np.asfortranarray(self._distances.lengths(vectors))
        return signed

    def lengths(self, vectors: Doubles) -> Doubles:
        """(N, C) mm: the same, 0 for those that have passed each other."""
        return np.maximum(self.signed(vectors), 0.0)

    def calmed(self, mute: Collection[str]) -> Calmed:
        """Its answer to smooths; `mute`: controls that edits cannot ask for."""
        own = tuple(c for c in self.own if c not in mute)
        return Calmed(own, self.have_columns)

    def at_rest(self, weights: Doubles) -> Doubles:
        """(N, K) see `TakeStatistics.at_rest`, of the channels that it has."""
        return self._statistics.at_rest(weights, slice(None) if self._has_all else self.have)

    @cached_property
    def idle(self) -> Indices:
        """Positions of channels that stay still, because the take never uses them."""
        return np.flatnonzero(~self._statistics.used)

    def whole(self, answer: Doubles, unlike: Doubles | float = 0.0) -> Doubles:
        """(N, K) the networks' answer, symmetric, and with accompanying channels.

        Args:
            answer: (N, M) for the channels of the networks.
            unlike: (N, 1) in 0..1, how unlike the take a request is.
        """
        count = len(self.region.channels)
        even = 0.5 * (answer + answer[:, self.mirror[:count]])
        even *= self._use + unlike * (1.0 - self._use) if np.any(unlike) else self._use
        return np.concatenate([even.T, self._follow.T @ even.T]).T

    def unlike(self, change: Doubles) -> Doubles:
        """(N,) in 0..1: how unlike the take changes (N, C) of its own curves are, mm."""
        if not len(self.own):
            return np.zeros(len(change))
        distance = self.expectation.distance(change)
        return limited((distance - ALIKE) / (UNLIKE - ALIKE))

    def last_layer(self, answers: list[Doubles], sample: Sample) -> LastLayer:
        """Fit the take's own last layer.

        Args:
            answers: (N, M) the networks' answer to each stretch of the sample.
        """
        curves = np.concatenate(sample.curves)[:, self.layer_columns]
        weights = np.concatenate(sample.weights)[:, self.columns]
        lacking = weights - self.whole(np.concatenate(answers))
        places = {CONTROL_IDS[column]: i for i, column in enumerate(self.layer_columns)}
        mirror = [places.get(MIRRORED_CONTROL[name], i) for name, i in places.items()]
        # Channels without a curve of their own only accompany what moves.
        moving = [] if len(self.own) else [len(stretch) for stretch in sample.curves]
        return LastLayer.fit(curves, lacking, self.mirror, np.array(mirror, np.intp), moving)
