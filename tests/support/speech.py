"""Speech for tests: a sound that espeak-ng speaks, and a take whose lips stay open."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.clip import Clip
from faceedit_app.media.sound import read_sound
from faceedit_app.words.aligning import TextLine, align
from faceedit_app.words.transcript import Phoneme, Transcript, Word

SENTENCE = "my mother made a bowl of apple soup"
needs_espeak = pytest.mark.skipif(
    shutil.which("espeak-ng") is None, reason="espeak-ng is not installed"
)


def speak(path: Path, text: str = SENTENCE, pace: int = 140) -> Path:
    """A WAV in which espeak-ng says a text, at a pace in words a minute."""
    command = ["espeak-ng", "-v", "en-us", "-s", str(pace), "-w", str(path), text]
    subprocess.run(command, check=True)
    return path


def said(*words: tuple[str, str], start: float = 0.4, each: float = 0.12) -> Transcript:
    """Words with phonemes of equal length, such as ("map", "M AE P"), one after the other."""
    made, at = [], start
    for text, symbols in words:
        phonemes = []
        for symbol in symbols.split():
            phonemes.append(Phoneme(symbol, round(at, 4), round(at + each, 4)))
            at += each
        made.append(Word(text, phonemes[0].start, phonemes[-1].end, tuple(phonemes)))
    return Transcript(tuple(made))


def mumbling_clip(words: Transcript, seconds: float = 3.0, rate: float = 60.0) -> Clip:
    """A mouth that opens with each phoneme but never closes for m, b and p."""
    times = np.arange(round(seconds * rate)) / rate
    jaw = np.full(len(times), 0.12)
    for _, phoneme in words.phonemes():
        middle = 0.5 * (phoneme.start + phoneme.end)
        height = -0.05 if phoneme.symbol in ("M", "B", "P") else 0.15
        jaw += height * np.exp(-(((times - middle) / 0.04) ** 2))
    weights = np.zeros((len(times), 52), np.float32)
    weights[:, ARKIT_INDEX["jawOpen"]] = jaw
    return Clip(weights, ARKIT_CHANNELS, times, rate)


def mumbling_take(folder: Path, text: str = SENTENCE) -> tuple[Path, Transcript]:
    """A take with its sound beside it, in which the lips stay open; and the words as they are."""
    sound = read_sound(speak(folder / "mumble.wav", text))
    assert sound is not None
    words = align(sound.samples, sound.rate, [TextLine(text)]).shifted(sound.start)
    clip = mumbling_clip(words, sound.end)
    lines = [",".join(["time_s", *ARKIT_CHANNELS])]
    for seconds, row in zip(clip.times, clip.weights, strict=True):
        lines.append(",".join([f"{seconds:.4f}", *(f"{weight:.5f}" for weight in row)]))
    path = folder / "mumble.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="")
    return path, words
