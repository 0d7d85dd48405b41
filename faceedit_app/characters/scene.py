"""A character with the animation of a take, ready to be written in a format of 3D programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from faceedit_app.characters.matches import Half, Share
from faceedit_app.characters.turning import Turning
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.arrays import Floats, Times
from faceedit_app.core.clip import Clip
from faceedit_app.core.levels import Levels
from faceedit_app.core.rig import Rig


@dataclass(frozen=True)
class Scene:
    """A rig, and the weights of its blendshapes over time.

    Attributes:
        rig: the character, with K channels.
        shapes: the K names that its blendshapes have in the file.
        weights: (T, K) float32.
        times: (T,) seconds from 0.
        rate: nominal frames per second.
        turning: how the head turns; None = it stays straight.
    """

    rig: Rig
    shapes: tuple[str, ...]
    weights: Floats
    times: Times
    rate: float
    turning: Turning | None = None


def make_scene(
    rig: Rig,
    clip: Clip,
    shares: Mapping[str, Sequence[Share]] | None = None,
    follows_head: bool = False,
) -> Scene:
    """Put a take on a rig; channels that the take lacks are 0.

    Args:
        follows_head: turn the head as it was recorded, if the take has its rotations.
        shares: the shapes of the character's file that make each channel. A channel that is one
            whole shape is named like it, so that the file fits the character elsewhere.
    """
    shapes = tuple(
        _shape_name(channel, (shares or {}).get(channel, ())) for channel in rig.channels
    )
    if len(set(shapes)) < len(shapes):  # two channels of one shape
        shapes = rig.channels
    weights = np.ascontiguousarray(rig.from_arkit(clip.arkit_weights()))
    turns = clip.rotations if follows_head else None
    turning = None if turns is None else Turning.of(rig, turns)
    return Scene(rig, shapes, weights, clip.times, clip.rate, turning)


def _shape_name(channel: str, shares: Sequence[Share]) -> str:
    if len(shares) == 1 and shares[0].weight == 1.0 and shares[0].half is Half.WHOLE:
        return shares[0].name
    return channel


def shape_weights(
    clip: Clip, shares: Mapping[str, Sequence[Share]], levels: Levels
) -> dict[str, Floats]:
    """(T,) weights of each shape of a character's file.

    A shape of which channels use halves, such as a blink of both eyes, plays their mean: files
    hold it as a whole.
    """
    column = dict(zip(ARKIT_CHANNELS, levels.applied(clip.arkit_weights()).T, strict=True))
    halves: dict[str, list[Floats]] = {}
    none = np.zeros(len(clip), np.float32)
    weights: dict[str, Floats] = {}
    for channel, used in shares.items():
        for share in used:
            amount = column[channel] * np.float32(share.weight)
            if share.half is Half.WHOLE:
                weights[share.name] = weights.get(share.name, none) + amount
            else:
                halves.setdefault(share.name, []).append(amount)
    for name, amounts in halves.items():
        mean = np.mean(amounts, axis=0, dtype=np.float32)
        weights[name] = weights.get(name, none) + mean
    return weights
