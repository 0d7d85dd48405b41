"""Blinks, gaze and what the lids do with them.

Figures: a lid closes in 80 to 120 ms and opens in about twice that (VanderWerf et al. 2003,
"Eyelid movements: behavioral studies of blinking in humans"); saccades follow the main sequence,
about 2.2 ms a degree and 21 ms (Carpenter 1988, "Movements of the Eyes"); the lids follow the
gaze downwards.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Doubles

DEGREES = 40.0  # of gaze at weight 1 of an eyeLook channel


@dataclass(frozen=True)
class Blink:
    """One blink of both eyes.

    Attributes:
        start: seconds at which the lids begin to close.
        closing, held, opening: seconds of each phase.
        depth: how far the left and the right lid close, 1 = shut.
        lag: seconds that the right lid is late.
    """

    start: float
    closing: float = 0.09
    held: float = 0.025
    opening: float = 0.21
    depth: tuple[float, float] = (1.0, 1.0)
    lag: float = 0.0

    @property
    def seconds(self) -> float:
        """From the first movement to the last, left lid."""
        return self.closing + self.held + self.opening


@dataclass(frozen=True)
class Gaze:
    """Where the eyes look from `start` on; 1 is as far as they go.

    Attributes:
        start: seconds at which the saccade begins.
        yaw: to the character's left is positive.
        pitch: up is positive.
    """

    start: float
    yaw: float
    pitch: float


def lids(times: Doubles, blinks: Sequence[Blink]) -> Doubles:
    """How far blinks close the left and the right lid: times (T,) -> (T, 2), 0..1."""
    out = np.zeros((len(times), 2))
    for blink in blinks:
        for side, lag in enumerate((0.0, blink.lag)):
            local = times - blink.start - lag
            shape = _smooth(local / blink.closing) * (
                1.0 - _settle((local - blink.closing - blink.held) / blink.opening)
            )
            np.maximum(out[:, side], blink.depth[side] * shape, out=out[:, side])
    return out


def gaze_curve(times: Doubles, gazes: Sequence[Gaze]) -> Doubles:
    """Yaw and pitch over time: times (T,) -> (T, 2), -1..1; straight ahead before the first."""
    out = np.zeros((len(times), 2))
    before = np.zeros(2)
    for gaze in gazes:
        target = np.array([gaze.yaw, gaze.pitch])
        step = float(np.abs(target - before).max()) * DEGREES
        share = _smooth((times - gaze.start) / (0.021 + 0.0022 * step))[:, None]
        out += share * (target - before)
        before = target
    return out


def draw_blinks(
    rng: np.random.Generator,
    seconds: float,
    per_minute: float,
    gazes: Sequence[Gaze] = (),
    depth: float = 1.0,
    tempo: float = 1.0,
    incomplete: float = 0.12,
) -> list[Blink]:
    """Blinks of `seconds` seconds, more likely with large gaze shifts, never overlapping.

    Args:
        rng: where chance comes from.
        seconds: until when blinks may start.
        per_minute: mean number of blinks a minute.
        gazes: large shifts among them bring a blink along.
        depth: how far this speaker's complete blinks reach as tracked.
        tempo: 1.2 blinks a fifth faster.
        incomplete: share of blinks that stop half-way.
    """
    previous = np.zeros(2)
    starts: list[float] = []
    for gaze in gazes:
        point = np.array([gaze.yaw, gaze.pitch])
        if np.abs(point - previous).max() > 0.35 and rng.random() < 0.35 * min(1, per_minute / 12):
            starts.append(gaze.start + float(rng.uniform(-0.06, 0.02)))
        previous = point
    spare = max(1.0, per_minute - 60.0 * len(starts) / max(seconds, 1.0))
    time = float(rng.uniform(0.0, 60.0 / spare))
    while time < seconds:
        starts.append(time)
        double = rng.random() < 0.06
        time += 0.42 if double else max(0.7, float(rng.gamma(2.0, 30.0 / spare)))
    out: list[Blink] = []
    for start in sorted(starts):
        if start < 0 or start >= seconds or (out and start < out[-1].start + out[-1].seconds):
            continue
        full = depth * (rng.uniform(0.45, 0.8) if rng.random() < incomplete else 1.0)
        full = float(np.clip(full * rng.normal(1.0, 0.06), 0.2, 1.0))
        side = float(rng.normal(0.0, 0.015))
        out.append(
            Blink(
                start=start,
                closing=float(np.clip(rng.normal(0.105, 0.015), 0.075, 0.15)) / tempo,
                held=float(rng.exponential(0.018)) + 0.012,
                opening=float(np.clip(rng.normal(0.24, 0.05), 0.16, 0.42)) / tempo,
                depth=(full, float(np.clip(full * (1.0 + side), 0.2, 1.0))),
                lag=float(rng.normal(0.0, 0.004)),
            )
        )
    return out


def draw_gazes(rng: np.random.Generator, seconds: float, reach: float = 0.3) -> list[Gaze]:
    """Fixations of 0.4 to some seconds, mostly near the middle; now and then far off or down."""
    out, time = [], float(rng.uniform(0.0, 1.0))
    while time < seconds:
        kind = rng.random()
        if kind < 0.45:  # back to the listener
            yaw, pitch = rng.normal(0.0, 0.05), rng.normal(0.0, 0.04)
        elif kind < 0.8:  # about the face and the room
            yaw, pitch = rng.normal(0.0, reach), rng.normal(-0.05, 0.5 * reach)
        else:  # down to the desk, or up for a word
            yaw = rng.normal(0.0, 0.6 * reach)
            pitch = -rng.uniform(0.5, 2.0) * reach if kind < 0.93 else rng.uniform(0.5, 1.4) * reach
        out.append(Gaze(time, float(np.clip(yaw, -0.9, 0.9)), float(np.clip(pitch, -0.9, 0.9))))
        time += 0.25 + float(rng.gamma(1.6, 0.85))
    return out


def _smooth(x: Doubles) -> Doubles:
    """0 before 0, 1 after 1, and a smooth, symmetric rise between."""
    x = np.clip(x, 0.0, 1.0)
    rise: Doubles = x * x * (3.0 - 2.0 * x)
    return rise


def _settle(x: Doubles) -> Doubles:
    """0 before 0, 1 after 1: fast at first, then settling, as opening lids do."""
    x = np.clip(x, 0.0, 1.0)
    rise: Doubles = 1.0 - (1.0 - x * x * (3.0 - 2.0 * x)) ** 1.6
    return rise
