"""The edit that headless runs and the smoke test make."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.controls import CONTROL_INDEX, LIP_OPENING
from faceedit_app.editing.edits.edit import Edit, Op

if TYPE_CHECKING:  # the window is there before the solver
    from faceedit_app.editing.session import EditSession


def sample_edit(session: EditSession) -> Edit:
    """An edit that opens the mouth wider, at a typical moment in the middle of the take."""
    times = session.take.clip.times
    opening = session.tracked[:, CONTROL_INDEX[LIP_OPENING]]
    inner = slice(len(times) // 4, max(3 * len(times) // 4, len(times) // 4 + 1))
    ordinary = int(np.argmin(np.abs(opening[inner] - np.median(opening))))
    moment = float(times[inner][ordinary])
    return Edit((LIP_OPENING,), Op.OFFSET, moment - 0.15, moment + 0.15, 0.25, 10.0)
