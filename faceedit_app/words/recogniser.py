"""The recogniser: finds words, in their order, in stretches of a sound.

Pocketsphinx (https://github.com/cmusphinx/pocketsphinx, BSD) brings an acoustic model and a
dictionary for US English. Its usual beams lose long or noisy sounds; these are so wide that every
state stays alive. A long sound is aligned in pieces: each piece may end after any word, and its
last words are left to the next one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.errors import FaceEditError
from faceedit_app.words.denoising import RATE, STEP, Spoken, Stopped, loudness
from faceedit_app.words.dictionary import pronunciations
from faceedit_app.words.transcript import Phoneme, Word

if TYPE_CHECKING:
    from pocketsphinx import Decoder

_BEAM = 1e-200
_LONGEST = 40.0  # seconds aligned at once
_PIECE = 30.0  # seconds of a piece of a longer sound
_SPARE = 1.0  # seconds at the end of a piece whose words are left to the next one
FASTEST = 8.0  # words a second; nobody speaks faster
_SHORTEST = 3  # frames: no phoneme is shorter in the model, so words that were not said are
_SQUEEZED = 0.35  # share of phonemes as short as that, above which the words do not fit
_FEW = 6  # phonemes, with which the share says nothing
_LONG_SILENCE = 120  # frames


class Aligner:
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
            for entry, said in (pronunciations(word) or {word: sounds}).items():
                self._decoder.add_word(entry, said, False)

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
            count, last = self._fitting(left[: round(FASTEST * (end - start))], start, end)
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
    """A decoder without words: its whole dictionary would take twelve times as long to read."""
    from pocketsphinx import Decoder

    return Decoder(
        samprate=RATE,
        lm=None,
        dict=None,
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
