"""The times of keys in an animation."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from faceedit_app.core.arrays import Times
from faceedit_app.core.errors import FileError
from faceedit_app.formats.timing import BadRow, NoTimes, Timing, time_rows


def time_keys(path: Path, times: Times, remedy: str) -> Timing | NoTimes:
    """The timing of keys that an animation stores as single-precision seconds.

    Args:
        path, remedy: for the message.

    Raises:
        FileError: a key does not come after the one before it.
    """
    try:
        return time_rows(times, 2 * float(np.spacing(np.float32(np.abs(times).max()))))
    except NoTimes as none:
        return none
    except BadRow as bad:
        problem = f"its key {bad.row + 1} does not come after the one before it"
        raise FileError(path, problem, remedy) from None
