"""Altering a take: another tempo, another face, another tracker."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX, mirrored_channel
from faceedit_app.core.arrays import Bools, Doubles, Floats
from faceedit_app.core.resample import GRID_RATE
from faceedit_app.lab.training.data import Performance, mirrored
from faceedit_app.lab.training.settings import Variety

_CLOSE, _JAW = ARKIT_INDEX["mouthClose"], ARKIT_INDEX["jawOpen"]
_SQUINT = [ARKIT_INDEX["eyeSquintLeft"], ARKIT_INDEX["eyeSquintRight"]]
_LEFT = np.array([c.endswith("Left") for c in ARKIT_CHANNELS])
_SIDE = _LEFT * 1.0 - np.array([c.endswith("Right") for c in ARKIT_CHANNELS])
_MIRROR = np.array([ARKIT_INDEX[mirrored_channel(c)] for c in ARKIT_CHANNELS])
# One number for the two sides of a channel: that of the left one.
_PAIR = np.where(_LEFT, np.arange(len(ARKIT_CHANNELS)), np.minimum(_MIRROR, np.arange(52)))


def play(
    take: Performance, how: Variety, window: int, mirror: bool, random: np.random.Generator
) -> Performance:
    """One take as another person, tracked by another tracker, might have played it.

    Args:
        take: a stretch of a performance.
        window: at least so many frames are left, if the take has them.
        mirror: half of the results are mirrored.
    """
    weights, captured = take.weights, take.captured
    if mirror and random.random() < 0.5:
        weights, captured = mirrored(weights), captured[_MIRROR]
    if random.random() >= how.share:
        return replace(take, weights=weights, captured=captured)
    weights = at_tempo(weights, _tempo(len(weights), how, window, random))
    moved = weights.astype(np.float64) * _gains(how, random)
    moved += _rest(how, random) + _drift(len(moved), how, random)
    moved *= captured
    np.clip(moved, 0.0, 1.0, out=moved)
    moved[:, _CLOSE] = np.minimum(moved[:, _CLOSE], moved[:, _JAW])
    return replace(take, weights=moved.astype(np.float32), captured=captured)


def at_tempo(weights: Floats, tempo: float) -> Floats:
    """Weights (T, K) played `tempo` times as fast: (about T / tempo, K)."""
    if len(weights) < 2:
        return weights
    frames = max(2, round((len(weights) - 1) / tempo) + 1)
    at = np.linspace(0, len(weights) - 1, frames)
    first = np.minimum(at.astype(np.intp), len(weights) - 2)
    part = (at - first).astype(np.float32)[:, None]
    played: Floats = weights[first] * (1 - part) + weights[first + 1] * part
    return played


def _tempo(frames: int, how: Variety, window: int, random: np.random.Generator) -> float:
    low, high = np.log(how.tempo)
    tempo = float(np.exp(random.uniform(low, high)))
    return min(tempo, max(1.0, (frames - 1) / (window - 1)))


def _gains(how: Variety, random: np.random.Generator) -> Doubles:
    """(52,) factors."""
    common = random.normal(0.0, how.gain)
    each = random.normal(0.0, how.channel_gain, len(_PAIR))[_PAIR]
    aside = _SIDE * random.normal(0.0, how.side_gain, len(_PAIR))[_PAIR]
    gains: Doubles = np.exp(common + each + aside)
    return gains


def _rest(how: Variety, random: np.random.Generator) -> Doubles:
    """(52,) what the resting face is moved by."""
    n = len(_PAIR)
    size = random.exponential(how.rest, n) * np.where(random.random(n) < 0.25, -1.0, 1.0)
    move = np.where(random.random(n) < how.rest_share, size, 0.0)[_PAIR]
    move *= 1.0 + _SIDE * random.normal(0.0, 0.2, n)[_PAIR]
    if random.random() < how.squint_share:
        move[_SQUINT] += random.uniform(0.1, 0.5)
    return move


def _drift(frames: int, how: Variety, random: np.random.Generator) -> Doubles:
    """(T, 52) a swing of each channel with a period of 4 to 20 seconds."""
    n = len(_PAIR)
    period, phase = random.uniform(4.0, 20.0, n), random.uniform(0.0, 2 * np.pi, n)
    size = np.sqrt(2.0) * how.drift * np.abs(random.normal(size=n))
    time = np.arange(frames)[:, None] / GRID_RATE
    swing: Doubles = (size * np.sin(2 * np.pi * time / period + phase))[:, _PAIR]
    return swing


def split_sides(
    weights: Floats, captured: Bools, share: float, random: np.random.Generator
) -> tuple[Floats, Bools]:
    """Give a share of the windows (N, W, 52) the left half of the face of another window.

    Returns:
        Weights (N, W, 52) and captured (N, 52).
    """
    n = len(weights)
    changed = np.flatnonzero(random.random(n) < share)
    other = random.integers(n, size=len(changed))
    out, seen = weights.copy(), captured.copy()
    out[changed] = np.where(_LEFT, weights[other], weights[changed])
    seen[changed] = np.where(_LEFT, captured[other], captured[changed])
    return out, seen
