"""Films of the character, rendered from takes: what tracking should find in them is known."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles, Floats, Pixels, Times
from faceedit_app.core.resample import at_rate
from faceedit_app.core.rig import Rig
from faceedit_app.formats.opening import open_take
from faceedit_app.lab.evaluation.film_file import write_film
from faceedit_app.render.camera import default_camera
from faceedit_app.render.renderer import open_renderer

_TURN, _NOD = 3.0, 2.2  # seconds of a turn there and back, and of a nod
_NOD_SHARE = 0.4  # of the turn
# A mouth that is kept open: the jaw, and what is left of what lips do to narrow it.
_JAW_OPEN, _JAW_MOVES, _NARROWED = 0.15, 0.8, 0.3
_NARROW = ("mouthRollLower", "mouthRollUpper", "mouthPucker", "mouthFunnel")


@dataclass(frozen=True)
class Conditions:
    """How a film is taken.

    Attributes:
        name: for the table.
        size: pixels of a side.
        rate: pictures per second.
        turn: degrees by which the head turns to either side.
        light: brightness; 1 is the renderer's.
        slope: how much darker the picture's right edge is, 0..1.
        noise: standard deviation of the sensor's noise, of 255.
        crf: how strongly the film is compressed (x264); more is worse.
        is_ajar: whether the mouth is kept open, so that the lips never touch.
    """

    name: str
    size: int = 640
    rate: float = 25.0
    turn: float = 0.0
    light: float = 1.0
    slope: float = 0.0
    noise: float = 3.0
    crf: int = 20
    is_ajar: bool = False


CONDITIONS: tuple[Conditions, ...] = (
    Conditions("plain"),
    Conditions("turned by 20°", turn=20.0),
    Conditions("turned by 35°", turn=35.0),
    Conditions("dim and noisy", light=0.4, noise=8.0),
    Conditions("light from one side", slope=0.7),
    Conditions("320 pixels", size=320),
    Conditions("compressed", crf=36),
    Conditions("60 fps", rate=60.0),
    Conditions("never shut", is_ajar=True),
)


@dataclass(frozen=True)
class Truth:
    """What a film shows.

    Attributes:
        weights: (T, 52) float32, 0..1, in ARKit's order.
        times: (T,) seconds.
    """

    weights: Floats
    times: Times


def truth_of(take: Path, seconds: float, rate: float, rig: Rig) -> Truth:
    """The liveliest stretch of a take, at a frame rate.

    Raises:
        FileError: the take cannot be read.
    """
    clip = open_take(take).clip
    whole = at_rate(clip.times, clip.arkit_weights(), rate, clip.rate)
    weights = np.clip(whole, 0.0, 1.0).astype(np.float32)
    count = min(round(seconds * rate), len(weights))
    controls = rig.arkit_distances.measure(weights)
    moved = np.abs(np.diff(controls, axis=0)).sum(axis=1)
    activity = np.convolve(moved, np.ones(max(count - 1, 1)), "valid")
    start = int(activity.argmax()) if len(activity) else 0
    return Truth(weights[start : start + count], np.arange(count) / rate)


def kept_open(truth: Truth) -> Truth:
    """The same performance with a jaw that never shuts, and lips that do not make up for it."""
    weights = truth.weights.copy()
    weights[:, ARKIT_INDEX["mouthClose"]] = 0.0
    weights[:, [ARKIT_INDEX[channel] for channel in _NARROW]] *= _NARROWED
    jaw = ARKIT_INDEX["jawOpen"]
    weights[:, jaw] = np.minimum(_JAW_MOVES * weights[:, jaw] + _JAW_OPEN, 1.0)
    return replace(truth, weights=weights)


def render_film(path: Path, rig: Rig, truth: Truth, how: Conditions, seed: int = 1) -> None:
    """Render a film of the character.

    Raises:
        FileError: it cannot be written.
        Unavailable: this computer offers no OpenGL, or no encoder.
    """
    write_film(path, _pictures(rig, truth, how, seed), truth.times, how.rate, how.crf)


def _pictures(rig: Rig, truth: Truth, how: Conditions, seed: int) -> Iterator[Pixels]:
    random = np.random.default_rng(seed)
    renderer = open_renderer(rig, how.size, how.size)
    front = default_camera(rig)
    shade = how.light * (1.0 - how.slope * np.linspace(0.0, 1.0, how.size))[None, :, None]
    try:
        for row, seconds in zip(truth.weights, truth.times.tolist(), strict=True):
            yaw, pitch = _turn(seconds, how.turn)
            camera = replace(front, yaw=yaw, pitch=pitch)
            drawn = renderer.draw(rig.vertices(rig.from_arkit(row)), camera)[..., 2::-1]
            noisy: Doubles = drawn * shade + random.normal(0.0, how.noise, drawn.shape)
            yield np.clip(noisy, 0, 255).astype(np.uint8)
    finally:
        renderer.close()


def _turn(seconds: float, degrees: float) -> tuple[float, float]:
    """Yaw and pitch of the camera at a time, radians."""
    most = math.radians(degrees)
    yaw = most * math.sin(math.tau * seconds / _TURN)
    return yaw, _NOD_SHARE * most * math.sin(math.tau * seconds / _NOD)
