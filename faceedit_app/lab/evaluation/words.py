"""How well words are aligned, and closures found and fixed, on takes whose word times are known."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles, Floats, Samples
from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.editing.help.spoken import (
    NEAR,
    closing_edits,
    closures_of,
)
from faceedit_app.editing.opening import open_session, open_sound
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.opening import open_take
from faceedit_app.formats.take import Take
from faceedit_app.networks.engine import Engine
from faceedit_app.words.aligning import TextLine, align_part
from faceedit_app.words.files import read_words
from faceedit_app.words.transcript import Transcript, Word

NOISES: tuple[float | None, ...] = (None, 20.0, 10.0, 5.0, 0.0)  # dB of speech over added noise
CLOSE = 0.04  # seconds from the published time
_SEEDS = 5  # noises of each level
_OPENED = 0.1  # weight by which the jaw stays open at every closure of the damaged takes
_WIDTH = 0.06  # seconds of that


@dataclass(frozen=True)
class Alignment:
    """Edges of words against published times, at one level of noise.

    Attributes:
        noise: dB of speech over the noise that was added; None = as recorded.
        edges: how many; the start of a take's first word is left out, since corpora differ in
            whether it holds the silence before it.
        refused: sounds in which the words were not found.
        median, ninety, worst: of the errors, seconds.
        within: share of edges within `CLOSE`.
        pace: seconds of work per second of sound.
    """

    noise: float | None
    edges: int
    refused: int
    median: float
    ninety: float
    worst: float
    within: float
    pace: float


@dataclass(frozen=True)
class ClosingFigures:
    """Closures at m, b and p, before and after all of them are fixed.

    Attributes:
        takes: such as “as tracked”.
        closures: m, b and p.
        open_before, open_after: those whose lips stay over 0.5 mm apart.
        gap_before, gap_after: the widest, mm.
        false: fixes that lie outside the published time of their word, by more than 80 ms.
        moved: the most that a curve moved farther than 80 ms from any fix, mm.
    """

    takes: str
    closures: int
    open_before: int
    open_after: int
    gap_before: float
    gap_after: float
    false: int
    moved: float


@dataclass(frozen=True)
class WordFigures:
    """All that is measured.

    Attributes:
        takes: the names of the takes.
    """

    takes: tuple[str, ...]
    alignment: tuple[Alignment, ...]
    closing: tuple[ClosingFigures, ...]

    def as_json(self) -> dict[str, Any]:
        """The figures as JSON values."""
        return asdict(self)


@dataclass(frozen=True)
class _Known:
    """A take with its sound, and its words at their published times, in seconds of the take."""

    take: Take
    samples: Samples
    rate: int
    start: float
    words: tuple[Word, ...]

    @property
    def text(self) -> str:
        return " ".join(word.text for word in self.words)


def evaluate_words(takes: Sequence[Path], words: Path, engine: Engine) -> WordFigures:
    """Measure alignment and closures.

    Args:
        takes: each with its sound beside it.
        words: the folder of their words (TextGrid or JSON), named like the takes.

    Raises:
        FileError: a take has no sound, or its words are not there.
    """
    known = [_known(path, words) for path in takes]
    if not known:
        raise FaceEditError("evaluate-words needs takes")
    return WordFigures(
        tuple(one.take.path.stem for one in known),
        tuple(_aligned(known, noise) for noise in NOISES),
        (_closed(known, engine, False), _closed(known, engine, True)),
    )


def _known(path: Path, folder: Path) -> _Known:
    take = open_take(path)
    found = open_sound(take)
    if found is None:
        raise FileError(path, "has no sound beside it", "add one of the same name")
    for ending in (".TextGrid", ".json"):
        file = folder / f"{path.stem}{ending}"
        if file.is_file() and (transcript := read_words(file).transcript) is not None:
            sound, offset = found
            words = transcript.shifted(offset).words
            return _Known(take, sound.samples, sound.rate, sound.start + offset, words)
    raise FileError(folder, f"has no words of {path.stem}", "add a TextGrid of that name")


# --- alignment -----------------------------------------------------------------------------------


def _aligned(known: Sequence[_Known], noise: float | None) -> Alignment:
    errors: list[Doubles] = []
    refused, spent, heard = 0, 0.0, 0.0
    for number, one in enumerate(known):
        for seed in range(_SEEDS if noise is not None else 1):
            samples = one.samples if noise is None else _noisy(one, noise, 100 * number + seed)
            began = time.process_time()
            try:
                found = _align(one, samples)
            except FaceEditError:
                refused += 1
                continue
            spent += time.process_time() - began
            heard += len(samples) / one.rate
            errors.append(np.abs(_edges(found.words) - _edges(one.words)))
    all_ = np.concatenate(errors) if errors else np.full(1, np.nan)
    return Alignment(
        noise,
        0 if not errors else len(all_),
        refused,
        float(np.median(all_)),
        float(np.percentile(all_, 90)),
        float(all_.max()),
        float(np.mean(all_ <= CLOSE + 1e-9)),
        spent / heard if heard else float("nan"),
    )


def _align(one: _Known, samples: Samples) -> Transcript:
    part = one.start, one.start + len(samples) / one.rate
    return align_part(samples, one.rate, one.start, part, [TextLine(one.text)])


def _edges(words: Sequence[Word]) -> Doubles:
    return np.array([word.start for word in words[1:]] + [words[-1].end])


def _noisy(one: _Known, decibels: float, seed: int) -> Samples:
    """The sound with white noise, the same in all channels, so many dB below its words' power."""
    sound = one.samples.astype(np.float64)
    first, last = (
        round((t - one.start) * one.rate) for t in (one.words[0].start, one.words[-1].end)
    )
    power = np.mean(sound[max(first, 0) : last] ** 2) / 10 ** (decibels / 10)
    noise = np.random.default_rng(seed).normal(0.0, np.sqrt(power), (len(sound), 1))
    return np.clip(np.rint(sound + noise), -32768, 32767).astype(np.int16)


# --- closures ------------------------------------------------------------------------------------


def _closed(known: Sequence[_Known], engine: Engine, damaged: bool) -> ClosingFigures:
    before, after, false, moved, count = [], [], 0, 0.0, 0
    for one in known:
        words = _align(one, one.samples)
        session = open_session(_damaged(one.take, words) if damaged else one.take, engine=engine)
        session.say(words)
        first = closures_of(session)
        was = session.achieved.copy()
        edits = closing_edits(session)
        session.add(*edits, name="closures")
        before += [closure.gap for closure in first]
        after += [closure.gap for closure in closures_of(session)]
        count += len(first)
        places = [closure for closure in first if closure.is_open]
        false += sum(not _is_in_word(c.time, c.word, words, one.words) for c in places)
        moved = max(moved, _moved_far(session, was, [c.time for c in places]))
    return ClosingFigures(
        "with every closure opened" if damaged else "as tracked",
        count,
        sum(gap > 0.5 for gap in before),
        sum(gap > 0.5 for gap in after),
        max(before, default=0.0),
        max(after, default=0.0),
        false,
        moved,
    )


def _is_in_word(at: float, word: Word, found: Transcript, published: Sequence[Word]) -> bool:
    truth = published[found.words.index(word)]
    return truth.start - NEAR <= at <= truth.end + NEAR


def _moved_far(session: EditSession, before: Floats, fixes: Sequence[float]) -> float:
    times = session.take.clip.times
    if not fixes:
        return 0.0
    far = np.abs(times[:, None] - np.array(fixes)).min(axis=1) > NEAR
    return float(np.abs(session.achieved - before)[far].max(initial=0.0))


def _damaged(take: Take, words: Transcript) -> Take:
    """The take with its jaw held open at every closure, and lips not pressed: a poor track."""
    session = open_session(take)
    session.say(words)
    weights = take.clip.arkit_weights().copy()
    times = take.clip.times
    for closure in closures_of(session):
        share = np.exp(-(((times - closure.time) / _WIDTH) ** 2)).astype(np.float32)
        weights[:, ARKIT_INDEX["mouthClose"]] *= 1 - share
        weights[:, ARKIT_INDEX["jawOpen"]] += _OPENED * share
    columns = [ARKIT_INDEX[channel] for channel in take.clip.channels]
    clip = replace(take.clip, weights=np.clip(weights[:, columns], 0.0, 1.0))
    return replace(take, clip=clip)


# --- report --------------------------------------------------------------------------------------


def report(figures: WordFigures) -> str:
    """The figures as a page of docs/evaluation."""
    lines = [
        "# Words and closures",
        "",
        "`faceedit evaluate-words` on takes with published word times: "
        f"{', '.join(figures.takes)}.",
        "",
        "## Alignment",
        "",
        "| noise | edges | refused | median | 90 % | worst | within 40 ms | work per second |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for row in figures.alignment:
        noise = "as recorded" if row.noise is None else f"{row.noise:.0f} dB"
        lines.append(
            f"| {noise} | {row.edges} | {row.refused} | {1000 * row.median:.0f} ms | "
            f"{1000 * row.ninety:.0f} ms | {1000 * row.worst:.0f} ms | {100 * row.within:.0f} % | "
            f"{row.pace:.2f} s |"
        )
    lines += [
        "",
        "The noise is white, the same in all channels, and that many dB below the words, with five",
        "seeds for each take. Refused counts sounds in which the words were not found. The start",
        "of the first word is left out: its published time includes silence.",
        "",
        "## Closures",
        "",
        "| takes | m, b, p | open | open after the fix | widest gap | after | false | elsewhere |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for entry in figures.closing:
        lines.append(
            f"| {entry.takes} | {entry.closures} | {entry.open_before} | {entry.open_after} | "
            f"{entry.gap_before:.2f} mm | {entry.gap_after:.2f} mm | {entry.false} | "
            f"{entry.moved:.2f} mm |"
        )
    lines += [
        "",
        "Open means over 0.5 mm. False counts fixes over 80 ms outside the published time of their",
        "word. Elsewhere is the most that a curve moved farther than 80 ms from every fix. In the",
        "second row, the jaw was held open at every closure, as poor tracking leaves it.",
        "",
    ]
    return "\n".join(lines)
