"""What the networks answer to the chunks of one take, and what the take adds to their answers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.resample import OffGrid, OnGrid
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.solving.answers import Answers
from faceedit_app.editing.solving.chunks import Chunks, ChunkTask
from faceedit_app.editing.solving.last_layer import LastLayer
from faceedit_app.editing.solving.recent import Recent
from faceedit_app.editing.solving.residual import Residuals
from faceedit_app.editing.solving.start import Start
from faceedit_app.editing.solving.take_regions import TakeRegion
from faceedit_app.editing.solving.take_statistics import Sample

if TYPE_CHECKING:  # the window is there before the networks
    from faceedit_app.networks.engine import Engine

# Layers between the two ends of naturalness that are kept: what is computed from one is recognised
# by it.
MIXED = 6


class NetworkAnswers:
    """The networks' answers, the take's own last layer, and the residuals of its poses.

    Args:
        engine: the networks; None = there are none yet, and nothing is answered.
        grid: (M, C) mm: the take's controls as tracked, on the networks' grid.
        chunks: the take's chunks.
        parts: what is known about each region, by its id.
        sampled, sample: the chunks that the last layers are fitted to, and what they hold.
    """

    def __init__(
        self,
        engine: Engine | None,
        grid: Doubles,
        chunks: Chunks,
        parts: Mapping[str, TakeRegion],
        sampled: Sequence[int],
        sample: Sample,
    ) -> None:
        self._engine, self._grid, self._chunks = engine, grid, chunks
        self._parts, self._sampled, self._sample = parts, sampled, sample
        self._answers = Answers(engine, grid) if engine else None
        self._layers: dict[tuple[str, float], LastLayer] = {}
        self._mixed = Recent[LastLayer](MIXED)
        self._functions = Recent[Doubles](1)
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
            layer = self._parts[region].last_layer(answers, self._sample)
            self._layers[key] = replace(layer, recent=self._functions)
        return self._layers[key]

    def begin(
        self,
        task: ChunkTask,
        regions: tuple[str, ...],
        begin: Start,
        change: Doubles,
    ) -> BegunAnswers:
        """Begin to answer a chunk: other cores go on while the regions are prepared and solved.

        Args:
            regions: in the order in which their answers will be needed.
            begin: what the edits start from, on the N' frames near the task.
            change: (N', C) mm by which the controls that are asked for differ from it.
        """
        nearby, settings = self._chunks.nearby(task), task.settings
        before = begin.weights[nearby.inner].astype(np.float64, order="F")
        begun = BegunAnswers(self._parts, before, settings.mode)
        heard = tuple(name for name in regions if not self._parts[name].is_optional)
        if self._answers is None or not heard:
            return begun
        first, last = nearby.grid
        to_grid = nearby.way.to_grid
        on_grid = self._grid[first:last] if begin.as_tracked else to_grid(begin.curves)
        edited = on_grid + to_grid(change)
        naturalness = settings.naturalness
        begun.edited = self._answers.begin(heard, (first, last), edited, naturalness)
        begun.from_grid = nearby.back
        if settings.mode is not Mode.PRESERVE:
            return begun
        if begin.as_tracked:
            begun.unedited = self._answers.to_tracked(heard, (first, last), naturalness)
        else:
            begun.unedited = self._answers.to(heard, (first, last), on_grid, naturalness)
        moved = edited - on_grid
        for name in heard:
            part, layer = self._parts[name], self.last_layer(name, settings)
            if layer is not None and len(part.own):
                # Sums over other frames near it are rounded in another way.
                key = (task.chunk, task.near, name, naturalness) if begin.as_tracked else None
                lacking = partial(_lacking, part, to_grid, begin, begun.unedited[name])
                curves, by = on_grid[:, part.layer_columns], moved[:, part.layer_columns]
                begun.exchanges[name] = self._residuals.exchange(key, layer, lacking, curves, by)
        return begun


def _lacking(part: TakeRegion, to_grid: OnGrid, begin: Start, unedited: Doubles) -> Doubles:
    """(M, K) the weights on the grid less the networks' answer to their curves."""
    return to_grid(begin.weights[:, part.columns]) - part.whole(unedited)


class BegunAnswers:
    """The networks' answers to one chunk, which other cores may still be computing.

    Args:
        parts: what is known about each region, by its id.
        before: (N, 52) the weights that the edits start from.
        mode: how the edits are answered.

    Attributes:
        edited: by region, what waits for the answer to the edited curves on the grid.
        unedited: by region, (M, K) the answer to the curves before the edits; in preserve mode.
        exchanges: by region, (M, K) by which the poses' residuals change, see `residual.py`.
        from_grid: interpolates them at the chunk's frames.
    """

    from_grid: OffGrid

    def __init__(self, parts: Mapping[str, TakeRegion], before: Doubles, mode: Mode) -> None:
        self._parts, self._before, self._mode = parts, before, mode
        self.edited: dict[str, Callable[[], Doubles]] = {}
        self.unedited: dict[str, Doubles] = {}
        self.exchanges: dict[str, Doubles] = {}

    def wait(self, name: str) -> tuple[Doubles, Doubles]:
        """A region's answer, once.

        Returns:
            (N, M) what the networks add to (preserve) or replace (resynthesize), and (N, K) how
            the poses' residuals change.
        """
        lone, still = self._unanswered(name)
        if name not in self.edited:
            return lone, still
        answer = self.edited[name]()
        if name not in self.unedited:
            found = self.from_grid(answer)
            lone[:, : found.shape[1]] = found
            return lone, still
        added = answer - self.unedited[name]
        if name not in self.exchanges:
            return self.from_grid(added), still
        both = self.from_grid(np.concatenate([added, self.exchanges[name]], axis=1))
        return both[:, : added.shape[1]], both[:, added.shape[1] :]

    def _unanswered(self, name: str) -> tuple[Doubles, Doubles]:
        """What stands in for the networks' answer if there is none; see `wait`."""
        part = self._parts[name]
        still = np.zeros((len(self._before), len(part.columns)), order="F")
        if self._mode is Mode.RESYNTHESIZE and not part.is_optional:
            return self._before[:, part.columns], still
        return np.zeros((len(self._before), len(part.region.channels)), order="F"), still
