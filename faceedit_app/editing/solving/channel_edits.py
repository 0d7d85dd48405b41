"""Edits of channels: what they do to the weights and rotations that the curves' answer left.

They act after the answer to the curves, in the order of the list, and no network hears of them. A
chunk is computed from its fixed frames, and from those around it that a smooth reads, so that a
part has the same bits as the whole.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.clip import Clip
from faceedit_app.core.levels import softly_limited
from faceedit_app.editing.edits.channels import CHANNEL_INDEX, CHANNELS
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.solving.bridging import Bridging, smoothed_without
from faceedit_app.editing.solving.chunks import SLACK, Chunks, ChunkTask, FrameRange
from faceedit_app.editing.solving.filters import smoothed
from faceedit_app.editing.solving.neutral import keep_lips_together, without_rest
from faceedit_app.editing.solving.request import active, smoothing, smoothing_frames
from faceedit_app.editing.solving.rounding import rounded

WEIGHTS = len(ARKIT_INDEX)
# How far an edit goes, unless the take is there already: weights, then degrees of the head (yaw,
# pitch, roll) and the eyes. Beyond this a file is taken to be in degrees, or gets a remark.
_FARTHEST = np.array([1.0] * WEIGHTS + [85.0, 85.0, 180.0] + [50.0] * 6)
_LOWEST = -_FARTHEST * (np.arange(len(CHANNELS)) >= WEIGHTS)


@dataclass(frozen=True)
class ChannelTask:
    """A chunk to compute with edits of channels, and all that its result depends on.

    Attributes:
        chunk: its number.
        near: the frames that it is computed from.
        bases: the chunks that hold these frames, with the answer to the curves there; None where
            no curve is edited.
        edits: the edits of channels that it depends on, in the user's order.
    """

    chunk: int
    near: FrameRange
    bases: tuple[tuple[int, ChunkTask | None], ...]
    edits: tuple[Edit, ...]


AnyTask = ChunkTask | ChannelTask


class Answered(Protocol):
    """A chunk whose curves have been answered."""

    @property
    def weights(self) -> Floats:
        """(N, 52) in ARKit order."""

    @property
    def rotations(self) -> Floats | None:
        """(N, 9) radians; None if the take has none."""


def channels_of(clip: Clip) -> frozenset[str]:
    """The channels of a clip that can be edited: weights, and rotations if it has them."""
    turns = () if clip.rotations is None else clip.rotation_names
    return frozenset((*clip.channels, *turns))


def missing_channels(edits: Sequence[Edit], clip: Clip) -> str:
    """One line about channels that edits name and a clip lacks; empty if there are none."""
    has = channels_of(clip)
    missing = dict.fromkeys(name for edit in edits for name in edit.channels if name not in has)
    return f"the take has no {', '.join(missing)} to change" if missing else ""


class ChannelEdits:
    """Computes the edits of channels of one take.

    Args:
        clip: the take as tracked.
        tracked: (T, 52) its weights in ARKit order.
    """

    def __init__(self, clip: Clip, tracked: Floats) -> None:
        self._times, self._rate, self._bridging = clip.times, clip.rate, Bridging(clip)
        self._has = channels_of(clip)
        turns = None if clip.rotations is None else clip.rotations[: len(tracked)]
        self._medians = np.median(self._values(tracked, turns), axis=0)

    def possible(self, edits: Sequence[Edit]) -> tuple[Edit, ...]:
        """The effective edits of channels, without the channels that the take lacks."""
        found = []
        for edit in active([edit for edit in edits if edit.channels]):
            kept = [k for k, name in enumerate(edit.channels) if name in self._has]
            if len(kept) == len(edit.channels):
                found.append(edit)
            elif kept:
                names = tuple(edit.channels[k] for k in kept)
                amounts = tuple(edit.amounts[k] for k in kept) if edit.amounts else ()
                found.append(replace(edit, channels=names, amounts=amounts))
        return tuple(found)

    def tasks(
        self, curves: Mapping[int, ChunkTask], edits: Sequence[Edit], chunks: Chunks
    ) -> dict[int, AnyTask]:
        """The tasks by chunk.

        Args:
            curves: the tasks that answer the edits of curves.
            edits: the edits of channels, see `possible`.
            chunks: the chunks of the take.
        """
        tasks: dict[int, AnyTask] = dict(curves)
        if not edits:
            return tasks
        spans = [self._frames(edit) for edit in edits]
        for chunk in range(len(chunks)):
            rows = chunks.slice(chunk)
            near, seen = (rows.start, rows.stop), []
            for edit, (start, stop) in reversed(list(zip(edits, spans, strict=True))):
                first, last = max(near[0], start), min(near[1], stop)
                if first < last:
                    seen.append(edit)
                    around = smoothing_frames(edit, self._rate)
                    near = min(near[0], first - around), max(near[1], last + around)
            acts = any(start < rows.stop and stop > rows.start for start, stop in spans)
            if not acts or rows.start == rows.stop:
                continue
            near = max(near[0], 0), min(near[1], len(self._times))
            bases = tuple(
                (k, curves.get(k))
                for k in range(chunks.of_frame(near[0]), chunks.of_frame(near[1] - 1) + 1)
            )
            tasks[chunk] = ChannelTask(chunk, near, bases, tuple(reversed(seen)))
        return tasks

    def _frames(self, edit: Edit) -> FrameRange:
        first, last = edit.span
        start, stop = np.searchsorted(self._times, (first - SLACK, last + SLACK))
        return int(start), int(stop)

    def _values(self, weights: Floats, rotations: Floats | None) -> Doubles:
        """(N, 61): the weights (N, 52), then the rotations (N, 9), in degrees."""
        turns = np.zeros((len(weights), len(CHANNELS) - WEIGHTS))
        if rotations is not None:
            turns = np.degrees(rotations.astype(np.float64))
        return np.concatenate([weights.astype(np.float64), turns], axis=1)

    def apply(
        self,
        task: ChannelTask,
        rows: slice,
        base: Callable[[int, ChunkTask | None], Answered],
    ) -> tuple[Floats, Floats | None]:
        """The weights (N, 52) and the rotations (N, 9) in radians of a chunk.

        Args:
            task: the task.
            rows: the chunk's frames.
            base: answers the curves of a chunk.
        """
        near = slice(*task.near)
        parts = [base(chunk, curves) for chunk, curves in task.bases]
        # The first part begins where its chunk does, at or before the first frame that is read.
        place = [chunk for chunk, _ in task.bases].index(task.chunk)
        first = rows.start - sum(len(part.weights) for part in parts[:place])
        read = slice(near.start - first, near.stop - first)
        around = np.concatenate([part.weights for part in parts])[read]
        turns = [part.rotations for part in parts if part.rotations is not None]
        turned = np.concatenate(turns)[read] if turns else None
        before = self._values(around, turned)
        after = self._edited(before, task.edits, near)
        inner = slice(rows.start - near.start, rows.stop - near.start)
        weights = rounded(after[inner, :WEIGHTS], around[inner])
        if turned is None:
            return weights, None
        return weights, rounded(np.radians(after[inner, WEIGHTS:]), turned[inner])

    def _edited(self, values: Doubles, edits: Sequence[Edit], near: slice) -> Doubles:
        """Values (N, 61) with the edits."""
        result, times = values.copy(), self._times[near]
        for edit in edits:
            start, stop = self._frames(edit)
            rows = slice(max(start, near.start) - near.start, min(stop, near.stop) - near.start)
            if rows.start >= rows.stop:
                continue
            columns = [CHANNEL_INDEX[name] for name in edit.channels]
            now = result[rows][:, columns]
            wanted = self._wanted(edit, result[:, columns], rows, near, columns)
            mask = edit.mask(times[rows])[:, None]
            strength = min(edit.strength, 1.0) if edit.op in _TO_A_GOAL else edit.strength
            moved = now + mask * strength * (wanted - now)
            low, high = _LOWEST[columns], _FARTHEST[columns]
            moved = np.clip(moved, np.minimum(now, low), np.maximum(now, high))
            result[rows, columns] = np.where(mask > 0, moved, now)
        keep_lips_together(result, values)
        return result

    def _wanted(
        self, edit: Edit, around: Doubles, rows: slice, near: slice, columns: list[int]
    ) -> Doubles:
        """(N, K) what an edit at full strength makes of its channels on `rows`."""
        now = around[rows]
        match edit.op:
            case Op.SCALE:
                middle = self._medians[columns] if edit.about is None else edit.about
                scaled: Doubles = middle + edit.value * (now - middle)
                return scaled
            case Op.SMOOTH:
                return self._smooth(edit, around, rows, near)
            case Op.DRAW:
                drawn = np.interp(self._times[near][rows], *edit.polyline)
                return np.repeat(drawn[:, None], len(columns), axis=1)
            case Op.LIMIT:
                return softly_limited(now, np.full(len(columns), edit.value))
            case Op.NEUTRAL:
                rest, peak = np.array(edit.amounts).T
                return without_rest(now, rest, peak)
            case Op.LEVELS:
                factor, offset, limit = np.array(edit.amounts).T
                levelled = factor * now + offset
                return np.where(limit < 1, softly_limited(levelled, limit), levelled)
            case _:
                return now + edit.value

    def _smooth(self, edit: Edit, around: Doubles, rows: slice, near: slice) -> Doubles:
        margin = smoothing_frames(edit, self._rate)
        if not margin:
            return around[rows]
        bridged = self._bridging(near)
        inner, shown = bridged.within(rows.start, rows.stop)
        first, last = max(inner.start - margin, 0), min(inner.stop + margin, len(bridged.times))
        smooth = smoothed_without(
            bridged.wide(around)[first:last],
            None if bridged.far is None else bridged.far[first:last],
            lambda kept: smoothed(kept, smoothing(edit) * self._rate),
        )
        return smooth[inner.start - first : inner.stop - first][shown]


# Operations that go to a goal: more than all the way would go beyond it.
_TO_A_GOAL = (Op.SMOOTH, Op.NEUTRAL, Op.LIMIT)
