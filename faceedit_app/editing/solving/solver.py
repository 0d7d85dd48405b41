"""From edits to weights: the networks' answer combined with the take, then reach.

The take is computed in chunks; see `chunks.py` for what a chunk's result depends on. So undo needs
no copies, an export has the same bytes whatever led to the edits, and moving an edit recomputes
only the chunks that it touches.

A request is divided into a slow and a quick part. The networks, corrected by the take's own last
layer, answer the slow part. The quick part, most of it shaking that a smooth takes away, is
answered by the channels that move quickly in this take, so that none begins to shake that did not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Bools, Doubles, Floats
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_INDEX, LIP_OPENING
from faceedit_app.core.regions import REGIONS
from faceedit_app.core.resample import from_grid, grid_length, to_grid
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edits.edit import Edit
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.solving.answerable import find_lacks, without
from faceedit_app.editing.solving.answers import Answers
from faceedit_app.editing.solving.chunks import Chunks, ChunkTask
from faceedit_app.editing.solving.companions import Companions
from faceedit_app.editing.solving.filters import smoothed
from faceedit_app.editing.solving.last_layer import LastLayer
from faceedit_app.editing.solving.parts import BEYOND, Part, Sample
from faceedit_app.editing.solving.reach import Goal
from faceedit_app.editing.solving.request import Request, request

if TYPE_CHECKING:  # the window is there before the networks
    from faceedit_app.networks.engine import Engine

# Chunks that the statistics of a take are measured on: 12 are 100 s.
SAMPLED = 12
# Seconds of standard deviation of the Gaussian that divides a request into slow and quick.
QUICK = 0.04
# How much a curve may miss what is missing for a moment only, as a share of that.
TWITCH = 2.0
# mm that a curve may miss before the take's own range is left.
MISSING_MM = 0.2
LAST = 2  # iterations of reach in the wider range
# The take's closed lips: this percentile of its opening, if that is less than so many mm; else the
# opening of closed lips in other performances.
_SHUT_PERCENTILE, _SHUT_MOST, _SHUT = 2.0, 2.2, 1.15


@dataclass(frozen=True)
class Patch:
    """A chunk's result: `asked` (N, C) mm, `weights` (N, 52), `controls` (N, C) mm."""

    asked: Floats
    weights: Floats
    controls: Floats


class Solver:
    """Computes the chunks of one take on one rig.

    Args:
        clip: the take as tracked.
        rig: the character that the controls are measured on.
        engine: the engine; None leaves all the work to reach, while no model is loaded.
    """

    def __init__(self, clip: Clip, rig: Rig, engine: Engine | None) -> None:
        self.clip = clip
        self.tracked = clip.arkit_weights()
        self.distances = rig.arkit_distances
        self._missing = frozenset(rig.missing_controls)
        self.controls = self.distances.measure(self.tracked)
        self.medians = np.median(self.controls, axis=0).astype(np.float64)
        self.grid = to_grid(clip.times, self.controls, 0, grid_length(clip.times))
        opening = self.controls[:, CONTROL_INDEX[LIP_OPENING]]
        shut = float(np.percentile(opening, _SHUT_PERCENTILE))
        self.shut = shut if shut < _SHUT_MOST else _SHUT  # mm between closed lips
        self.use_engine(engine)

    def use_engine(self, engine: Engine | None) -> None:
        """Use another engine from now on; the chunks may change."""
        self.engine = engine
        clip, present = self.clip, frozenset(self.clip.channels)
        self.lacks = find_lacks(present, self.distances, engine)
        self._mute = self._missing | self.lacks.keys()
        scale, context = (engine.scale, engine.context) if engine else (1, 0)
        self.chunks = Chunks(clip.times, clip.rate, len(self.grid), scale, context)
        may = present if "jawOpen" in present else present - {"mouthClose"}
        self._sample = self._measure()
        self._parts = {
            region.id: Part(region, engine, self.distances, may, self._missing, self._sample)
            for region in REGIONS
        }
        self._companions = Companions(
            {part.own: part.control_covariance() for part in self._parts.values()}
        )
        lows, highs = zip(*(part.limits() for part in self._parts.values()), strict=True)
        self._low, self._high = np.max(lows, axis=0), np.min(highs, axis=0)
        self._answers = Answers(engine, self.grid) if engine else None
        self._layers: dict[tuple[str, float], LastLayer] = {}
        self.limits = self._limits()

    def _measure(self) -> Sample:
        """The part of the take that its statistics are measured on."""
        times, weights, curves = self.clip.times, [], []
        self._sampled = self.chunks.spread(SAMPLED)
        for chunk in self._sampled:
            first, last = (int(i) for i in self.chunks.own_ranges[chunk])
            rows = self.chunks.slice(chunk)
            near = slice(max(rows.start - 3, 0), rows.stop + 3)
            weights.append(to_grid(times[near], self.tracked[near], first, last))
            curves.append(self.grid[first:last])
        low, high = self.tracked.min(axis=0), self.tracked.max(axis=0)
        shortest, longest = self.controls.min(axis=0), self.controls.max(axis=0)
        extremes = (each.astype(np.float64) for each in (low, high, shortest, longest))
        return Sample(weights, curves, *extremes, self.clip.duration)

    def _last_layer(self, region: str, naturalness: float) -> LastLayer:
        """The take's own last layer of a region; linear in naturalness, as the answers are."""
        if 0 < naturalness < 1:
            ends = self._last_layer(region, 0.0), self._last_layer(region, 1.0)
            return ends[0].towards(ends[1], naturalness)
        key = region, naturalness
        if key not in self._layers:
            assert self.engine is not None
            answers = []
            for chunk in self._sampled:
                own = self.chunks.own_ranges[chunk]
                first, last = (int(i) for i in self.chunks.grid_ranges[chunk])
                answer = self.engine.answer(region, self.grid[first:last], naturalness)
                answers.append(answer[own[0] - first : own[1] - first])
            self._layers[key] = self._parts[region].last_layer(answers, self._sample)
        return self._layers[key]

    def _limits(self) -> list[tuple[float, float]]:
        """The lowest and highest value of each control that a face, or this take, can have, mm.

        Without an engine the lowest is 0.
        """
        high = np.where(np.isfinite(self._high), self._high, self.distances.farthest)
        low = np.where(np.isfinite(self._low), self._low, 0.0)
        low = np.maximum(low - BEYOND * (high - low), 0.0)
        low = np.minimum(low, self.controls.min(axis=0))
        high = np.maximum(high, self.controls.max(axis=0))
        return list(zip(low.tolist(), high.tolist(), strict=True))

    def tasks(self, edits: Sequence[Edit], settings: Settings) -> dict[int, ChunkTask]:
        """The tasks that answer edits, by chunk."""
        listening = {name: part.listens_to for name, part in self._parts.items()}
        return self.chunks.tasks(self._possible(edits), settings, listening)

    def _possible(self, edits: Sequence[Edit]) -> Sequence[Edit]:
        """The edits without controls that the character lacks or the take cannot answer."""
        if not self._mute:
            return edits
        parts = (without(edit, self._mute) for edit in edits)
        return [part for part in parts if part is not None]

    def solve(self, task: ChunkTask) -> Patch:
        """Compute one chunk."""
        rows, near, settings = self.chunks.slice(task.chunk), slice(*task.near), task.settings
        tracked = self.controls[near].astype(np.float64)
        times, rate = self.clip.times[near], self.clip.rate
        asked = request(times, rate, tracked, self.medians, task.edits, self._companions)
        inner = slice(rows.start - near.start, rows.stop - near.start)
        mine = Request(asked.curves[inner], asked.hold[inner], asked.influence[inner])
        weights = self.tracked[rows].astype(np.float64)
        influences = {}
        for name, part in self._parts.items():
            influence = part.influence(mine.influence)
            if name in task.regions:
                influence = np.ones_like(influence)
            if influence.any():
                influences[name] = influence
        if influences:
            change = self._wanted_change(asked, tracked)
            slow = smoothed(change, QUICK * rate)
            answers = self._answer(task, tuple(influences), slow)
            quick = (change - slow)[inner]
            for name, influence in influences.items():
                part = self._parts[name]
                answer = answers[name]
                if settings.mode is Mode.PRESERVE:
                    self._respect_take(part, answer, rows, slow[inner], quick, settings)
                self._combine(weights, part, answer, influence, rows, settings)
            wanted = tracked[inner] + change[inner]
            for name, influence in influences.items():
                self._reach(weights, self._parts[name], mine, wanted, influence, settings)
        result = weights.astype(np.float32)
        controls = self.distances.measure(result)
        # The last bits of a matrix product depend on the number of frames.
        same = (result == self.tracked[rows]).all(axis=1)
        controls[same] = self.controls[rows][same]
        return Patch(mine.curves.astype(np.float32), result, controls)

    def _wanted_change(self, asked: Request, tracked: Doubles) -> Doubles:
        """(N, C) mm: the change that is asked for, limited to what faces do or this take does.

        Curves that nobody asked for take the most probable change.
        """
        low, high = np.minimum(self._low, tracked), np.maximum(self._high, tracked)
        wanted = np.minimum(np.maximum(asked.curves, low), high)
        lips = CONTROL_INDEX[LIP_OPENING]
        shut = np.minimum(self.shut, tracked[:, lips])
        wanted[:, lips] = np.maximum(wanted[:, lips], shut)
        change: Doubles = wanted - tracked
        for part in self._parts.values():
            own = part.own_columns
            if len(own):
                change[:, own] = part.expectation.fill(change[:, own], asked.hold[:, own] > 0)
        return change

    def _answer(
        self, task: ChunkTask, regions: tuple[str, ...], change: Doubles
    ) -> dict[str, Doubles]:
        """(N, K) by region: what the networks add to (preserve) or replace (resynthesize).

        Args:
            change: (N', C) mm by which the controls near the task differ from the take.
        """
        rows, settings = self.chunks.slice(task.chunk), task.settings
        resynthesize = settings.mode is Mode.RESYNTHESIZE
        share, weights = float(resynthesize), self.tracked[rows].astype(np.float64)
        answers = {name: share * weights[:, self._parts[name].columns] for name in regions}
        if self._answers is None or not regions:
            return answers
        first, last = (int(i) for i in self.chunks.grid_ranges[task.chunk])
        times = self.clip.times[slice(*task.near)]
        edited = self.grid[first:last] + to_grid(times, change, first, last)
        grid_range = first, last
        found = self._answers.to(regions, grid_range, edited, settings.naturalness)
        if not resynthesize:
            unedited = self._answers.to_tracked(regions, grid_range, settings.naturalness)
            found = {name: answer - unedited[name] for name, answer in found.items()}
        stacked = np.concatenate([found[name] for name in regions], axis=1)
        ends = np.cumsum([found[name].shape[1] for name in regions])[:-1]
        parts = np.split(from_grid(stacked, first, self.clip.times[rows]), ends, axis=1)
        for name, answer in zip(regions, parts, strict=True):
            if resynthesize:
                answers[name][:, : answer.shape[1]] = answer
            else:
                answers[name] = self._parts[name].whole(answer)
        return answers

    def _respect_take(
        self,
        part: Part,
        answer: Doubles,
        rows: slice,
        slow: Doubles,
        quick: Doubles,
        settings: Settings,
    ) -> None:
        """Add to the networks' answer what this take's face does, in place."""
        heard = part.heard_columns
        if self._answers is not None:
            before = self.controls[rows][:, heard].astype(np.float64)
            layer = self._last_layer(part.region.id, settings.naturalness)
            answer += layer.change(before, before + slow[:, heard])
        if part.reach is not None:
            answer += quick[:, part.own_columns] @ part.quick
        answer[:, part.idle] = 0.0

    def _combine(
        self,
        weights: Doubles,
        part: Part,
        answer: Doubles,
        influence: Doubles,
        rows: slice,
        settings: Settings,
    ) -> None:
        """Combine the networks' answer with the chunk's weights, within bounds."""
        columns = part.columns[part.have]
        answer, influence = answer[:, part.have], influence[:, part.have]
        old = weights[:, columns]
        if settings.mode is Mode.PRESERVE:
            answer = old + influence * answer
        new = np.clip(answer, np.minimum(old, 0.0), _upper(old, influence))
        weights[:, columns] = np.where(influence > 0, new, old)
        if "mouthClose" in part.region.channels:
            _couple(weights, self.tracked[rows], (influence > 0).any(axis=1))

    def _reach(
        self,
        weights: Doubles,
        part: Part,
        mine: Request,
        wanted: Doubles,
        influence: Doubles,
        settings: Settings,
    ) -> None:
        """Bring the region's own controls the rest of the way to what was asked for."""
        where = np.flatnonzero(mine.hold[:, part.own_columns].any(axis=1))
        if not len(where) or part.reach is None or settings.reach == 0:
            return
        columns = part.columns[part.have]
        hold = mine.hold[np.ix_(where, part.own_columns)]
        asked = hold > 0
        strength = np.where(asked, hold, hold.max(axis=1, keepdims=True))
        here = weights[where]
        influence = influence[np.ix_(where, part.have)]
        targets = wanted[np.ix_(where, part.own_columns)]
        tolerance = self._passing(part, weights, wanted, mine.hold)[where]
        goal = Goal(targets, settings.reach * strength, asked, tolerance)
        beyond = part.beyond(targets, hold)
        closed = self._are_closures(part, targets, asked)
        start = here[:, columns]
        lower, upper = self._within(part.bounds(beyond), start, influence)
        found = here.copy()
        found[:, columns] = part.reach(here, goal, upper, settings.naturalness, lower, closed)
        # What the take's own range cannot answer, a wider one has to.
        targets = goal.targets_from(part.lengths(here))
        missing = np.abs(targets - part.lengths(found)) - MISSING_MM - tolerance
        missing = np.where(asked, missing, 0.0).max(axis=1)
        short = np.flatnonzero((missing > 0) & (beyond < 1))
        if len(short):
            wider = part.bounds(np.minimum(beyond[short] + missing[short], 1.0))
            lower, upper = self._within(wider, start[short], influence[short])
            rest = Goal(targets, np.ones_like(targets), asked, tolerance).at(short)
            found[np.ix_(short, columns)] = part.reach(
                found[short], rest, upper, settings.naturalness, lower, closed[short], LAST
            )
        weights[np.ix_(where, columns)] = found[:, columns]

    @staticmethod
    def _within(
        bounds: tuple[Doubles, Doubles], start: Doubles, influence: Doubles
    ) -> tuple[Doubles, Doubles]:
        """Bounds (N, K) that leave alone what no edit influences."""
        still = influence == 0
        upper = np.where(still, start, np.minimum(bounds[1], _upper(start, influence)))
        return np.where(still, start, bounds[0]), upper

    def _passing(self, part: Part, weights: Doubles, wanted: Doubles, hold: Doubles) -> Doubles:
        """(N, C) mm: how much of what is missing comes and goes within a few frames.

        Curves that were smoothed one by one are not always those of a face. Where they cannot be
        met together but by a twitch, they need not be.
        """
        own = part.own_columns
        missing = hold[:, own] * (wanted[:, own] - part.lengths(weights))
        passing = missing - smoothed(missing, QUICK * self.clip.rate)
        tolerance: Doubles = TWITCH * np.abs(passing)
        return tolerance

    def _are_closures(self, part: Part, targets: Doubles, asked: Bools) -> Bools:
        """(N,) the frames on which the lips are asked to shut."""
        if LIP_OPENING not in part.own:
            return np.zeros(len(targets), np.bool_)
        lips = part.own.index(LIP_OPENING)
        closures: Bools = asked[:, lips] & (targets[:, lips] <= self.shut + 0.01)
        return closures


def _upper(old: Doubles, influence: Doubles) -> Doubles:
    """The largest weight: 1; a tracked value above 1 is reduced only as the edit fades in."""
    return 1.0 + np.maximum(old - 1.0, 0.0) * (1.0 - influence)


def _couple(weights: Doubles, tracked: Floats, where: Bools) -> None:
    """Keep mouthClose <= jawOpen, in place: mouthClose is a corrective, which tears any rig alone.

    If the take itself exceeds this, the same excess is allowed.
    """
    close, jaw = ARKIT_INDEX["mouthClose"], ARKIT_INDEX["jawOpen"]
    slack = np.maximum(tracked[:, close].astype(np.float64) - tracked[:, jaw], 0.0)
    limit = np.minimum(weights[:, close], weights[:, jaw] + slack)
    weights[where, close] = limit[where]
