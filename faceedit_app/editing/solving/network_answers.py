"""What the networks answer to the chunks of one take, and what the take adds to their answers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.arrays import Doubles, Times
from faceedit_app.core.resample import from_grid, to_grid
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

    def answer(
        self,
        task: ChunkTask,
        regions: tuple[str, ...],
        begin: Start,
        change: Doubles,
    ) -> tuple[dict[str, Doubles], dict[str, Doubles]]:
        """(N, K) by region: what the networks add to (preserve) or replace (resynthesize).

        Args:
            begin: what the edits start from, on the N' frames near the task.
            change: (N', C) mm by which the controls that are asked for differ from it.

        Returns:
            The answers, and by how much the poses' residuals change, see `residual.py`.
        """
        rows, settings = self._chunks.slice(task.chunk), task.settings
        resynthesize = settings.mode is Mode.RESYNTHESIZE
        first, last = task.near
        before = begin.weights[rows.start - first : rows.stop - first].astype(np.float64)
        answers = {name: self._unanswered(name, before, resynthesize) for name in regions}
        still = {n: np.zeros((len(answers[n]), len(self._parts[n].columns))) for n in regions}
        regions = tuple(name for name in regions if not self._parts[name].is_optional)
        if self._answers is None or not regions:
            return answers, still
        first, last = (int(i) for i in self._chunks.grid_ranges[task.chunk])
        times = self._times[slice(*task.near)]
        same = begin.as_tracked
        start = self._grid[first:last] if same else to_grid(times, begin.curves, first, last)
        edited = start + to_grid(times, change, first, last)
        grid_range = first, last
        found = self._answers.to(regions, grid_range, edited, settings.naturalness)
        exchanges: dict[str, Doubles] = {}
        if not resynthesize:
            unedited = (
                self._answers.to_tracked(regions, grid_range, settings.naturalness)
                if same
                else self._answers.to(regions, grid_range, start, settings.naturalness)
            )
            found = {name: answer - unedited[name] for name, answer in found.items()}
            for name in regions:
                part, layer = self._parts[name], self.last_layer(name, settings)
                if layer is None or not len(part.own):
                    continue
                heard, key = part.layer_columns, (task.chunk, name, settings.naturalness)

                def lacking(part: Part = part, answer: Doubles = unedited[name]) -> Doubles:
                    weights = to_grid(times, begin.weights[:, part.columns], first, last)
                    return weights - part.whole(answer)

                now, change_by = start[:, heard], (edited - start)[:, heard]
                exchanges[name] = self._residuals.exchange(
                    key if same else None, layer, lacking, now, change_by
                )
        # All in one go: the positions between grid frames are the same.
        columns = [*found.values(), *exchanges.values()]
        ends = np.cumsum([each.shape[1] for each in columns])[:-1]
        stacked = from_grid(np.concatenate(columns, axis=1), first, self._times[rows])
        parts = np.split(stacked, ends, axis=1)
        for name, answer in zip(found, parts, strict=False):
            if resynthesize:
                answers[name][:, : answer.shape[1]] = answer
            else:
                answers[name] = answer
        still |= zip(exchanges, parts[len(found) :], strict=True)
        return answers, still

    def _unanswered(self, name: str, before: Doubles, resynthesize: bool) -> Doubles:
        """(N, K) what stands in for the networks' answer if there is none."""
        part = self._parts[name]
        if resynthesize and not part.is_optional:
            return before[:, part.columns]
        return np.zeros((len(before), len(part.region.channels)))
