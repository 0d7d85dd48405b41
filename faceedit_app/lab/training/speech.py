"""Whole performances of one face: talking, blinking, looking about, moods, tracker noise.

`synthesize` draws everything from one seed: the same seed gives the same performance (the
transcription comes from espeak-ng, so another version of it may give other phonemes).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import gaussian_filter1d

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.arrays import Doubles, Floats, Times
from faceedit_app.lab.training import expressions, eyes
from faceedit_app.lab.training.phonemes import (
    PAUSE,
    VOWELS,
    StressedPhoneme,
    transcribe,
    with_durations,
)
from faceedit_app.lab.training.sentences import SENTENCES
from faceedit_app.lab.training.visemes import ARTICULATOR_INDEX, ARTICULATORS, articulate

_JAW, _CLOSE = ARKIT_INDEX["jawOpen"], ARKIT_INDEX["mouthClose"]

# Typical rest pose of a calibrated phone tracker; speakers scatter around it.
_REST = {
    "jawOpen": 0.035, "mouthFunnel": 0.06, "mouthPucker": 0.05, "mouthFrown": 0.04,
    "mouthStretch": 0.06, "mouthRollUpper": 0.03, "mouthRollLower": 0.03, "mouthPress": 0.03,
    "mouthShrugLower": 0.05, "mouthShrugUpper": 0.05, "mouthDimple": 0.04, "mouthUpperUp": 0.02,
    "mouthLowerDown": 0.03, "browInnerUp": 0.07, "browOuterUp": 0.03, "browDown": 0.04,
    "eyeSquint": 0.07, "eyeWide": 0.02, "eyeBlink": 0.03, "cheekSquint": 0.03, "noseSneer": 0.05,
    "jawForward": 0.04, "mouthSmile": 0.01, "cheekPuff": 0.02,
}  # fmt: skip
_REGIONS = ("jaw", "mouth", "brow", "eye", "cheek", "nose")


@dataclass(frozen=True)
class Speaker:
    """How one person, as one tracker sees them, differs from the tables.

    Attributes:
        jaw, lips, rounding, brows, affect: gains, about 1.
        tempo, pauses: speech, 1.2 is a fifth faster; length of what is between sentences.
        closure: how fully the lips meet as tracked, 1 = sealed.
        close_leak: `mouthClose` as a share of `jawOpen` while the lips are apart.
        emphasis: chance that a stressed vowel moves the brows.
        stretch_with_jaw, lower_with_jaw, upper_with_jaw: lip channels that follow the jaw.
        blinks: a minute; blink_depth: of a complete one, as tracked; incomplete: share that is not.
        lid_with_gaze: `eyeBlink` for a gaze fully down.
        squint_with_blink, brow_with_blink: at a full blink.
        gaze: how far the eyes wander, as a share of their range.
        gestures: wordless gestures a minute.
        idle, noise: standard deviations of slow drift and of the tracker's jitter.
        rest: (52,) weights of the resting face.
        side: (52,) gains by channel, for asymmetry.
    """

    jaw: float = 1.0
    lips: float = 1.0
    rounding: float = 1.0
    brows: float = 1.0
    affect: float = 1.0
    tempo: float = 1.0
    pauses: float = 1.0
    closure: float = 1.0
    close_leak: float = 0.08
    emphasis: float = 0.25
    stretch_with_jaw: float = 0.08
    lower_with_jaw: float = 0.2
    upper_with_jaw: float = 0.04
    blinks: float = 14.0
    blink_depth: float = 0.95
    incomplete: float = 0.12
    lid_with_gaze: float = 0.25
    squint_with_blink: float = 0.08
    brow_with_blink: float = 0.02
    gaze: float = 0.25
    gestures: float = 1.5
    idle: float = 0.008
    noise: float = 0.0015
    rest: Doubles | None = None
    side: Doubles | None = None


def draw_speaker(rng: np.random.Generator) -> Speaker:
    """A person and a tracker, by chance."""
    rest = expressions.vector({k: v * float(rng.gamma(1.6, 0.6)) for k, v in _REST.items()})
    rest *= rng.uniform(0.85, 1.15, len(rest))
    if rng.random() < 0.3:  # a film tracker, which sees squinting everywhere
        rest[[ARKIT_INDEX["eyeSquintLeft"], ARKIT_INDEX["eyeSquintRight"]]] += rng.uniform(
            0.1, 0.45
        )
    side = np.ones(len(ARKIT_CHANNELS))
    for region in _REGIONS:
        left = float(rng.normal(0.0, 0.05))
        for channel, index in ARKIT_INDEX.items():
            if channel.startswith(region) and not channel.startswith("eyeBlink"):
                tilt = left * (1 if channel.endswith("Left") else -1)
                side[index] = 1.0 + (tilt if channel.endswith(("Left", "Right")) else 0.0)
    return Speaker(
        jaw=float(rng.uniform(0.85, 1.6)),
        lips=float(rng.uniform(0.6, 1.4)),
        rounding=float(rng.uniform(0.6, 1.5)),
        brows=float(rng.uniform(0.4, 1.4)),
        affect=float(rng.uniform(0.4, 1.3)),
        tempo=float(rng.uniform(0.85, 1.18)),
        pauses=float(rng.uniform(0.7, 2.5)),
        closure=float(1.0 - rng.exponential(0.02)),
        close_leak=float(rng.uniform(0.0, 0.35)),
        emphasis=float(rng.uniform(0.08, 0.4)),
        stretch_with_jaw=float(rng.uniform(0.0, 0.25)),
        lower_with_jaw=float(rng.uniform(0.0, 0.5)),
        upper_with_jaw=float(rng.uniform(0.0, 0.12)),
        blinks=float(np.clip(rng.normal(15.0, 3.5), 7.0, 25.0)),
        blink_depth=float(rng.uniform(0.68, 1.0)),
        incomplete=float(rng.uniform(0.05, 0.25)),
        lid_with_gaze=float(rng.uniform(0.1, 0.6)),
        squint_with_blink=float(rng.uniform(-0.03, 0.2)),
        brow_with_blink=float(rng.uniform(0.0, 0.06)),
        gaze=float(rng.uniform(0.12, 0.35)),
        gestures=float(rng.uniform(1.0, 6.0)),
        idle=float(rng.uniform(0.004, 0.014)),
        noise=float(rng.uniform(0.0006, 0.003)),
        rest=rest,
        side=side,
    )


def synthesize(
    seconds: float,
    seed: int,
    rate: float = 60.0,
    utterances: Sequence[Sequence[StressedPhoneme]] | None = None,
    speaker: Speaker | None = None,
) -> tuple[Doubles, Floats]:
    """A performance: sentences in random order, with pauses, until the time is over.

    Args:
        seconds: its length.
        seed: of everything that is left to chance, the speaker included.
        rate: frames a second.
        utterances: what to say, at tempo 1 or without durations; sentences of our own,
            transcribed by espeak-ng, if None.
        speaker: who says it; drawn from the seed if None.

    Returns:
        Times (T,) in seconds and weights (T, 52) float32 in ARKit order, 0..1, with
        `mouthClose <= jawOpen`.

    Raises:
        Unavailable: `utterances` is None and espeak-ng is not installed.
    """
    rng = np.random.default_rng(seed)
    drawn = draw_speaker(rng)
    speaker = drawn if speaker is None else speaker
    if utterances is None:
        utterances = [transcribe(sentence) for sentence in SENTENCES]
    phonemes, strengths, events = _script(rng, seconds, speaker, utterances)
    times = np.arange(round(seconds * rate)) / rate
    events = events + expressions.draw_moods(rng, seconds, speaker.affect)
    events = events + _brow_beats(rng, phonemes, speaker)
    gazes = eyes.draw_gazes(rng, seconds, speaker.gaze)
    blinks = eyes.draw_blinks(
        rng, seconds, speaker.blinks, gazes, speaker.blink_depth, incomplete=speaker.incomplete
    )
    return times, perform(times, rng, speaker, phonemes, strengths, events, gazes, blinks)


def perform(
    times: Times,
    rng: np.random.Generator,
    speaker: Speaker,
    phonemes: Sequence[StressedPhoneme],
    strengths: Sequence[float],
    events: Sequence[expressions.Event],
    gazes: Sequence[eyes.Gaze],
    blinks: Sequence[eyes.Blink],
) -> Floats:
    """Weights (T, 52) float32 of a script that is fully known, evenly spaced `times` (T,)."""
    rate = (len(times) - 1) / (times[-1] - times[0]) if len(times) > 1 else 60.0
    rest = np.zeros(len(ARKIT_CHANNELS)) if speaker.rest is None else speaker.rest
    side = np.ones(len(ARKIT_CHANNELS)) if speaker.side is None else speaker.side
    mouth = _fit(articulate(phonemes, rate, strengths), len(times))
    closure = mouth[:, ARTICULATOR_INDEX["closure"]]
    gains = {"jawOpen": speaker.jaw, "mouthFunnel": speaker.rounding,
             "mouthPucker": speaker.rounding}  # fmt: skip
    talk = np.zeros((len(times), len(ARKIT_CHANNELS)))
    for name in ARTICULATORS:
        if name != "closure":
            shape = expressions.vector({name: gains.get(name, speaker.lips)})
            talk += mouth[:, ARTICULATOR_INDEX[name], None] * shape
    jaw = talk[:, [_JAW]]
    talk += jaw * (1.0 - closure[:, None]) * expressions.vector(
        {"mouthStretch": speaker.stretch_with_jaw, "mouthLowerDown": speaker.lower_with_jaw,
         "mouthUpperUp": speaker.upper_with_jaw}
    )  # fmt: skip
    mood = expressions.overlay(times, events)
    weights = rest + (talk + mood.weights) * side
    weights += _idle(rng, rate, weights, speaker.idle)
    _compete(weights, jaw * (1.0 - closure[:, None]))
    _eyes(weights, times, speaker, gazes, blinks)
    weights += _jitter(rng, weights, speaker.noise)
    weights = _limited(np.maximum(weights, 0.0))
    sealed = closure * (1.0 - mood.unseal) * speaker.closure
    leak = speaker.close_leak * (1.0 - mood.unseal)
    weights[:, _CLOSE] = np.maximum(sealed, leak) * weights[:, _JAW]
    out = weights.astype(np.float32)
    out[:, _CLOSE] = np.minimum(out[:, _CLOSE], out[:, _JAW])
    return out


def _script(
    rng: np.random.Generator,
    seconds: float,
    speaker: Speaker,
    utterances: Sequence[Sequence[StressedPhoneme]],
) -> tuple[list[StressedPhoneme], list[float], list[expressions.Event]]:
    """Phonemes one after the other, pauses included, how strongly each is said, and gestures."""
    phonemes = [StressedPhoneme(PAUSE, float(rng.uniform(0.2, 1.0)))]
    strengths, gestures = [1.0], []
    time = phonemes[0].seconds
    order: list[int] = []
    while time < seconds:
        order = order or rng.permutation(len(utterances)).tolist()
        said = utterances[order.pop()]
        tempo = speaker.tempo * float(rng.normal(1.0, 0.06))
        if not any(p.seconds for p in said):
            said = with_durations(tuple(said))
        loud, word = float(rng.normal(1.0, 0.1)), 0.0
        for phoneme in said:
            word = 0.8 * word + 0.6 * float(rng.normal(0.0, 0.13))
            accent = float(rng.uniform(1.0, 1.35)) if phoneme.stress == 2 else 1.0
            stretch = max(0.6, float(rng.normal(1.0, 0.12))) / tempo
            phonemes.append(replace(phoneme, seconds=phoneme.seconds * stretch))
            strengths.append(max(0.4, (loud + word) * accent))
            time += phonemes[-1].seconds
        pause = float(0.28 + rng.gamma(1.5, 0.28) * speaker.pauses)
        if rng.random() < speaker.gestures * 4.0 / 60.0:  # a sentence takes about four seconds
            length = float(rng.uniform(0.7, 2.2))
            gestures.append(expressions.draw_gesture(rng, time + 0.1, length))
            pause = max(pause, length + 0.2)
        phonemes.append(StressedPhoneme(PAUSE, pause))
        strengths.append(1.0)
        time += pause
    return phonemes, strengths, gestures


def _brow_beats(
    rng: np.random.Generator, phonemes: Sequence[StressedPhoneme], speaker: Speaker
) -> list[expressions.Event]:
    """Small raises or knits of the brows on stressed vowels."""
    out, time = [], 0.0
    for phoneme in phonemes:
        if phoneme.stress == 2 and phoneme.symbol in VOWELS and rng.random() < speaker.emphasis:
            name = "interest" if rng.random() < 0.8 else "attention"
            length = float(rng.uniform(0.3, 0.65))
            amount = speaker.brows * float(rng.uniform(0.15, 0.8))
            start = time - 0.35 * length
            out.append(expressions.Event(name, start, length, 0.4 * length, 0.6 * length, amount))
        time += phoneme.seconds
    return out


def _idle(rng: np.random.Generator, rate: float, weights: Doubles, amount: float) -> Doubles:
    """Slow motion (T, 52) of a face that does nothing, larger where a channel is active."""
    drift = np.zeros_like(weights)
    for channel, index in ARKIT_INDEX.items():
        if channel.startswith(("eyeLook", "tongue")) or channel.endswith("Right"):
            continue
        noise = gaussian_filter1d(rng.normal(size=len(weights)), 0.35 * rate, mode="wrap")
        noise *= amount / max(float(noise.std()), 1e-9)
        columns = [index]
        if channel.endswith("Left") and channel not in ("jawLeft", "mouthLeft"):
            columns.append(ARKIT_INDEX[channel[: -len("Left")] + "Right"])
        for column in columns:
            drift[:, column] = noise * (0.4 + 4.0 * weights[:, column].clip(0.0, 0.6))
    return drift


def _compete(weights: Doubles, gap: Doubles) -> None:
    """Muscles that pull against each other: rounding undoes smiling, smiling frowning.

    `weights` (T, 52) are changed; `gap` (T, 1) is how far talking opens the lips, as `jawOpen`.
    """
    rounding = weights[:, [ARKIT_INDEX["mouthPucker"]]] + weights[:, [ARKIT_INDEX["mouthFunnel"]]]
    for stems, rival, share in (
        (("mouthSmile", "mouthStretch", "mouthDimple"), np.clip(rounding, 0, 1), 0.5),
        (("mouthFrown",), weights[:, [ARKIT_INDEX["mouthSmileLeft"]]].clip(0, 1), 0.8),
        (("browDown",), (1.6 * weights[:, [ARKIT_INDEX["browInnerUp"]]]).clip(0, 1), 0.8),
        (("mouthPress", "mouthRollLower", "mouthShrugLower"), (4.0 * gap).clip(0, 1), 0.75),
    ):
        columns = [ARKIT_INDEX[n] for stem in stems for n in (stem, stem + "Left", stem + "Right")
                   if n in ARKIT_INDEX]  # fmt: skip
        weights[:, columns] *= 1.0 - share * rival


def _eyes(
    weights: Doubles,
    times: Times,
    speaker: Speaker,
    gazes: Sequence[eyes.Gaze],
    blinks: Sequence[eyes.Blink],
) -> None:
    """Write gaze and lids into `weights` (T, 52), on top of what moods ask of the lids."""
    shut = eyes.lids(times, blinks)
    gaze = eyes.gaze_curve(times, gazes)
    yaw, up = gaze[:, 0], gaze[:, 1]
    for side, (name, outward) in enumerate((("Left", 1.0), ("Right", -1.0))):
        lid, out = shut[:, side], outward * yaw - 0.08  # the eyes converge a little
        down = np.maximum(-up, 0.0) + 0.2 * lid * (1.0 + np.minimum(up, 0.0))
        column = {c: ARKIT_INDEX[c + name] for c in (
            "eyeBlink", "eyeWide", "eyeSquint", "browDown", "eyeLookDown", "eyeLookUp",
            "eyeLookIn", "eyeLookOut")}  # fmt: skip
        weights[:, column["eyeLookOut"]] = np.maximum(out, 0.0)
        weights[:, column["eyeLookIn"]] = np.maximum(-out, 0.0)
        weights[:, column["eyeLookUp"]] = np.maximum(up, 0.0)
        weights[:, column["eyeLookDown"]] = down
        base = weights[:, column["eyeBlink"]] + speaker.lid_with_gaze * np.maximum(-up, 0.0)
        base = np.clip(base - 0.1 * np.maximum(up, 0.0), 0.0, 1.0)
        weights[:, column["eyeBlink"]] = np.maximum(base, lid + base * (1.0 - lid) * 0.8)
        wide = weights[:, column["eyeWide"]] + 0.25 * np.maximum(up, 0.0)
        weights[:, column["eyeWide"]] = wide * (1.0 - np.maximum(lid, base)) ** 2
        weights[:, column["eyeSquint"]] += speaker.squint_with_blink * lid
        weights[:, column["browDown"]] += speaker.brow_with_blink * lid


def _jitter(rng: np.random.Generator, weights: Doubles, amount: float) -> Doubles:
    """The tracker's own noise: larger where a channel is active, a little smoothed by it."""
    noise = gaussian_filter1d(rng.normal(size=weights.shape), 0.7, axis=0, mode="nearest")
    jitter: Doubles = amount * noise * (0.3 + 2.0 * np.minimum(np.abs(weights), 0.6))
    return jitter


def _limited(weights: Doubles) -> Doubles:
    """At most 1, bent softly above 0.85."""
    knee = 0.85
    bent = knee + (1 - knee) * np.tanh((weights - knee) / (1 - knee))
    return np.where(weights > knee, bent, weights)


def _fit(curves: Doubles, length: int) -> Doubles:
    """Cut (T, A) to `length` frames, or hold the last one."""
    missing = max(0, length - len(curves))
    return np.pad(curves, ((0, missing), (0, 0)), mode="edge")[:length]
