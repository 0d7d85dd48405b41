"""Find where the user's character leaves open what FaceEdit's own closes, and how to close it.

The edits ask for nothing: they scale curves by 1. Where an edit is, lips and lids are closed on the
user's character as well (`solving/closing.py`), and our curves stay as they are.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from faceedit_app.characters.closure import ARE_LIPS, CLOSING, SHUT, Openings
from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edits.edit import Edit, Op

NAME = "Close on the character"
_CLOSING = [CONTROL_INDEX[control] for control in CLOSING]
_TOGETHER = 0.3  # seconds; gaps closer than this are one
_SHORTEST = 0.05  # seconds; shorter gaps of the lips are not noticed
_FALLOFF = 0.1  # seconds


@dataclass(frozen=True)
class LostClosure:
    """A time during which lips or lids are open on the user's character only.

    Attributes:
        start, end: seconds.
        time: seconds of the widest gap.
        controls: what is open; either the lips or lids.
        width: mm of the widest gap.
    """

    start: float
    end: float
    time: float
    controls: tuple[str, ...]
    width: float

    @property
    def are_lips(self) -> bool:
        """Whether it is between the lips."""
        return bool(ARE_LIPS[CLOSING.index(self.controls[0])])

    @property
    def fix(self) -> Edit:
        """Closes it."""
        return close_between(self.start, self.end, self.controls, _FALLOFF)


def close_between(
    start: float, end: float, controls: tuple[str, ...] = CLOSING, falloff: float = 0.0
) -> Edit:
    """The edit that closes lips and lids on the user's character from `start` to `end` seconds."""
    return Edit(controls, Op.SCALE, start, end, falloff, 1.0, name=NAME)


def gaps_on_character(
    clip: Clip, weights: Floats, ours: Rig, theirs: Rig, nearer: Doubles | float = 0.0
) -> Iterator[LostClosure]:
    """The gaps of a clip on the user's character.

    Args:
        clip: its times are used, not its weights.
        weights: (T, 52) in ARKit order.
        ours, theirs: FaceEdit's own character, and the user's.
        nearer: (T, 3) mm by which ours is nearer than was asked for. Beside lips that are closed on
            theirs, closing fades: ours is drawn along there, but nobody asked for it to be shut.
    """
    widths = Openings.of(theirs).measure(weights)
    are_open = (Openings.of(ours).measure(weights) + nearer < SHUT) & (widths > SHUT)
    for columns, shortest in ((ARE_LIPS, _SHORTEST), (~ARE_LIPS, 0.0)):
        mine = are_open & columns
        frames = np.flatnonzero(mine.any(axis=1))
        if not len(frames):
            continue
        cuts = np.flatnonzero(np.diff(clip.times[frames]) > _TOGETHER)
        for run in np.split(frames, cuts + 1):
            first, last = int(run[0]), int(run[-1])
            start, end = (round(float(clip.times[frame]), 4) for frame in (first, last))
            if end - start < shortest:
                continue
            here = np.where(mine[first : last + 1], widths[first : last + 1], 0.0)
            controls = tuple(CLOSING[i] for i in np.flatnonzero(here.any(axis=0)))
            worst = first + int(here.max(axis=1).argmax())
            yield LostClosure(start, end, float(clip.times[worst]), controls, float(here.max()))


@dataclass(frozen=True)
class AsAsked:
    """What tells closing on the user's character from what was asked for.

    Attributes:
        rigs: FaceEdit's own character, and the one shown.
        asked: (T, C) mm, what the edits ask for.
        weights: (T, 52) as tracked.
        controls: (T, C) mm, as tracked.
    """

    rigs: tuple[Rig, Rig]
    asked: Floats
    weights: Floats
    controls: Floats

    def gaps(self, clip: Clip, weights: Floats, controls: Floats) -> Iterator[LostClosure]:
        """Where the user's character is open, with weights (T, 52) and controls (T, C), mm."""
        return gaps_on_character(clip, weights, *self.rigs, self._nearer(controls))

    def without_closing(self, weights: Doubles, controls: Doubles) -> bool:
        """Take from weights (T, 52) and controls (T, C), in place, what only closing has changed.

        Beside closures on the user's character, ours is drawn along, and presses its lips: that is
        no problem that anybody has made.

        Returns:
            Whether it has changed anything.
        """
        still = (self.asked == self.controls).all(axis=1)
        has_moved = (weights[still] != self.weights[still]).any()
        has_moved |= (controls[still] != self.controls[still]).any()
        weights[still], controls[still] = self.weights[still], self.controls[still]
        nearer = self._nearer(controls)
        controls[:, _CLOSING] += nearer
        return bool(has_moved or nearer.any())

    def _nearer(self, controls: Floats | Doubles) -> Doubles:
        """(T, 3) mm by which lips and lids are nearer than was asked for."""
        lack = (self.asked[:, _CLOSING] - controls[:, _CLOSING]).astype(np.float64)
        return np.asarray(np.maximum(lack, 0.0), np.float64)
