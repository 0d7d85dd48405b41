"""Finds when words were said in a sound: forced alignment with pocketsphinx, offline.

A noisy sound is aligned several times, with its noise taken out in different ways.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Samples
from faceedit_app.core.errors import FaceEditError
from faceedit_app.words.denoising import (
    RATE,
    STEP,
    Spoken,
    Stopped,
    frame_power,
    views,
    without_silence,
)
from faceedit_app.words.dictionary import pronounce, tokens
from faceedit_app.words.recogniser import FASTEST, Aligner
from faceedit_app.words.transcript import MOST_WORDS, Phoneme, Transcript, Word

NOISY = 10.0  # dB; below, the times are doubtful
_AROUND = 0.3  # seconds on either side of a line with times
_SILENT = 33  # of 32768, -60 dB


@dataclass(frozen=True)
class TextLine:
    """Some text, and when it was said if that is known; seconds of the sound."""

    text: str
    start: float | None = None
    end: float | None = None


def align(
    samples: Samples,
    rate: int,
    lines: Sequence[TextLine],
    sounds_like: Mapping[str, str] | None = None,
    progress: Callable[[float], bool] | None = None,
) -> Transcript:
    """Find when each word and phoneme was said.

    Args:
        samples: (N,) or (N, C) int16.
        rate: samples per second.
        lines: all that is said, in order; a line without times may be anywhere after the last,
            and those with times outside the sound are left out.
        sounds_like: spellings of words that are not in the dictionary.
        progress: is given 0..1 now and then; False gives up.

    Returns:
        The words, in seconds from the first sample.

    Raises:
        FaceEditError: the sound is silent, the words do not fit it, or one is unknown.
        Stopped: `progress` said so.
    """
    sounds_like, seconds = dict(sounds_like or {}), len(samples) / rate
    typed = [(line, tokens(line.text)) for line in lines if _is_in(line, seconds)]
    if lines and not typed:
        raise FaceEditError("None of the lines is said in this sound; choose those of the take")
    total = sum(len(words) for _, words in typed)
    _check_amount(total, seconds)
    phones = pronounce((word.lower() for _, words in typed for word in words), sounds_like)
    voice = _mono(samples, rate)
    if not len(voice) or np.percentile(np.abs(voice.astype(np.int32)), 99) < _SILENT:
        raise FaceEditError("The sound is silent where the words should be; choose another part")
    progress = progress or (lambda _: True)
    found = _agreed(views(voice, progress), typed, phones, progress)
    used = tuple((word, spelling) for word, spelling in sounds_like.items() if word in phones)
    return Transcript(found, used, round(noise_of(voice, found), 1))


def _agreed(
    heard: Sequence[Samples],
    typed: Sequence[tuple[TextLine, list[str]]],
    phones: Mapping[str, str],
    progress: Callable[[float], bool],
) -> tuple[Word, ...]:
    """The words at the medians of their times in several views of a sound.

    Raises:
        FaceEditError: in most of them, the words do not fit.
    """
    found: list[list[Word]] = []
    refusals: list[FaceEditError] = []
    for number, voice in enumerate(heard):

        def advanced(share: float, number: int = number) -> bool:
            return progress((number + share) / len(heard))

        try:
            found.append(_found(without_silence(voice), typed, phones, advanced))
        except Stopped:
            raise
        except FaceEditError as refusal:
            refusals.append(refusal)
            if 2 * len(refusals) > len(heard):
                raise
    return tuple(_median(same) for same in zip(*found, strict=True))


def _found(
    spoken: Spoken,
    typed: Sequence[tuple[TextLine, list[str]]],
    phones: Mapping[str, str],
    progress: Callable[[float], bool],
) -> list[Word]:
    aligner = Aligner(spoken, phones, progress)
    found: list[Word] = []
    at = 0.0
    for line, words in typed:
        if line.start is not None and line.end is not None:
            begin = max(spoken.inside(line.start) - _AROUND, at)
            end = min(spoken.inside(line.end) + _AROUND, aligner.seconds)
            found += aligner.whole(words, begin, end)
        else:
            found += aligner.in_pieces(words, at)
        at = found[-1].end if found else at
    return [_moved(word, spoken) for word in found]


def _median(same: Sequence[Word]) -> Word:
    """A word at the median of its times; its pronunciation is that of the first."""
    first = same[0]
    alike = [word for word in same if len(word.phonemes) == len(first.phonemes)]
    edges = [
        [word.start, word.end, *(t for p in word.phonemes for t in (p.start, p.end))]
        for word in alike
    ]
    start, end, *inner = np.median(edges, axis=0).round(3).tolist()
    phonemes = zip(first.phonemes, inner[::2], inner[1::2], strict=True)
    return Word(first.text, start, end, tuple(Phoneme(p.symbol, a, b) for p, a, b in phonemes))


def align_part(
    samples: Samples,
    rate: int,
    start: float,
    part: tuple[float, float],
    lines: Sequence[TextLine],
    sounds_like: Mapping[str, str] | None = None,
    progress: Callable[[float], bool] | None = None,
) -> Transcript:
    """Find when words were said in a part of a sound; see `align`.

    Args:
        start: the time of the first sample, seconds.
        part: where to look, in the same seconds, as are the times of `lines`.

    Returns:
        The words, in the same seconds.

    Raises:
        FaceEditError: as `align`, or there is no sound in that part.
    """
    first, last = (round((time - start) * rate) for time in part)
    first = max(first, 0)
    inside = samples[first:last]
    if not len(inside):
        raise FaceEditError("There is no sound in this part; choose another part")
    begins = start + first / rate
    moved = [
        TextLine(line.text, line.start - begins, line.end - begins)
        if line.start is not None and line.end is not None
        else TextLine(line.text)
        for line in lines
    ]
    return align(inside, rate, moved, sounds_like, progress).shifted(begins)


def noise_of(voice: Samples, words: Sequence[Word]) -> float:
    """The signal-to-noise ratio of a sound at 16 kHz, dB: words against what lies between them."""
    power = frame_power(voice)
    times = STEP * (np.arange(len(power)) + 0.5)
    inside, outside = np.zeros(len(power), np.bool_), np.ones(len(power), np.bool_)
    for word in words:
        inside |= (times >= word.start) & (times < word.end)
        outside &= (times < word.start - 0.05) | (times > word.end + 0.05)
    if not inside.any():
        return 0.0
    between = power[outside] if outside.sum() * STEP >= 0.2 else np.sort(power)[: len(power) // 10]
    # Breath and clicks are not the noise that hides speech.
    quiet = max(float(np.percentile(between, 50)) if len(between) else 1.0, 1.0)
    speech = max(float(power[inside].mean()) - quiet, 1.0)
    return min(10.0 * float(np.log10(speech / quiet)), 60.0)


def _moved(word: Word, spoken: Spoken) -> Word:
    """A word at its time in the whole sound."""

    def begin(time: float) -> float:
        return round(spoken.begin(time), 3)

    def end(time: float) -> float:
        return round(spoken.end(time), 3)

    phonemes = tuple(Phoneme(p.symbol, begin(p.start), end(p.end)) for p in word.phonemes)
    return Word(word.text, begin(word.start), end(word.end), phonemes)


def _is_in(line: TextLine, seconds: float) -> bool:
    """Whether a line may be said in the sound; subtitles are often those of a whole film."""
    if line.start is None or line.end is None:
        return True
    return line.end > 0.0 and line.start < seconds


def _check_amount(words: int, seconds: float) -> None:
    if not words:
        raise FaceEditError("There are no words; type what is said")
    if words > MOST_WORDS:
        raise FaceEditError(f"There are over {MOST_WORDS:,} words; align one scene at a time")
    if words > 1 + FASTEST * seconds:
        raise FaceEditError(
            f"{words} words cannot be said in {seconds:.1f} s; choose the right sound or part"
        )


def _mono(samples: Samples, rate: int) -> Samples:
    """(N,) int16 at 16 kHz."""
    if samples.ndim == 1:
        samples = samples[:, None]
    if rate == RATE and samples.shape[1] == 1:
        return samples[:, 0]
    from av import AudioFrame, AudioResampler  # with a sound, it is there already

    frame = AudioFrame.from_ndarray(
        np.ascontiguousarray(samples).reshape(1, -1),
        format="s16",
        layout="mono" if samples.shape[1] == 1 else "stereo",
    )
    frame.sample_rate = rate
    resampler = AudioResampler("s16", "mono", RATE)
    parts = [part.to_ndarray().ravel() for part in resampler.resample(frame)]
    parts += [part.to_ndarray().ravel() for part in resampler.resample(None)]
    return np.concatenate(parts).astype(np.int16)
