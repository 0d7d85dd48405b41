"""Which curves a take's channels can answer.

A take need not have all channels. A curve is moved mostly by some of them: the width of the mouth
by smiles and stretches, an eye by its blink. If those are missing, a solver would have to use the
others, and shut the mouth to widen it. So a curve that lacks too much of its movement is not
answered at all, and the user sees which channels it needs. The jaw counts for the opening of the
mouth alone: no other curve of a take without all channels may be moved by opening it.

The share of each channel follows from how channels vary together in performances: if the curve
c = J w moves by one millimetre, the most probable change of the weights is S J' / (J S J'), with S
their covariance, and channel k contributes J_k (S J')_k / (J S J') of it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles
from faceedit_app.core.controls import CONTROL_INDEX, LIP_OPENING, control_named
from faceedit_app.core.regions import OPTIONAL_REGIONS, REGIONS, Region
from faceedit_app.core.rig import Distances, Rig
from faceedit_app.editing.edits.edit import OF_THE_TAKE, Edit, Op
from faceedit_app.formats.take import Take

if TYPE_CHECKING:  # the window is there before the networks
    from faceedit_app.networks.engine import Engine

ENOUGH = 0.45  # share of a curve's movement that the take's channels must cover
BY_REGION = (*OF_THE_TAKE, Op.RESET)  # their curves stand for regions, and ask for no value
_MAIN = 0.1  # missing channels with a smaller share are not named
_PRIOR = 0.04  # variance of each weight if no engine is loaded


@dataclass(frozen=True)
class Lack:
    """A curve that a take's channels cannot answer.

    Attributes:
        control: its id.
        channels: the missing channels with the largest shares, the most important first.
    """

    control: str
    channels: tuple[str, ...]

    def __str__(self) -> str:
        """One line for the user."""
        label, names = control_named(self.control).label, ", ".join(self.channels)
        return f"“{label}” cannot be changed: the take has no {names}"


def region_covariance(region: Region, engine: Engine | None) -> Doubles:
    """(K, K) the covariance of a region's channels in performances.

    Those of an optional region may be among the channels of another one.
    """
    for model in engine.models.values() if engine is not None else ():
        known = model.description.channels
        if set(region.channels) <= set(known):
            places = [known.index(channel) for channel in region.channels]
            return model.description.covariance[np.ix_(places, places)]
    return _PRIOR * np.eye(len(region.channels))


def find_lacks(
    channels: Collection[str], distances: Distances, engine: Engine | None = None
) -> dict[str, Lack]:
    """The curves that cannot be answered, by control id.

    Args:
        channels: the take's channels.
        distances: the controls as a function of the 52 weights in ARKit order.
        engine: the engine, if it is loaded.
    """
    rest = np.zeros((1, len(ARKIT_INDEX)), np.float32)
    slopes = distances.jacobian(rest)[1][0].astype(np.float64)
    present = {*channels} - (set() if "jawOpen" in channels else {"mouthClose"})  # its corrective
    lacks: dict[str, Lack] = {}
    for region in (*REGIONS, *OPTIONAL_REGIONS):
        columns = [ARKIT_INDEX[channel] for channel in region.channels]
        covariance = region_covariance(region, engine)
        for control in region.own:
            slope = slopes[CONTROL_INDEX[control], columns]
            shares = slope * (covariance @ slope)
            if shares.sum() <= 0:  # no channel moves it on this character
                continue
            shares /= shares.sum()
            missing = [k for k, name in enumerate(region.channels) if name not in present]
            jaw = [k for k, name in enumerate(region.channels) if name == "jawOpen"]
            jaws = 0.0 if control == LIP_OPENING or "jawOpen" not in present else shares[jaw].sum()
            if 1 - shares[missing].sum() - jaws < ENOUGH * (1 - jaws):
                missing.sort(key=lambda k: -shares[k])
                main = [k for k in missing if shares[k] >= _MAIN] or missing[:1]
                lacks[control] = Lack(control, tuple(region.channels[k] for k in main))
    return lacks


def unanswerable(
    edit: Edit, take: Take, rig: Rig, engine: Engine | None = None
) -> tuple[Lack, ...]:
    """The curves of an edit that the take's channels cannot answer; they stay unchanged."""
    return lacks_of(edit, find_lacks(take.clip.channels, rig.arkit_distances, engine))


def lacks_of(edit: Edit, lacks: Mapping[str, Lack]) -> tuple[Lack, ...]:
    """What an edit asks for in vain.

    A fill, a retime or a reset acts on whatever channels the take has, and misses none.

    Args:
        edit: the edit.
        lacks: the curves that the take cannot answer, by control id.
    """
    if edit.op in BY_REGION:
        return ()
    return tuple(lacks[control] for control in edit.controls if control in lacks)


def without(edit: Edit, controls: Collection[str]) -> Edit | None:
    """The edit without some controls; None if it has no others."""
    kept = tuple(control for control in edit.controls if control not in controls)
    if kept == edit.controls:
        return edit
    return replace(edit, controls=kept) if kept else None
