"""Finds when words were said in a sound: forced alignment with pocketsphinx, offline.

Pocketsphinx (https://github.com/cmusphinx/pocketsphinx, BSD) brings an acoustic model and a
dictionary for US English. Its usual beams lose long or noisy sounds; these are so wide that every
state stays alive. A long sound is aligned in pieces: each piece may end after any word, and its
last words are left to the next one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.errors import FaceEditError
from faceedit_app.words.denoising import (
    RATE,
    STEP,
    Samples,
    Spoken,
    Stopped,
    frame_power,
    loudness,
    without_noise,
    without_silence,
)
from faceedit_app.words.dictionary import pronounce, tokens
from faceedit_app.words.transcript import MOST_WORDS, Phoneme, Transcript, Word

if TYPE_CHECKING:
    from pocketsphinx import Decoder

NOISY = 10.0  # dB; below, the times are doubtful
_BEAM = 1e-200
_LONGEST = 40.0  # seconds aligned at once
_PIECE = 30.0  # seconds of a piece of a longer sound
_SPARE = 1.0  # seconds at the end of a piece whose words are left to the next one
_FASTEST = 8.0  # words a second; nobody speaks faster
_AROUND = 0.3  # seconds on either side of a line with times
_SHORTEST = 3  # frames: no phoneme is shorter in the model, so words that were not said are
_SQUEEZED = 0.35  # share of phonemes as short as that, above which the words do not fit
_FEW = 6  # phonemes, with which the share says nothing
_LONG_SILENCE = 120  # frames
_SILENT = 33  # of 32768, -60 dB


@dataclass(frozen=True)
class Line:
    """Some text, and when it was said if that is known; seconds of the sound."""

    text: str
    start: float | None = None
    end: float | None = None


def align(
    samples: Samples,
    rate: int,
    lines: Sequence[Line],
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
    spoken = without_silence(without_noise(voice, progress))
    aligner = _Aligner(spoken, phones, progress)
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
    found = [_moved(word, spoken) for word in found]
    used = tuple((word, spelling) for word, spelling in sounds_like.items() if word in phones)
    return Transcript(tuple(found), used, round(noise_of(voice, found), 1))


def align_part(
    samples: Samples,
    rate: int,
    start: float,
    part: tuple[float, float],
    lines: Sequence[Line],
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
        Line(line.text, line.start - begins, line.end - begins)
        if line.start is not None and line.end is not None
        else Line(line.text)
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


def _is_in(line: Line, seconds: float) -> bool:
    """Whether a line may be said in the sound; subtitles are often those of a whole film."""
    if line.start is None or line.end is None:
        return True
    return line.end > 0.0 and line.start < seconds


def _check_amount(words: int, seconds: float) -> None:
    if not words:
        raise FaceEditError("There are no words; type what is said")
    if words > MOST_WORDS:
        raise FaceEditError(f"There are over {MOST_WORDS:,} words; align one scene at a time")
    if words > 1 + _FASTEST * seconds:
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


class _Aligner:
    """Aligns words to stretches of what is spoken in a sound; all times are those within it.

    Attributes:
        seconds: length of the sound.
    """

    def __init__(
        self, spoken: Spoken, phones: Mapping[str, str], progress: Callable[[float], bool]
    ) -> None:
        self._voice, self._progress = spoken.samples, progress
        self.seconds = len(self._voice) / RATE
        self._decoder = _decoder()
        for word, sounds in phones.items():
            if self._decoder.lookup_word(word) is None:
                self._decoder.add_word(word, sounds, True)

    def whole(self, words: Sequence[str], start: float, end: float) -> list[Word]:
        """All words in a stretch, seconds."""
        if not words:
            return []
        self._report(start)
        return self._align(words, start, end)

    def in_pieces(self, words: Sequence[str], start: float) -> list[Word]:
        """Words somewhere after a time, in pieces if that is long."""
        found: list[Word] = []
        left = list(words)
        while left and self.seconds - start > _LONGEST:
            self._report(start)
            end = self._quiet_end(start)
            count, last = self._fitting(left[: round(_FASTEST * (end - start))], start, end)
            if count:
                found += self._align(left[:count], start, last)
                left = left[count:]
            start = last if count else end - _SPARE
        return found + self.whole(left, start, self.seconds)

    def _report(self, at: float) -> None:
        if not self._progress(min(at / self.seconds, 1.0)):
            raise Stopped("Cancelled")

    def _quiet_end(self, start: float) -> float:
        """The quietest moment in the last third of the piece that begins at `start`."""
        first = start + _PIECE * 2 / 3
        part = self._voice[round(first * RATE) : round((start + _PIECE) * RATE)]
        return first + STEP * int(np.argmin(loudness(part)))

    def _fitting(self, words: Sequence[str], start: float, end: float) -> tuple[int, float]:
        """How many words, from the first on, were said in a stretch, and when the last one ended.

        Those that end close to the end of the stretch are left out: they may be cut off. So are
        those after what was taken for a long silence: there is none left, so it is speech.
        """
        count = len(words)
        stops = [(i, count, 0.5) for i in range(count)]
        self._decode(words, start, end, stops)
        ends: list[float] = []
        for part in self._decoder.seg():
            if _is_word(part.word):
                ends.append(start + STEP * (part.end_frame + 1))
            elif ends and part.end_frame - part.start_frame > _LONG_SILENCE:
                break
        while ends and ends[-1] > end - _SPARE:
            ends.pop()
        return len(ends), ends[-1] if ends else start

    def _align(self, words: Sequence[str], start: float, end: float) -> list[Word]:
        pcm = self._decode(words, start, end, [])
        said = sum(_is_word(part.word) for part in self._decoder.seg())
        if said != len(words):
            raise _no_fit(start, end)
        self._decoder.set_alignment()
        _listen(self._decoder, pcm)
        found = [
            Word(text, phonemes[0].start, phonemes[-1].end, phonemes)
            for text, phonemes in zip(words, _timed(self._decoder, start), strict=True)
        ]
        _check_fit(found)
        return found

    def _decode(
        self, words: Sequence[str], start: float, end: float, stops: list[tuple[int, int, float]]
    ) -> bytes:
        """Find the best path through the words; returns the samples."""
        steps = [(i, i + 1, 1.0, word.lower()) for i, word in enumerate(words)]
        decoder = self._decoder
        grammar = decoder.create_fsg("words", 0, len(words), [*steps, *stops])
        decoder.add_fsg("words", grammar)
        decoder.activate_search("words")
        pcm = self._voice[round(start * RATE) : round(end * RATE)].tobytes()
        _listen(decoder, pcm)
        if decoder.hyp() is None:
            raise _no_fit(start, end)
        return pcm


def _timed(decoder: Decoder, start: float) -> list[tuple[Phoneme, ...]]:
    """The phonemes of each word that was aligned last.

    Pocketsphinx frees an entry when the next one is asked for, so nothing of it is kept.
    """
    words = []
    for word in decoder.get_alignment():
        if _is_word(word.name):
            times = [(p.name, p.start, p.start + p.duration) for p in word]
            words.append(
                tuple(
                    Phoneme(name, round(start + STEP * first, 3), round(start + STEP * last, 3))
                    for name, first, last in times
                )
            )
    return words


def _decoder() -> Decoder:
    from pocketsphinx import Decoder

    return Decoder(
        samprate=RATE,
        lm=None,
        bestpath=False,
        dither=False,
        maxhmmpf=-1,
        beam=_BEAM,
        pbeam=_BEAM,
        wbeam=_BEAM,
        loglevel="FATAL",
    )


def _listen(decoder: Decoder, pcm: bytes) -> None:
    decoder.start_utt()
    decoder.process_raw(pcm, full_utt=True)
    decoder.end_utt()


def _is_word(name: str) -> bool:
    """Whether a segment is a word: silence, noise and the ends have brackets or plus signs."""
    return name[:1] not in "<[+("


def _check_fit(words: Sequence[Word]) -> None:
    """Check that words were said: those that were not are squeezed into almost no time.

    Raises:
        FaceEditError: they were not.
    """
    lengths = [p.end - p.start for word in words for p in word.phonemes]
    short = sum(length < (_SHORTEST + 0.5) * STEP for length in lengths)
    if len(lengths) >= _FEW and short > _SQUEEZED * len(lengths):
        raise _no_fit(words[0].start, words[-1].end)


def _no_fit(start: float, end: float) -> FaceEditError:
    return FaceEditError(
        f"The words do not fit the sound from {start:.1f} to {end:.1f} s; "
        f"type just what is said there, in English, or select the part in which it is said"
    )
