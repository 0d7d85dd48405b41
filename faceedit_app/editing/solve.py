"""From edits to weights: the networks' answer combined with the take, then reach.

Edits that can influence the same frames form an island, and an island's result depends on the
take, on the edits near it and on the settings, on nothing else: not on the order in which the
user got there. So undo needs no copies, an export has the same bytes however an edit came to
be, and moving one edit recomputes one island only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.clip import Clip
from faceedit_app.core.regions import CONTROL_INDEX, CONTROLS, REGIONS, Region
from faceedit_app.core.resample import GRID_RATE, from_grid, grid_length, to_grid
from faceedit_app.core.rig import Rig
from faceedit_app.editing.companions import follow
from faceedit_app.editing.edit import Edit
from faceedit_app.editing.reach import Goal, reach
from faceedit_app.editing.request import (
    Request,
    active,
    affected,
    region_influence,
    request,
    smoothing,
)

if TYPE_CHECKING:  # torch comes with it, and the window is there before torch
    from faceedit_app.networks.engine import Engine

Array = NDArray[np.float64]

# How far above the range seen in training a request is followed, as a share of that range.
BEYOND = 0.1
# Seconds by which a frame may stand outside a time range and still count as on its edge.
SLACK = 1e-9


class Mode(StrEnum):
    """How the networks' answer is combined with the take."""

    PRESERVE = "preserve"  # take + N(asked) - N(tracked): what no edit reaches stays as it was
    RESYNTHESIZE = "resynthesize"  # N(asked), as in the paper, over the whole take


@dataclass(frozen=True)
class Settings:
    """How edits are answered.

    Attributes:
        mode: see `Mode`.
        naturalness: 0 = regressor alone (obeys), 1 = full system (believable).
        reach: 0 = what the networks answer, 1 = all the way to what was asked.
    """

    mode: Mode = Mode.PRESERVE
    naturalness: float = 1.0
    reach: float = 1.0

    def __post_init__(self) -> None:
        if not 0 <= self.naturalness <= 1:
            raise ValueError(f"naturalness {self.naturalness:g}: must be from 0 to 1")


@dataclass(frozen=True)
class Island:
    """A run of frames that edits change together.

    Attributes:
        rows: the frames.
        settings: how the edits are answered.
        edits: those that matter to the frames, in the user's order.
    """

    rows: slice
    settings: Settings
    edits: tuple[Edit, ...]

    @property
    def key(self) -> tuple[object, ...]:
        """Islands with equal keys have equal results."""
        return (self.rows.start, self.rows.stop, self.settings, self.edits)


@dataclass(frozen=True)
class Patch:
    """An island's result: `asked` (N, 8) mm, `weights` (N, 52), `controls` (N, 8) mm."""

    asked: NDArray[np.float32]
    weights: NDArray[np.float32]
    controls: NDArray[np.float32]


class Solver:
    """Computes islands of one take on one rig.

    Args:
        clip: the take as tracked.
        rig: the character that the controls are measured on.
        engine: the networks; None leaves all the work to reach (while they are loading, or
            where no model can be had).
    """

    def __init__(self, clip: Clip, rig: Rig, engine: Engine | None) -> None:
        self.clip, self.rig, self.engine = clip, rig, engine
        self.tracked = clip.arkit_weights()
        self.distances = rig.arkit_distances
        self.controls = self.distances.measure(self.tracked)
        self.medians = np.median(self.controls, axis=0).astype(np.float64)
        self.grid = to_grid(clip.times, self.controls, 0, grid_length(clip.times))
        self._present = frozenset(clip.channels)

    def islands(self, edits: Sequence[Edit], settings: Settings) -> list[Island]:
        """Group edits into islands, in order of time."""
        edits = active(edits)
        if not edits:
            return []
        if settings.mode is Mode.RESYNTHESIZE:
            return [Island(slice(0, len(self.clip)), settings, tuple(edits))]
        spans = np.array([affected(edit) for edit in edits])
        runs: list[list[float]] = []
        for first, last in spans[np.argsort(spans[:, 0], kind="stable")].tolist():
            if runs and first <= runs[-1][1] + 2 * SLACK:
                runs[-1][1] = max(runs[-1][1], last)
            else:
                runs.append([first, last])
        sights = np.array([_sight([edit]) for edit in edits])
        islands = []
        for first, last in runs:
            ends = np.searchsorted(self.clip.times, (first - SLACK, last + SLACK))
            rows = slice(int(ends[0]), int(ends[1]))
            if rows.start < rows.stop:
                near = self._near(spans, sights, first, last)
                islands.append(Island(rows, settings, tuple(edits[i] for i in near)))
        return islands

    def _near(self, spans: Array, sights: Array, first: float, last: float) -> list[int]:
        """Which edits the networks can see from a run of seconds, in the user's order.

        Args:
            spans: (E, 2) seconds within which each edit can change the face.
            sights: (E,) seconds beyond its span that each edit reads the curves.
        """
        margin = (self._context + 4) / GRID_RATE
        first, last = first - margin, last + margin
        seen = (spans[:, 0] <= last) & (spans[:, 1] >= first)
        sight = float(sights[seen].max())
        if sight > 0:
            seen = (spans[:, 0] <= last + sight) & (spans[:, 1] >= first - sight)
        return np.flatnonzero(seen).tolist()

    @property
    def _context(self) -> int:
        return self.engine.context if self.engine else 0

    def solve(self, island: Island) -> Patch:
        """Compute one island."""
        rows, settings, edits = island.rows, island.settings, island.edits
        window = self._window(rows)
        near = slice(*self._rows_of(window, _sight(edits)))
        asked = request(
            self.clip.times[near],
            self.clip.rate,
            self.controls[near].astype(np.float64),
            self.medians,
            edits,
        )
        inner = slice(rows.start - near.start, rows.stop - near.start)
        mine = Request(asked.curves[inner], asked.hold[inner], asked.influence[inner])
        weights = self.tracked[rows].astype(np.float64)
        for region in REGIONS:
            influence = self._influence(mine, region, settings)
            if influence.any():
                answer = self._answer(region, asked, near, window, rows, settings)
                self._combine(weights, region, answer, influence, rows, settings)
        for region in REGIONS:
            self._reach(weights, region, mine, rows, settings)
        result = weights.astype(np.float32)
        return Patch(mine.curves.astype(np.float32), result, self.distances.measure(result))

    def _window(self, rows: slice) -> tuple[int, int]:
        """Grid frames that the networks need to answer for `rows`."""
        scale = self.engine.scale if self.engine else 1
        first = int(np.floor(self.clip.times[rows.start] * GRID_RATE)) - 2 - self._context
        last = int(np.ceil(self.clip.times[rows.stop - 1] * GRID_RATE)) + 3 + self._context
        return max(first // scale * scale, 0), min(last, len(self.grid))

    def _rows_of(self, window: tuple[int, int], sight: float) -> tuple[int, int]:
        """The clip's frames that a window of grid frames is computed from."""
        edges = ((window[0] - 1) / GRID_RATE - sight, window[1] / GRID_RATE + sight)
        first, last = np.searchsorted(self.clip.times, edges)
        return max(int(first) - 1, 0), min(int(last) + 1, len(self.clip))

    def _influence(self, mine: Request, region: Region, settings: Settings) -> Array:
        """(N,) where the region may change: all frames of an edited region when resynthesizing."""
        influence = region_influence(mine, self._listens_to(region))
        if settings.mode is Mode.RESYNTHESIZE and influence.any():
            return np.ones_like(influence)
        return influence

    def _listens_to(self, region: Region) -> tuple[str, ...]:
        return self.engine.models[region.id].controls if self.engine else region.controls

    def _channels(self, region: Region) -> NDArray[np.intp]:
        """Positions in the region of the channels that may change: the source has a column."""
        may = self._present if "jawOpen" in self._present else self._present - {"mouthClose"}
        return np.array([i for i, c in enumerate(region.channels) if c in may], np.intp)

    def _answer(
        self,
        region: Region,
        asked: Request,
        near: slice,
        window: tuple[int, int],
        rows: slice,
        settings: Settings,
    ) -> Array:
        """(N, K): what the networks add (preserve) or put (resynthesize) on the island's rows."""
        if self.engine is None:
            if settings.mode is Mode.RESYNTHESIZE:
                return self.tracked[rows][:, _columns(region)].astype(np.float64)
            return np.zeros((rows.stop - rows.start, len(region.channels)))
        tracked = self.grid[window[0] : window[1]]
        change = self._wanted(asked, self.controls[near], region) - self.controls[near]
        edited = tracked + to_grid(self.clip.times[near], change, *window)
        times = self.clip.times[rows]
        if settings.mode is Mode.RESYNTHESIZE:
            answer = self.engine.answer(region.id, edited[None], settings.naturalness)
            return from_grid(answer[0], window[0], times)
        answers = self.engine.answer(region.id, np.stack([tracked, edited]), settings.naturalness)
        return from_grid(answers[1] - answers[0], window[0], times)

    def _wanted(self, asked: Request, tracked: NDArray[np.float32], region: Region) -> Array:
        """(N, 8) mm: the curves that a region should show, companions and bounds included."""
        change = asked.curves - tracked
        followed = follow(change, asked.hold, region.controls, self._control_covariance(region))
        return self._believable(tracked + followed, tracked, region)

    def _control_covariance(self, region: Region) -> Array:
        """(C, C) mm² how the region's controls vary together, linearised at rest."""
        rest = np.zeros((1, len(ARKIT_INDEX)), np.float32)
        mine = self.distances.select([CONTROL_INDEX[c] for c in region.controls])
        slopes = mine.jacobian(rest)[1][0][:, _columns(region)].astype(np.float64)
        covariance: Array = slopes @ self._covariance(region) @ slopes.T
        return covariance

    def _believable(self, curves: Array, tracked: NDArray[np.float32], region: Region) -> Array:
        """Keep a region's curves within what faces do, or what this face already did."""
        if self.engine is None:
            return curves
        model = self.engine.models[region.id]
        bounded = curves.copy()
        for i, control in enumerate(model.controls):
            c = CONTROL_INDEX[control]
            slack = BEYOND * (model.high[i] - model.low[i])
            low = np.minimum(model.low[i], tracked[:, c])
            high = np.maximum(model.high[i] + slack, tracked[:, c])
            bounded[:, c] = np.clip(curves[:, c], low, high)
        return bounded

    def _combine(
        self,
        weights: Array,
        region: Region,
        answer: Array,
        influence: Array,
        rows: slice,
        settings: Settings,
    ) -> None:
        """Put the networks' answer into the island's weights, within bounds."""
        have = self._channels(region)
        columns = _columns(region)[have]
        answer = answer[:, have]
        old = weights[:, columns]
        if settings.mode is Mode.PRESERVE:
            answer = old + influence[:, None] * answer
        new = np.clip(answer, np.minimum(old, 0.0), self._upper(old, influence))
        weights[:, columns] = np.where(influence[:, None] > 0, new, old)
        if "mouthClose" in region.channels:
            _couple(weights, self.tracked[rows], influence > 0)

    @staticmethod
    def _upper(old: Array, influence: Array) -> Array:
        """Largest weight: 1, but a tracked value above 1 is let go of only as the edit fades in."""
        return 1.0 + np.maximum(old - 1.0, 0.0) * (1.0 - influence[:, None])

    def _reach(
        self, weights: Array, region: Region, mine: Request, rows: slice, settings: Settings
    ) -> None:
        """Bring the region's own controls the rest of the way to what was asked."""
        # The brows have none: they move no control.
        controls = np.array([i for i, c in enumerate(CONTROLS) if c.region == region.id], np.intp)
        where = np.flatnonzero(mine.hold[:, controls].any(axis=1))
        have = self._channels(region)
        if not len(where) or not len(have) or settings.reach == 0:
            return
        tracked = self.controls[rows][where]
        there = Request(mine.curves[where], mine.hold[where], mine.influence[where])
        goals = self._wanted(there, tracked, region)[:, controls]
        columns = _columns(region)[have]
        names = [region.channels[i] for i in have]
        coupled = (
            (names.index("mouthClose"), names.index("jawOpen"))
            if {"mouthClose", "jawOpen"} <= set(names)
            else None
        )
        hold = mine.hold[np.ix_(where, controls)]
        asked = hold > 0
        strength = np.where(asked, hold, hold.max(axis=1, keepdims=True))
        old = weights[np.ix_(where, columns)]
        influence = region_influence(mine, region.controls)[where]
        weights[np.ix_(where, columns)] = reach(
            self.distances.select(controls),
            weights[where],
            columns,
            Goal(goals, settings.reach * strength, asked),
            self._covariance(region)[np.ix_(have, have)],
            self._upper(old, influence),
            coupled,
            settings.naturalness,
        )

    def _covariance(self, region: Region) -> Array:
        """(K, K) how the region's channels vary together."""
        if self.engine is None:
            return 0.04 * np.eye(len(region.channels))
        return self.engine.models[region.id].covariance


def _sight(edits: Sequence[Edit]) -> float:
    """Seconds beyond their own reach that edits read the take: a Gaussian ends at four sigma."""
    return 4.0 * max(map(smoothing, edits), default=0.0)


def _columns(region: Region) -> NDArray[np.intp]:
    return np.array([ARKIT_INDEX[c] for c in region.channels], np.intp)


def _couple(weights: Array, tracked: NDArray[np.float32], where: NDArray[np.bool_]) -> None:
    """Keep mouthClose <= jawOpen, in place: alone, the corrective tears any rig.

    Where the take itself exceeds it, by as much as the take does.
    """
    close, jaw = ARKIT_INDEX["mouthClose"], ARKIT_INDEX["jawOpen"]
    slack = np.maximum(tracked[:, close].astype(np.float64) - tracked[:, jaw], 0.0)
    limit = np.minimum(weights[:, close], weights[:, jaw] + slack)
    weights[where, close] = limit[where]
