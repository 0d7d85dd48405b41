"""Whether lips and lids close on a character where they close on FaceEdit's own.

The same weights mean other distances on another head: blendshapes that close one mouth leave
another one open.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles, Floats
from faceedit_app.core.controls import CONTROL_INDEX, CONTROLS, Closes
from faceedit_app.core.rig import Distances, Rig

# The controls at whose 0 something touches: lips, then lids.
CLOSING: tuple[str, ...] = tuple(c.id for c in CONTROLS if c.closes is not None)
ARE_LIPS = np.array([c.closes is Closes.LIPS for c in CONTROLS if c.closes is not None])
# Millimetres up to which something is shut, and beyond which it is seen to be open.
SHUT = np.where(ARE_LIPS, 2.0, 1.5)
CLOSE_ENOUGH = 0.5  # mm
_PARTED_AT_REST = 1.5  # mm; a mouth that rests more open than this can be shut farther
_FLAT = 0.05  # mm of height that say which way round two vertices are that lie together


@dataclass(frozen=True)
class Gaps:
    """How far lips and lids are apart on a character.

    Attributes:
        distances: of the controls of `CLOSING`, by weights in ARKit's order.
        touching: (3,) mm between their vertices where they touch: they lie beside each other.
        has: (3,) which of them the character has.
    """

    distances: Distances
    touching: Doubles
    has: Bools

    @classmethod
    def of(cls, rig: Rig) -> Gaps:
        """The gaps of a character."""
        rows = [CONTROL_INDEX[name] for name in CLOSING]
        distances = rig.arkit_distances.select(rows)
        rest = np.linalg.norm(distances.offsets, axis=1).astype(np.float64)
        # Lips and lids both can pass each other. Where vertices lie together at rest, the upper
        # one is taken to be above by a little.
        offsets = distances.offsets.copy()
        offsets[np.abs(offsets[:, 1]) < _FLAT, 1] = -_FLAT
        distances = replace(distances, offsets=offsets, shuts=np.ones(len(rows), np.bool_))
        touching = np.where(ARE_LIPS, np.minimum(rest, _PARTED_AT_REST), 0.0)
        return cls(distances, touching, rig.has_control[rows])

    def measure(self, weights: Floats) -> Doubles:
        """(T, 52) weights in ARKit's order -> (T, 3) mm beyond touching, 0 or more."""
        lengths = self.distances.measure(weights).astype(np.float64)
        gaps: Doubles = np.maximum(lengths - self.touching, 0.0)
        return gaps


@dataclass(frozen=True)
class Closure:
    """How often a character's lips and lids stay open where ours are shut.

    Attributes:
        lips_frames, lids_frames: on how many frames (and eyes) they are shut on ours.
        lips_open_share, lids_open_share: of these, the share on which they are open on theirs:
            by more than 2 mm (lips), 1.5 mm (lids).
        lips_within_share, lids_within_share: the share on which they are within 0.5 mm.
        lips_gap, lids_gap: 95th percentile of the gap there, mm.
    """

    lips_frames: int
    lips_open_share: float
    lips_within_share: float
    lips_gap: float
    lids_frames: int
    lids_open_share: float
    lids_within_share: float
    lids_gap: float


def closure(ours: Doubles, theirs: Doubles) -> Closure:
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

    return Closure(*kind(lips=True), *kind(lips=False))


def together(all_gaps: Sequence[Doubles]) -> Doubles:
    """The gaps of several takes as one, (T, 3) mm."""
    return np.concatenate([np.zeros((0, len(CLOSING))), *all_gaps])
