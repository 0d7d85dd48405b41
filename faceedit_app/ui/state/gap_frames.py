"""The frames that fills give to gaps: what the export writes there is what is shown there."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, QTimer, Signal

from faceedit_app.core.arrays import Floats, Times
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.timeline import Stop, Timeline

if TYPE_CHECKING:  # the window is there before the solver
    from faceedit_app.editing.session import EditSession

Values = NDArray[np.floating]
_Kind = TypeVar("_Kind", bound=np.generic)

_QUICK = 0.003  # seconds; in a gesture, what takes longer waits until the hand rests
_REST_MS = 100
_SLICE = 0.01  # seconds of work before events are handled


class GapFrames(QObject):
    """Keeps the filled frames of the timeline up to date.

    It is made before the views, so that it hears of a change before them.

    Signals:
        changed(): the frames are there later than the change that made them.
    """

    changed = Signal()

    def __init__(self, document: Document, timeline: Timeline, parent: QObject) -> None:
        super().__init__(parent)
        self._document, self._timeline = document, timeline
        self._took = 0.0
        self._later = QTimer(self, singleShot=True)
        self._later.timeout.connect(self._go_on)
        document.changed.connect(self.refresh)
        document.previewed.connect(self._previewed)

    def _previewed(self) -> None:
        if self._took < _QUICK:
            self.refresh()
        else:
            self._later.start(_REST_MS)

    def _go_on(self) -> None:
        if self.refresh():
            self.changed.emit()

    def refresh(self) -> bool:
        """Find them again, unless what they follow from is still being computed.

        Many gaps are filled in slices; the frames are shown when all are there.

        Returns:
            Whether they are up to date.
        """
        self._later.stop()
        session = self._document.session
        if session is None or not session.live.is_complete:
            return False
        began = time.perf_counter()
        if not session.find_filled(_SLICE):
            self._later.start(0)
            return False
        self._timeline.fill_gaps(session.filled_frames())
        self._took = time.perf_counter() - began
        return True


def weights_at(session: EditSession, line: Timeline) -> Floats:
    """(52,) of the edited face at the playhead, in ARKit order."""
    if line.filled is not None and line.filled_frames is not None:
        filled: Floats = line.filled_frames.weights[line.filled]
        return filled
    weights: Floats = session.weights[_clamped(line.frame, session.weights)]
    return weights


def edited_at(
    session: EditSession, line: Timeline, stop: Stop | None = None
) -> tuple[Floats, Floats]:
    """(C,) mm each: what the edits ask for, and the face.

    Args:
        stop: where; None = at the playhead.
    """
    frame, filled = stop or line.stop
    if filled is not None and line.filled_frames is not None:
        return line.filled_frames.asked[filled], line.filled_frames.controls[filled]
    frame = _clamped(frame, session.achieved)
    return session.asked[frame], session.achieved[frame]


def values_at(values: Floats, line: Timeline, stop: Stop | None = None) -> Floats:
    """(K,) of values (T, K); in a gap, between those of the frames around it.

    Args:
        stop: where; None = at the playhead.
    """
    frame, filled = stop or line.stop
    if filled is not None and line.filled_frames is not None:
        return line.filled_frames.between(values, filled)
    row: Floats = values[_clamped(frame, values)]
    return row


def through_gaps(
    times: Values, values: NDArray[_Kind], seconds: Times, filled: NDArray[_Kind]
) -> tuple[Values, NDArray[_Kind]]:
    """The points of a line with those of the filled frames between its ends.

    Args:
        times, values: (N,) of the line's points.
        seconds, filled: (M,) of all filled frames.

    Returns:
        Times and values; the same arrays if no filled frame lies between the line's ends.
    """
    if not len(times):
        return times, values
    first, stop = np.searchsorted(seconds, (times[0], times[-1])).tolist()
    if first == stop:
        return times, values
    at = np.searchsorted(times, seconds[first:stop])
    return (
        np.insert(times, at, seconds[first:stop]),
        np.insert(values, at, filled[first:stop]),
    )


def _clamped(frame: int, values: Floats) -> int:
    """A frame of the values (T, K): while a take opens, that on screen may be of the last one."""
    return min(max(frame, 0), len(values) - 1)
