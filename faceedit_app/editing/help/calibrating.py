"""Calibrate a take: make its rest neutral, and give each channel its strength."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.arrays import Floats
from faceedit_app.core.clip import nearest
from faceedit_app.core.levels import UNCHANGED, Level
from faceedit_app.editing.edits.dividing import divided, is_behind
from faceedit_app.editing.edits.edit import OF_THE_TAKE, Edit, Op
from faceedit_app.editing.session import EditSession

# The rest of a whole take, and the least that is taken away: less is a tracker's noise.
_REST_PERCENTILE, _LEAST = 5.0, 0.01
# At most this share of a channel's peak is rest, so that noise grows by no more than four.
_MOST_SHARE = 0.75
# Rests above these are plainly not neutral; trackers of films squint by up to 0.25 at rest.
NOT_NEUTRAL: Mapping[str, float] = {
    "eyeBlinkLeft": 0.15,
    "eyeBlinkRight": 0.15,
    "eyeSquintLeft": 0.3,
    "eyeSquintRight": 0.3,
    "jawOpen": 0.15,
}
_SHORTEST = 3.0  # seconds; in less, a face may well not come to rest


def neutral_at(
    session: EditSession, at: float, start: float, end: float, falloff: float = 0.0
) -> Edit | None:
    """The edit that makes the pose at a time neutral; None if it is neutral.

    Edits of curves are no part of the rest: they act on the take without it.

    Args:
        at: seconds, of the frame; it may be one that a fill gave to a gap.
        start, end, falloff: seconds, where the rest is taken away.
    """
    frames = session.all_frames()
    peaks = frames.weights.max(axis=0)
    shown = _without(frames.weights[nearest(frames.times, at)], peaks, start, end, falloff)
    if any(edit.op in OF_THE_TAKE for edit in session.edits):
        return shown
    _, then = divided(session.edits)
    if shown is not None and is_behind(shown.channels, then):
        return shown
    clip = session.take.clip  # which no fill changes
    return _without(clip.arkit_weights()[clip.frame_at(at)], peaks, start, end, falloff)


def neutral_rest(session: EditSession) -> Edit | None:
    """The edit that makes the take's rest neutral, if that is plainly not so; else None.

    The rest is the 5th percentile of each channel over the take, as tracked.
    """
    clip = session.take.clip
    if clip.duration < _SHORTEST or any(edit.op is Op.NEUTRAL for edit in session.edits):
        return None
    weights = clip.arkit_weights()
    columns = [ARKIT_INDEX[name] for name in NOT_NEUTRAL]
    rests = np.percentile(weights[:, columns], _REST_PERCENTILE, axis=0)
    if (rests <= list(NOT_NEUTRAL.values())).all():
        return None
    rest = np.percentile(weights, _REST_PERCENTILE, axis=0).astype(np.float32)
    peaks = session.all_frames().weights.max(axis=0)
    return _without(rest, peaks, 0.0, clip.duration, 0.0)


def _without(pose: Floats, peaks: Floats, start: float, end: float, falloff: float) -> Edit | None:
    """The edit that takes a pose (52,) away from a take with peaks (52,) of its channels.

    The gaze is no part of a rest: taking it away would move the eyes of all other frames.
    """
    amounts = {
        name: _amounts(float(pose[k]), float(peaks[k]))
        for k, name in enumerate(ARKIT_CHANNELS)
        if pose[k] >= _LEAST and not name.startswith("eyeLook")
    }
    if not amounts:
        return None
    return Edit(
        (),
        Op.NEUTRAL,
        start,
        end,
        falloff,
        channels=tuple(amounts),
        amounts=tuple(amounts.values()),
    )


def _amounts(rest: float, peak: float) -> tuple[float, float]:
    """The rest to take away, and the peak that keeps its height.

    A channel that hardly leaves its rest has no peak; stretched up to one, its noise would be,
    too. So the peak is at least twice the rest.
    """
    top = max(peak, min(2.0 * rest, 1.0))
    return round(min(rest, _MOST_SHARE * top), 6), round(top, 6)


def levels(
    chosen: Mapping[str, Level], start: float, end: float, falloff: float = 0.0
) -> Edit | None:
    """The edit that gives channels another strength; None if none changes.

    Args:
        chosen: multiplier, offset and ceiling by channel.
        start, end, falloff: seconds.
    """
    changed = {name: level for name, level in chosen.items() if level != UNCHANGED}
    if not changed:
        return None
    return Edit(
        (),
        Op.LEVELS,
        start,
        end,
        falloff,
        channels=tuple(changed),
        amounts=tuple(changed.values()),
    )
