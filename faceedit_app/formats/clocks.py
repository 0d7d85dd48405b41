"""Which of several clocks in a file to believe.

A recorder may note when it worked on a frame beside when the frame is in the film, which counts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faceedit_app.formats.files import shown
from faceedit_app.formats.rates import sure_notes
from faceedit_app.formats.time_names import is_of_media, is_of_wall, unit_of
from faceedit_app.formats.timing import Timing, format_rate, format_time

_SAME = 0.01  # relative difference of rates and lengths of clocks that agree
_EVEN = 0.05  # frames by which half of the steps of an even clock may be off whole ones


@dataclass(frozen=True)
class FrameClock:
    """A clock that a file has for its frames.

    Attributes:
        name: the file's name for it.
        kind: `time_columns.RowTimes.kind`.
        timing: its times.
    """

    name: str
    kind: str
    timing: Timing

    @property
    def _merit(self) -> tuple[bool, ...]:
        """What speaks for it, the strongest first."""
        steps = np.diff(self.timing.times) * self.timing.rate
        off = np.median(np.abs(steps - np.round(steps))) if len(steps) else 0.0
        is_even = bool(off < _EVEN) and sure_notes(self.timing.notes) == self.timing.notes
        is_guessed = self.kind == "number" and unit_of(self.name) is None
        of_media = is_of_media(self.name) and not is_guessed
        # A clip keeps its timecodes, so that they stay those that everybody knows.
        return (
            self.kind == "timecode",
            of_media,
            is_even,
            not is_guessed,
            not is_of_wall(self.name),
        )

    def is_better(self, other: FrameClock) -> bool:
        """Whether it is to be believed more than one that names alone rank higher."""
        return self._merit > other._merit

    def agrees(self, other: FrameClock) -> bool:
        """Whether it tells the same as another one."""
        rates = self.timing.rate, other.timing.rate
        lengths = float(self.timing.times[-1]), float(other.timing.times[-1])
        return all(max(two) - min(two) <= _SAME * max(two) for two in (rates, lengths))


def believed(clocks: Sequence[FrameClock]) -> tuple[int, tuple[str, ...]]:
    """The index of the clock to believe, and notes about the first one that says something else.

    Args:
        clocks: at least one, the most reliable by their names first.
    """
    best = 0
    for k, clock in enumerate(clocks):
        if not clock.agrees(clocks[best]) and clock.is_better(clocks[best]):
            best = k
    chosen = clocks[best]
    other = next((clock for clock in clocks if not clock.agrees(chosen)), None)
    if other is None:
        return best, ()
    says = f"{format_rate(other.timing.rate)} and {format_time(float(other.timing.times[-1]))}"
    note = f'the times are those of "{shown(chosen.name)}", not of "{shown(other.name)}"'
    return best, (f"{note}, which says {says}",)
