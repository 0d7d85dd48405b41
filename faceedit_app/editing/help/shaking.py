"""Where curves shake from frame to frame, faster than any face moves."""

from __future__ import annotations

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles
from faceedit_app.editing.solving.filters import moving_mean

_SHAKES = 0.15  # mm of ripple between frames
# Ripple relative to the movement from frame to frame: 0.37 for noise, 0.18 for a wave at a quarter
# of the frame rate, 0.5 at half of it.
_SHARE = 0.25
_LEAST_LEFT = 0.25  # share of a window that is not meant; with less, it cannot be told


def find_shaking(curves: Doubles, meant: Bools, window: int) -> tuple[Doubles, Bools]:
    """Find where curves oscillate faster than any face.

    Speech moves the lips at up to 8 Hz, which is a ripple too at 30 frames a second; it is shaking
    where most of the movement is ripple. A closure for an m, b or p is over in two or three frames:
    at 25 frames a second a row of them looks like shaking, and steadying it would open the lips.

    Args:
        curves: (T, C) mm, at least one frame.
        meant: (T, C) where a quick movement is known to belong to the take; a curve shakes only if
            it does so beside that as well.
        window: frames over which it is judged.

    Returns:
        The ripple (T, C) in mm, 0 where it is meant, and (T, C) where a curve shakes.
    """
    ripple, moves = _ripple(curves), np.diff(curves, axis=0, prepend=curves[:1])
    free = ~_widened(meant)
    beside = np.where(free, ripple, 0.0)
    shaking = _is_shaking(ripple, moves, np.ones(curves.shape, np.bool_), window)
    if meant.any() and shaking.any():
        shaking &= _is_shaking(beside, np.where(free, moves, 0.0), free, window)
    return beside, shaking


def _is_shaking(ripple: Doubles, moves: Doubles, judged: Bools, window: int) -> Bools:
    """(T, C) from ripple and movement between frames, which are 0 where they are not judged."""
    share, wide = (_share(part, window) for part in (judged, np.abs(ripple) > _SHAKES))
    # The median of the frames, not the mean: one fast movement is not shaking.
    often = (wide > 0.5 * share) & (share >= _LEAST_LEFT)
    if not often.any():
        return often
    ripples, all_ = (moving_mean(part**2, window) for part in (ripple, moves))
    shaking: Bools = often & (ripples > _SHARE**2 * all_)
    return shaking


def _share(where: Bools, window: int) -> Doubles:
    """(T, C) the share of the frames around each frame."""
    return moving_mean(where.astype(np.float64), window)


def _widened(where: Bools) -> Bools:
    """Where the ripple, which is measured over five frames, may come from some of its frames."""
    wide = where.copy()
    for step in (1, 2):
        wide[step:] |= where[:-step]
        wide[:-step] |= where[step:]
    return wide


def _ripple(curves: Doubles) -> Doubles:
    """(T, C) mm: the oscillation from frame to frame; slow movement is removed."""
    x = np.pad(curves, ((2, 2), (0, 0)), mode="edge")
    ripple: Doubles = (x[:-4] - 4 * x[1:-3] + 6 * x[2:-2] - 4 * x[3:-1] + x[4:]) / 16
    return ripple
