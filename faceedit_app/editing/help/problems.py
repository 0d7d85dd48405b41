"""Find common faults of tracked faces in a take, each with a proposed fix."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles, Floats
from faceedit_app.core.clip import UNSURE, Clip
from faceedit_app.core.controls import CONTROL_INDEX, LIP_OPENING, MAIN_CONTROLS, control_named
from faceedit_app.editing.edits.describe import describe_controls
from faceedit_app.editing.edits.edit import LONGEST_FILL, Edit, Op
from faceedit_app.editing.help.confidence import confidence_of
from faceedit_app.editing.help.fixes import close_lips, complete_blink
from faceedit_app.editing.help.habits import Habits, habits_of, half_blinks, missed_closures
from faceedit_app.editing.help.lost_frames import (
    BESIDE,
    IN_PARTS,
    STEADIED,
    TOGETHER,
    LostFrames,
    beside_gaps,
    lost_frames,
)
from faceedit_app.editing.help.on_character import AsAsked, LostClosure
from faceedit_app.editing.help.shaking import find_shaking
from faceedit_app.editing.help.spoken import NEAR, Closure, close_at, closures_of
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.timing import counted

SHAKE_WINDOW = 0.5  # seconds
SHORTEST_SHAKE = 0.15  # seconds
_BESIDE = 0.02  # seconds beside a problem that still belong to it
_MAIN = [CONTROL_INDEX[control] for control in MAIN_CONTROLS]
_LIPS = control_named(LIP_OPENING).region
_MOVE_WITH_LIPS: Bools = np.array([control_named(c).region == _LIPS for c in MAIN_CONTROLS])
# What counts as entirely wrong, for `Problem.severity`.
WIDE_APART = 5.0  # mm between lips that should meet
VIOLENT = 1.5  # mm of shaking
MANY = 12  # lost frames in a row
HARDLY = 0.5  # confidence


class Kind(StrEnum):
    """What is wrong."""

    LIPS = "lips"  # the lips nearly meet, but do not
    BLINK = "blink"  # a blink does not close the eyes
    JITTER = "jitter"  # a curve shakes from frame to frame
    CHARACTER = "character"  # lips or lids are open on the user's character only
    DROPPED = "dropped"  # the recording lost frames
    UNSURE = "unsure"  # the tracker hardly saw the face


@dataclass(frozen=True)
class Problem:
    """A place where the take is probably wrong.

    Attributes:
        kind: see `Kind`.
        start, end: seconds.
        time: seconds of the frame where it is worst.
        controls: the curves that show it; none for a gap without a jump.
        message: one line for the user.
        amount: how bad it is, with its unit, such as "4.6 mm", or how far from right: "30 % shut".
        severity: how bad it is, 0..1, comparable between kinds.
        fix: the proposed edits; none if edits cannot help.
        about: the sound that it concerns, such as "b of “blue”"; empty for others.
        instead: what else can be done if there is no fix; empty if nothing can.
    """

    kind: Kind
    start: float
    end: float
    time: float
    controls: tuple[str, ...]
    message: str
    amount: str
    severity: float
    fix: tuple[Edit, ...]
    about: str = ""
    instead: str = ""

    def is_at(self, seconds: float) -> bool:
        """Whether a time is within it, or a frame beside."""
        return self.start - _BESIDE <= seconds <= self.end + _BESIDE

    @property
    def why_unfixed(self) -> str:
        """Why there is no fix, and what else can be done; empty if there is one."""
        return "" if self.fix else self.instead or "edits cannot help here"

    def is_as(self, other: Problem) -> bool:
        """Whether another search found the same fault: of its kind, in its curves, at its time.

        A gap is the same whichever curves jump across it.
        """
        same_curves = self.controls == other.controls or {*self.controls} & {*other.controls}
        return (
            self.kind is other.kind
            and self.start <= other.end
            and other.start <= self.end
            and (bool(same_curves) or self.kind is Kind.DROPPED)
        )


def find_problems(session: EditSession) -> list[Problem]:
    """The problems of the take with its edits, in order of time."""
    return search_of(session)()


def search_of(session: EditSession) -> Callable[[], list[Problem]]:
    """The search for problems of the take as it is now; it may run in another thread."""
    take, rigs = session.take, (session.rig, session.shown_rig)
    lost = take.lost_rows.positions if take.lost_rows is not None else ()
    weights, controls, asked = session.weights.copy(), session.achieved.copy(), session.asked.copy()
    spoken, usual, edits = closures_of(session), habits_of(session), session.edits
    sure = confidence_of(take)
    if sure is not None:
        sure = session.moved(sure.astype(np.float32)).astype(np.float64)

    as_asked: AsAsked | None = None
    if rigs[0] is not rigs[1]:
        as_asked = AsAsked(rigs, asked, session.tracked_weights, session.tracked)

    def search() -> list[Problem]:
        return problems_of(take.clip, weights, controls, as_asked, spoken, lost, sure, edits, usual)

    return search


def problems_of(
    clip: Clip,
    weights: Floats,
    controls: Floats,
    as_asked: AsAsked | None = None,
    spoken: Sequence[Closure] = (),
    lost: Sequence[float] = (),
    confidence: Doubles | None = None,
    edits: Sequence[Edit] = (),
    usual: Habits | None = None,
) -> list[Problem]:
    """The problems of a clip, in order of time.

    Args:
        clip: its times, rate and gaps are used, not its weights.
        weights: (T, 52) in ARKit order.
        controls: (T, C) mm, measured with these weights.
        as_asked: if another character is shown.
        spoken: each m, b and p, if the words are known.
        lost: the rows that a fill can give a face to, see `LostRows.positions`.
        confidence: (T,) of the tracker, if it is known.
        edits: where they fill, gaps are answered, and it does not matter how sure the tracker was.
        usual: in the take as tracked; None = in the clip.
    """
    values, measured = weights.astype(np.float64), controls.astype(np.float64)
    usual = Habits.of(clip, values, measured) if usual is None else usual
    shown = _of_curves(clip, values, measured, spoken, usual)
    main = measured[:, _MAIN]
    gaps: list[LostClosure] = []
    if as_asked is not None:
        gaps += as_asked.gaps(clip, weights, controls)
        if as_asked.without_closing(values, measured):
            without = _of_curves(clip, values, measured, spoken, usual)
            shown = [problem for problem in shown if any(map(problem.is_as, without))]
    found = [
        *_spoken(spoken),
        *shown,
        *_dropped(lost_frames(clip, main, lost, confidence, edits)),
        *_unsure(clip, confidence, lost, edits),
        *map(_on_character, gaps),
    ]
    return sorted(found, key=lambda problem: (problem.time, problem.kind))


def _of_curves(
    clip: Clip, weights: Doubles, controls: Doubles, spoken: Sequence[Closure], usual: Habits
) -> list[Problem]:
    """What the curves show: lips that nearly meet, half blinks, and shaking."""
    return [
        *_unspoken(_lips(clip, weights, controls, usual), spoken),
        *_blinks(clip, controls, usual),
        *_jitter(clip, controls[:, _MAIN], spoken),
    ]


def _spoken(closures: Sequence[Closure]) -> list[Problem]:
    return [
        Problem(
            Kind.LIPS,
            round(min(closure.phoneme.start, closure.time), 4),
            round(max(closure.phoneme.end, closure.time), 4),
            closure.time,
            (LIP_OPENING,),
            closure.message,
            f"{closure.gap:.1f} mm",
            _share(closure.gap, WIDE_APART),
            (close_at(closure),),
            closure.name,
        )
        for closure in closures
        if closure.is_open
    ]


def _unspoken(lips: list[Problem], spoken: Sequence[Closure]) -> list[Problem]:
    """Lips that nearly meet where no words are known: words say better where they should."""
    if not spoken:
        return lips
    first, last = spoken[0].phoneme.start - NEAR, spoken[-1].phoneme.end + NEAR
    return [problem for problem in lips if problem.end < first or problem.start > last]


def _lips(clip: Clip, weights: Doubles, controls: Doubles, usual: Habits) -> list[Problem]:
    return [
        Problem(
            Kind.LIPS,
            dip.start,
            dip.end,
            dip.time,
            (LIP_OPENING,),
            f"The lips nearly meet: the mouth stays open by {dip.level:.1f} mm",
            f"{dip.level:.1f} mm",
            _share(dip.level - usual.closed, WIDE_APART),
            (close_lips(dip, usual.closed),),
        )
        for dip in missed_closures(clip, controls, weights, usual)
    ]


def _blinks(clip: Clip, controls: Doubles, usual: Habits) -> list[Problem]:
    open_ = usual.eyes[2]
    return [
        Problem(
            Kind.BLINK,
            dip.start,
            dip.end,
            dip.time,
            lids,
            f"The blink stops half-way: the eyes close by {100 * (1 - dip.level / open_):.0f} %",
            f"{100 * (1 - dip.level / open_):.0f} % shut",
            _share(dip.level, open_),
            (complete_blink(dip, lids),),
        )
        for dip, lids in half_blinks(clip, controls, usual)
    ]


def _on_character(gap: LostClosure) -> Problem:
    what = "lips" if gap.are_lips else "lids"
    return Problem(
        Kind.CHARACTER,
        gap.start,
        gap.end,
        gap.time,
        gap.controls,
        f"On your character the {what} stay {gap.width:.1f} mm apart",
        f"{gap.width:.1f} mm",
        _share(gap.width, WIDE_APART),
        (gap.fix,),
    )


def _jitter(clip: Clip, controls: Doubles, spoken: Sequence[Closure]) -> list[Problem]:
    if len(clip) < 5:
        return []
    window = max(round(SHAKE_WINDOW * clip.rate), 5)
    closing = np.zeros(len(clip), np.bool_)
    for closure in spoken:
        closing |= np.abs(clip.times - closure.time) <= NEAR
    apart = np.zeros(len(clip), np.bool_)  # what happens across a gap is no ripple between frames
    for gap in clip.gaps:
        apart[gap.frame : gap.frame + 2] = True
    meant = closing[:, None] & _MOVE_WITH_LIPS | apart[:, None]
    ripple, shaking = find_shaking(controls, meant, window)
    found = []
    somewhere: Bools = np.any(shaking, axis=1)
    for first, last in _runs(somewhere, round(TOGETHER * clip.rate)):
        if clip.times[last] - clip.times[first] < SHORTEST_SHAKE:
            continue
        # A stretch whose window is half shaking still counts, at either end.
        first, last = max(first - window // 4, 0), min(last + window // 4, len(clip) - 1)
        start, end = (round(float(clip.times[frame]), 4) for frame in (first, last))
        which = np.flatnonzero(shaking[first : last + 1].any(axis=0))
        ids = tuple(MAIN_CONTROLS[i] for i in which)
        shakes = np.abs(ripple[first : last + 1, which]).max(axis=1)
        amount = float(shakes.max())
        worst = float(clip.times[first + int(shakes.argmax())])
        edit = Edit(ids, Op.SMOOTH, start, end, 0.15, STEADIED, name="Steady the curve")
        message = f"Shaking by up to {amount:.1f} mm: {describe_controls(ids)}"
        size = f"{amount:.1f} mm", _share(amount, VIOLENT)
        found.append(Problem(Kind.JITTER, start, end, worst, ids, message, *size, (edit,)))
    return found


def _dropped(gaps: Sequence[LostFrames]) -> list[Problem]:
    return [
        Problem(
            Kind.DROPPED,
            gap.start,
            gap.end,
            gap.time,
            gap.controls,
            gap.message,
            counted(gap.missing, "frame"),
            _share(gap.most, MANY),
            gap.fix,
            instead=gap.instead,
        )
        for gap in gaps
    ]


def _unsure(
    clip: Clip, confidence: Doubles | None, lost: Sequence[float], edits: Sequence[Edit]
) -> list[Problem]:
    if confidence is None:
        return []
    unsure: Bools = (confidence > 0.0) & (confidence < UNSURE)  # 0: it has been filled
    unsure = unsure & ~beside_gaps(clip, lost, confidence)
    for edit in edits:
        if edit.op is Op.FILL and edit.enabled:
            unsure = unsure & ~((clip.times >= edit.start) & (clip.times <= edit.end))
    found = []
    for first, last in _runs(unsure, round(TOGETHER * clip.rate)):
        start, end = (round(float(clip.times[frame]), 4) for frame in (first, last))
        least = first + int(confidence[first : last + 1].argmin())
        sure = float(confidence[least])
        around = (
            float(clip.times[max(first - 1, 0)]),
            float(clip.times[min(last + 1, len(clip) - 1)]),
        )
        fits = around[1] - around[0] <= LONGEST_FILL
        fill = Edit(MAIN_CONTROLS, Op.FILL, *around, BESIDE, name="Fill what is hidden")
        found.append(
            Problem(
                Kind.UNSURE,
                start,
                end,
                float(clip.times[least]),
                MAIN_CONTROLS,
                f"The face is hidden or turned away: the tracker is {100 * sure:.0f} % sure",
                f"{100 * sure:.0f} % sure",
                _share(UNSURE - sure, UNSURE - HARDLY),
                (fill,) if fits else (),
                instead="" if fits else IN_PARTS,
            )
        )
    return found


def _share(amount: float, most: float) -> float:
    return min(max(amount / most, 0.0), 1.0) if most > 0 else 1.0


def _runs(where: Bools, join: int) -> list[tuple[int, int]]:
    """Runs (first, last) of true frames; runs at most `join` frames apart are joined."""
    frames = np.flatnonzero(where)
    if not len(frames):
        return []
    cuts = np.flatnonzero(np.diff(frames) > join)
    firsts, lasts = frames[np.r_[0, cuts + 1]], frames[np.r_[cuts, len(frames) - 1]]
    return list(zip(firsts.tolist(), lasts.tolist(), strict=True))
