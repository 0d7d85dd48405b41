"""What a character can and cannot do: its shapes, its control points, its faults."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from faceedit_app.characters.closure import CLOSE_ENOUGH, LID_SLACK
from faceedit_app.characters.face import Points, WeldedFace
from faceedit_app.characters.matches import ShapeMatch
from faceedit_app.characters.names import is_without_channel
from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.arrays import Indices
from faceedit_app.core.levels import Levels
from faceedit_app.core.rig import Rig

DEAD = 0.3  # mm; a shape that moves no vertex farther is not visible
# These move eyeballs, tongue or brows, which are often separate meshes.
_OWN_MESH = ("eyeLook", "tongue", "brow")
# Distances of adult and stylised faces, with a margin, mm.
_PLAUSIBLE = {
    ("left_mouth_corner", "right_mouth_corner"): (15.0, 80.0, "the mouth corners"),
    ("left_upper_lid", "left_lower_lid"): (3.0, 40.0, "the left lids"),
    ("right_upper_lid", "right_lower_lid"): (3.0, 40.0, "the right lids"),
    ("nose_bridge", "upper_lip"): (20.0, 80.0, "nose bridge and upper lip"),
    ("chin", "lower_lip"): (5.0, 45.0, "chin and lower lip"),
}
_OPENS, _SHUT, _WIDENS = 5.0, 2.5, 0.5  # mm
_PARTED = 2.0  # mm between lips at rest that are visibly apart
_STRONGEST = 2.0  # a blink is not made stronger than this


@dataclass(frozen=True)
class Checklist:
    """What the user learns about a character when it is opened.

    Attributes:
        matched: the names of the shapes that make each channel.
        missing: channels without a shape.
        dead: channels whose shapes move the skin by less than 0.3 mm.
        several: channels made of more than one shape.
        unknown: shapes that no channel uses.
        lost: sentences about shapes that do not quite fit their channels.
        doubts: sentences about points that were not found or may be wrong.
        remarks: sentences about what was changed or could not be read.
    """

    matched: Mapping[str, Sequence[str]]
    missing: Sequence[str]
    dead: Sequence[str]
    several: Mapping[str, Sequence[str]]
    unknown: Sequence[str]
    lost: Sequence[str]
    doubts: Sequence[str]
    remarks: Sequence[str]


def make_checklist(
    match: ShapeMatch,
    face: WeldedFace,
    points: Points,
    problems: Sequence[str],
    lids: Sequence[str],
    remarks: Sequence[str],
) -> Checklist:
    """Check a character.

    Args:
        problems: sentences about points that were not found.
        lids: sentences about lids (`lid_doubts`).
        remarks: sentences from reading and assembling it.
    """
    return Checklist(
        matched=match.matched,
        missing=match.missing,
        dead=dead_channels(face),
        several=match.several,
        unknown=tuple(name for name in match.unknown if not is_without_channel(name)),
        lost=match.lost,
        doubts=(*problems, *doubts(face, points), *lids),
        remarks=tuple(remarks),
    )


def dead_channels(face: WeldedFace) -> tuple[str, ...]:
    """Channels whose shapes have no visible effect."""
    dead = []
    for channel in face.moves:
        amount = face.amount(channel)
        if not channel.startswith(_OWN_MESH):
            amount = amount[face.skin]
        if amount.max(initial=0.0) < DEAD:
            dead.append(channel)
    return tuple(dead)


def doubts(face: WeldedFace, points: Points) -> list[str]:
    """Sentences about points that do not behave like those of a face."""
    found = []

    def apart(a: str, b: str, *channels: str) -> float:
        moved = sum((face.move(channel) for channel in channels), face.places)
        return float(np.linalg.norm(moved[points[a]] - moved[points[b]]))

    for (a, b), (low, high, what) in _PLAUSIBLE.items():
        if a in points and b in points and not low <= apart(a, b) <= high:
            found.append(f"{what} are {apart(a, b):.1f} mm apart, which is unlikely")
    lips = ("inner_upper_lip", "inner_lower_lip")
    if all(name in points for name in lips):
        rest = apart(*lips)
        if rest > _PARTED:
            found.append(
                f"the inner lips rest {rest:.1f} mm apart, which counts as shut: if they should "
                "meet, bring them together in the neutral shape of the file"
            )
        opened = apart(*lips, "jawOpen")
        if "jawOpen" in face.moves and opened - rest < _OPENS:
            found.append(f"jawOpen parts the lips by only {opened - rest:.1f} mm")
        shut = apart(*lips, "jawOpen", "mouthClose")
        if {"jawOpen", "mouthClose"} <= set(face.moves) and shut - rest > _SHUT:
            found.append(f"mouthClose leaves the lips {shut:.1f} mm apart when the jaw is open")
    corners = "left_mouth_corner", "right_mouth_corner"
    smiles = "mouthSmileLeft", "mouthSmileRight"
    if all(name in points for name in corners) and set(smiles) <= set(face.moves):
        wider = apart(*corners, *smiles) - apart(*corners)
        if wider < _WIDENS:
            found.append("a smile does not widen the mouth, whose corners may be wrong")
        middle = [face.places[points[name], 0] - face.middle for name in corners]
        if not middle[0] > 0 > middle[1] or abs(sum(middle)) > 10:
            found.append("the mouth corners are not on both sides of the midline")
    return found


def lid_doubts(rig: Rig, points: Points) -> list[str]:
    """What eyes leave open when they blink as strongly as the character shows it, and what helps.

    Args:
        points: the control points, as vertices of the rig.
    """
    found = []
    for side in ("left", "right"):
        lids = [points.get(side + lid) for lid in ("_upper_lid", "_lower_lid")]
        if None not in lids:
            found += _lid_doubts(rig, np.array(lids, np.intp), side)
    return found


def _lid_doubts(rig: Rig, lids: Indices, side: str) -> list[str]:
    blink, squint = (f"eye{name}{side.capitalize()}" for name in ("Blink", "Squint"))

    def gap(levels: Levels, *channels: str) -> float:
        """Mm; 0 once the upper lid has passed the lower one."""
        weights = np.zeros(len(ARKIT_CHANNELS), np.float32)
        weights[[ARKIT_INDEX[channel] for channel in channels]] = 1.0
        shown = replace(rig, levels=levels).from_arkit(weights)
        upper, lower = rig.neutral[lids] + np.tensordot(shown, rig.deltas[:, lids], 1)
        apart = 1000.0 * (upper - lower).astype(np.float64)
        return float(np.linalg.norm(apart)) if apart[1] > 0 else 0.0

    rest, left = gap(Levels()), gap(rig.levels, blink)
    if min(left, gap(rig.levels, blink, squint)) <= CLOSE_ENOUGH + LID_SLACK * rest:
        return []
    sentence = f"{blink} leaves the {side} eye {left:.1f} mm open"
    if squint not in rig.channels:
        sentence += f", and there is no {squint}"
    closes = rest - gap(Levels(), blink)
    if closes > 0 and rest / closes <= _STRONGEST:
        sentence += f"; a multiplier of {np.ceil(20 * rest / closes) / 20:.2f} closes it"
    return [sentence]
