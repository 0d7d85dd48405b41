"""Dubbing: a retime that shows the take's phonemes when another sound says them.

Both sides' phonemes are aligned in order by dynamic programming (Needleman and Wunsch, "A general
method applicable to the search for similarities in the amino acid sequence of two proteins",
1970). The edges of those that match become pins, no closer together or farther apart than speeds
from `SLOWEST` to `FASTEST` allow.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.clip import Clip
from faceedit_app.core.errors import FaceEditError
from faceedit_app.editing.edits.edit import Edit
from faceedit_app.editing.edits.media import MediaFile, Placement
from faceedit_app.editing.help.retime import FASTEST, SLOWEST, by_pins, padded
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.timing import counted
from faceedit_app.words.speech_sounds import lips_of
from faceedit_app.words.transcript import Transcript

MATCH = "Match another sound"  # the step
MOST_UNITS = 12_000  # phonemes of one side: the table of the alignment takes their square
_GAP = 0.7  # cost of a phoneme that only one side has
_ALIKE, _SAME_KIND, _OTHER = 0.4, 1.0, 1.6  # cost of two that differ
_CLOSEST = 0.02  # seconds between two pins of the take
_MISSED = 0.02  # seconds from where a pin should be that are said to the user
_VOWELS = frozenset("aeiouyæɑɒɔəɛɜɪʊʌøœɐɨʉɯɤ")


@dataclass(frozen=True)
class Matchable:
    """A phoneme, or a word without phonemes: what is matched.

    Attributes:
        symbol: what it is compared by.
        start, end: seconds.
    """

    symbol: str
    start: float
    end: float


@dataclass(frozen=True)
class DubMatch:
    """What was matched.

    Attributes:
        edit: the retime.
        words: the words of the other sound, in seconds of the take.
        offset: when the other sound's file begins, in seconds of the take.
        matched: how many of the take's phonemes (or words) have a counterpart.
        total: how many it has.
        unmatched: words of the take none of which was found in the other sound, by time.
        limited: (first, last) seconds of the take where it would have to be played too slow or
            too fast, and is late or early instead.
    """

    edit: Edit
    words: Transcript
    offset: float
    matched: int
    total: int
    unmatched: tuple[str, ...]
    limited: tuple[tuple[float, float], ...]

    @property
    def message(self) -> str:
        """What came of it, for the user."""
        text = f"Matched {self.matched} of {counted(self.total, 'phoneme')}"
        if self.unmatched:
            shown = ", ".join(self.unmatched[:4]) + (", …" if len(self.unmatched) > 4 else "")
            text += f"; not found: {shown}"
        if self.limited:
            first, last = self.limited[0]
            text += f"; too far apart at {first:.2f} to {last:.2f} s"
            if len(self.limited) > 1:
                text += f" and {len(self.limited) - 1} more"
        return text


def match(
    clip: Clip, ours: Transcript, theirs: Transcript, offset: float | None = None
) -> DubMatch:
    """A retime that brings the take's words to those of another sound.

    Args:
        clip: the take.
        ours: its words, in its seconds.
        theirs: the other sound's words, in seconds of its file.
        offset: when that file begins, in seconds of the take; None = so that the words lie as
            near to each other as possible.

    Raises:
        FaceEditError: too little matches, there is too much to match, or no word lies in the take.
    """
    mine, other = _units(ours, theirs)
    if max(len(mine), len(other)) > MOST_UNITS:
        raise FaceEditError(
            f"There are over {MOST_UNITS:,} phonemes to match; match a shorter take"
        )
    pairs = _aligned([unit.symbol for unit in mine], [unit.symbol for unit in other])
    good = [(i, j) for i, j in pairs if _cost(mine[i].symbol, other[j].symbol) <= _ALIKE]
    if len(good) < 2 or 2 * len(good) < min(len(mine), len(other)):
        raise FaceEditError(
            f"Only {len(good)} of {counted(len(mine), 'phoneme')} match the other sound; "
            "check that it says the same words"
        )
    if offset is None:
        apart = [mine[i].start + mine[i].end - other[j].start - other[j].end for i, j in good]
        offset = round(0.5 * float(np.median(apart)), 3)
    wanted = _pins([(mine[i], other[j]) for i, j in good], offset, clip)
    if not wanted:
        raise FaceEditError("None of the words lies within the take; set when the sound begins")
    (was, now), (then_was, then_now) = wanted[0], wanted[-1]
    first, last = float(clip.times[0]), float(clip.times[-1])
    start = max(min(was, now) - padded(now - was), first)
    end = min(max(then_was, then_now) + padded(then_now - then_was), last)
    pins = _limited(wanted, start, end)
    edit = by_pins(clip, pins, start, end)
    found = {i for i, _ in good}
    return DubMatch(
        replace(edit, name="Match another sound"),
        theirs.shifted(offset),
        offset,
        len(good),
        len(mine),
        _missing(ours, mine, found),
        _missed(wanted, pins),
    )


def keep(
    session: EditSession,
    found: DubMatch,
    media: Placement | None = None,
    sound: MediaFile | None = None,
) -> None:
    """Retime the take, and give it the other sound's words, as one step.

    Args:
        media: the take's sound and film as they are placed now; None = as the session has them.
        sound: the other sound, to play with the take; None = the take keeps its own.
    """
    state = session.state
    media = media or state.media
    if sound is not None:
        film = None if media is None else media.film
        media = Placement(replace(sound, offset=found.offset), film)
    edits = (*state.edits, found.edit)
    session.restore(replace(state, edits=edits, words=found.words, media=media), MATCH)


# --- matching ----------------------------------------------------------------------------------


def _units(ours: Transcript, theirs: Transcript) -> tuple[list[Matchable], list[Matchable]]:
    """What is matched: phonemes if both sides have them, else words."""
    both = ours, theirs
    if all(any(True for _ in side.phonemes()) for side in both):
        found = [
            [Matchable(_plain(p.symbol), p.start, p.end) for _, p in side.phonemes()]
            for side in both
        ]
    else:
        found = [
            [Matchable(w.text.casefold(), w.start, w.end) for w in side.words] for side in both
        ]
    return found[0], found[1]


def _plain(symbol: str) -> str:
    return re.sub(r"[\d:ːˈˌ]+", "", symbol.strip()) or symbol


def _cost(one: str, other: str) -> float:
    """How badly two phonemes match, or two words."""
    if one == other:
        return 0.0
    if (lips := lips_of(one)) is not None and lips == lips_of(other):
        return _ALIKE
    vowels = [symbol[:1].casefold() in _VOWELS for symbol in (one, other)]
    return _SAME_KIND if vowels[0] == vowels[1] else _OTHER


def _aligned(ours: Sequence[str], theirs: Sequence[str]) -> list[tuple[int, int]]:
    """Pairs of positions, in order, by the cheapest alignment."""
    kinds = list(dict.fromkeys((*ours, *theirs)))
    index = {symbol: i for i, symbol in enumerate(kinds)}
    costs = np.array([[_cost(one, other) for other in kinds] for one in kinds])
    columns = np.array([index[symbol] for symbol in theirs], np.intp)
    gaps = _GAP * np.arange(len(theirs) + 1)
    total = gaps.copy()
    came = np.zeros((len(ours) + 1, len(theirs) + 1), np.int8)  # 0 pair, 1 only ours, 2 theirs
    came[0] = 2
    for i, symbol in enumerate(ours, start=1):
        paired = np.concatenate([[np.inf], total[:-1] + costs[index[symbol]][columns]])
        alone = total + _GAP
        best = np.minimum(paired, alone)
        total = np.minimum.accumulate(best - gaps) + gaps
        came[i] = np.where(total < best - 1e-9, 2, np.where(paired <= alone, 0, 1))
    pairs, i, j = [], len(ours), len(theirs)
    while i or j:
        way = came[i, j] if i else 2
        if way == 0:
            pairs.append((i - 1, j - 1))
        i, j = i - (way != 2), j - (way != 1)
    return pairs[::-1]


def _missing(ours: Transcript, mine: Sequence[Matchable], found: set[int]) -> tuple[str, ...]:
    """The words of which nothing was found."""
    there = sorted((mine[i].start, mine[i].end) for i in found)
    return tuple(
        word.text
        for word in ours.words
        if not any(start < word.end and end > word.start for start, end in there)
    )


# --- pins --------------------------------------------------------------------------------------


def _pins(
    pairs: Sequence[tuple[Matchable, Matchable]], offset: float, clip: Clip
) -> list[tuple[float, float]]:
    """(was, is) seconds of the edges of matched units, within the take and in order."""
    first, last = float(clip.times[0]), float(clip.times[-1])
    pins: list[tuple[float, float]] = []
    for mine, other in pairs:
        for was, now in ((mine.start, other.start), (mine.end, other.end)):
            pin = was, now + offset
            inside = all(first < second < last for second in pin)
            later = not pins or (was - pins[-1][0] >= _CLOSEST and pin[1] > pins[-1][1])
            if inside and later:
                pins.append(pin)
    return pins


def _limited(
    wanted: Sequence[tuple[float, float]], start: float, end: float
) -> tuple[tuple[float, float], ...]:
    """The pins as near to where they should be as the speeds allow.

    Going forwards, each pin is as near as those before it let it be; going backwards likewise. The
    mean of the two keeps to the speeds as well, and shares what is missed.
    """
    was, now = np.array(wanted, np.float64).T
    forwards = _pass(was, now, start, end)
    backwards = -_pass(-was[::-1], -now[::-1], -end, -start)[::-1]
    found = 0.5 * (forwards + backwards)
    return tuple(zip(was.tolist(), found.tolist(), strict=True))


def _pass(was: Doubles, now: Doubles, start: float, end: float) -> Doubles:
    low = np.maximum(start + (was - start) / FASTEST, end - (end - was) / SLOWEST)
    high = np.minimum(start + (was - start) / SLOWEST, end - (end - was) / FASTEST)
    found, before, at = np.empty_like(now), start, start
    for i, (moment, goal) in enumerate(zip(was.tolist(), now.tolist(), strict=True)):
        least = max(low[i], at + (moment - before) / FASTEST)
        most = min(high[i], at + (moment - before) / SLOWEST)
        before, at = moment, min(max(goal, least), most)
        found[i] = at
    return found


def _missed(
    wanted: Sequence[tuple[float, float]], pins: Sequence[tuple[float, float]]
) -> tuple[tuple[float, float], ...]:
    """The stretches in which pins are not where they should be."""
    runs: list[tuple[float, float]] = []
    was_off = False
    for (_, goal), (_, now) in zip(wanted, pins, strict=True):
        off = abs(goal - now) > _MISSED
        if off:
            runs.append((runs.pop()[0] if was_off else now, now))
        was_off = off
    return tuple(runs)
