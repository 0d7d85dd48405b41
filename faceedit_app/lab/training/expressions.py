"""What a face does besides talking: moods that come and go, and wordless gestures in pauses.

Weights are by ARKit channel; a name without its side means both sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.arrays import Doubles

MOODS: dict[str, dict[str, float]] = {
    "smile": {"mouthSmile": 0.55, "cheekSquint": 0.28, "eyeSquint": 0.16, "mouthDimple": 0.10,
              "mouthUpperUp": 0.05},
    "grin": {"mouthSmile": 0.80, "cheekSquint": 0.45, "eyeSquint": 0.28, "mouthUpperUp": 0.25,
             "mouthLowerDown": 0.22, "mouthStretch": 0.15, "jawOpen": 0.05, "browOuterUp": 0.08},
    "sadness": {"mouthFrown": 0.45, "browInnerUp": 0.45, "mouthShrugLower": 0.25,
                "mouthRollLower": 0.05, "eyeSquint": 0.06, "mouthPucker": 0.05},
    "anger": {"browDown": 0.60, "eyeSquint": 0.25, "mouthPress": 0.15, "noseSneer": 0.20,
              "mouthFrown": 0.15, "mouthStretch": 0.08},
    "surprise": {"browInnerUp": 0.55, "browOuterUp": 0.55, "eyeWide": 0.45, "jawOpen": 0.05},
    "doubt": {"mouthFrown": 0.22, "browDownLeft": 0.30, "browOuterUpRight": 0.45,
              "browInnerUp": 0.15, "mouthShrugUpper": 0.15, "mouthShrugLower": 0.18,
              "mouthLeft": 0.12},
    "disgust": {"noseSneer": 0.45, "mouthUpperUp": 0.30, "browDown": 0.30, "eyeSquint": 0.25,
                "mouthFrown": 0.25, "mouthShrugLower": 0.15},
    "attention": {"browDown": 0.28, "eyeSquint": 0.14, "mouthPress": 0.06},
    "interest": {"browInnerUp": 0.28, "browOuterUp": 0.26, "eyeWide": 0.15, "mouthSmile": 0.08},
    "worry": {"browInnerUp": 0.50, "browDown": 0.20, "mouthStretch": 0.22, "eyeWide": 0.10,
              "mouthFrown": 0.12},
    "fatigue": {"eyeBlink": 0.28, "browDown": 0.08, "mouthFrown": 0.08},
    "smirk": {"mouthSmileLeft": 0.50, "mouthSmileRight": 0.20, "mouthDimpleLeft": 0.25,
              "cheekSquintLeft": 0.22, "mouthLeft": 0.12, "browOuterUpLeft": 0.18},
}  # fmt: skip

GESTURES: dict[str, dict[str, float]] = {
    "open": {"jawOpen": 0.85, "mouthStretch": 0.30, "mouthLowerDown": 0.40, "browInnerUp": 0.20},
    "gasp": {"jawOpen": 0.45, "browInnerUp": 0.60, "browOuterUp": 0.60, "eyeWide": 0.60},
    "kiss": {"mouthPucker": 0.85, "mouthFunnel": 0.25, "mouthShrugUpper": 0.10},
    "blow": {"mouthFunnel": 0.75, "mouthPucker": 0.35, "jawOpen": 0.15, "cheekPuff": 0.20},
    "press": {"mouthPress": 0.60, "mouthRollUpper": 0.35, "mouthRollLower": 0.40,
              "mouthDimple": 0.20, "mouthStretch": 0.12},
    "lips in": {"mouthRollUpper": 0.70, "mouthRollLower": 0.75, "mouthPress": 0.25},
    "shrug": {"mouthShrugLower": 0.65, "mouthShrugUpper": 0.45, "mouthFrown": 0.45,
              "browInnerUp": 0.30, "browOuterUp": 0.30},
    "teeth": {"mouthSmile": 0.55, "mouthUpperUp": 0.60, "mouthLowerDown": 0.65,
              "mouthStretch": 0.40, "jawOpen": 0.04, "cheekSquint": 0.35, "eyeSquint": 0.25},
    "laugh": {"mouthSmile": 0.85, "jawOpen": 0.40, "cheekSquint": 0.65, "eyeSquint": 0.50,
              "mouthUpperUp": 0.35, "mouthLowerDown": 0.35, "eyeBlink": 0.20},
    "snarl": {"noseSneer": 0.70, "mouthUpperUp": 0.60, "browDown": 0.65, "eyeSquint": 0.40},
    "grimace": {"mouthStretch": 0.70, "mouthLowerDown": 0.45, "jawOpen": 0.06, "eyeWide": 0.30},
    "pout": {"mouthFrown": 0.65, "mouthShrugLower": 0.50, "browInnerUp": 0.50,
             "mouthPucker": 0.20},
    "brows up": {"browInnerUp": 0.80, "browOuterUp": 0.80, "eyeWide": 0.25},
    "scowl": {"browDown": 0.90, "eyeSquint": 0.50, "noseSneer": 0.25},
    "eyes wide": {"eyeWide": 0.85, "browInnerUp": 0.35, "browOuterUp": 0.40},
    "eyes shut": {"eyeBlink": 1.00, "eyeSquint": 0.20},
    "squeeze": {"eyeBlink": 1.00, "eyeSquint": 0.80, "cheekSquint": 0.55, "browDown": 0.45,
                "noseSneer": 0.25},
    "squint": {"eyeSquint": 0.75, "cheekSquint": 0.35, "browDown": 0.20, "eyeBlink": 0.12},
    "wink left": {"eyeBlinkLeft": 0.95, "eyeSquintLeft": 0.40, "cheekSquintLeft": 0.50,
                  "mouthSmileLeft": 0.35},
    "wink right": {"eyeBlinkRight": 0.95, "eyeSquintRight": 0.40, "cheekSquintRight": 0.50,
                   "mouthSmileRight": 0.35},
    "aside left": {"mouthLeft": 0.60, "mouthSmileLeft": 0.20, "mouthDimpleLeft": 0.25},
    "aside right": {"mouthRight": 0.60, "mouthSmileRight": 0.20, "mouthDimpleRight": 0.25},
    "chew": {"jawLeft": 0.30, "jawOpen": 0.12, "mouthShrugLower": 0.20, "mouthRight": 0.10},
    "puff": {"cheekPuff": 0.70, "mouthPress": 0.20, "mouthPucker": 0.15},
}  # fmt: skip

_OPENING = ("jawOpen", "mouthUpperUp", "mouthLowerDown", "mouthFunnel")


@dataclass(frozen=True)
class Event:
    """One mood or gesture.

    Attributes:
        name: a key of `MOODS` or `GESTURES`.
        start, seconds: from the first movement to the last.
        rise, fall: seconds of the ramps.
        amount: 1 as in the table.
        side: -0.3..0.3, how much stronger the left side is.
    """

    name: str
    start: float
    seconds: float
    rise: float
    fall: float
    amount: float
    side: float = 0.0


@dataclass
class Overlay:
    """Weights to add to a performance.

    Attributes:
        weights: (T, 52), added to the talking face.
        unseal: (T,) 0..1, how far the lips may not stay sealed (an open mouth, bared teeth).
    """

    weights: Doubles
    unseal: Doubles = field(init=False)

    def __post_init__(self) -> None:
        self.unseal = np.zeros(len(self.weights))


def vector(shape: dict[str, float], side: float = 0.0) -> Doubles:
    """(52,) weights of a table entry; `side` makes the left stronger and the right weaker."""
    out = np.zeros(len(ARKIT_CHANNELS))
    for name, value in shape.items():
        for channel, factor in ((name, 1.0), (name + "Left", 1 + side), (name + "Right", 1 - side)):
            if channel in ARKIT_INDEX:
                out[ARKIT_INDEX[channel]] += factor * value
    return out


def overlay(times: Doubles, events: Sequence[Event]) -> Overlay:
    """What the events add up to: times (T,) -> weights (T, 52)."""
    out = Overlay(np.zeros((len(times), len(ARKIT_CHANNELS))))
    for event in events:
        shape = GESTURES[event.name] if event.name in GESTURES else MOODS[event.name]
        first, last = np.searchsorted(times, [event.start, event.start + event.seconds])
        local = times[first:last] - event.start
        level = (
            event.amount * _ramp(local / event.rise) * _ramp((event.seconds - local) / event.fall)
        )
        out.weights[first:last] += level[:, None] * vector(shape, event.side)
        opening = sum(shape.get(name, 0.0) for name in _OPENING)
        if opening > 0.1 and event.name in GESTURES:
            here = out.unseal[first:last]
            np.maximum(here, np.minimum(1.0, level * min(1.0, 3.0 * opening)), out=here)
    return out


def draw_moods(rng: np.random.Generator, seconds: float, amount: float) -> list[Event]:
    """Moods of two to nine seconds that follow each other, with breaks."""
    out, time = [], float(rng.uniform(0.0, 2.0))
    names = tuple(MOODS)
    while time < seconds:
        length = 1.6 + float(rng.gamma(2.0, 1.4))
        rise, fall = rng.uniform(0.25, 0.7), rng.uniform(0.4, 1.1)
        out.append(
            Event(
                str(rng.choice(names)), time, length, float(rise), float(fall),
                amount * float(rng.beta(2.0, 2.2)) * 1.3, float(rng.normal(0.0, 0.06)),
            )
        )  # fmt: skip
        time += length * float(rng.uniform(0.6, 1.1)) + float(rng.exponential(1.2))
    return out


def draw_gesture(rng: np.random.Generator, start: float, seconds: float) -> Event:
    """One gesture that fills `seconds` from `start`."""
    rise, fall = rng.uniform(0.16, 0.4), rng.uniform(0.2, 0.45)
    return Event(
        str(rng.choice(tuple(GESTURES))), start, seconds, float(rise), float(fall),
        float(rng.uniform(0.4, 1.1)), float(rng.normal(0.0, 0.05)),
    )  # fmt: skip


def _ramp(x: Doubles) -> Doubles:
    """0 before 0, 1 after 1, without a kink in speed or acceleration between."""
    x = np.clip(x, 0.0, 1.0)
    rise: Doubles = x**3 * (10.0 + x * (6.0 * x - 15.0))
    return rise
