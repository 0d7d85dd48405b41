"""What a preset does to a face at rest, as a picture of it needs."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.arrays import Floats
from faceedit_app.core.clip import Clip
from faceedit_app.editing.edits.edit import Op
from faceedit_app.editing.help.fixes import apply_preset
from faceedit_app.editing.help.presets import Preset
from faceedit_app.editing.session import EditSession

if TYPE_CHECKING:  # the networks are imported after the window is up
    from faceedit_app.networks.engine import Engine

_RATE, _FRAMES = 30.0, 31
_HOLD = (0.3, 0.7)  # seconds
_POSES = (Op.OFFSET, Op.SET)  # what shows on a face that does not move


def has_pose(preset: Preset) -> bool:
    """Whether a preset changes a face at rest; to enlarge movements, say, does not."""
    return any(edit.op in _POSES for edit in preset.edits)


def pose_of(preset: Preset, session: EditSession, engine: Engine | None) -> Floats:
    """(K,) weights in the order of `session.shown_rig`: the face at rest with a preset.

    Args:
        preset: one that has a pose.
        session: whose character it is.
        engine: answers the edits; None = the rig alone.
    """
    times = np.arange(_FRAMES) / _RATE
    weights = np.zeros((_FRAMES, len(ARKIT_CHANNELS)), np.float32)
    take = replace(session.take, clip=Clip(weights, ARKIT_CHANNELS, times, _RATE))
    rest = EditSession(take, session.rig, engine)
    middle = sum(_HOLD) / 2
    rest.add(*apply_preset(rest, preset, _HOLD, middle))
    return session.shown_rig.from_arkit(rest.weights[take.clip.frame_at(middle)])
