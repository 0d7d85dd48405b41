"""What the edits of a chunk start from.

That is the take, with fills and retimes, and calm where a whole region is smoothed.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.clip import Clip
from faceedit_app.core.rig import Distances
from faceedit_app.editing.edits.edit import OF_THE_TAKE
from faceedit_app.editing.edits.settings import Mode
from faceedit_app.editing.solving.bridging import Nearby
from faceedit_app.editing.solving.calming import Calmed
from faceedit_app.editing.solving.chunks import ChunkTask
from faceedit_app.editing.solving.fills import Fills
from faceedit_app.editing.solving.filters import smoothed
from faceedit_app.editing.solving.recent import Recent

# Seconds: what calm channels lack of calm curves is brought only as far as it lasts longer.
LASTS = 0.16
# Chunks with gaps whose frames, bridged, are kept.
REMEMBERED = 4


@dataclass(frozen=True)
class Start:
    """What edits start from, on N frames.

    Attributes:
        weights, curves: (N, 52), and (N, C) mm.
        lacks: (N, C) mm, what the curves lack of being smoothed themselves, where smooths of all
            curves of a region have smoothed its channels; None without any.
        as_tracked: it is the take itself.
    """

    weights: Floats
    curves: Doubles
    lacks: Doubles | None = None
    as_tracked: bool = False

    def without_twitches(self, change: Doubles, calm: Doubles, rate: float) -> Doubles:
        """A change of the curves (N, C), mm, less what calm channels lack for a moment only.

        Curves that are smoothed one by one are not always those of a face, above all in blinks.

        Args:
            calm: (N, C) in 0..1, see `Request`.
            rate: frames per second.
        """
        if self.lacks is None:
            return change
        lacks = calm * self.lacks
        left: Doubles = change - (lacks - smoothed(lacks, LASTS * rate))
        return left


class Starts:
    """The starts of one take.

    Args:
        clip: the take.
        tracked, controls: (T, 52), and (T, C) mm, as tracked.
        distances: the controls as a function of the weights.
        fills: its fills and retimes.
    """

    def __init__(
        self, clip: Clip, tracked: Floats, controls: Floats, distances: Distances, fills: Fills
    ) -> None:
        self._rate, self._fills = clip.rate, fills
        self._tracked, self._controls, self._distances = tracked, controls, distances
        self._bridged = Recent[tuple[Floats, Floats]](REMEMBERED)

    def recorded(self, nearby: Nearby) -> tuple[Floats, Floats]:
        """(N', 52), and (N', C) mm: the take as tracked on the frames near a chunk."""
        tracked, controls = self._tracked[nearby.frames], self._controls[nearby.frames]
        bridged = nearby.bridged
        if isinstance(bridged.own, slice):
            return tracked, controls

        def found() -> tuple[Floats, Floats]:
            wide, curves = bridged.wide(tracked), bridged.wide(controls)
            added = np.ascontiguousarray(wide[bridged.added])
            curves[bridged.added] = self._distances.measure(added)
            return wide, curves

        return self._bridged.to((nearby.frames.start, nearby.frames.stop), found)

    def filled(self, task: ChunkTask, nearby: Nearby) -> Start:
        """The take with fills and retimes, on the frames near a chunk."""
        tracked, controls = self.recorded(nearby)
        if not any(edit.op in OF_THE_TAKE for edit in task.edits):
            return Start(tracked, controls.astype(np.float64, order="F"), as_tracked=True)
        weights = nearby.bridged.wide(self._fills.applied(task.edits, nearby.frames))
        curves = self.measured(weights, tracked, controls).astype(np.float64, order="F")
        return Start(weights, curves)

    def calmed(
        self, start: Start, task: ChunkTask, nearby: Nearby, regions: Iterable[Calmed]
    ) -> Start:
        """The same with smooths of all curves of a region, see `calming.py`.

        Resynthesized regions are smoothed by their curves alone.
        """
        if task.settings.mode is Mode.RESYNTHESIZE:
            return start
        weights, calm = start.weights, start.curves
        times, far = nearby.times, nearby.bridged.far
        for region in regions:
            weights, calm = region(task.edits, times, self._rate, weights, calm, far)
        if weights is start.weights:
            return start
        known = start.curves.astype(np.float32)
        curves = self.measured(weights, start.weights, known).astype(np.float64, order="F")
        return Start(weights, curves, calm - curves)

    def measured(self, weights: Floats, known: Floats, controls: Floats) -> Floats:
        """(N, C) mm: the controls of weights (N, 52), with the bits of known ones of equal weights.

        The last bits of a matrix product depend on the number of frames.
        """
        measured = self._distances.measure(np.ascontiguousarray(weights))
        same = (weights == known).all(axis=1)
        measured[same] = controls[same]
        return measured
