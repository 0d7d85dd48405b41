"""Which takes count: those of people, grouped by source, with what recorded them."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from itertools import islice

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Floats
from faceedit_app.core.regions import EYELIDS
from faceedit_app.formats import livelink, mediapipe
from faceedit_app.formats.opening import open_take
from faceedit_app.formats.take import Take
from faceedit_app.lab.training.data import Performance, source_of
from faceedit_app.lab.training.examples import SYNTHETIC
from faceedit_app.lab.training.synthesis import rotations

SHORTEST, LONGEST = 2.0, 40.0  # seconds of a take
MOST_SECONDS = 300.0  # of a source; more adds little and costs time
_SYNTHESISED_NAME = re.compile(r"speaker_\d\d_take_\d\d")
_COMPARED = 100  # rows of a file
_SAME = 1e-6  # radians
_TRACKED = "_tracked"  # how `faceedit track` ends its names
# MediaPipe never moves these; ARKit always does a little.
_ARKIT_ONLY = ("cheekSquintLeft", "cheekSquintRight", "noseSneerLeft", "noseSneerRight")
_MOVES = 0.02


class Tracker(StrEnum):
    """What recorded a source."""

    IPHONE = "iphone"  # ARKit
    FILM = "film"  # a film tracked by MediaPipe
    OTHER = "other"  # such as a solve cleaned by animators


@dataclass(frozen=True)
class TakeSource:
    """The takes of one source, which stands for one person and tracker.

    Attributes:
        name: as in `data.source_of`.
        tracker: what recorded it.
        takes: each cut to `LONGEST` seconds; about `MOST_SECONDS` in all.
        performances: the same takes whole, on the networks' grid.
        trained_on: whether the measured models were trained on it, which flatters them.
    """

    name: str
    tracker: Tracker
    takes: tuple[Take, ...]
    performances: tuple[Performance, ...]
    trained_on: bool = False

    @property
    def seconds(self) -> float:
        """Length of the takes that are measured."""
        return sum(take.clip.duration for take in self.takes)

    def captures(self, *channels: str) -> bool:
        """Whether the source's tracker produces all of these channels."""
        columns = [ARKIT_INDEX[c] for c in channels]
        return bool(self.performances[0].captured[columns].all())


def is_synthesised(take: Take) -> bool:
    """Whether `faceedit synthesize` wrote a take, or the demo take, by its name or content.

    In a file of the synthesiser the head rests and the eyes turn exactly as the eyeLook channels
    say, to the last digit; no tracker writes that.
    """
    if _SYNTHESISED_NAME.fullmatch(take.path.stem) or source_of(take.path) == SYNTHETIC:
        return True
    clip = take.clip
    if take.kind != livelink.FORMAT or not take.path.is_file():
        return False
    with take.path.open(encoding="utf-8", errors="replace") as file:
        next(file)
        lines = list(islice(file, _COMPARED))
    expected = rotations(clip.arkit_weights()[: len(lines)])
    try:
        turns = np.array([line.split(",")[-expected.shape[1] :] for line in lines], np.float64)
    except ValueError:  # rows without a face, or other columns
        return False
    return turns.shape == expected.shape and bool(np.abs(turns - expected).max() < _SAME)


def of_people(performances: Sequence[Performance]) -> list[Performance]:
    """Those that are not synthesised."""
    return [p for p in performances if p.path is None or not is_synthesised(open_take(p.path))]


def sources_of(
    performances: Sequence[Performance], trained_on: Collection[str] = ()
) -> tuple[list[TakeSource], list[Performance]]:
    """Group takes by source.

    Args:
        performances: with the paths of their files; those without one are ignored.
        trained_on: names of the sources that the measured models were trained on.

    Returns:
        The sources of people, and the synthesised takes, which are none.
    """
    people: dict[str, list[tuple[Take, Performance]]] = {}
    synthesised = []
    for performance in performances:
        if performance.path is None:
            continue
        take = open_take(performance.path)
        if is_synthesised(take):
            synthesised.append(performance)
        elif take.clip.duration >= SHORTEST:
            people.setdefault(performance.source, []).append((take, performance))
    out = []
    for name, pairs in people.items():
        takes = _some([_middle(take) for take, _ in pairs])
        kinds = {take.kind for take, _ in pairs}
        mine = tuple(performance for _, performance in pairs)
        out.append(TakeSource(name, _tracker(mine, kinds), takes, mine, name in trained_on))
    return out, synthesised


def _tracker(performances: Sequence[Performance], kinds: Collection[str]) -> Tracker:
    # A tracked film is a file in the layout of Live Link Face; only its name says what it is.
    films = [p.path is not None and p.path.stem.endswith(_TRACKED) for p in performances]
    if mediapipe.FORMAT in kinds or all(films):
        return Tracker.FILM
    if not performances[0].captured[[ARKIT_INDEX[c] for c in EYELIDS.channels]].any():
        return Tracker.OTHER
    columns = [ARKIT_INDEX[c] for c in _ARKIT_ONLY]
    moves = max(float(p.weights[:, columns].max()) for p in performances) > _MOVES
    return Tracker.IPHONE if moves else Tracker.FILM


def _some(takes: Sequence[Take]) -> tuple[Take, ...]:
    """Takes of about `MOST_SECONDS` in all, from everywhere in the list."""
    seconds = sum(take.clip.duration for take in takes)
    count = len(takes) if seconds <= MOST_SECONDS else round(len(takes) * MOST_SECONDS / seconds)
    chosen = np.linspace(0, len(takes) - 1, max(count, 1)).round().astype(int).tolist()
    return tuple(takes[i] for i in chosen)


def _middle(take: Take) -> Take:
    """The middle `LONGEST` seconds of a take."""
    clip = take.clip
    if clip.duration <= LONGEST:
        return take
    begin = 0.5 * (clip.duration - LONGEST)
    rows = slice(*np.searchsorted(clip.times, (begin, begin + LONGEST)).tolist())
    times = clip.times[rows] - clip.times[rows][0]
    part = replace(clip, weights=clip.weights[rows], times=times, gaps=(), timecodes=None)
    return replace(take, clip=part)


def with_weights(take: Take, weights: Floats) -> Take:
    """A take with other weights (T, 52), in ARKit order, in its own channels."""
    columns = [ARKIT_INDEX[c] for c in take.clip.channels]
    clip = replace(take.clip, weights=np.ascontiguousarray(weights[:, columns], np.float32))
    return replace(take, clip=clip)
