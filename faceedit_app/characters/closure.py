"""Measure whether lips and lids close on a character where they close on FaceEdit's own.

The same weights give other distances on another head: blendshapes that close one mouth may leave
another open.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.arrays import Bools, Doubles, Floats
from faceedit_app.core.controls import CONTROL_INDEX, CONTROLS, Closes
from faceedit_app.core.levels import Levels
from faceedit_app.core.rig import Distances, Rig

# The controls that touch at 0: lips, then lids.
CLOSING: tuple[str, ...] = tuple(c.id for c in CONTROLS if c.closes is not None)
ARE_LIPS = np.array([c.closes is Closes.LIPS for c in CONTROLS if c.closes is not None])
# mm up to which something is closed, and beyond which it is visibly open.
SHUT = np.where(ARE_LIPS, 2.0, 1.5)
CLOSE_ENOUGH = 0.5  # mm
# A shape that closes an eye need not bring two vertices together: lids that it leaves apart by this
# share of the open eye are as closed as their artist made them.
LID_SLACK = 0.05
_FLAT = 0.05  # mm; the least difference in height that shows which of two vertices is above
_BLINK = np.zeros((1, len(ARKIT_CHANNELS)), np.float32)
_BLINK[0, [ARKIT_INDEX["eyeBlinkLeft"], ARKIT_INDEX["eyeBlinkRight"]]] = 1.0


@dataclass(frozen=True)
class Openings:
    """How far apart lips and lids are on a character.

    Attributes:
        distances: the controls of `CLOSING`, as a function of weights as the character shows
            them, in ARKit's order.
        levels: how strongly the character answers each channel.
        touching: (3,) mm between their vertices when they touch, which are side by side. Lips touch
            at rest: on a head that rests with parted lips, only grimaces bring them nearer.
        has: (3,) whether the character has each of them.
    """

    distances: Distances
    touching: Doubles
    has: Bools
    levels: Levels = field(default_factory=Levels)

    @classmethod
    def of(cls, rig: Rig) -> Openings:
        """Make the gaps of a character."""
        rows = [CONTROL_INDEX[name] for name in CLOSING]
        distances = _without_sliding(rig.arkit_distances.select(rows))
        rest = np.linalg.norm(distances.offsets, axis=1).astype(np.float64)
        # Lips and lids can pass each other. If two vertices coincide at rest, the upper one counts
        # as slightly higher.
        offsets = distances.offsets.copy()
        offsets[np.abs(offsets[:, 1]) < _FLAT, 1] = -_FLAT
        distances = replace(distances, offsets=offsets, shuts=np.ones(len(rows), np.bool_))
        shut = distances.measure(rig.levels.applied(_BLINK))[0].astype(np.float64)
        touching = np.where(
            ARE_LIPS,
            rest,
            np.where(shut > CLOSE_ENOUGH, np.minimum(shut, LID_SLACK * rest), 0.0),
        )
        return cls(distances, touching, rig.has_control[rows], rig.levels)

    def measure(self, weights: Floats) -> Doubles:
        """(T, 52) weights in ARKit's order -> (T, 3) mm beyond touching, 0 or more."""
        lengths = self.distances.measure(self.levels.applied(weights)).astype(np.float64)
        gaps: Doubles = np.maximum(lengths - self.touching, 0.0)
        return gaps


def _without_sliding(distances: Distances) -> Distances:
    """The distances, of lips only in height and depth: in a crooked smile they slide sideways."""
    offsets, gradients = distances.offsets.copy(), distances.gradients.copy()
    offsets[ARE_LIPS, 0] = 0.0
    gradients[:, ARE_LIPS, 0] = 0.0
    return replace(distances, offsets=offsets, gradients=gradients)


@dataclass(frozen=True)
class ClosureShares:
    """How often a character's lips and lids stay open where ours are closed.

    Attributes:
        lips_frames, lids_frames: the number of frames (and eyes) closed on ours.
        lips_open_share, lids_open_share: the share of these that are open on theirs, by more
            than 2 mm (lips) or 1.5 mm (lids).
        lips_within_share, lids_within_share: the share that are within 0.5 mm.
        lips_gap, lids_gap: the 95th percentile of the gap on these frames, mm.
    """

    lips_frames: int
    lips_open_share: float
    lips_within_share: float
    lips_gap: float
    lids_frames: int
    lids_open_share: float
    lids_within_share: float
    lids_gap: float


def closure(ours: Doubles, theirs: Doubles) -> ClosureShares:
    """Compare gaps, (T, 3) mm each, of the same frames on two characters."""
    shut = ours < SHUT
    open_ = theirs > SHUT

    def kind(lips: bool) -> tuple[int, float, float, float]:
        columns = lips == ARE_LIPS
        where = shut[:, columns]
        gaps = theirs[:, columns][where]
        if not len(gaps):
            return 0, 0.0, 1.0, 0.0
        far, within = open_[:, columns][where].mean(), (gaps <= CLOSE_ENOUGH).mean()
        return len(gaps), float(far), float(within), float(np.percentile(gaps, 95))

    return ClosureShares(*kind(lips=True), *kind(lips=False))


def together(all_gaps: Sequence[Doubles]) -> Doubles:
    """The gaps of several takes as one, (T, 3) mm."""
    return np.concatenate([np.zeros((0, len(CLOSING))), *all_gaps])
