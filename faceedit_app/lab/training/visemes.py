"""Timed phonemes to lip and jaw motion, with coarticulation by dominance functions.

Cohen and Massaro (1993), "Modeling coarticulation in synthetic visual speech": each segment has
a target for each articulator and a dominance that falls off around the segment's centre; the
motion is the mean of the targets, weighted by their dominances. A segment that cares little
about an articulator (the lips of /t/) has a small dominance there and takes what its neighbours
do; one that must be seen (the lips of /p/) wins whatever surrounds it. We use Gaussian
dominances (no cusp at the centre), and low-pass the result, because jaw and lips have mass.

Closure is an articulator of its own, 0 (apart) to 1 (sealed), whatever the jaw does:
`mouthClose` is `closure * jawOpen`, so it can never exceed `jawOpen`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from faceedit_app.core.arrays import Doubles
from faceedit_app.lab.training.phonemes import PAUSE, PHONEMES, VOWELS, StressedPhoneme

ARTICULATORS: tuple[str, ...] = (
    "jawOpen",
    "closure",
    "mouthFunnel",
    "mouthPucker",
    "mouthStretch",
    "mouthSmile",
    "mouthUpperUp",
    "mouthLowerDown",
    "mouthRollUpper",
    "mouthRollLower",
    "mouthPress",
    "mouthShrugUpper",
    "mouthShrugLower",
    "mouthDimple",
    "jawForward",
)
"""ARKit channels without their side, but for `closure`; the columns of `articulate`."""
ARTICULATOR_INDEX: dict[str, int] = {name: i for i, name in enumerate(ARTICULATORS)}

# Standard deviation of the low-pass filter, seconds: the jaw is the heaviest, and a closure is
# the fastest thing lips do.
_INERTIA: dict[str, float] = {"jawOpen": 0.016, "closure": 0.014}
_LIP_INERTIA = 0.018

# How far a dominance reaches (standard deviation, as a multiple of the segment's duration, plus
# seconds). Rounding begins early: its backward reach is the longest.
_REACH: dict[str, tuple[float, float]] = {
    "jawOpen": (0.42, 0.008),
    "closure": (0.34, 0.002),
    "mouthFunnel": (0.60, 0.035),
    "mouthPucker": (0.60, 0.040),
}
_DEFAULT_REACH = (0.46, 0.012)
# A seal is held, then broken at once: its dominance is flatter and steeper than a Gaussian.
_STEEPNESS: dict[str, float] = {"closure": 4.0}


@dataclass(frozen=True)
class Viseme:
    """What a phoneme asks of the face.

    Attributes:
        targets: articulator -> value, about 0..1; those not named are 0.
        dominance: articulator -> how much the phoneme insists; those not named have
            `default`.
        default: dominance of the other articulators.
    """

    targets: dict[str, float]
    dominance: dict[str, float]
    default: float = 0.4


def _vowel(jaw: float, **targets: float) -> Viseme:
    named = {"jawOpen": jaw, "mouthLowerDown": 0.30 * jaw, "mouthUpperUp": 0.15 * jaw} | targets
    insist = dict.fromkeys(named, 1.0) | {"mouthFunnel": 1.0, "mouthPucker": 1.0, "closure": 0.8}
    return Viseme(named, insist, default=0.8)


def _consonant(jaw: float, insist: dict[str, float], **targets: float) -> Viseme:
    return Viseme({"jawOpen": jaw} | targets, {"jawOpen": 0.8} | insist)


_SEALED = {"closure": 60.0, "jawOpen": 1.6, "mouthPress": 2.0, "mouthRollUpper": 2.0,
           "mouthRollLower": 2.0, "mouthLowerDown": 3.0, "mouthUpperUp": 3.0,
           "mouthFunnel": 0.5}  # fmt: skip
_LIP_TO_TEETH = {"closure": 12.0, "jawOpen": 2.0, "mouthRollLower": 6.0, "mouthUpperUp": 3.0,
                 "mouthLowerDown": 4.0, "mouthFunnel": 1.5, "mouthPucker": 1.0}  # fmt: skip
_ROUNDED = {"mouthFunnel": 3.0, "mouthPucker": 3.0, "mouthStretch": 2.0, "mouthSmile": 2.0}
_TEETH_TOGETHER = {"jawOpen": 2.2}

VISEMES: dict[str, Viseme] = {
    # Vowels, from close to open and from spread to rounded.
    "i": _vowel(0.13, mouthStretch=0.20, mouthSmile=0.12, mouthDimple=0.08, mouthLowerDown=0.12),
    "I": _vowel(0.17, mouthStretch=0.10, mouthSmile=0.05, mouthLowerDown=0.08),
    "E": _vowel(0.26, mouthStretch=0.13, mouthSmile=0.04, mouthUpperUp=0.06),
    "a": _vowel(0.36, mouthStretch=0.14, mouthUpperUp=0.08),
    "A": _vowel(0.40, mouthFunnel=0.05),
    "O": _vowel(0.30, mouthFunnel=0.32, mouthPucker=0.16),
    "U": _vowel(0.17, mouthFunnel=0.26, mouthPucker=0.26),
    "u": _vowel(0.12, mouthFunnel=0.30, mouthPucker=0.48, jawForward=0.05),
    "V": _vowel(0.28),
    "@": _vowel(0.17),
    "3": _vowel(0.18, mouthFunnel=0.22, mouthPucker=0.14),
    # The lips.
    "p": _consonant(0.10, _SEALED, closure=1.06, mouthPress=0.12, mouthRollUpper=0.05,
                    mouthRollLower=0.07),
    "b": _consonant(0.10, _SEALED, closure=1.05, mouthPress=0.09, mouthRollUpper=0.05,
                    mouthRollLower=0.06),
    "m": _consonant(0.09, _SEALED, closure=1.05, mouthPress=0.10, mouthRollUpper=0.07,
                    mouthRollLower=0.08),
    "f": _consonant(0.09, _LIP_TO_TEETH, closure=0.50, mouthRollLower=0.22, mouthUpperUp=0.12,
                    mouthShrugUpper=0.06),
    "v": _consonant(0.09, _LIP_TO_TEETH, closure=0.48, mouthRollLower=0.18, mouthUpperUp=0.10,
                    mouthShrugUpper=0.05),
    "w": _consonant(0.10, _ROUNDED, mouthPucker=0.55, mouthFunnel=0.20, closure=0.25),
    # The tongue: the lips mostly follow their neighbours.
    "T": _consonant(0.13, _TEETH_TOGETHER, mouthLowerDown=0.09, mouthStretch=0.04),
    "D": _consonant(0.12, {}, mouthLowerDown=0.08),
    "t": _consonant(0.09, {"jawOpen": 1.2}, mouthLowerDown=0.08, mouthStretch=0.05),
    "d": _consonant(0.10, {"jawOpen": 1.1}, mouthLowerDown=0.07, mouthStretch=0.04),
    "n": _consonant(0.11, {"jawOpen": 0.8}, mouthLowerDown=0.05),
    "s": _consonant(0.05, _TEETH_TOGETHER, mouthLowerDown=0.12, mouthStretch=0.12,
                    mouthUpperUp=0.05, mouthDimple=0.05),
    "z": _consonant(0.06, _TEETH_TOGETHER, mouthLowerDown=0.10, mouthStretch=0.10),
    "S": _consonant(0.07, _TEETH_TOGETHER | _ROUNDED, mouthFunnel=0.38, mouthPucker=0.22,
                    mouthUpperUp=0.06),
    "Z": _consonant(0.08, _TEETH_TOGETHER | _ROUNDED, mouthFunnel=0.32, mouthPucker=0.18),
    "tS": _consonant(0.07, _TEETH_TOGETHER | _ROUNDED, mouthFunnel=0.36, mouthPucker=0.20),
    "dZ": _consonant(0.08, _TEETH_TOGETHER | _ROUNDED, mouthFunnel=0.32, mouthPucker=0.18),
    "k": _consonant(0.15, {}, mouthLowerDown=0.04),
    "g": _consonant(0.15, {}, mouthLowerDown=0.04),
    "N": _consonant(0.15, {}),
    "l": _consonant(0.15, {"jawOpen": 0.7}),
    "r": _consonant(0.12, {"mouthFunnel": 1.4, "mouthPucker": 1.4}, mouthFunnel=0.24,
                    mouthPucker=0.16),
    "j": _consonant(0.10, {"jawOpen": 0.8}, mouthStretch=0.12, mouthSmile=0.06),
    "h": Viseme({"jawOpen": 0.18}, {"jawOpen": 0.25}, default=0.15),
    PAUSE: Viseme({}, {"closure": 3.0}, default=0.5),
}  # fmt: skip

# Lips part a little for a comma, and to draw breath before a sentence; they do not seal.
_BREATH = Viseme({"jawOpen": 0.07, "closure": 0.2, "mouthLowerDown": 0.03}, {"closure": 1.0}, 0.5)
_COMMA_SECONDS, _BREATH_SECONDS = 0.4, 0.2

_GLIDES: dict[str, tuple[str, str]] = {
    "eI": ("E", "I"),
    "aI": ("A", "I"),
    "OI": ("O", "I"),
    "oU": ("O", "u"),
    "aU": ("A", "U"),
}

assert set(VISEMES) | set(_GLIDES) == set(PHONEMES)


@dataclass(frozen=True)
class _Segment:
    viseme: Viseme
    centre: float
    seconds: float
    strength: float


def articulate(
    phonemes: Sequence[StressedPhoneme],
    rate: float,
    strengths: Sequence[float] | None = None,
    rest: Doubles | None = None,
) -> Doubles:
    """Lip and jaw motion of a run of phonemes, one after the other from time 0.

    Args:
        phonemes: with durations in seconds.
        rate: frames a second of the result.
        strengths: how far each phoneme's targets go, 1 as in the table; closures stay closures.
        rest: (A,) articulators of silence, in the order of `ARTICULATORS`; lips together if None.

    Returns:
        (T, A) about 0..1, T the whole duration times `rate`, rounded. `closure` is 0..1.
    """
    if rest is None:
        rest = np.zeros(len(ARTICULATORS))
        rest[ARTICULATOR_INDEX["closure"]] = 1.0
    strengths = [1.0] * len(phonemes) if strengths is None else strengths
    seconds = sum(p.seconds for p in phonemes)
    times = np.arange(max(1, round(seconds * rate))) / rate
    segments: list[_Segment] = []
    start = 0.0
    for phoneme, strength in zip(phonemes, strengths, strict=True):
        if phoneme.symbol == PAUSE:
            segments += _silence(phoneme.seconds, start, last=phoneme is phonemes[-1])
        else:
            segments += _segments(phoneme, start, strength)
        start += phoneme.seconds
    blended = np.empty((len(times), len(ARTICULATORS)))
    for column, name in enumerate(ARTICULATORS):
        curve = _blend(segments, times, name, float(rest[column]))
        sigma = _INERTIA.get(name, _LIP_INERTIA) * rate
        blended[:, column] = gaussian_filter1d(curve, sigma, mode="nearest")
    closure = ARTICULATOR_INDEX["closure"]
    blended[:, closure] = blended[:, closure].clip(0.0, 1.0)
    return np.maximum(blended, 0.0)


def _segments(phoneme: StressedPhoneme, start: float, strength: float) -> list[_Segment]:
    """The stretches of one target each: one, or two of a diphthong."""
    if phoneme.symbol in _GLIDES:
        first, second = (VISEMES[s] for s in _GLIDES[phoneme.symbol])
        at, length = (0.30, 0.85), 0.55 * phoneme.seconds
        return [
            _Segment(viseme, start + share * phoneme.seconds, length, strength * fade)
            for viseme, share, fade in zip((first, second), at, (1.0, 0.85), strict=True)
        ]
    if phoneme.symbol in VOWELS and phoneme.stress == 0:
        strength *= 0.8
    middle = start + 0.5 * phoneme.seconds
    return [_Segment(VISEMES[phoneme.symbol], middle, phoneme.seconds, strength)]


def _silence(seconds: float, start: float, last: bool) -> list[_Segment]:
    """A pause: a parting of the lips if it is short, else rest and, before speech, a breath."""
    if seconds < _COMMA_SECONDS and not last:
        return [_Segment(_BREATH, start + 0.5 * seconds, seconds, 1.0)]
    breath = 0.0 if last or seconds < 3 * _BREATH_SECONDS else _BREATH_SECONDS
    parts = max(1, round((seconds - breath) / 0.12))
    length = (seconds - breath) / parts
    out = [_Segment(VISEMES[PAUSE], start + (i + 0.5) * length, length, 1.0) for i in range(parts)]
    if breath:
        out.append(_Segment(_BREATH, start + seconds - 0.5 * breath, breath, 1.0))
    return out


def _blend(segments: Sequence[_Segment], times: Doubles, name: str, rest: float) -> Doubles:
    """The dominance-weighted mean of the targets of one articulator: (T,)."""
    share, extra = _REACH.get(name, _DEFAULT_REACH)
    power = _STEEPNESS.get(name, 2.0)
    weighted, total = np.full(len(times), 1e-6 * rest), np.full(len(times), 1e-6)
    scaled = name != "closure"
    for segment in segments:
        sigma = share * segment.seconds + extra
        first, last = np.searchsorted(times, segment.centre + np.array([-5.0, 5.0]) * sigma)
        offset = times[first:last] - segment.centre
        dominance = segment.viseme.dominance.get(name, segment.viseme.default)
        pull = dominance * np.exp(-0.5 * np.abs(offset / sigma) ** power)
        if segment.viseme is VISEMES[PAUSE]:
            target = rest
        else:
            target = segment.viseme.targets.get(name, 0.0) * (segment.strength if scaled else 1.0)
        weighted[first:last] += pull * target
        total[first:last] += pull
    blended: Doubles = weighted / total
    return blended
