"""Times that are numbers: in which unit, or whether they number frames."""

from __future__ import annotations

import numpy as np

from faceedit_app.core.arrays import Times
from faceedit_app.formats.files import shown
from faceedit_app.formats.time_names import TICKS, names_frames, only_names_frames, unit_of
from faceedit_app.formats.timing import (
    DEFAULT_RATE,
    FASTEST,
    SLOWEST,
    NoTimes,
    Timing,
    shown_step,
    single_row,
    time_rows,
    typical_step,
)

UNITS = {
    **{"seconds": 1.0, "milliseconds": 1e-3, "microseconds": 1e-6, "nanoseconds": 1e-9},
    TICKS: 1e-7,
    "days": 86_400.0,  # as spreadsheets count
}
# Ticks of our days since the year 1601 or 1: no other unit has such numbers.
_SINCE_1601, _SINCE_1 = (1.2e17, 1.5e17), (6.2e17, 6.7e17)
_FILM_RATE = 30.0  # the most likely rate of a film whose frames are numbered
_USUAL = (2.0, 245.0)  # frames per second; a plausible rate for a unit that is not named
_LONGEST_COUNT = 4.0  # steps from row to row up to which numbers of any name may number frames
_LONGEST_STRIDE = 15.0  # the same, of a name that says so; in milliseconds, it would be over 60 fps
_MOST_FRAMES = 1e9  # numbers beyond are times, whatever their name
_OFTEN = 0.1  # share of the steps that are one frame longer or shorter, as of every 2.4th frame


def number_times(values: Times, name: str) -> tuple[str, Timing]:
    """The times of rows in any unit, and their kind (`time_columns.RowTimes.kind`).

    Args:
        values: (T,) finite.
        name: the file's name for them, which may contain a unit.

    Raises:
        NoTimes: they are frame numbers, or impossible.
        BadRow: one row, or a few, is out of order.
    """
    if len(values) == 1:
        return "seconds", single_row()
    steps = np.diff(values)
    if not np.any(steps > 0):
        backwards = np.any(steps < 0)
        what = "times that do not run forward" if backwards else "the same time in every row"
        raise NoTimes(f"has {what}")
    if _number_frames(values, steps, name):
        raise _frame_numbers(values, steps, name)
    named = unit_of(name)
    # If times repeat, the clock is slower than the rows.
    step = typical_step(steps) if np.mean(steps > 0) > 0.9 else float(steps.mean())
    is_ticks = any(low < values[0] < high for low, high in (_SINCE_1601, _SINCE_1))
    unit = _unit(step, TICKS if is_ticks else named)
    if unit is None:
        raise NoTimes(f"has times in {_column(name)} that step by {step:g}")
    timing = time_rows(values * UNITS[unit])
    kind = "seconds" if unit == "seconds" else "number"
    if unit == (named or "seconds"):
        return kind, timing
    note = f"{shown(name)} is in {unit}"
    return kind, Timing(timing.times, timing.rate, (note, *timing.notes))


def _column(name: str) -> str:
    return f'"{shown(name)}"' if name else "a column without a name"


def _number_frames(values: Times, steps: Times, name: str) -> bool:
    """Whether values number frames, of which some or most may be left out."""
    if np.any(steps != np.round(steps)) or np.mean(steps > 0) <= 0.9:
        return False
    step = float(np.median(steps[steps > 0]))
    if only_names_frames(name) and step <= _LONGEST_STRIDE:
        return bool(values.max() < _MOST_FRAMES)
    if step > _LONGEST_COUNT:
        return False
    if unit_of(name) is not None and not names_frames(name):
        return step == 1
    return bool(np.mean(steps % step == 0) > 0.9)


def _frame_numbers(values: Times, steps: Times, name: str) -> NoTimes:
    """What to raise about values that number frames."""
    likely = _FILM_RATE if names_frames(name) else DEFAULT_RATE
    step = _usual_step(steps)
    problem = f"numbers its frames in {_column(name)} and does not say how many make a second"
    if step != 1:
        by = f"has frame numbers in {_column(name)} that step by {shown_step(step)}"
        problem = f"{by} and does not say how many rows make a second"
    return NoTimes(problem, likely, values / step if np.all(steps > 0) else None, step)


def _usual_step(steps: Times) -> float:
    """From row to row, of frame numbers; of those that step by 2, 3, 2, 2, 3 the mean."""
    forward = np.sort(steps[steps > 0])
    step = float(forward[(len(forward) - 1) // 2])
    near = steps[np.abs(steps - step) <= 1]
    if step == 1 or np.mean(near != step) < _OFTEN:
        return step
    return float(near.mean())


def _unit(step: float, named: str | None) -> str | None:
    """The unit of times that step by `step`; None if no unit fits."""
    if step <= 0:
        return None
    if named is not None and SLOWEST <= 1 / (step * UNITS[named]) <= FASTEST:
        return named
    low, high = _USUAL
    return next((u for u, size in UNITS.items() if low <= 1 / (step * size) <= high), None)
