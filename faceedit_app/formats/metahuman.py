"""MetaHuman's control curves, `CTRL_expressions_*`, as ARKit channels: an approximation.

A channel is the mean of the controls that make its shape, each 0..1; no control belongs to two
channels. The table follows the names in Epic's pose asset `mh_arkit_mapping`, which turns ARKit's
weights into these curves, but not its amounts: those are not published as numbers. An edit adds its
change of the channel to each of its controls, so that the file reads as it was edited, and controls
without a channel are carried.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.arrays import Floats, Indices
from faceedit_app.formats.csv_table import read_table
from faceedit_app.formats.csv_take import csv_take
from faceedit_app.formats.files import shown
from faceedit_app.formats.json_text import looks_like_json
from faceedit_app.formats.named_weights import read_named
from faceedit_app.formats.take import FillableSource, RotatingSource, Source, Take

FORMAT = "MetaHuman controls"
_HEAD = 1 << 16
# Some controls have ARKit's names; these show that a file has MetaHuman's.
# In small letters: to search whatever the case takes five times as long.
_TELLING = re.compile(
    rb"ctrl_expressions[_.]|mouthcornerpull[lr]\b|mouthlipstogether[ud][lr]\b|browraisein[lr]\b"
)
_PREFIX = re.compile(r"^(?:.*[.:|/])?(?:ctrl_expressions[_.])?", re.IGNORECASE)
_QUARTERS = ("UL", "UR", "DL", "DR")
_LISTED = 5  # carried controls named in a note

# ARKit's channels with a side, and the control that makes their shape on each side.
_SIDED = {
    "eyeBlink": "eyeBlink",
    "eyeLookDown": "eyeLookDown",
    "eyeLookUp": "eyeLookUp",
    "eyeSquint": "eyeSquintInner",
    "eyeWide": "eyeWiden",
    "mouthSmile": "mouthCornerPull",
    "mouthFrown": "mouthCornerDepress",
    "mouthDimple": "mouthDimple",
    "mouthStretch": "mouthStretch",
    "mouthLowerDown": "mouthLowerLipDepress",
    "mouthUpperUp": "mouthUpperLipRaise",
    "browDown": "browDown",
    "browOuterUp": "browRaiseOuter",
    "cheekSquint": "eyeCheekRaise",
    "noseSneer": "noseWrinkle",
}
# The others, and the controls that make their shape: some per quarter of the lips, upper and lower.
_PLAIN: dict[str, tuple[str, ...]] = {
    # A left eye that looks in looks to the right.
    "eyeLookInLeft": ("eyeLookRightL",),
    "eyeLookOutLeft": ("eyeLookLeftL",),
    "eyeLookInRight": ("eyeLookLeftR",),
    "eyeLookOutRight": ("eyeLookRightR",),
    "jawOpen": ("jawOpen",),
    "jawForward": ("jawFwd",),
    "jawLeft": ("jawLeft",),
    "jawRight": ("jawRight",),
    "mouthLeft": ("mouthLeft",),
    "mouthRight": ("mouthRight",),
    "mouthClose": tuple(f"mouthLipsTogether{q}" for q in _QUARTERS),
    "mouthFunnel": tuple(f"mouthFunnel{q}" for q in _QUARTERS),
    "mouthPucker": tuple(f"mouthLipsPurse{q}" for q in _QUARTERS),
    "mouthPressLeft": ("mouthPressUL", "mouthPressDL"),
    "mouthPressRight": ("mouthPressUR", "mouthPressDR"),
    "mouthRollUpper": ("mouthUpperLipRollInL", "mouthUpperLipRollInR"),
    "mouthRollLower": ("mouthLowerLipRollInL", "mouthLowerLipRollInR"),
    "mouthShrugUpper": ("jawChinRaiseUL", "jawChinRaiseUR"),
    "mouthShrugLower": ("jawChinRaiseDL", "jawChinRaiseDR"),
    "browInnerUp": ("browRaiseInL", "browRaiseInR"),
    "cheekPuff": ("mouthCheekBlowL", "mouthCheekBlowR"),
    "tongueOut": ("tongueOut",),
}


def _controls() -> dict[str, tuple[str, ...]]:
    sided = {
        f"{channel}{side}": (f"{control}{side[0]}",)
        for channel, control in _SIDED.items()
        for side in ("Left", "Right")
    }
    found = _PLAIN | sided
    return {channel: found[channel] for channel in ARKIT_CHANNELS}


CONTROLS = _controls()
"""The controls of each ARKit channel."""

_CHANNEL_OF = {name: channel for channel, names in CONTROLS.items() for name in names}
_NAME_OF = {name.lower(): name for name in _CHANNEL_OF}


def control_of(name: str) -> str | None:
    """The control with an ARKit channel that a name in a file means, or None."""
    return _NAME_OF.get(_PREFIX.sub("", name.strip()).lower())


def sniff(content: bytes) -> float:
    """How likely, 0..1, this is a table or JSON of MetaHuman's controls."""
    head = content[:_HEAD]
    return 0.97 if _TELLING.search(head.lower()) and b"\0" not in head else 0.0


def read(path: Path, content: bytes, fps: float | None) -> Take:
    """Open MetaHuman's controls.

    Raises:
        RateNeeded: they have neither times nor a rate, and `fps` is None.
        FileError: the file is damaged, or has none of the controls in `CONTROLS`.
    """
    if looks_like_json(content):
        take = read_named(path, content, fps, FORMAT, control_of)
    else:
        take = csv_take(read_table(path, content), fps, FORMAT, control_of)
    return _as_arkit(take)


def _as_arkit(take: Take) -> Take:
    """A take of ARKit channels from one whose channels are controls."""
    owners = [_CHANNEL_OF[control] for control in take.clip.channels]
    channels = tuple(dict.fromkeys(owners))
    groups = np.array([channels.index(owner) for owner in owners])
    raw = take.clip.weights
    means = np.eye(len(channels))[groups] / np.bincount(groups)  # (N, K)
    clip = replace(take.clip, weights=(raw @ means).astype(np.float32), channels=channels)
    lost = _without_channel(take)
    notes = (*take.notes, "MetaHuman controls: their ARKit channels are an approximation", *lost)
    return replace(take, clip=clip, notes=notes, source=ControlSource(take.source, raw, groups))


def _without_channel(take: Take) -> tuple[str, ...]:
    names = [_PREFIX.sub("", name) for name in take.carried if "ctrl" in name.lower()]
    if not names:
        return ()
    more = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
    listed = ", ".join(map(shown, names[:_LISTED]))
    return (f"{len(names)} controls without an ARKit channel are carried: {listed}{more}",)


@dataclass(frozen=True)
class ControlSource:
    """A source of controls, written from the weights of channels (`take.Source`).

    Attributes:
        source: of the file's own controls.
        raw: (T, N) their weights in the file.
        groups: (N,) the channel of each.
    """

    source: Source
    raw: Floats
    groups: Indices

    def encode(self, tracked: Floats, edited: Floats) -> bytes:
        """The whole file; see `take.Source.encode`."""
        changes = (edited - tracked)[:, self.groups]
        return self.source.encode(self.raw, self.raw + changes)

    def rotated(self, tracked: Floats, edited: Floats) -> ControlSource:
        """See `take.RotatingSource.rotated`."""
        if not isinstance(self.source, RotatingSource):
            return self
        return replace(self, source=self.source.rotated(tracked, edited))

    def with_faces(self, weights: Floats) -> ControlSource:
        """See `take.FillableSource.with_faces`."""
        if not isinstance(self.source, FillableSource):
            return self
        return replace(self, source=self.source.with_faces(weights[:, self.groups]))
