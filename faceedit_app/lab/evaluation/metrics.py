"""Figures that say how good an answer is. Small functions over arrays, time first.

Throughout, `answer` and `truth` are weights (T, K) at 25 frames a second, and `captured` (K,)
bool says which channels the truth knows about.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles, Indices
from faceedit_app.core.controls import CONTROL_INDEX, LIP_OPENING, MOUTH_CORNERS, MOUTH_WIDTH
from faceedit_app.core.regions import LOWER, MODELLED_CHANNELS, UPPER, Region
from faceedit_app.core.resample import GRID_RATE
from faceedit_app.core.rig import MILLIMETRES, Rig

HIGH_HZ = 4.0
"""What moves faster than this is what over-smoothing takes away first."""

# Which vertices belong to the lips and lids: those near their control points.
NEAR_LIPS_MM = 12.0
NEAR_LIDS_MM = 10.0
MOVED_MM = 2.0  # the brows: vertices that a brow channel moves by so much
_LIPS = (LIP_OPENING, MOUTH_WIDTH, *MOUTH_CORNERS)
_AT_LIMIT = 1e-4


def squared_errors(answer: Doubles, truth: Doubles, captured: Bools) -> Doubles:
    """(n,) squared weight errors of the captured channels; their mean is the MSE."""
    return ((answer - truth)[:, captured] ** 2).ravel()


def high_energy(
    answer: Doubles, truth: Doubles, captured: Bools, above: float = HIGH_HZ
) -> tuple[float, float]:
    """How much of the fast motion of the truth is in the answer.

    Returns:
        The product of answer and truth above some Hz, summed over the captured channels (Hann
        window over the whole take), and that of the truth with itself, its energy. Jitter that an
        answer makes up has no part in the product.
    """
    if len(truth) < 8 or not captured.any():
        return 0.0, 0.0
    window = np.hanning(len(truth))[:, None]
    fast = np.fft.rfftfreq(len(truth), 1.0 / GRID_RATE) > above
    mine, theirs = (
        np.fft.rfft((x[:, captured] - x[:, captured].mean(axis=0)) * window, axis=0)[fast]
        for x in (answer, truth)
    )
    return float((mine * theirs.conj()).real.sum()), float((np.abs(theirs) ** 2).sum())


def energy_kept(product: float, energy: float) -> float:
    """Share of the energy that is kept, from sums of `high_energy`: 1 all, 0 none."""
    return max(product / energy, 0.0) ** 2 if energy > 0 else float("nan")


def jerk(weights: Doubles, captured: Bools) -> float:
    """Sum of the absolute third differences of the captured channels."""
    if len(weights) < 4:
        return 0.0
    return float(np.abs(np.diff(weights[:, captured], n=3, axis=0)).sum())


@dataclass(frozen=True)
class Closures:
    """How well closures are kept, by threshold of detection.

    A frame is a closure where the distance is below the threshold; both rates count frames.

    Attributes:
        thresholds: mm.
        tpr: share of the actual closures that are closures in the answer; NaN without any.
        fpr: closures in the answer that are none in truth, by the number of actual ones.
        actual: number of actual closures.
    """

    thresholds: tuple[float, ...]
    tpr: tuple[float, ...]
    fpr: tuple[float, ...]
    actual: tuple[int, ...]

    def fpr_at(self, wanted: float) -> tuple[float, float]:
        """The smallest threshold from which on the TPR stays `wanted` or more, and the FPR there.

        NaN, NaN if there is none.
        """
        found = float("nan"), float("nan")
        for threshold, tpr, fpr in reversed(
            list(zip(self.thresholds, self.tpr, self.fpr, strict=True))
        ):
            if not tpr >= wanted:
                break
            found = threshold, fpr
        return found


def closures(answer: Doubles, truth: Doubles, thresholds: Sequence[float]) -> Closures:
    """Closures kept, lost and made up: distances (T,) mm of the answer and of the truth."""
    tpr, fpr, actual = [], [], []
    for threshold in thresholds:
        is_closed, says_closed = truth < threshold, answer < threshold
        count = int(is_closed.sum())
        actual.append(count)
        tpr.append(float((is_closed & says_closed).sum() / count) if count else float("nan"))
        fpr.append(float((~is_closed & says_closed).sum() / count) if count else float("nan"))
    return Closures(tuple(map(float, thresholds)), tuple(tpr), tuple(fpr), tuple(actual))


@dataclass(frozen=True)
class ShutCounts:
    """How many closures are kept and made up, by frames or by events; sums of films can be added.

    An event is a run of closed frames. It is kept if the answer is closed in any of them. One of
    the answer is made up if the truth is closed neither in it nor in a frame beside it.

    Attributes:
        actual: closures in truth.
        kept: those that are closures in the answer.
        made_up: closures in the answer that are none in truth.
        far: those of them in which the truth is not even near one.
    """

    actual: int
    kept: int
    made_up: int
    far: int

    def __add__(self, other: ShutCounts) -> ShutCounts:
        return ShutCounts(
            self.actual + other.actual,
            self.kept + other.kept,
            self.made_up + other.made_up,
            self.far + other.far,
        )

    @property
    def rates(self) -> tuple[float, float, float]:
        """`kept`, `made_up` and `far` by the number of actual closures; NaN without any."""
        count = self.actual or float("nan")
        return self.kept / count, self.made_up / count, self.far / count


def shut_counts(
    answer: Doubles, truth: Doubles, threshold: float, near: float
) -> tuple[ShutCounts, ShutCounts]:
    """Count closures by frames, and by events.

    Args:
        answer, truth: (T,) mm, consecutive frames.
        threshold: mm, below which a frame is closed.
        near: mm above the threshold in which a truth is near a closure.
    """
    says, is_closed, is_near = answer < threshold, truth < threshold, truth < threshold + near
    frames = ShutCounts(
        int(is_closed.sum()),
        int((is_closed & says).sum()),
        int((says & ~is_closed).sum()),
        int((says & ~is_near).sum()),
    )
    found = [slice(max(first - 1, 0), last + 1) for first, last in _runs(says)]
    events = ShutCounts(
        len(_runs(is_closed)),
        sum(bool(says[first:last].any()) for first, last in _runs(is_closed)),
        sum(not is_closed[run].any() for run in found),
        sum(not is_near[run].any() for run in found),
    )
    return frames, events


def _runs(closed: Bools) -> list[tuple[int, int]]:
    """The first frame of each run of closed ones, and the one after its last."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], closed.astype(int), [0]])))
    return [(int(first), int(last)) for first, last in edges.reshape(-1, 2)]


def region_vertices(rig: Rig, region: Region) -> Indices:
    """Indices of the lip, lid or brow vertices that a region's error is measured on."""
    if region.id == UPPER.id:
        rows = [rig.channel_index[c] for c in region.channels if c in rig.channel_index]
        moved = np.linalg.norm(rig.deltas[rows], axis=2).max(axis=0) * MILLIMETRES
        return np.flatnonzero(moved > MOVED_MM)
    lips = region.id == LOWER.id
    controls = _LIPS if lips else region.controls
    points = rig.neutral[rig.control_pairs[[CONTROL_INDEX[c] for c in controls]].ravel()]
    away = np.linalg.norm(rig.neutral[:, None] - points[None], axis=2).min(axis=1) * MILLIMETRES
    rows = [rig.channel_index[c] for c in MODELLED_CHANNELS if c in rig.channel_index]
    moves = np.linalg.norm(rig.deltas[rows], axis=2).max(axis=0) > 0
    return np.flatnonzero((away < (NEAR_LIPS_MM if lips else NEAR_LIDS_MM)) & moves)


def vertex_errors(rig: Rig, region: Region, answer: Doubles, truth: Doubles) -> Doubles:
    """(T,) mm: mean distance of the region's vertices between two sets of its weights.

    Blendshapes add up, so the rest of the face makes no difference.
    """
    rows = [i for i, c in enumerate(region.channels) if c in rig.channel_index]
    columns = [rig.channel_index[region.channels[i]] for i in rows]
    deltas = rig.deltas[columns][:, region_vertices(rig, region)].astype(np.float64)
    flat = deltas.reshape(len(columns), -1)
    moved = ((answer - truth)[:, rows] @ flat).reshape(len(answer), -1, 3)
    errors: Doubles = np.linalg.norm(moved, axis=2).mean(axis=1) * MILLIMETRES
    return errors


def boundary_jump(before: Doubles, after: Doubles, frames: Iterable[int]) -> float:
    """Largest jump of velocity that an edit adds at some frames, in weight per frame.

    Args:
        before, after: (T, K) weights.
        frames: where the edit begins and ends; those without neighbours are left out.
    """
    change = after - before
    jumps = [
        float(np.abs(change[f - 1] - 2 * change[f] + change[f + 1]).max())
        for f in frames
        if 0 < f < len(change) - 1
    ]
    return max(jumps, default=0.0)


def clipped_share(before: Doubles, after: Doubles) -> float:
    """Share of the changed weights (T, K) that an edit drove to 0 or 1."""
    changed = np.abs(after - before) > _AT_LIMIT
    if not changed.any():
        return 0.0
    limit = (np.abs(after) < _AT_LIMIT) | (np.abs(after - 1.0) < _AT_LIMIT)
    return float((limit & changed).sum() / changed.sum())
