"""The values of a channel, as the panel of all channels shows them."""

from __future__ import annotations

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles
from faceedit_app.editing.edits.channels import CHANNEL_INDEX, is_rotation
from faceedit_app.editing.session import EditSession
from faceedit_app.editing.solving.filled_frames import FilledFrames
from faceedit_app.ui.state.gap_frames import Values, through_gaps, values_at, weights_at
from faceedit_app.ui.state.timeline import Timeline

_IDLE = 0.005  # a weight that moves less is idle

Points = tuple[Values, Values]  # seconds and values, (N,) each


def points_of(
    session: EditSession, channel: str, filled: FilledFrames | None
) -> tuple[Points, Points]:
    """The points of a channel's lines, as tracked and as edited: weights, or degrees.

    The edited one goes through the frames that fill gaps. A fill does not turn the head, so that a
    rotation has no other values there.
    """
    times, (tracked, edited) = session.take.clip.times, _values_of(session, channel)
    points: Points = times, edited
    if filled is not None and not is_rotation(channel):
        weights = filled.weights[:, ARKIT_INDEX[channel]]
        points = through_gaps(times, edited, filled.times, weights)
    return (times, tracked), points


def value_at(session: EditSession, channel: str, line: Timeline) -> float:
    """An edited channel at the playhead: a weight, or degrees."""
    if not is_rotation(channel):
        return float(weights_at(session, line)[ARKIT_INDEX[channel]])
    assert session.rotations is not None
    return float(np.degrees(values_at(session.rotations, line)[_turn(channel)]))


def idle_channels(session: EditSession) -> set[str]:
    """The channels that the take never moves."""
    clip = session.take.clip
    moves = np.ptp(clip.weights, axis=0)
    return {name for name, move in zip(clip.channels, moves, strict=True) if move < _IDLE}


def _values_of(session: EditSession, channel: str) -> tuple[Doubles, Doubles]:
    """(T,) a channel as tracked and as edited: a weight, or degrees."""
    if not is_rotation(channel):
        k = ARKIT_INDEX[channel]
        clip = session.take.clip
        tracked = clip.weights[:, clip.channels.index(channel)].astype(np.float64)
        return tracked, session.weights[:, k].astype(np.float64)
    k, before = _turn(channel), session.take.clip.rotations
    assert before is not None
    assert session.rotations is not None
    return (
        np.degrees(before[:, k].astype(np.float64)),
        np.degrees(session.rotations[:, k].astype(np.float64)),
    )


def _turn(channel: str) -> int:
    """The place of a rotation among the nine."""
    return CHANNEL_INDEX[channel] - len(ARKIT_INDEX)
