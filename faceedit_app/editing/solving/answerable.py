"""Which curves a take's channels can answer.

A take need not have all channels. What is asked of a curve is done mostly by some of them: the
width of the mouth by smiles and stretches, an eye by its blink. Where those are missing, a solver
that insists would take what is left, and shut the mouth to widen it. So a curve of which the take
has too little is not answered at all, and the user is told which channels it needs.

How much of a curve each channel does comes from how channels vary together in performances: if
the curve c = J w moves by one millimetre, the most probable change of the weights is
S J' / (J S J'), with S their covariance, and channel k does J_k (S J')_k / (J S J') of it.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles
from faceedit_app.core.controls import CONTROL_INDEX, control_named
from faceedit_app.core.regions import REGIONS, Region
from faceedit_app.core.rig import Distances, Rig
from faceedit_app.editing.edits.edit import Edit
from faceedit_app.formats.take import Take

if TYPE_CHECKING:  # the window is there before the networks
    from faceedit_app.networks.engine import Engine

ENOUGH = 0.45  # share of a curve's movement that the take's channels must be able to do
_MAIN = 0.1  # share from which on a missing channel is worth naming
_PRIOR = 0.04  # variance of each weight where no network tells


@dataclass(frozen=True)
class Lack:
    """A curve that a take's channels cannot answer.

    Attributes:
        control: its id.
        channels: the missing channels that would do most of it, the most important first.
    """

    control: str
    channels: tuple[str, ...]

    def __str__(self) -> str:
        """One line for the user."""
        label, names = control_named(self.control).label, ", ".join(self.channels)
        return f"“{label}” cannot be changed: the take has no {names}"


def region_covariance(region: Region, engine: Engine | None) -> Doubles:
    """(K, K) how a region's channels vary together in performances."""
    if engine is not None:
        return engine.models[region.id].description.covariance
    return _PRIOR * np.eye(len(region.channels))


def find_lacks(
    channels: Collection[str], distances: Distances, engine: Engine | None = None
) -> dict[str, Lack]:
    """The curves that cannot be answered, by control.

    Args:
        channels: those that the take has.
        distances: the controls as a function of the 52 weights in ARKit order.
        engine: the networks, if they are there.
    """
    rest = np.zeros((1, len(ARKIT_INDEX)), np.float32)
    slopes = distances.jacobian(rest)[1][0].astype(np.float64)
    present = {*channels} - (set() if "jawOpen" in channels else {"mouthClose"})  # its corrective
    lacks: dict[str, Lack] = {}
    for region in REGIONS:
        columns = [ARKIT_INDEX[channel] for channel in region.channels]
        covariance = region_covariance(region, engine)
        for control in region.own:
            slope = slopes[CONTROL_INDEX[control], columns]
            shares = slope * (covariance @ slope)
            if shares.sum() <= 0:  # nothing moves it on this character
                continue
            shares /= shares.sum()
            missing = [k for k, name in enumerate(region.channels) if name not in present]
            if 1 - shares[missing].sum() < ENOUGH:
                missing.sort(key=lambda k: -shares[k])
                main = [k for k in missing if shares[k] >= _MAIN] or missing[:1]
                lacks[control] = Lack(control, tuple(region.channels[k] for k in main))
    return lacks


def unanswerable(
    edit: Edit, take: Take, rig: Rig, engine: Engine | None = None
) -> tuple[Lack, ...]:
    """The curves of an edit that the take's channels cannot answer; the edit leaves them as is."""
    lacks = find_lacks(take.clip.channels, rig.arkit_distances, engine)
    return tuple(lacks[control] for control in edit.controls if control in lacks)


def without(edit: Edit, controls: Collection[str]) -> Edit | None:
    """The edit without some of its controls; None if it has no other."""
    kept = tuple(control for control in edit.controls if control not in controls)
    if kept == edit.controls:
        return edit
    return replace(edit, controls=kept) if kept else None
