"""From edits to weights: the networks' answer combined with the take, then reach.

The take is computed in chunks; see `chunks.py` for what a chunk's result depends on. So undo needs
no copies, an export has the same bytes whatever led to the edits, and moving an edit recomputes
only the chunks that it touches.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Bools, Doubles, Floats
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_INDEX, CONTROLS
from faceedit_app.core.regions import REGIONS, Region
from faceedit_app.core.resample import from_grid, grid_length, to_grid
from faceedit_app.core.rig import Distances, Rig
from faceedit_app.editing.edits.edit import Edit
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.solving.answerable import find_lacks, region_covariance, without
from faceedit_app.editing.solving.answers import Answers
from faceedit_app.editing.solving.chunks import Chunks, ChunkTask
from faceedit_app.editing.solving.closing import Closing
from faceedit_app.editing.solving.companions import Companions
from faceedit_app.editing.solving.reach import Goal, Reach
from faceedit_app.editing.solving.request import Request, region_influence, request

if TYPE_CHECKING:  # the window is there before the networks
    from faceedit_app.networks.engine import Engine

# Changed weights are multiples of this. The last bits of a matrix product depend on the processor;
# rounded, nearly all weights are the same on every one. It moves a jaw by less than a micrometre.
DECIMALS = 5
# How far beyond the range seen in training a curve is followed, as a share of that range.
BEYOND = 0.1


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
        self._rig = rig
        self._theirs: Rig | None = None
        self.distances = rig.arkit_distances
        self._missing = frozenset(rig.missing_controls)
        self.controls = self.distances.measure(self.tracked)
        self.medians = np.median(self.controls, axis=0).astype(np.float64)
        self.grid = to_grid(clip.times, self.controls, 0, grid_length(clip.times))
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
        self._parts = {
            region.id: _Part(region, engine, self.distances, may, self._missing)
            for region in REGIONS
        }
        self._companions = Companions(
            {part.own: part.control_covariance() for part in self._parts.values()}
        )
        lows, highs = zip(*(part.limits() for part in self._parts.values()), strict=True)
        self._low, self._high = np.max(lows, axis=0), np.min(highs, axis=0)
        self._answers = Answers(engine, self.grid) if engine else None
        self.limits = self._limits()
        self.use_character(self._theirs)

    def use_character(self, theirs: Rig | None) -> None:
        """Close lips and lids on the user's character from now on; the chunks change."""
        self._theirs = theirs
        self._closing = (
            Closing(
                self._rig,
                theirs,
                frozenset(self.clip.channels),
                {name: model.description.covariance for name, model in self.engine.models.items()}
                if self.engine
                else None,
            )
            if theirs is not None
            else None
        )

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
        wanted = self._believable(asked.curves, tracked)
        influences = {}
        for name, part in self._parts.items():
            influence = region_influence(mine, part.listens_to)
            if name in task.regions:
                influence = np.ones_like(influence)
            if influence.any():
                influences[name] = influence
        answers = self._answer(task, tuple(influences), wanted - tracked)
        for name, influence in influences.items():
            self._combine(weights, self._parts[name], answers[name], influence, rows, settings)
        for name in influences:
            self._reach(weights, self._parts[name], mine, wanted[inner], settings)
        result = weights.astype(np.float32)
        if self._closing is not None and settings.closes:
            result = self._closing(result, influences)
        result = _rounded(result, self.tracked[rows])
        controls = self.distances.measure(result)
        # The last bits of a matrix product depend on the number of frames.
        same = (result == self.tracked[rows]).all(axis=1)
        controls[same] = self.controls[rows][same]
        return Patch(mine.curves.astype(np.float32), result, controls)

    def _believable(self, curves: Doubles, tracked: Doubles) -> Doubles:
        """(N, C) mm: the curves, limited to what faces do or this take already does."""
        low, high = np.minimum(self._low, tracked), np.maximum(self._high, tracked)
        believable: Doubles = np.minimum(np.maximum(curves, low), high)
        return believable

    def _answer(
        self, task: ChunkTask, regions: tuple[str, ...], change: Doubles
    ) -> dict[str, Doubles]:
        """(N, K) by region: what the networks add to (preserve) or replace (resynthesize).

        Args:
            change: (N', C) mm by which the controls near the task differ from the take.
        """
        rows, settings = self.chunks.slice(task.chunk), task.settings
        resynthesize = settings.mode is Mode.RESYNTHESIZE
        if self._answers is None:
            share, tracked = float(resynthesize), self.tracked[rows].astype(np.float64)
            return {name: share * tracked[:, self._parts[name].columns] for name in regions}
        if not regions:
            return {}
        first, last = (int(i) for i in self.chunks.grid_ranges[task.chunk])
        times = self.clip.times[slice(*task.near)]
        edited = self.grid[first:last] + to_grid(times, change, first, last)
        grid_range = first, last
        answers = self._answers.to(regions, grid_range, edited, settings.naturalness)
        if not resynthesize:
            unedited = self._answers.to_tracked(regions, grid_range, settings.naturalness)
            answers = {name: answer - unedited[name] for name, answer in answers.items()}
        stacked = np.concatenate([answers[name] for name in regions], axis=1)
        ends = np.cumsum([answers[name].shape[1] for name in regions])[:-1]
        parts = np.split(from_grid(stacked, first, self.clip.times[rows]), ends, axis=1)
        return dict(zip(regions, parts, strict=True))

    def _combine(
        self,
        weights: Doubles,
        part: _Part,
        answer: Doubles,
        influence: Doubles,
        rows: slice,
        settings: Settings,
    ) -> None:
        """Combine the networks' answer with the chunk's weights, within bounds."""
        columns = part.columns[part.have]
        answer = answer[:, part.have]
        old = weights[:, columns]
        if settings.mode is Mode.PRESERVE:
            answer = old + influence[:, None] * answer
        new = np.clip(answer, np.minimum(old, 0.0), _upper(old, influence))
        weights[:, columns] = np.where(influence[:, None] > 0, new, old)
        if "mouthClose" in part.region.channels:
            _couple(weights, self.tracked[rows], influence > 0)

    def _reach(
        self, weights: Doubles, part: _Part, mine: Request, wanted: Doubles, settings: Settings
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
        influence = region_influence(mine, part.listens_to)[where]
        goal = Goal(wanted[np.ix_(where, part.own_columns)], settings.reach * strength, asked)
        upper = _upper(here[:, columns], influence)
        weights[np.ix_(where, columns)] = part.reach(here, goal, upper, settings.naturalness)


def _rounded(weights: Floats, tracked: Floats) -> Floats:
    """(N, 52) float32: changed weights rounded, the others with the bits of the take."""
    rounded = np.round(weights.astype(np.float64), DECIMALS).astype(np.float32)
    result: Floats = np.where(weights == tracked, tracked, rounded)
    jaw, lips = ARKIT_INDEX["jawOpen"], ARKIT_INDEX["mouthClose"]
    # Lips that are no more closed than the jaw is open stay so.
    over = (result[:, lips] > result[:, jaw]) & (weights[:, lips] <= weights[:, jaw])
    result[over, lips] = result[over, jaw]
    return result


class _Part:
    """What the solver needs to know about a region, computed once.

    Attributes:
        own: ids of the controls that it moves, in columns `own_columns`; the upper face has none.
        listens_to: ids of the controls that its networks or reach answer.
        columns: (K,) its channels among the 52.
        have: positions of the channels that may change, because the take has them.
        reach: brings its own controls to a goal; None if it has none or no channel may change.
    """

    def __init__(
        self,
        region: Region,
        engine: Engine | None,
        distances: Distances,
        may: frozenset[str],
        missing: frozenset[str],
    ) -> None:
        self.region = region
        self._model = engine.models[region.id].description if engine else None
        self.own = tuple(name for name in region.own if name not in missing)
        self.own_columns = np.array([CONTROL_INDEX[name] for name in self.own], np.intp)
        self._distances = distances.select(self.own_columns)
        heard = self._model.controls if self._model else region.controls
        self.listens_to = tuple(dict.fromkeys((*heard, *self.own)))
        self.columns = np.array([ARKIT_INDEX[c] for c in region.channels], np.intp)
        self.have = np.array([i for i, c in enumerate(region.channels) if c in may], np.intp)
        self._covariance = region_covariance(region, engine)
        names = [region.channels[i] for i in self.have]
        both = {"mouthClose", "jawOpen"} <= set(names)
        coupled = (names.index("mouthClose"), names.index("jawOpen")) if both else None
        self.reach: Reach | None = None
        if len(self.own) and len(self.have):
            covariance = self._covariance[np.ix_(self.have, self.have)]
            self.reach = Reach(self._distances, self.columns[self.have], covariance, coupled)

    def control_covariance(self) -> Doubles:
        """(C, C) mm²: the covariance of its own controls, linearised at rest."""
        rest = np.zeros((1, len(ARKIT_INDEX)), np.float32)
        slopes = self._distances.jacobian(rest)[1][0][:, self.columns].astype(np.float64)
        covariance: Doubles = slopes @ self._covariance @ slopes.T
        return covariance

    def limits(self) -> tuple[Doubles, Doubles]:
        """(C,) mm: the lowest and highest values to which its controls are followed."""
        low, high = np.full(len(CONTROLS), -np.inf), np.full(len(CONTROLS), np.inf)
        if self._model is not None:
            heard = [CONTROL_INDEX[control] for control in self._model.controls]
            slack = BEYOND * (self._model.high - self._model.low)
            low[heard], high[heard] = self._model.low, self._model.high + slack
        return low, high


def _upper(old: Doubles, influence: Doubles) -> Doubles:
    """The largest weight: 1; a tracked value above 1 is reduced only as the edit fades in."""
    return 1.0 + np.maximum(old - 1.0, 0.0) * (1.0 - influence[:, None])


def _couple(weights: Doubles, tracked: Floats, where: Bools) -> None:
    """Keep mouthClose <= jawOpen, in place: mouthClose is a corrective, which tears any rig alone.

    If the take itself exceeds this, the same excess is allowed.
    """
    close, jaw = ARKIT_INDEX["mouthClose"], ARKIT_INDEX["jawOpen"]
    slack = np.maximum(tracked[:, close].astype(np.float64) - tracked[:, jaw], 0.0)
    limit = np.minimum(weights[:, close], weights[:, jaw] + slack)
    weights[where, close] = limit[where]
