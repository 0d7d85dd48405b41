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
from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_INDEX, LIP_OPENING
from faceedit_app.core.regions import OPTIONAL_REGIONS, REGIONS
from faceedit_app.core.resample import grid_length, to_grid
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edits.dividing import divided
from faceedit_app.editing.edits.edit import Edit
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.solving.accompanying import across
from faceedit_app.editing.solving.answerable import BY_REGION, find_lacks, without
from faceedit_app.editing.solving.bridging import Nearby
from faceedit_app.editing.solving.channel_edits import AnyTask, ChannelEdits, ChannelTask
from faceedit_app.editing.solving.chunks import Chunks, ChunkTask
from faceedit_app.editing.solving.closing import Closing
from faceedit_app.editing.solving.companions import Companions
from faceedit_app.editing.solving.fills import Fills
from faceedit_app.editing.solving.giving_way import firmness
from faceedit_app.editing.solving.network_answers import NetworkAnswers
from faceedit_app.editing.solving.recent import Recent
from faceedit_app.editing.solving.request import Request, active, request
from faceedit_app.editing.solving.rounding import rounded
from faceedit_app.editing.solving.sideways import Sideways
from faceedit_app.editing.solving.solved_regions import SolvedRegions
from faceedit_app.editing.solving.start import Start, Starts
from faceedit_app.editing.solving.take_regions import BEYOND, TakeRegion
from faceedit_app.editing.solving.take_statistics import IDLE, Sample
from faceedit_app.formats.take import LostRows

if TYPE_CHECKING:  # the window is there before the networks
    from faceedit_app.networks.engine import Engine

# Chunks that the statistics of a take are measured on: 12 are 100 s.
SAMPLED = 12
# Answers to curves that are kept for edits of channels.
REMEMBERED_CHUNKS = 6
# Seconds of standard deviation of the Gaussian that divides a request into slow and quick.
QUICK = 0.04
# The take's closed lips: this percentile of its opening, if that is less than so many mm; else the
# opening of closed lips in other performances.
_SHUT_PERCENTILE, _SHUT_MOST, _SHUT = 2.0, 2.2, 1.15


@dataclass(frozen=True)
class Patch:
    """A chunk's result: `asked` (N, C) mm, `weights` (N, 52), `controls` (N, C) mm.

    `rotations` are (N, 9) radians, or None; edits of curves started from `started` (N, C) mm.
    """

    asked: Floats
    weights: Floats
    controls: Floats
    rotations: Floats | None
    started: Floats


class Solver:
    """Computes the chunks of one take on one rig.

    Args:
        clip: the take as tracked.
        rig: the character that the controls are measured on.
        engine: the engine; None leaves all the work to reach, while no model is loaded.
    """

    def __init__(self, clip: Clip, rig: Rig, engine: Engine | None) -> None:
        self.clip = clip
        tracked = clip.arkit_weights()
        # Column by column in memory, as the arrays of all that is solved: sums over columns and
        # lookups of some of them are several times as fast.
        self.tracked = np.asfortranarray(tracked)
        self._rig = rig
        self._theirs: Rig | None = None
        self._channels = ChannelEdits(clip, self.tracked)
        self.distances = rig.arkit_distances
        self._missing = frozenset(rig.missing_controls)
        self.controls = self.distances.measure(tracked)
        self.medians = np.median(self.controls, axis=0).astype(np.float64)
        self.grid = to_grid(clip.times, self.controls, 0, grid_length(clip.times))
        opening = self.controls[:, CONTROL_INDEX[LIP_OPENING]]
        self._fills = Fills(clip, self.tracked, opening, self.distances.measure)
        self._starts = Starts(clip, self.tracked, self.controls, self.distances, self._fills)
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
        self.chunks = Chunks(clip, len(self.grid), scale, context, self._fills.reads)
        may = present if "jawOpen" in present else present - {"mouthClose"}
        self._sample = self._measure()
        across_the_face = [region for region in OPTIONAL_REGIONS if region.is_sideways]
        by_reach = [region for region in OPTIONAL_REGIONS if not region.is_sideways]
        self._parts = {
            region.id: TakeRegion(region, engine, self.distances, may, self._missing, self._sample)
            for region in (*by_reach, *REGIONS)
        }
        self._sideways = [
            Sideways(region, self.distances, may, self._sample) for region in across_the_face
        ]
        self._companions = Companions(
            {part.own: part.control_covariance() for part in self._parts.values()}
        )
        lows, highs = zip(*(part.limits() for part in self._parts.values()), strict=True)
        self._low, self._high = np.max(lows, axis=0), np.min(highs, axis=0)
        for one in self._sideways:
            self._low[one.column], self._high[one.column] = one.limits
        moves = self._sample.high - self._sample.low > IDLE
        used = [c for c in self.clip.channels if moves[ARKIT_INDEX[c]]]
        self._across = across(used, self._sample.weights, self._sample.low, self.distances)
        networks = NetworkAnswers(
            engine, self.grid, self.chunks, self._parts, self._sampled, self._sample
        )
        self._regions = SolvedRegions(self._parts, networks, self.shut, QUICK * clip.rate)
        self.limits = self._limits()
        self._limit_arrays = np.array(self.limits).T[0], np.array(self.limits).T[1]
        self.use_character(self._theirs)

    def use_character(self, theirs: Rig | None) -> None:
        """Close lips and lids on the user's character from now on; the chunks change."""
        self._theirs = theirs
        self._bases = Recent[Patch](REMEMBERED_CHUNKS)
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

    def on(self, clip: Clip) -> Solver:
        """A solver of another clip, with the same rigs and engine."""
        solver = Solver(clip, self._rig, self.engine)
        solver.use_character(self._theirs)
        return solver

    def _measure(self) -> Sample:
        """The part of the take that its statistics are measured on."""
        times = self.clip.times
        weights, frames, curves = [], [], []
        self._sampled = self.chunks.spread(SAMPLED)
        for chunk in self._sampled:
            first, last = (int(i) for i in self.chunks.own_ranges[chunk])
            rows = self.chunks.slice(chunk)
            near = slice(max(rows.start - 3, 0), rows.stop + 3)
            weights.append(to_grid(times[near], self.tracked[near], first, last))
            frames.append(self.tracked[rows].astype(np.float64))
            curves.append(self.grid[first:last])
        return Sample(
            weights,
            frames,
            curves,
            low=self.tracked.min(axis=0).astype(np.float64),
            high=self.tracked.max(axis=0).astype(np.float64),
            shortest=self.controls.min(axis=0).astype(np.float64),
            longest=self.controls.max(axis=0).astype(np.float64),
            seconds=self.clip.duration,
        )

    def _limits(self) -> list[tuple[float, float]]:
        """The lowest and highest value of each control that a face, or this take, can have, mm.

        Without an engine the lowest is 0.
        """
        high = np.where(np.isfinite(self._high), self._high, self.distances.farthest)
        low = np.where(np.isfinite(self._low), self._low, 0.0)
        beyond = np.maximum(low - BEYOND * (high - low), 0.0)
        low = np.where(self.distances.least < 0, low, beyond)
        low = np.minimum(low, self.controls.min(axis=0))
        high = np.maximum(high, self.controls.max(axis=0))
        return list(zip(low.tolist(), high.tolist(), strict=True))

    def tasks(self, edits: Sequence[Edit], settings: Settings) -> dict[int, AnyTask]:
        """The tasks that answer edits, by chunk."""
        listening = {name: part.listens_to for name, part in self._parts.items()}
        listening |= {one.region.id: one.region.own for one in self._sideways}
        curves, channels = divided(edits)
        tasks = self.chunks.tasks(self._possible(curves), settings, listening)
        return self._channels.tasks(tasks, self._channels.possible(channels), self.chunks)

    def _possible(self, edits: Sequence[Edit]) -> Sequence[Edit]:
        """The edits without controls that the character lacks or the take cannot answer."""
        if not self._mute:
            return edits
        parts = (edit if edit.op in BY_REGION else without(edit, self._mute) for edit in edits)
        return [part for part in parts if part is not None]

    def find_some(self, lost: LostRows, edits: Sequence[Edit], until: float) -> bool:
        """Find some of the weights for `found` until a time of `time.perf_counter`.

        Returns:
            Whether all are found.
        """
        acting = active(divided(edits)[0])
        return self._fills.found(acting, lost.times(self.clip), until) is not None

    def found(self, lost: LostRows, edits: Sequence[Edit]) -> Floats:
        """(L, 52) what fills put in the rows without a face that they cover; else NaN."""
        found = self._fills.found(active(divided(edits)[0]), lost.times(self.clip))
        assert found is not None, "it has all the time"
        return found

    def started(self, edits: Sequence[Edit]) -> Floats:
        """(T, 52) the take that all edits but fills, retimes and neutral rests start from."""
        return self._fills.applied(active(divided(edits)[0]), slice(0, len(self.clip)))

    def closed_on_theirs(self, weights: Floats) -> Floats:
        """(N, 52) weights with lips and lids closed on the user's character, if there is one."""
        return weights if self._closing is None else rounded(self._closing(weights), weights)

    def moved(self, edits: Sequence[Edit], values: Floats) -> Floats:
        """(T,) values of the frames, such as confidence, at the moments that retimes show."""
        return self._fills.moved(active(divided(edits)[0]), values)

    def solve(self, task: AnyTask) -> Patch:
        """Compute one chunk."""
        return self._edit_channels(task) if isinstance(task, ChannelTask) else self._answered(task)

    def _edit_channels(self, task: ChannelTask) -> Patch:
        """Edit the channels of a chunk after its curves have been answered."""
        rows = self.chunks.slice(task.chunk)
        mine = self._base(task.chunk, dict(task.bases)[task.chunk])
        weights, rotations = self._channels.apply(task, rows, self._base)
        controls = self._starts.measured(weights, mine.weights, mine.controls)
        # Curves that nobody asked for go where the channels take them, and only there.
        moved = (weights != mine.weights).any(axis=1, keepdims=True)
        asked = np.where(moved & (mine.asked == mine.started), controls, mine.asked)
        return Patch(asked, weights, controls, rotations, mine.started)

    def _base(self, chunk: int, task: ChunkTask | None) -> Patch:
        """The answer to the curves of a chunk; the last ones are kept for further edits."""
        if task is None:
            rows = self.chunks.slice(chunk)
            tracked, turned = self.controls[rows], self._fills.turned((), rows, rows)
            return Patch(tracked, self.tracked[rows], tracked, turned, tracked)
        return self._bases.to(task, lambda: self._answered(task))

    def _answered(self, task: ChunkTask) -> Patch:
        """Answer the curves of one chunk."""
        rows, nearby = self.chunks.slice(task.chunk), self.chunks.nearby(task)
        inner, shown = nearby.inner, nearby.shown
        filled = self._starts.filled(task, nearby)
        asked = self._request(task, filled, nearby)
        mine = asked.at(inner)
        regions = (part.calmed(self._mute) for part in self._parts.values())
        start = self._starts.calmed(filled, task, nearby, regions)
        weights = start.weights[inner].astype(np.float64, order="F")
        influences = self._regions.influences(task, mine)
        if influences or any(mine.influence[:, one.column].any() for one in self._sideways):
            before = weights.copy(order="F")
            change = self._wanted_change(asked, start.curves, task, nearby)
            change = start.without_twitches(change, asked.calm, self.clip.rate)
            for one in self._sideways:
                one.move(weights, change[inner], mine.hold)
            self._regions.solve(task, inner, weights, start, change, mine, influences)
            if task.settings.mode is Mode.PRESERVE:
                for each in self._across:
                    each.join(weights, before, mine.hold, mine.calm)
        result = weights[shown].astype(np.float32)
        if self._closing is not None and task.settings.closes:
            share = {name: each[shown].max(axis=1) for name, each in influences.items()}
            result = self._closing(result, share)
        result = rounded(result, self.tracked[rows])
        controls = self._starts.measured(result, self.tracked[rows], self.controls[rows])
        turned = self._fills.turned(task.edits, nearby.frames, rows)
        asked_for, started = (
            curves[shown].astype(np.float32) for curves in (mine.curves, filled.curves[inner])
        )
        return Patch(asked_for, result, controls, turned, started)

    def _request(self, task: ChunkTask, filled: Start, nearby: Nearby) -> Request:
        """What the edits of a chunk ask for, on the frames near it."""
        return request(
            nearby.times,
            self.clip.rate,
            filled.curves,
            self.medians,
            task.edits,
            self._companions,
            self._limit_arrays,
            self._starts.recorded(nearby)[1].astype(np.float64),
            nearby.bridged.far,
        )

    def _wanted_change(
        self, asked: Request, tracked: Doubles, task: ChunkTask, nearby: Nearby
    ) -> Doubles:
        """(N, C) mm: the change that is asked for, limited to what faces do or this take does.

        Curves that nobody asked for take the most probable change, see `completing.py`.
        """
        low, high = np.minimum(self._low, tracked), np.maximum(self._high, tracked)
        wanted = np.minimum(np.maximum(asked.curves, low), high)
        lips = CONTROL_INDEX[LIP_OPENING]
        shut = np.minimum(self.shut, tracked[:, lips])
        wanted[:, lips] = np.maximum(wanted[:, lips], shut)
        change: Doubles = wanted - tracked
        for part in self._parts.values():
            own = part.own_columns
            if len(own) and not (part.is_optional and not asked.hold[:, own].any()):
                at = tracked[:, own], change[:, own]
                change[:, own] = self._completed(part, task, nearby, asked, *at)
        return change

    def _completed(
        self,
        part: TakeRegion,
        task: ChunkTask,
        nearby: Nearby,
        asked: Request,
        tracked: Doubles,
        change: Doubles,
    ) -> Doubles:
        """(N, C) mm: a change of a region's own curves, with that of those not asked for."""
        own = part.own_columns
        hold = asked.hold[:, own]
        filled = part.expectation.expected(change, firmness(change, hold, part.leaders))
        if part.completing is None or task.settings.mode is not Mode.PRESERVE or not hold.any():
            return filled
        firm = np.maximum(hold - asked.calm[:, own].max(axis=1, keepdims=True), 0.0)
        given = part.expectation.given(change, hold > 0)
        to = nearby.times, nearby.way
        return filled + part.completing.further(*to, tracked, filled, given, firm)
