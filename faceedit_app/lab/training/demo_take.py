"""The take that ships with FaceEdit: ten seconds with something to fix.

One speaker says two sentences, blinks three times, looks about and smiles at the end. Two
things go wrong, as they do in tracked takes: the second blink stops half-way, and the lips do
not quite meet on the /m/ of "move". Build it with

    python -m faceedit_app.lab.training.demo_take assets/demo_take.csv

It needs no espeak-ng: the transcription is written down here.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.lab.training import expressions
from faceedit_app.lab.training.expressions import Event
from faceedit_app.lab.training.eyes import Blink, Gaze
from faceedit_app.lab.training.phonemes import PAUSE, StressedPhoneme, parse, with_durations
from faceedit_app.lab.training.speech import Speaker, perform
from faceedit_app.lab.training.synthesis import write_livelink

SECONDS, RATE, SEED, START = 10.0, 60.0, 1, "10:00:00:00.000"
TEMPO = 0.9

SENTENCES = (
    "My name is Poppy, and this is my first performance.",
    "If something looks wrong, grab the curve, and move it.",
)
TRANSCRIPTIONS = (
    "m_'aI n_'eI_m I_z p_'0_p_i\na_n_d D_I_s I_z m_aI f_'3:_s_t p_3_f_'o@_m_@_n_s",
    "I_f s_'V_m_T_I_N l_'U_k_s r_'O:_N\ng_r_'a_b D_@2 k_'3:_v\na_n_d m_'u:_v I_t",
)

INCOMPLETE_BLINK = 4.62  # seconds at which it begins
BLINKS = (
    Blink(1.52, closing=0.095, held=0.02, opening=0.22, depth=(0.98, 0.97)),
    Blink(INCOMPLETE_BLINK, closing=0.10, held=0.01, opening=0.20, depth=(0.50, 0.47), lag=0.005),
    Blink(8.12, closing=0.10, held=0.03, opening=0.25, depth=(0.99, 0.98), lag=-0.004),
)
GAZES = (
    Gaze(0.10, 0.02, 0.0),
    Gaze(1.55, 0.22, 0.06),
    Gaze(2.45, 0.0, 0.0),
    Gaze(4.10, -0.20, -0.10),
    Gaze(4.95, 0.03, 0.02),
    Gaze(7.00, 0.10, -0.28),
    Gaze(7.70, 0.0, 0.0),
    Gaze(9.10, -0.05, 0.04),
)
EVENTS = (
    Event("interest", 0.55, 0.75, 0.25, 0.40, 0.60),
    Event("interest", 2.55, 0.70, 0.22, 0.40, 0.50),
    Event("attention", 4.35, 1.70, 0.40, 0.70, 0.50),
    Event("interest", 6.45, 0.90, 0.30, 0.50, 0.75, 0.06),
    Event("smile", 7.75, 2.60, 0.75, 0.60, 0.62, 0.05),
)


@dataclass(frozen=True)
class Timed:
    """The phonemes of the take and how strongly each is said."""

    phonemes: tuple[StressedPhoneme, ...]
    strengths: tuple[float, ...]

    def span(self, index: int) -> tuple[float, float]:
        """Seconds at which phoneme `index` begins and ends."""
        start = sum(p.seconds for p in self.phonemes[:index])
        return start, start + self.phonemes[index].seconds

    @property
    def open_closure(self) -> int:
        """The /m/ of "move", on which the lips do not quite meet."""
        return max(i for i, p in enumerate(self.phonemes) if p.symbol == "m")


def script() -> Timed:
    """The phonemes and their times."""
    first, second = (with_durations(parse(text), TEMPO) for text in TRANSCRIPTIONS)
    phonemes = [StressedPhoneme(PAUSE, 0.70), *first, StressedPhoneme(PAUSE, 0.62), *second]
    phonemes.append(StressedPhoneme(PAUSE, max(0.5, SECONDS - sum(p.seconds for p in phonemes))))
    strengths = [(0.95, 1.0, 1.05)[p.stress] for p in phonemes]
    return Timed(tuple(phonemes), tuple(strengths))


def speaker() -> Speaker:
    """A calm face, tracked well; slightly uneven, as faces are."""
    rest = expressions.vector(
        {"jawOpen": 0.030, "mouthFunnel": 0.03, "mouthPucker": 0.03, "mouthStretch": 0.03,
         "mouthFrown": 0.03, "mouthRollLower": 0.02, "mouthRollUpper": 0.02, "mouthPress": 0.04,
         "mouthShrugLower": 0.06, "mouthShrugUpper": 0.03, "mouthDimple": 0.03,
         "browInnerUp": 0.05, "browDown": 0.02, "eyeSquint": 0.05, "eyeBlink": 0.03,
         "cheekSquint": 0.03, "noseSneer": 0.04, "jawForward": 0.03}
    )  # fmt: skip
    side = np.ones(len(rest))
    for stem, tilt in (("mouthSmile", 0.05), ("mouthStretch", 0.06), ("browOuterUp", 0.08),
                       ("mouthLowerDown", 0.05), ("eyeSquint", 0.04)):  # fmt: skip
        side[ARKIT_INDEX[stem + "Left"]] += tilt
        side[ARKIT_INDEX[stem + "Right"]] -= tilt
    return replace(
        Speaker(), jaw=0.76, lips=0.95, rounding=1.25, close_leak=0.06, lower_with_jaw=0.22,
        stretch_with_jaw=0.08, lid_with_gaze=0.3, idle=0.006, noise=0.0010, rest=rest, side=side,
    )  # fmt: skip


def build() -> tuple[Doubles, Floats]:
    """Times (T,) in seconds and weights (T, 52) float32 in ARKit order."""
    said = script()
    times = np.arange(round(SECONDS * RATE)) / RATE
    rng = np.random.default_rng(SEED)
    weights = perform(times, rng, speaker(), said.phonemes, said.strengths, EVENTS, GAZES, BLINKS)
    start, stop = said.span(said.open_closure)
    centre, reach = 0.5 * (start + stop), 0.5 * (stop - start) + 0.05
    near = np.clip(1.0 - ((times - centre) / reach) ** 2, 0.0, 1.0)
    weights[:, ARKIT_INDEX["mouthClose"]] *= (1.0 - 0.55 * near).astype(np.float32)
    return times, weights


def main() -> None:
    """Write the take to the path given, `assets/demo_take.csv` if none is."""
    path = sys.argv[1] if len(sys.argv) > 1 else "assets/demo_take.csv"
    write_livelink(path, build()[1], RATE, START)
    print(f"{path}: {SECONDS:.0f} s at {RATE:.0f} frames a second")


if __name__ == "__main__":
    main()
