"""The regions of a chunk, solved one after the other; their last results are kept."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Doubles
from faceedit_app.editing.edits.settings import Settings
from faceedit_app.editing.solving.chunks import ChunkTask
from faceedit_app.editing.solving.combining import Answer, Combining
from faceedit_app.editing.solving.filters import smoothed
from faceedit_app.editing.solving.network_answers import NetworkAnswers
from faceedit_app.editing.solving.region_request import RegionRequest
from faceedit_app.editing.solving.request import Request
from faceedit_app.editing.solving.start import Start
from faceedit_app.editing.solving.take_regions import TakeRegion

# Results that are kept.
REMEMBERED = 12


class SolvedRegions:
    """Solves the regions of one take's chunks.

    Args:
        parts: what is known about each region, by its id.
        networks: what the networks answer.
        shut: mm between the take's closed lips.
        quick: frames of standard deviation of the Gaussian that divides slow from quick.
    """

    def __init__(
        self, parts: Mapping[str, TakeRegion], networks: NetworkAnswers, shut: float, quick: float
    ) -> None:
        self._parts, self._networks, self._quick = parts, networks, quick
        # Brows move lids a little; the mouth, which is edited most, comes last.
        self._in_order = sorted(parts.items(), key=lambda entry: len(entry[1].own))
        self._combining = {name: Combining(part, shut, quick) for name, part in parts.items()}
        self._solved: dict[tuple[int, str], _Solved] = {}

    def influences(self, task: ChunkTask, asked: Request) -> dict[str, Doubles]:
        """(N, K) in 0..1, where each channel may answer; by region, in the order of solving.

        Args:
            asked: on the N frames of the chunk.
        """
        influences = {}
        for name, part in self._in_order:
            if part.is_optional and not asked.influence[:, part.own_columns].any():
                continue
            influence = part.influence(asked.influence)
            if name in task.regions and not part.is_optional:
                influence = np.ones_like(influence)
            if influence.any():
                influences[name] = influence
        return influences

    def solve(
        self,
        task: ChunkTask,
        inner: slice,
        weights: Doubles,
        start: Start,
        change: Doubles,
        asked: Request,
        influences: Mapping[str, Doubles],
    ) -> None:
        """Put the weights that answer a change into those of a chunk.

        Args:
            inner: the chunk's N frames among the N' frames near it.
            weights: (N, 52), in place.
            start: what the edits start from, on the N' frames.
            change: (N', C) mm by which the curves that are asked for differ from it.
            asked: on the N frames.
            influences: see `influences`.
        """
        slow = smoothed(change, self._quick)
        answers = self._networks.begin(task, tuple(influences), start, slow)
        curves = _Curves.of(start.curves[inner], change[inner], slow[inner])
        requests = {}
        for name, influence in influences.items():
            request = self._request(name, task.settings, curves, asked, influence)
            solved = self._solved.get((task.chunk, name))
            if solved is not None and solved.asked.equals(request):
                request = solved.asked  # which need not be compared again
            else:
                self._combining[name].prepare(weights, request)
            requests[name] = request
        for name, request in requests.items():
            self._solve_one(task.chunk, name, weights, request, answers.wait(name))

    def _request(
        self, name: str, settings: Settings, curves: _Curves, asked: Request, influence: Doubles
    ) -> RegionRequest:
        """What a change of the curves asks of a region."""
        part = self._parts[name]
        heard, own = part.layer_columns, part.own_columns
        return RegionRequest(
            settings=part.answered_by(settings),
            layer=self._networks.last_layer(name, settings),
            unlike=part.unlike(curves.change[:, own]),
            influence=influence,
            slow=curves.slow[:, heard],
            before=curves.tracked[:, heard],
            quick=curves.quick[:, own],
            tracked=curves.tracked[:, own],
            wanted=curves.wanted[:, own],
            hold=asked.hold[:, own],
            calm=asked.calm[:, own],
        )

    def _solve_one(
        self, chunk: int, name: str, weights: Doubles, asked: RegionRequest, answer: Answer
    ) -> None:
        """Put a region's weights into those of a chunk (N, 52).

        The last result is kept: a drag changes one region, and the others ask for the same again.
        """
        part = self._parts[name]
        seen = weights[:, part.sees]
        known = self._solved.pop((chunk, name), None)
        if known is None or not known.answers(asked, answer, seen):
            result = self._combining[name](weights, asked, answer)
            known = _Solved(asked, answer, seen, result)
        self._solved[chunk, name] = known
        while len(self._solved) > REMEMBERED:
            del self._solved[next(iter(self._solved))]  # the least recently used
        weights[:, part.have_columns] = known.result


@dataclass(frozen=True)
class _Curves:
    """All curves of a chunk, (N, C) mm each.

    Attributes:
        tracked, wanted: as they are, and as they should be.
        change, slow, quick: the change, and its two parts.
    """

    tracked: Doubles
    wanted: Doubles
    change: Doubles
    slow: Doubles
    quick: Doubles

    @classmethod
    def of(cls, tracked: Doubles, change: Doubles, slow: Doubles) -> _Curves:
        """With what follows from these."""
        return cls(tracked, tracked + change, change, slow, change - slow)


@dataclass(frozen=True)
class _Solved:
    """A region's result, with all that it depends on.

    Attributes:
        asked, answer: what was asked for, and what the networks answered.
        seen: (N, S) the weights that it depends on.
        result: (N, K) the weights of its channels.
    """

    asked: RegionRequest
    answer: Answer
    seen: Doubles
    result: Doubles

    def answers(self, asked: RegionRequest, answer: Answer, seen: Doubles) -> bool:
        """Whether it is the result for exactly this."""
        pairs = zip((*self.answer, self.seen), (*answer, seen), strict=True)
        return all(np.array_equal(*pair) for pair in pairs) and self.asked.equals(asked)
