"""What the networks answer to the chunks of one take, and what the take adds to their answers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.arrays import Doubles, Times
from faceedit_app.core.resample import OffGrid, to_grid
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.solving.answers import Answers
from faceedit_app.editing.solving.chunks import Chunks, ChunkTask
from faceedit_app.editing.solving.last_layer import LastLayer
from faceedit_app.editing.solving.parts import Part, Sample
from faceedit_app.editing.solving.recent import Recent
from faceedit_app.editing.solving.residual import Residuals
from faceedit_app.editing.solving.start import Start

if TYPE_CHECKING:  # the window is there before the networks
    from faceedit_app.networks.engine import Engine

# Layers between the two ends of naturalness that are kept: what is computed from one is recognised
# by it.
MIXED = 6


class NetworkAnswers:
    """The networks' answers, the take's own last layer, and the residuals of its poses.

    Args:
        engine: the networks; None = there are none yet, and nothing is answered.
        times: (T,) seconds of the take's frames.
        grid: (M, C) mm: the take's controls as tracked, on the networks' grid.
        chunks: the take's chunks.
        parts: what is known about each region, by its id.
        sampled, sample: the chunks that the last layers are fitted to, and what they hold.
    """

    def __init__(
        self,
        engine: Engine | None,
        times: Times,
        grid: Doubles,
        chunks: Chunks,
        parts: Mapping[str, Part],
        sampled: Sequence[int],
        sample: Sample,
    ) -> None:
        self._engine, self._times, self._grid, self._chunks = engine, times, grid, chunks
        self._parts, self._sampled, self._sample = parts, sampled, sample
        self._answers = Answers(engine, grid) if engine else None
        self._layers: dict[tuple[str, float], LastLayer] = {}
        self._mixed = Recent[LastLayer](MIXED)
        self._residuals = Residuals()
        for name in engine.models if engine else ():
            self.last_layer(name, Settings())  # now, so that the first drag need not wait for it

    def last_layer(self, region: str, settings: Settings) -> LastLayer | None:
        """The take's own last layer of a region; None if it has no part in the answer."""
        if self._engine is None or settings.mode is Mode.RESYNTHESIZE:
            return None
        if region not in self._engine.models:
            return None
        return self._fitted_layer(region, settings.naturalness, self._engine)

    def _fitted_layer(self, region: str, naturalness: float, engine: Engine) -> LastLayer:
        """Linear in naturalness, as the answers are."""
        key = region, naturalness
        if 0 < naturalness < 1:
            plain, believable = (self._fitted_layer(region, end, engine) for end in (0.0, 1.0))
            return self._mixed.to(key, lambda: plain.towards(believable, naturalness))
        if key not in self._layers:
            answers = []
            for chunk in self._sampled:
                own = self._chunks.own_ranges[chunk]
                first, last = (int(i) for i in self._chunks.grid_ranges[chunk])
                answer = engine.answer(region, self._grid[first:last], naturalness)
                answers.append(answer[own[0] - first : own[1] - first])
            self._layers[key] = self._parts[region].last_layer(answers, self._sample)
        return self._layers[key]

    def begin(
        self,
        task: ChunkTask,
        regions: tuple[str, ...],
        begin: Start,
        change: Doubles,
    ) -> Callable[[str], tuple[Doubles, Doubles]]:
        """Begin to answer a chunk: other cores go on while the first regions are used.

        Args:
            regions: in the order in which their answers will be needed.
            begin: what the edits start from, on the N' frames near the task.
            change: (N', C) mm by which the controls that are asked for differ from it.

        Returns:
            What gives for a region, once, (N, M) what the networks add to (preserve) or replace
            (resynthesize), and (N, K) how the pose's residual changes, see `residual.py`.
        """
        rows, settings = self._chunks.slice(task.chunk), task.settings
        near = task.near[0]
        before = begin.weights[rows.start - near : rows.stop - near].astype(np.float64)
        heard = tuple(name for name in regions if not self._parts[name].is_optional)
        if self._answers is None or not heard:
            return partial(self._unanswered, before=before, mode=settings.mode)
        first, last = (int(i) for i in self._chunks.grid_ranges[task.chunk])
        times, grid_range = self._times[slice(*task.near)], (first, last)
        start = begin.curves
        on_grid = self._grid[first:last] if begin.as_tracked else to_grid(times, start, first, last)
        edited = on_grid + to_grid(times, change, first, last)
        naturalness = settings.naturalness
        begun = self._answers.begin(heard, grid_range, edited, naturalness)
        off_grid = OffGrid(last - first, first, self._times[rows])
        unedited: dict[str, Doubles] = {}
        if settings.mode is Mode.PRESERVE:
            unedited = (
                self._answers.to_tracked(heard, grid_range, naturalness)
                if begin.as_tracked
                else self._answers.to(heard, grid_range, on_grid, naturalness)
            )

        def answer(name: str) -> tuple[Doubles, Doubles]:
            lone, still = self._unanswered(name, before, settings.mode)
            if name not in begun:
                return lone, still
            if name not in unedited:
                found = off_grid(begun[name]())
                lone[:, : found.shape[1]] = found
                return lone, still
            part, layer = self._parts[name], self.last_layer(name, settings)
            if layer is None or not len(part.own):
                return off_grid(begun[name]() - unedited[name]), still

            def lacking() -> Doubles:
                weights = to_grid(times, begin.weights[:, part.columns], first, last)
                return weights - part.whole(unedited[name])

            key = (task.chunk, name, naturalness) if begin.as_tracked else None
            now = on_grid[:, part.layer_columns]
            by = (edited - on_grid)[:, part.layer_columns]
            exchange = self._residuals.exchange(key, layer, lacking, now, by)
            added = begun[name]() - unedited[name]
            both = off_grid(np.concatenate([added, exchange], axis=1))
            return both[:, : added.shape[1]], both[:, added.shape[1] :]

        return answer

    def _unanswered(self, name: str, before: Doubles, mode: Mode) -> tuple[Doubles, Doubles]:
        """What stands in for the networks' answer if there is none; see `begin`."""
        part = self._parts[name]
        still = np.zeros((len(before), len(part.columns)))
        if mode is Mode.RESYNTHESIZE and not part.is_optional:
            return before[:, part.columns], still
        return np.zeros((len(before), len(part.region.channels))), still
