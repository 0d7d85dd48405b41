"""Channels that move with a region's own although no network answers them.

A smile that stops at the mouth is no smile: cheeks rise and dimples form. How far is a table,
measured on smiles, sneers and wide eyes of people in front of a phone (Apple's ARKit, 3 mm of
both mouth corners: `mouthSmile` .26, `cheekSquint` .155, `mouthDimple` .151, `eyeSquint` .126).
It is what a take's own frames are weighed against, and all there is for movements that the take
does not show. A channel that the take lacks or never uses stays as it is.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from faceedit_app.core.arrays import Doubles

# (leading, following) -> weight of the follower for each unit of the leader, side by side.
_GAINS = {
    ("mouthSmile", "cheekSquint"): 0.60,
    ("mouthSmile", "mouthDimple"): 0.58,
    ("mouthUpperUp", "noseSneer"): 0.68,
    ("mouthPucker", "mouthShrugLower"): 0.30,
}
# Channels that performances trained on, most of them ranges of motion, use more than people do
# when they smile or speak; a take that uses them says so itself.
_RESERVED = {"mouthStretch": 0.3, "mouthFrown": 0.6, "mouthPress": 0.5}
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
