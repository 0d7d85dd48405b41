"""What is usual in a take: how far its own closures close, and how wide its eyes are open.

Whether lips nearly met, or a blink stopped half-way, is judged by this. It is measured in the take
as tracked: an edit of a second must not change what is said about another minute.
"""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np

from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import LIDS, LIP_OPENING
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.help.events import (
    APART,
    HARDLY_APART,
    LID_COLUMNS,
    MOST_OF_THE_WAY,
    NEARLY,
    OPENING,
    PRESSED,
    RAISED,
    SHUT,
    STILL,
    Dip,
    blinks,
    closed_lips,
    lip_dips,
    open_eyes,
    pressing,
)
from faceedit_app.editing.session import EditSession

# These move or calm what is there; they do not make the lips meet at another height.
_KEEP = (Op.SMOOTH, Op.RETIME, Op.FILL, Op.RESET)


@dataclass(frozen=True)
class Habits:
    """What is usual in a take.

    Attributes:
        closed: mm, the mouth opening of closed lips.
        wide: mm, that of a mouth that is wide open.
        pressed: weight by which the lips are pressed as a rule.
        shows: whether its closures press the lips: many trackers do not record that.
        eyes: mm, the opening of open eyes: left, right, both together, and of their mean.
    """

    closed: float
    wide: float
    pressed: float
    shows: bool
    eyes: tuple[float, float, float, float]

    @classmethod
    def of(cls, clip: Clip, weights: Doubles, controls: Doubles) -> Habits:
        """Measure them.

        Args:
            clip: its times and rate are used.
            weights: (T, 52) in ARKit order.
            controls: (T, C) mm.
        """
        closed, press = closed_lips(controls), pressing(weights)
        usual = float(np.median(press))
        found = lip_dips(clip.times, controls, press - usual, clip.rate)
        own = [much for dip, much in found if dip.level <= closed + HARDLY_APART]
        lids = controls[:, LID_COLUMNS]
        left, right, both, mean = map(open_eyes, (lids[:, 0], lids[:, 1], lids, lids.mean(axis=1)))
        return cls(
            closed,
            float(np.percentile(controls[:, OPENING], 95)),
            usual,
            bool(own) and float(np.median(own)) > PRESSED,
            (left, right, both, mean),
        )


def missed_closures(clip: Clip, controls: Doubles, weights: Doubles, usual: Habits) -> list[Dip]:
    """Closures, as for /p b m/, in which the lips stayed apart, compared with the take's own.

    The opening alone cannot distinguish an open /m/ from an /f/, in which the lower lip meets the
    teeth. Lips that close press and roll in, the upper lip too, and it is not raised. Many
    trackers do not record pressing, though: if the take's own closures show none, a movement that
    came most of the way counts, unless the upper lip is raised.

    Args:
        clip: its times and rate are used.
        controls: (T, C) mm.
        weights: (T, 52) in ARKit order.
        usual: in this take.
    """
    nearly = min(NEARLY[0] * (usual.wide - usual.closed), NEARLY[1])

    def is_missed(dip: Dip, press: float) -> bool:
        gap = dip.level - usual.closed
        if not HARDLY_APART < gap < nearly:
            return False
        came = gap <= MOST_OF_THE_WAY * dip.depth
        return (press > PRESSED and gap > APART) or (not usual.shows and came and press > -RAISED)

    pressed = pressing(weights) - usual.pressed
    found = lip_dips(clip.times, controls, pressed, clip.rate)
    return [dip for dip, press in found if is_missed(dip, press)]


def half_blinks(clip: Clip, controls: Doubles, usual: Habits) -> list[tuple[Dip, tuple[str, ...]]]:
    """The blinks that left an eye open, and the ids of the eyelids that took part.

    Args:
        clip: its times and rate are used.
        controls: (T, C) mm.
        usual: in this take.
    """
    left, right, _, mean = usual.eyes
    found = []
    for dip in blinks(clip.times, controls, clip.rate, mean):
        near = controls[max(dip.frame - 1, 0) : dip.frame + 2, LID_COLUMNS].min(axis=0)
        # If one lid stays up, it is a wink of the other.
        took_part = [low < STILL * high for low, high in zip(near, (left, right), strict=True)]
        shut = [low <= SHUT * high for low, high in zip(near, (left, right), strict=True)]
        lids = tuple(name for name, took in zip(LIDS, took_part, strict=True) if took)
        if any(took and not s for took, s in zip(took_part, shut, strict=True)):
            found.append((dip, lids))
    return found


_known: WeakKeyDictionary[EditSession, Habits] = WeakKeyDictionary()


def habits_of(session: EditSession) -> Habits:
    """What is usual in a take.

    Edits that change lips, lids or channels from the first frame to the last, such as a new
    neutral, count as part of the take.
    """
    last = float(session.take.clip.times[-1])
    if any(_is_throughout(edit, last) for edit in session.edits):
        return _measured(session, session.weights, session.achieved)
    if session not in _known:
        weights = session.take.clip.arkit_weights()
        _known[session] = _measured(session, weights, session.tracked)
    return _known[session]


def _measured(session: EditSession, weights: Floats, controls: Floats) -> Habits:
    clip = session.take.clip
    return Habits.of(clip, weights.astype(np.float64), controls.astype(np.float64))


def _is_throughout(edit: Edit, last: float) -> bool:
    """Whether an edit changes what is usual from the first second to the last."""
    if edit.effect is None or edit.op in _KEEP or (edit.op is Op.SCALE and edit.value == 1.0):
        return False
    concerned = bool(edit.channels) or {LIP_OPENING, *LIDS} & set(edit.controls)
    return bool(concerned) and edit.start <= 0.0 and edit.end >= last
