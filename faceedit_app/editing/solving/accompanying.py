"""Channels that move with a region's own although no network answers them.

A smile that stops at the mouth is no smile: cheeks rise and dimples form. How far is a table,
measured on smiles, sneers and wide eyes of people in front of a phone (Apple's ARKit, 3 mm of
both mouth corners: `mouthSmile` .26, `cheekSquint` .155, `mouthDimple` .151, `eyeSquint` .126).
It is what a take's own frames are weighed against, and all there is for movements that the take
does not show. A channel that the take lacks or never uses stays as it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.arrays import Doubles, Indices
from faceedit_app.core.rig import Distances

# (leading, following) -> weight of the follower for each unit of the leader, side by side.
_GAINS = {
    ("mouthSmile", "cheekSquint"): 0.60,
    ("mouthSmile", "mouthDimple"): 0.58,
    ("mouthUpperUp", "noseSneer"): 0.68,
    ("mouthPucker", "mouthShrugLower"): 0.30,
}
# The same across regions: the follower joins in unless its own curve is asked for.
_ACROSS = {("mouthSmile", "eyeSquint"): 0.48}
# Frames at 25 fps, with a leader that varies by `_SPREAD`, that the table counts as.
_PRIOR_FRAMES, _SPREAD = 200.0, 0.15
# Channels that performances trained on, most of them ranges of motion, use more than people do
# when they smile, speak or blink; a take that uses them says so itself.
_RESERVED = {
    "mouthStretch": 0.3,
    "mouthFrown": 0.6,
    "mouthPress": 0.5,
    "browDown": 0.5,
    "browInnerUp": 0.5,
    "browOuterUp": 0.5,
}
# Channels that do not rise while lips are closed.
STAYS_IN_CLOSURES = ("mouthFrown",)
# Variance of an accompanying channel that the leaders do not explain.
_OWN_VARIANCE = 0.002


def gains(leading: Sequence[str], following: Sequence[str]) -> Doubles:
    """(K, E) how far E channels follow K others."""
    table = np.zeros((len(leading), len(following)))
    for i, leader in enumerate(leading):
        for j, follower in enumerate(following):
            table[i, j] = _gain(leader, follower)
    return table


def stem(channel: str) -> str:
    """A channel's name without its side."""
    return _side(channel)[0]


def use(channels: Sequence[str]) -> Doubles:
    """(K,) in 0..1, the share of the networks' answer that each channel gives."""
    return np.array([_RESERVED.get(stem(channel), 1.0) for channel in channels])


def with_accompanying(covariance: Doubles, table: Doubles) -> Doubles:
    """The covariance (K + E, K + E) of channels and those that accompany them.

    Args:
        covariance: (K, K).
        table: (K, E), see `gains`.
    """
    across = covariance @ table
    own = table.T @ across + _OWN_VARIANCE * np.eye(table.shape[1])
    return np.block([[covariance, across], [across.T, own]])


@dataclass(frozen=True)
class Across:
    """A channel that accompanies one of another region.

    Attributes:
        leader, follower: columns among the 52.
        gain: how far the follower goes with the leader in this take.
        low: the follower's smallest weight in the take.
        leads, follows: the controls that the leader and the follower move.
    """

    leader: int
    follower: int
    gain: float
    low: float
    leads: Indices
    follows: Indices

    def join(self, weights: Doubles, tracked: Doubles, hold: Doubles, calm: Doubles) -> None:
        """Move the follower with the leader, in place.

        Args:
            weights: (N, 52) edited.
            tracked: (N, 52).
            hold, calm: (N, C) in 0..1, see `Request`. Shaking is nothing to join in.
        """
        change = weights[:, self.leader] - tracked[:, self.leader]
        free = 1.0 - hold[:, self.follows].max(axis=1, initial=0.0)
        free *= 1.0 - calm[:, self.leads].max(axis=1, initial=0.0)
        now = weights[:, self.follower]
        low, high = np.minimum(now, self.low), np.maximum(now, 1.0)
        moved = np.clip(now + self.gain * free * change, low, high)
        weights[:, self.follower] = np.where(change != 0, moved, now)


def across(
    used: Sequence[str], blocks: list[Doubles], low: Doubles, distances: Distances
) -> list[Across]:
    """The channels that accompany others of another region in a take.

    Args:
        used: channels that the take has and uses.
        blocks: stretches (N, 52) of the take at 25 fps.
        low: (52,) the smallest weights of the take.
        distances: all controls as a function of the 52 weights.
    """
    weights = np.concatenate(blocks)
    centred = weights - weights.mean(axis=0)
    found = []
    for (lead, follow), gain in _ACROSS.items():
        for leader in (c for c in ARKIT_CHANNELS if stem(c) == lead and c in used):
            follower = follow + _side(leader)[1]
            if follower not in used:
                continue
            a, b = ARKIT_INDEX[leader], ARKIT_INDEX[follower]
            prior = _PRIOR_FRAMES * _SPREAD**2
            own = centred[:, a] @ centred[:, b] + prior * gain
            fitted = float(own / (centred[:, a] @ centred[:, a] + prior))
            moves = [np.flatnonzero(distances.gradients[i].any(axis=1)) for i in (a, b)]
            found.append(Across(a, b, max(fitted, 0.0), float(low[b]), *moves))
    return found


def _gain(leader: str, follower: str) -> float:
    (lead, left), (follow, right) = _side(leader), _side(follower)
    same = not left or not right or left == right
    return _GAINS.get((lead, follow), 0.0) if same else 0.0


def _side(channel: str) -> tuple[str, str]:
    """A channel's name without its side, and the side."""
    for side in ("Left", "Right"):
        if channel.endswith(side):
            return channel[: -len(side)], side
    return channel, ""
