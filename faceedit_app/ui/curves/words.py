"""Hints and notes of the curves panel."""

from __future__ import annotations

from faceedit_app.editing.edits.describe import one_decimal
from faceedit_app.ui.state.timeline import Timeline
from faceedit_app.ui.state.tools import Tool

_APART = 0.05  # least mm between two lines for a note in the header
CHOSEN_HINT = "Drag the handles of the chosen edit, or its curve; Esc: done"
IDLE_HINTS = {
    Tool.MOVE: "Drag a curve up or down to change the face",
    Tool.DRAW: "Draw a curve freehand",
    Tool.SMOOTH: "Paint over a shaky curve to smooth it",
    Tool.SCALE: "Drag a curve up to enlarge movements, down to reduce them",
    Tool.FLATTEN: "Paint over a curve to hold it at the value where you pressed",
    Tool.RESTORE: "Paint over edits to go back to the tracked take",
    Tool.RETIME: "Drag the curve or the selection sideways to move it in time, an end to stretch",
}


def length(timeline: Timeline, seconds: float, sign: str = "") -> str:
    """A length of time in the unit in which times are shown; `sign` may be `+`."""
    clip = timeline.clip
    if clip is None or not timeline.display.counts_frames:
        return f"{seconds:{sign}.2f} s"
    return f"{seconds * clip.rate:{sign}.1f} frames"


def note_on(tracked: float, asked: float, face: float) -> str:
    """A note if the face differs from what was asked for, or else from the tracked value."""
    if abs(asked - tracked) > _APART and _read_apart(asked, face):
        return f"asked {one_decimal(asked)}"
    return f"tracked {one_decimal(tracked)}" if _read_apart(tracked, face) else ""


def _read_apart(one: float, other: float) -> bool:
    """Whether two values differ visibly and in one decimal."""
    return abs(one - other) > _APART and one_decimal(one) != one_decimal(other)
