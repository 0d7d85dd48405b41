"""Text to timed phonemes: espeak-ng's transcription and a deterministic duration model.

espeak-ng (https://github.com/espeak-ng/espeak-ng, GPL) is called as a program where it is
installed; nothing of it is part of FaceEdit. Everything behind `transcribe` also works on
phonemes that were written down by hand, see `parse`.

Durations are a table of inherent durations with rules in the manner of Klatt (1976),
"Linguistic uses of segmental duration in English": stress, place in the phrase, clusters.
"""

from __future__ import annotations

import functools
import re
import shutil
import subprocess
from dataclasses import dataclass, replace

from faceedit_app.core.errors import Unavailable

PAUSE = "_"
"""The symbol of silence."""

VOWELS: dict[str, float] = {
    # Seconds when stressed, at normal tempo.
    "i": 0.105, "I": 0.075, "E": 0.090, "a": 0.130, "A": 0.135, "O": 0.130, "U": 0.080,
    "u": 0.110, "V": 0.085, "@": 0.050, "3": 0.115, "eI": 0.140, "aI": 0.165, "OI": 0.180,
    "oU": 0.140, "aU": 0.170,
}  # fmt: skip
CONSONANTS: dict[str, float] = {
    "p": 0.085, "b": 0.080, "m": 0.075, "f": 0.095, "v": 0.065, "T": 0.085, "D": 0.050,
    "t": 0.070, "d": 0.060, "n": 0.060, "s": 0.100, "z": 0.080, "S": 0.105, "Z": 0.080,
    "tS": 0.120, "dZ": 0.105, "k": 0.080, "g": 0.070, "N": 0.070, "l": 0.060, "r": 0.065,
    "w": 0.065, "j": 0.055, "h": 0.060,
}  # fmt: skip
PHONEMES: tuple[str, ...] = (*VOWELS, *CONSONANTS, PAUSE)

# espeak-ng's mnemonics for English, where they differ from ours.
_ESPEAK: dict[str, tuple[str, ...]] = {
    "i:": ("i",), "I2": ("I",), "I#": ("I",), "a#": ("@",), "aa": ("a",), "@2": ("@",),
    "@L": ("@", "l"), "@-": ("@",), "3:": ("3",), "A:": ("A",), "0": ("A",), "O2": ("A",),
    "0#": ("A",), "O:": ("O",), "o:": ("O",), "u:": ("u",), "U2": ("U",), "A@": ("A", "r"),
    "O@": ("O", "r"), "o@": ("O", "r"), "e@": ("E", "r"), "i@": ("i", "@"), "i@3": ("i", "r"),
    "U@": ("U", "r"), "aI@": ("aI", "@"), "aI3": ("aI", "3"), "aU@": ("aU", "@"),
    "r-": ("r",), "t#": ("d",), "t2": ("t",), "d#": ("d",), "z#": ("z",), "*": ("d",),
    "n-": ("@", "n"), "m-": ("@", "m"), "l-": ("@", "l"), "w#": ("w",), "x": ("k",),
    "E2": ("E",), "E#": ("E",), "V2": ("V",), "I": ("I",), "o": ("oU",), "e": ("eI",),
    "": (), ";": (), ":": (), "?": (), "_": (), "-": (), "|": (),
}  # fmt: skip


@dataclass(frozen=True)
class StressedPhoneme:
    """One speech sound in time.

    Attributes:
        symbol: one of `PHONEMES`.
        seconds: its duration.
        stress: 0 none, 1 secondary, 2 primary; vowels only.
    """

    symbol: str
    seconds: float = 0.0
    stress: int = 0


def parse(transcription: str) -> tuple[StressedPhoneme, ...]:
    """Phonemes of a transcription in espeak-ng's mnemonics (`espeak-ng -x --sep=_`).

    Words are parted by spaces, phonemes by `_`, clauses by line ends; `'` marks primary and
    `,` secondary stress. Unknown symbols are left out: a mouth can do without one. Durations
    are still 0, see `with_durations`.
    """
    out: list[StressedPhoneme] = []
    for clause in transcription.splitlines():
        tokens = [token for word in clause.split() for token in word.split("_")]
        stress = 0
        for token in tokens:
            stress = 2 if "'" in token else 1 if "," in token else stress
            name = re.sub(r"[',]", "", token)
            symbols = _ESPEAK.get(name, (name,))
            for symbol in symbols:
                if symbol in VOWELS:
                    out.append(StressedPhoneme(symbol, stress=stress))
                    stress = 0
                elif symbol in CONSONANTS:
                    out.append(StressedPhoneme(symbol))
        if out and out[-1].symbol != PAUSE:
            out.append(StressedPhoneme(PAUSE))
    return tuple(out[:-1]) if out and out[-1].symbol == PAUSE else tuple(out)


def with_durations(
    phonemes: tuple[StressedPhoneme, ...], tempo: float = 1.0
) -> tuple[StressedPhoneme, ...]:
    """The same phonemes with durations, in seconds; `tempo` 1.2 is a fifth faster than 1."""
    out = []
    for i, phoneme in enumerate(phonemes):
        before = phonemes[i - 1].symbol if i else PAUSE
        after = phonemes[i + 1].symbol if i + 1 < len(phonemes) else PAUSE
        out.append(replace(phoneme, seconds=_seconds(phoneme, before, after, phonemes[i:]) / tempo))
    return tuple(out)


def transcribe(text: str, tempo: float = 1.0, voice: str = "en-us") -> tuple[StressedPhoneme, ...]:
    """Timed phonemes of an English text.

    Raises:
        Unavailable: espeak-ng is not installed or cannot speak.
    """
    return with_durations(parse(_espeak(text, voice)), tempo)


@functools.lru_cache(maxsize=1024)
def _espeak(text: str, voice: str) -> str:
    program = shutil.which("espeak-ng")
    if program is None:
        raise Unavailable(
            "espeak-ng: not installed, speech cannot be synthesised without it; "
            "install it (Debian and Ubuntu: apt install espeak-ng)"
        )
    command = [program, "-q", "-v", voice, "-x", "--sep=_", "--stdin"]
    try:
        done = subprocess.run(
            command, input=text.encode(), capture_output=True, check=True, timeout=30
        )
    except (OSError, subprocess.SubprocessError) as error:
        raise Unavailable(
            f"espeak-ng: cannot transcribe speech ({' '.join(str(error).split())}); reinstall it"
        ) from error
    return done.stdout.decode("utf-8", "replace")


def _seconds(
    phoneme: StressedPhoneme, before: str, after: str, rest: tuple[StressedPhoneme, ...]
) -> float:
    if phoneme.symbol == PAUSE:
        return 0.22
    if phoneme.symbol in VOWELS:
        seconds = VOWELS[phoneme.symbol]
        seconds *= (0.66, 0.85, 1.0)[phoneme.stress]
        if after in ("b", "d", "g", "v", "D", "z", "Z", "dZ"):
            seconds *= 1.12
    else:
        seconds = CONSONANTS[phoneme.symbol]
        if before in CONSONANTS or after in CONSONANTS:
            seconds *= 0.85
    return seconds * (1.35 if _ends_phrase(rest) else 1.0)


def _ends_phrase(rest: tuple[StressedPhoneme, ...]) -> bool:
    """Whether the first of `rest` is in the last syllable's rhyme before a pause or the end."""
    for phoneme in rest[1:]:
        if phoneme.symbol == PAUSE:
            return True
        if phoneme.symbol in VOWELS:
            return False
    return True
