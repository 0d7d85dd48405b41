"""Words are found where they are said; what cannot be found is refused with one line."""

from __future__ import annotations

import time
import wave
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from support.places import SHARED
from support.speech import SENTENCE, needs_espeak, speak

from faceedit_app.core.arrays import Samples
from faceedit_app.core.errors import FaceEditError
from faceedit_app.media.sound import read_sound
from faceedit_app.words import recogniser
from faceedit_app.words.aligning import NOISY, TextLine, align, align_part
from faceedit_app.words.denoising import Stopped

# Of three films of the GRID corpus: the words, and their starts and the end, as published. The
# first start is left out: the corpus has silence in it.
PUBLISHED = {
    "bbaf2n": ("bin blue at f two now", (1.18, 1.36, 1.42, 1.64, 1.89, 2.12)),
    "bbal6n": ("bin blue at l six now", (0.85, 1.07, 1.11, 1.26, 1.57, 1.81)),
    "bbbf8p": ("bin blue by f eight please", (0.37, 0.59, 0.72, 0.88, 1.01, 1.43)),
}
VIDEO = SHARED / "data" / "video"
needs_films = pytest.mark.skipif(
    not VIDEO.is_dir(), reason="no real films here; FACEEDIT_SHARED may name their folder"
)


def samples_of(path: Path) -> tuple[Samples, int]:
    with wave.open(str(path)) as file:
        return np.frombuffer(file.readframes(file.getnframes()), np.int16), file.getframerate()


@pytest.fixture(scope="module")
def sentence(tmp_path_factory: pytest.TempPathFactory) -> tuple[Samples, int]:
    return samples_of(speak(tmp_path_factory.mktemp("speech") / "said.wav"))


def padded(samples: Samples, rate: int, before: float, after: float) -> Samples:
    return np.concatenate(
        [np.zeros(round(before * rate)), samples, np.zeros(round(after * rate))]
    ).astype(np.int16)


@needs_espeak
def test_words_are_found_in_their_order(sentence: tuple[Samples, int]) -> None:
    samples, rate = sentence
    words = align(samples, rate, [TextLine("My mother, made a bowl of apple soup!")])
    assert [word.text for word in words.words] == SENTENCE.replace("my", "My").split()
    assert all(one.end <= other.start + 1e-9 for one, other in pairwise(words.words))
    mother = words.words[1]
    assert [p.symbol for p in mother.phonemes] == ["M", "AH", "DH", "ER"]
    assert (mother.phonemes[0].start, mother.phonemes[-1].end) == (mother.start, mother.end)
    assert 0 <= words.words[0].start < words.words[-1].end <= len(samples) / rate


@needs_espeak
def test_silence_before_the_words_moves_them(sentence: tuple[Samples, int]) -> None:
    samples, rate = sentence
    alone = align(samples, rate, [TextLine(SENTENCE)])
    later = align(padded(samples, rate, 1.5, 1.0), rate, [TextLine(SENTENCE)])
    for word, moved in zip(alone.words[1:], later.words[1:], strict=True):
        assert moved.start == pytest.approx(word.start + 1.5, abs=0.04)


@needs_espeak
def test_a_part_of_the_sound_is_enough(sentence: tuple[Samples, int]) -> None:
    samples, rate = sentence
    twice = np.concatenate([samples, samples])
    length = len(samples) / rate
    second = align_part(twice, rate, 0.25, (length + 0.25, 2 * length + 0.25), [TextLine(SENTENCE)])
    assert second.words[0].start >= length + 0.249
    assert second.words[-1].end <= 2 * length + 0.251
    with pytest.raises(FaceEditError, match="no sound in this part"):
        align_part(twice, rate, 0.0, (99.0, 100.0), [TextLine(SENTENCE)])


@needs_espeak
def test_lines_with_times_are_found_near_them(sentence: tuple[Samples, int]) -> None:
    samples, rate = sentence
    length = len(samples) / rate
    sound = np.concatenate([samples, np.zeros(rate, np.int16), samples])
    lines = [TextLine(SENTENCE, 0.0, length), TextLine(SENTENCE, length + 1.0, 2 * length + 1.0)]
    words = align(sound, rate, lines).words
    assert len(words) == 16
    assert words[8].start == pytest.approx(words[0].start + length + 1.0, abs=0.1)


@needs_espeak
def test_long_sounds_are_aligned_in_pieces(
    sentence: tuple[Samples, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    samples, rate = sentence
    sound, text = np.tile(padded(samples, rate, 0.2, 0.3), 4), " ".join([SENTENCE] * 4)
    whole = align(sound, rate, [TextLine(text)])
    monkeypatch.setattr(recogniser, "_LONGEST", 8.0)
    monkeypatch.setattr(recogniser, "_PIECE", 6.0)
    shares: list[float] = []
    pieces = align(sound, rate, [TextLine(text)], None, lambda share: not shares.append(share))
    assert len(shares) > 2
    assert shares == sorted(shares)
    starts = np.array([[word.start for word in one.words] for one in (whole, pieces)])
    apart = np.abs(starts[1] - starts[0])
    assert np.median(apart) < 0.01
    assert np.percentile(apart, 90) < 0.06  # synthetic speech leaves a few edges undecided


@needs_espeak
@pytest.mark.parametrize("hiss", [0.0, 20.0])
def test_words_are_found_after_minutes_of_silence(
    sentence: tuple[Samples, int], hiss: float
) -> None:
    samples, rate = sentence
    alone = align(samples, rate, [TextLine(SENTENCE)])
    sound = padded(np.concatenate([samples, np.zeros(15 * rate), samples]), rate, 70.0, 20.0)
    noise = np.random.default_rng(2).normal(0, hiss, len(sound))
    found = align((sound + noise).astype(np.int16), rate, [TextLine(f"{SENTENCE} {SENTENCE}")])
    length = len(samples) / rate
    for first, before in ((0, 70.0), (8, 85.0 + length)):
        for word, moved in zip(alone.words[1:], found.words[first + 1 : first + 8], strict=True):
            assert moved.start == pytest.approx(word.start + before, abs=0.06)


@needs_espeak
def test_lines_outside_the_sound_are_left_out(sentence: tuple[Samples, int]) -> None:
    samples, rate = sentence
    length = len(samples) / rate
    lines = [TextLine("while nobody knew", -9.0, -5.0), TextLine(SENTENCE, 0.0, length)]
    found = align(samples, rate, [*lines, TextLine("our station", 60.0, 62.0)])
    assert found.text == SENTENCE
    with pytest.raises(FaceEditError, match="None of the lines"):
        align(samples, rate, [lines[0]])


def test_no_sound_at_all_is_refused() -> None:
    with pytest.raises(FaceEditError, match="silent"):
        align(np.zeros(0, np.int16), 16_000, [TextLine("a")])


@needs_espeak
def test_it_can_be_cancelled(sentence: tuple[Samples, int]) -> None:
    samples, rate = sentence
    with pytest.raises(Stopped):
        align(samples, rate, [TextLine(SENTENCE)], None, lambda _share: False)


@needs_espeak
def test_a_word_that_only_sounds_known_is_found(sentence: tuple[Samples, int]) -> None:
    samples, rate = sentence
    text = SENTENCE.replace("soup", "zoop")
    with pytest.raises(FaceEditError, match="“zoop”"):
        align(samples, rate, [TextLine(text)])
    words = align(samples, rate, [TextLine(text)], {"zoop": "soup", "other": "two"})
    assert words.words[-1].text == "zoop"
    assert words.sounds_like == (("zoop", "soup"),)


@needs_espeak
def test_a_word_is_heard_in_any_of_the_ways_to_say_it(tmp_path: Path) -> None:
    text = "read the record to them"
    words = align(*samples_of(speak(tmp_path / "said.wav", text)), [TextLine(text)]).words
    sounds = {word.text: " ".join(p.symbol for p in word.phonemes) for word in words}
    assert sounds["read"] == "R IY D"  # and not R EH D, which comes first in the dictionary
    assert sounds["record"] == "R EH K ER D"
    assert sounds["them"] == "DH EH M"


@needs_espeak
def test_words_that_were_not_said_are_refused(sentence: tuple[Samples, int]) -> None:
    samples, rate = sentence
    for wrong in ("set white in nine again", "while nobody knew our green station grows"):
        with pytest.raises(FaceEditError, match="do not fit"):
            align(samples, rate, [TextLine(wrong)])


def test_silence_noise_and_music_are_refused() -> None:
    rate = 16_000
    t = np.arange(5 * rate) / rate
    chord = sum(np.sin(2 * np.pi * f * t) * np.exp(-2 * (2 * t % 1)) for f in (220, 277, 330, 440))
    noise = np.random.default_rng(0).normal(0, 1500, len(t))
    for sound, says in ((0 * t, "silent"), (3000 * chord, "fit"), (noise, "fit")):
        began = time.process_time()
        with pytest.raises(FaceEditError, match=says):
            align(np.asarray(sound).astype(np.int16), rate, [TextLine(SENTENCE)])
        assert time.process_time() - began < 20


def test_too_many_words_are_refused_at_once() -> None:
    with pytest.raises(FaceEditError, match="cannot be said in"):
        align(np.zeros(16_000, np.int16), 16_000, [TextLine("word " * 40)])
    with pytest.raises(FaceEditError, match="There are no words"):
        align(np.zeros(16_000, np.int16), 16_000, [TextLine(" – ")])


@needs_espeak
def test_noise_is_estimated(sentence: tuple[Samples, int]) -> None:
    samples, rate = sentence
    clean = padded(samples, rate, 0.6, 0.6)
    loud = float(np.mean(samples.astype(np.float64) ** 2))
    found = []
    for decibels in (30, 20, 5):
        noise = np.random.default_rng(1).normal(
            0, np.sqrt(loud / 10 ** (decibels / 10)), len(clean)
        )
        words = align(
            (clean + noise).clip(-32768, 32767).astype(np.int16), rate, [TextLine(SENTENCE)]
        )
        assert words.noise is not None
        found.append(words.noise)
    assert found == pytest.approx([30, 20, 5], abs=3)
    assert found[2] < NOISY < found[1]


@needs_films
@pytest.mark.parametrize("name", PUBLISHED)
def test_words_of_real_films_are_where_their_corpus_says(name: str) -> None:
    text, edges = PUBLISHED[name]
    sound = read_sound(VIDEO / f"{name}.mpg")
    assert sound is not None
    words = align(sound.samples, sound.rate, [TextLine(text)]).shifted(sound.start).words
    found = [word.start for word in words[1:]] + [words[-1].end]
    np.testing.assert_allclose(found, edges, atol=0.04)
