"""Closures and blinks as events: are they kept when a take is answered from its curves alone?

Every system is given the same share of false positives, so that one that closes everything gains
nothing.
"""

from __future__ import annotations

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles, Floats
from faceedit_app.core.controls import CONTROL_INDEX, LIDS
from faceedit_app.lab.evaluation.people.gestures import OPENING, closed, own_closure
from faceedit_app.lab.evaluation.people.opened import Opened
from faceedit_app.lab.evaluation.people.places import runs

FALSE = 0.05  # share of the open stretches that may count as closed
OPEN_SECONDS = 0.2  # of an open stretch
OPEN_MM = 1.0  # above the take's own closure: where lips are open for certain
SHUT_LID, OPEN_LID = 0.35, 0.6  # of the take's median: a blink, an open eye
FEWEST = 4  # events, and open stretches, that a rate is said of


class Events:
    """The lowest distance of each event and each open stretch, by system."""

    def __init__(self) -> None:
        self._events: dict[str, list[float]] = {}
        self._open: dict[str, list[float]] = {}

    def add(self, system: str, answer: Doubles, shut: Bools, is_open: Bools, length: int) -> None:
        """Add a take.

        Args:
            system: whose answer it is.
            answer: (T,) a distance, the lower the more closed.
            shut, is_open: (T,) in the take as tracked; neither is in between.
            length: frames of an open stretch.
        """
        events = [float(answer[rows].min()) for rows in runs(shut)]
        stretches = [
            float(answer[begin : begin + length].min())
            for rows in runs(is_open)
            for begin in range(rows.start, rows.stop - length + 1, length)
        ]
        self._events.setdefault(system, []).extend(events)
        self._open.setdefault(system, []).extend(stretches)

    @property
    def systems(self) -> list[str]:
        """The systems that something was added of."""
        return list(self._events)

    def rate(self, system: str) -> float:
        """The share of events below the distance that `FALSE` of the open stretches are below.

        NaN if there are too few.
        """
        events, stretches = np.array(self._events[system]), np.array(self._open[system])
        if len(events) < FEWEST or len(stretches) < FEWEST:
            return float("nan")
        return float((events < np.quantile(stretches, FALSE)).mean())


def add_events(opened: Opened, closures: Events, blinks: Events, sees_lids: bool) -> None:
    """Answer a take from its own curves by every system, and add its closures and blinks.

    Distances of the mouth are relative to the take's own closure, of the lids to its median.
    """
    tracked = opened.tracked
    length = max(1, round(OPEN_SECONDS * opened.take.clip.rate))
    opening = tracked[:, OPENING]
    own = own_closure(opening)
    for system in opened.editors:
        answer = opened.controls(opened.regenerated(system)).astype(np.float64)
        closures.add(
            system,
            answer[:, OPENING] - own,
            closed(opening, own),
            opening > own + OPEN_MM,
            length,
        )
        for lid in LIDS if sees_lids else ():
            column = CONTROL_INDEX[lid]
            median = float(np.median(tracked[:, column]))
            share: Floats = tracked[:, column] / max(median, 1.0)
            blinks.add(
                system,
                answer[:, column] / max(median, 1.0),
                share < SHUT_LID,
                share > OPEN_LID,
                length,
            )
