"""Gaps in a take, and the fills that give their rows a face.

A fill replaces only what is missing, and frames beside it of which the tracker was unsure. Frames
that were tracked well stay as they are, however many gaps there are around them: a film whose
camera dropped every fourth picture still shows each closure and blink.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles
from faceedit_app.core.clip import UNSURE, Clip, Gap
from faceedit_app.core.controls import MAIN_CONTROLS, control_named
from faceedit_app.editing.edits.describe import describe_controls
from faceedit_app.editing.edits.edit import LONGEST_FILL, Edit, Op

BESIDE = 0.15  # seconds on either side of a gap in which unsure frames belong to it
TOGETHER = 0.3  # seconds; gaps closer than this are reported as one
STEADIED = 0.04  # seconds of smoothing against a jump
_AT_A_TIME = f"Fill replaces up to {LONGEST_FILL:.0f} s of it at a time"
IN_PARTS = f"too long for one fix; {_AT_A_TIME}"
_JUMP = 1.5  # mm across a gap that are noticeable
_LONG = 0.25  # seconds from which the face may jump across a gap that has no rows
_BLEND = 0.04  # seconds on either side of such a gap that change so that motion runs through


@dataclass(frozen=True)
class LostFrames:
    """A gap, or several that are close together.

    Attributes:
        start, end: seconds of the frames before and after.
        time: seconds of the frame before the worst of them.
        controls: the curves that jump.
        message: one line for the user.
        missing: the number of frames.
        most: the number of frames that are missing in a row.
        fix: an edit for each gap that one can help.
        instead: what else can be done if there is none; empty if nothing can.
    """

    start: float
    end: float
    time: float
    controls: tuple[str, ...]
    message: str
    missing: int
    most: int
    fix: tuple[Edit, ...]
    instead: str


@dataclass(frozen=True)
class _Hole:
    """A gap with what is needed to fix it.

    Attributes:
        gap: the gap.
        rows: seconds of the rows of the file that lie in it.
        filled: for each of them, whether a fill of the whole face gives it one.
        kept: the sure frames before and after.
        moved: the curves that jump across it.
        softened: those that were smoothed across it.
    """

    gap: Gap
    rows: tuple[float, ...]
    filled: tuple[bool, ...]
    kept: tuple[int, int]
    moved: tuple[str, ...]
    softened: frozenset[str]


def lost_frames(
    clip: Clip,
    controls: Doubles,
    lost: Sequence[float] = (),
    confidence: Doubles | None = None,
    edits: Sequence[Edit] = (),
) -> list[LostFrames]:
    """The gaps of a clip that no fills cover, in order of time.

    Args:
        clip: its times and gaps are used.
        controls: (T, C) mm of the main controls.
        lost: the rows that a fill can give a face to, see `LostRows.positions`.
        confidence: (T,) of the tracker, if it is known.
        edits: those that have been made.
    """
    holes = [_hole(clip, gap, controls, lost, confidence, edits) for gap in clip.gaps]
    open_ = [hole for hole in holes if not _is_filled(clip, hole, edits)]
    return [_together(clip, group, controls) for group in _grouped(clip, open_)]


def beside_gaps(clip: Clip, lost: Sequence[float], confidence: Doubles) -> Bools:
    """(T,) the unsure frames that the fills of gaps cover."""
    beside = np.zeros(len(clip), np.bool_)
    for gap in clip.gaps:
        if _rows_in(clip, gap, lost):
            before, after = _kept(clip, gap, confidence)
            beside[before + 1 : after] = True
    return beside


def _hole(
    clip: Clip,
    gap: Gap,
    controls: Doubles,
    lost: Sequence[float],
    confidence: Doubles | None,
    edits: Sequence[Edit],
) -> _Hole:
    rows, (start, end) = _rows_in(clip, gap, lost), _ends(clip, gap)
    kept = gap.frame, min(gap.frame + 1, len(clip) - 1)
    if rows and confidence is not None:
        kept = _kept(clip, gap, confidence)
    moved: tuple[str, ...] = ()
    if rows or end - start >= _LONG:  # less than that, a face may move as far in any take
        jumps = np.abs(controls[kept[1]] - controls[kept[0]])
        moved = tuple(c for c, jump in zip(MAIN_CONTROLS, jumps, strict=True) if jump > _JUMP)
    softened = {c for edit in _covering(edits, Op.SMOOTH, start, end) for c in edit.controls}
    return _Hole(gap, rows, _filled(rows, edits), kept, moved, frozenset(softened))


def _ends(clip: Clip, gap: Gap) -> tuple[float, float]:
    """Seconds of the frames before and after a gap."""
    after = min(gap.frame + 1, len(clip) - 1)
    return round(float(clip.times[gap.frame]), 4), round(float(clip.times[after]), 4)


def _rows_in(clip: Clip, gap: Gap, lost: Sequence[float]) -> tuple[float, ...]:
    """Seconds of the lost rows in a gap."""
    start, end = _ends(clip, gap)
    inside = [place - gap.frame for place in lost if 0 < place - gap.frame < 1]
    return tuple(start + share * (end - start) for share in inside)


def _kept(clip: Clip, gap: Gap, confidence: Doubles) -> tuple[int, int]:
    """The last frame before a gap, and the first after it, that are sure or too far from it."""
    (start, end), before, after = _ends(clip, gap), gap.frame, gap.frame + 1
    while before > 0 and confidence[before] < UNSURE and start - clip.times[before] < BESIDE:
        before -= 1
    last = len(clip) - 1
    while after < last and confidence[after] < UNSURE and clip.times[after] - end < BESIDE:
        after += 1
    return before, min(after, last)


def _filled(rows: tuple[float, ...], edits: Sequence[Edit]) -> tuple[bool, ...]:
    """For each of some times, whether a fill of the whole face covers it, as in `Fills.found`."""
    filled = np.zeros(len(rows), np.bool_)
    for edit in edits:
        if edit.op is Op.FILL and edit.effect is not None and _is_whole(edit):
            filled |= edit.mask(np.array(rows)) > 0.5
    return tuple(filled.tolist())


def _is_filled(clip: Clip, hole: _Hole, edits: Sequence[Edit]) -> bool:
    """Whether fills of the whole face cover all rows of a gap, or one both frames beside it."""
    if hole.rows:
        return all(hole.filled)
    return any(map(_is_whole, _covering(edits, Op.FILL, *_ends(clip, hole.gap))))


def _is_whole(edit: Edit) -> bool:
    return set(edit.controls) >= set(MAIN_CONTROLS)


def _grouped(clip: Clip, holes: Sequence[_Hole]) -> list[list[_Hole]]:
    """Gaps that are close together."""
    groups: list[list[_Hole]] = []
    for hole in sorted(holes, key=lambda hole: hole.gap.frame):
        now = clip.times[hole.gap.frame]
        if groups and now - clip.times[groups[-1][-1].gap.frame] <= TOGETHER:
            groups[-1].append(hole)
        else:
            groups.append([hole])
    return groups


def _together(clip: Clip, holes: Sequence[_Hole], controls: Doubles) -> LostFrames:
    worst = max(holes, key=lambda hole: (_jump(hole, controls), hole.gap.missing))
    start, end = _ends(clip, holes[0].gap)[0], _ends(clip, holes[-1].gap)[1]
    missing = sum(hole.gap.missing for hole in holes)
    moved = tuple(c for c in MAIN_CONTROLS if any(c in hole.moved for hole in holes))
    message = "1 frame is missing" if missing == 1 else f"{missing} frames are missing"
    if len(holes) > 1:
        message += f" at {len(holes)} places"
    if filled := sum(sum(hole.filled) for hole in holes):
        message += f", {filled} of them {'is' if filled == 1 else 'are'} filled"
    without = missing - sum(len(hole.rows) for hole in holes)
    if without >= missing:
        message += f", and the file has no row for {'it' if missing == 1 else 'them'}"
    elif without > 0:
        message += f", and the file has no row for {without} of them"
    if moved:
        message += f"; a jump in: {describe_controls(moved)}"
    fix = tuple(edit for hole in holes for edit in _fixes(clip, hole))
    return LostFrames(
        start,
        end,
        _ends(clip, worst.gap)[0],
        moved,
        message,
        missing,
        max(hole.gap.missing for hole in holes),
        fix,
        "" if fix else _instead(holes),
    )


def _instead(holes: Sequence[_Hole]) -> str:
    """What else can be done about gaps that have no fix, or why nothing can; else nothing."""
    is_soft, has_rows = any(h.softened for h in holes), any(h.rows for h in holes)
    if has_rows:
        return f"its jump is softened, and {_AT_A_TIME}" if is_soft else IN_PARTS
    return "its jump is softened already" if is_soft else ""


def _jump(hole: _Hole, controls: Doubles) -> float:
    """mm by which a curve moves across a gap."""
    before, after = hole.kept
    return float(np.abs(controls[after] - controls[before]).max(initial=0.0))


def _fixes(clip: Clip, hole: _Hole) -> tuple[Edit, ...]:
    """What helps a gap; () if nothing does.

    Rows of the file get a face, as far as no fill has given them one. Frames that the file has no
    rows for stay missing; across a long gap, those beside it change so that the motion runs
    through.
    """
    start, end = _ends(clip, hole.gap)
    if hole.rows:
        first, last = _to_fill(clip, hole)
    elif hole.moved:
        first, last = max(start - _BLEND, 0.0), min(end + _BLEND, float(clip.times[-1]))
    else:
        return ()
    if last - first <= LONGEST_FILL:
        span = round(first, 4), round(last, 4), 0.0
        return (Edit(MAIN_CONTROLS, Op.FILL, *span, name="Fill the gap"),)
    # With all curves of its region: those that are left out would jump instead. A second time does
    # not help.
    regions = {control_named(c).region for c in hole.moved if c not in hole.softened}
    region = (c for c in MAIN_CONTROLS if control_named(c).region in regions)
    rest = tuple(c for c in region if c not in hole.softened)
    soft = start, end, 0.1, STEADIED
    return (Edit(rest, Op.SMOOTH, *soft, name="Soften the jump"),) if rest else ()


def _to_fill(clip: Clip, hole: _Hole) -> tuple[float, float]:
    """Seconds from the first to the last row that needs a face, with unsure frames beside them.

    Each end is half-way to the row or frame that stays.
    """
    (before, after), frame = hole.kept, hole.gap.frame
    beside = clip.times[before : frame + 1].tolist(), clip.times[frame + 1 : after + 1].tolist()
    seconds, begin = [*beside[0], *hole.rows, *beside[1]], len(beside[0])
    left = [begin + row for row, filled in enumerate(hole.filled) if not filled]
    first = left[0] if hole.filled[0] else 1
    last = left[-1] if hole.filled[-1] else len(seconds) - 2
    return 0.5 * (seconds[first - 1] + seconds[first]), 0.5 * (seconds[last] + seconds[last + 1])


def _covering(edits: Sequence[Edit], op: Op, start: float, end: float) -> list[Edit]:
    """The edits of a kind that have an effect and cover all of a range."""
    return [
        edit
        for edit in edits
        if edit.op is op and edit.effect is not None and edit.start <= start and end <= edit.end
    ]
