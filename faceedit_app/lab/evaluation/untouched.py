"""What edits change that they do not name, and how calm channels stay, on takes of people.

Each curve, and each pair that the window links, is dragged up and down in the same places in every
run, through the session as in the window. Then edits that overlap are drawn at random.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from faceedit_app.core.arrays import Doubles, Floats, Times
from faceedit_app.core.controls import CONTROL_INDEX, LIP_OPENING, MAIN_CONTROLS, control_named
from faceedit_app.core.regions import LOWER
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.opening import open_session
from faceedit_app.editing.session import EditSession
from faceedit_app.lab.evaluation.people.gestures import APART, ASKED_MM, MOST, OPENING
from faceedit_app.lab.evaluation.people.places import frames, inside, pick, random_for
from faceedit_app.lab.evaluation.people.report import TRACKERS
from faceedit_app.lab.evaluation.people.sources import TakeSource
from faceedit_app.lab.evaluation.tables import cell, markdown_table
from faceedit_app.networks.engine import Engine

MOST_TAKES = 10  # of a source
BY = (1.0, 1.5, 2.0, -1.0, -1.5, -2.0)  # standard deviations of the curve in the take
HOLD, FALLOFF = 0.5, 0.2  # seconds
ROUNDS = 6  # of edits that overlap
_AROUND = 0.5  # seconds around the holds in which channels may jump
_STILL = 0.2  # mm; curves with a smaller standard deviation are not dragged


def _label(name: str) -> str:
    control = control_named(name)
    return (control.together if control.mirror else control.label).lower()


CURVES = {label: [i for i, name in enumerate(MAIN_CONTROLS) if _label(name) == label]
          for label in map(_label, MAIN_CONTROLS)}  # fmt: skip
"""Columns of the curves, left and right together."""


@dataclass(frozen=True, eq=False)
class Drag:
    """What one drag moves: a curve, or left and right together.

    Attributes:
        controls: their ids.
        label: left alone and right alone have the same.
        others: columns of the curves that it does not name, by the keys of `CURVES`.
        led: which of these follow it on purpose.
    """

    controls: tuple[str, ...]
    label: str
    others: dict[str, list[int]]
    led: frozenset[str]

    @classmethod
    def of(cls, *controls: str) -> Drag:
        """The drag of these controls."""
        label, first = _label(controls[0]), control_named(controls[0])
        named = [CONTROL_INDEX[name] for name in controls]
        rest = {name: [i for i in all_ if i not in named] for name, all_ in CURVES.items()}
        one_side = ", one side" if first.mirror and len(controls) == 1 else ""
        others = {name: columns for name, columns in rest.items() if columns}
        led = frozenset(_label(name) for name in first.leads) - {label}
        return cls(controls, f"{label}{one_side}", others, led)

    @property
    def is_mouth(self) -> bool:
        """Whether it moves the mouth."""
        return self.controls[0] in LOWER.own

    def by(self, start: float, mm: float) -> Edit:
        """The edit at a time."""
        return Edit(self.controls, Op.OFFSET, start, start + HOLD, FALLOFF, mm)


def _drags() -> Iterator[Drag]:
    for name in MAIN_CONTROLS:
        yield Drag.of(name)
        mirror = control_named(name).mirror
        if mirror and CONTROL_INDEX[mirror] > CONTROL_INDEX[name]:
            yield Drag.of(name, mirror)


DRAGS = tuple(_drags())


@dataclass
class Untouched:
    """What `measure_untouched` finds; lists have one value for each edit.

    Attributes:
        sources: those that were measured.
        takes: by source, the seconds of each take that was edited.
        asked, missed: by drag and direction, mm that were asked for, and that the mean over the
            hold lacks.
        changed: by drag and direction, and curve: the largest change in mm that was not asked for.
        jumps: the largest second difference of any channel: what `one` edit of the mouth adds,
            and `two` that overlap, and what the `take` has where these are.
        closures: mm by which the worst frame misses a closure that overlaps another edit.
    """

    sources: Sequence[TakeSource]
    takes: dict[str, list[float]] = field(default_factory=dict)
    asked: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    missed: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    changed: dict[tuple[str, str], list[float]] = field(default_factory=lambda: defaultdict(list))
    jumps: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    closures: list[float] = field(default_factory=list)


def measure_untouched(
    sources: Sequence[TakeSource], rig: Rig, engine: Engine, progress: Callable[[int, int], None]
) -> Untouched:
    """Edit up to `MOST_TAKES` takes of each source; `progress` gets how many are done, of all."""
    found = Untouched(sources)
    takes = []
    for source in sources:
        chosen = np.linspace(0, len(source.takes) - 1, min(len(source.takes), MOST_TAKES))
        takes += [(source, source.takes[i]) for i in chosen.round().astype(int).tolist()]
    for done, (source, take) in enumerate(takes, 1):
        found.takes.setdefault(source.name, []).append(take.clip.duration)
        session = open_session(take, rig, engine)
        spread = session.tracked.std(axis=0)
        sizes = {drag: float(spread[CONTROL_INDEX[drag.controls[0]]]) for drag in DRAGS}
        lacking = session.lacks.keys()
        moved = [d for d in DRAGS if sizes[d] > _STILL and not lacking & {*d.controls}]
        _measure_single(session, [(drag, sizes[drag]) for drag in moved], found)
        _measure_pairs(session, [(drag, sizes[drag]) for drag in moved if drag.is_mouth], found)
        progress(done, len(takes))
    return found


def _measure_single(
    session: EditSession, drags: Sequence[tuple[Drag, float]], found: Untouched
) -> None:
    """Drag each by `BY` times its standard deviation in mm, at up to `MOST` places."""
    times, before = session.take.clip.times, session.weights.copy()
    room = inside(times, HOLD + _AROUND)
    starts = pick(random_for(session.take, "untouched"), times, room, APART, MOST)
    for drag, mm in drags if starts else ():
        named = [CONTROL_INDEX[name] for name in drag.controls]
        for by in BY:
            _show(session, [drag.by(start, by * mm) for start in starts])
            kind = f"{drag.label} {'+' if by > 0 else '−'}"
            missing, jumps = _missing(session)[:, named], _jumps(session.weights - before)
            change = np.abs(session.achieved - session.tracked)
            for start in starts:
                rows = frames(times, start, start + HOLD)
                found.asked[kind].append(abs(by) * mm)
                found.missed[kind].append(float(np.abs(missing[rows].mean(axis=0)).max()))
                for curve, columns in drag.others.items():
                    found.changed[kind, curve].append(float(change[rows][:, columns].max()))
                if drag.is_mouth:
                    found.jumps["one"].append(_largest(jumps, times, start, start + HOLD))


def _measure_pairs(
    session: EditSession, drags: Sequence[tuple[Drag, float]], found: Untouched
) -> None:
    """Let two drags overlap, or a drag and a closure, drawn at random, `ROUNDS` times."""
    times, before = session.take.clip.times, session.weights.copy()
    own, random = _jumps(before), random_for(session.take, "overlapping")
    for _ in range(ROUNDS if len(drags) > 1 else 0):
        starts = pick(random, times, inside(times, 1.0 + 2 * FALLOFF), 2.6, MOST)
        pairs = [_pair(random, drags, start) for start in starts]
        _show(session, [edit for pair in pairs for edit in pair])
        jumps, missing = _jumps(session.weights - before), np.abs(_missing(session))
        for first, second in pairs:
            found.jumps["two"].append(_largest(jumps, times, first.start, second.end))
            found.jumps["take"].append(_largest(own, times, first.start, second.end))
            if second.op is Op.SET:
                rows = frames(times, second.start + 0.05, second.end - 0.05)
                found.closures.append(float(missing[rows, OPENING].max()))


def _pair(
    random: np.random.Generator, drags: Sequence[tuple[Drag, float]], start: float
) -> tuple[Edit, Edit]:
    one, other = random.choice(len(drags), 2, replace=False).tolist()
    later = start + float(random.uniform(0.1, 0.5))
    edits = []
    for index, begin in ((one, start), (other, later)):
        drag, mm = drags[index]
        edits.append(drag.by(begin, mm * float(random.choice([-1, 1]) * random.uniform(1, 2))))
    shut = Edit((LIP_OPENING,), Op.SET, later, later + 0.4, 0.15, ASKED_MM)
    closes = LIP_OPENING not in drags[one][0].controls and random.random() < 0.2
    return edits[0], shut if closes else edits[1]


def _show(session: EditSession, edits: Sequence[Edit]) -> None:
    session.put(edits)
    session.live.work()


def _missing(session: EditSession) -> Floats:
    """(T, C) mm from what was asked for to the face; lips shut no further than the take's own."""
    wish = session.asked.copy()
    shut = np.minimum(session.tracked[:, OPENING], session.closed)
    wish[:, OPENING] = np.maximum(wish[:, OPENING], shut)
    return session.achieved - wish


def _jumps(weights: Floats) -> Doubles:
    """(T,): the largest second difference of any channel (T, K); 0 at both ends."""
    jumps = np.zeros(len(weights))
    jumps[1:-1] = np.abs(np.diff(weights.astype(np.float64), 2, axis=0)).max(axis=1)
    return jumps


def _largest(jumps: Doubles, times: Times, start: float, end: float) -> float:
    return float(jumps[frames(times, start - _AROUND, end + _AROUND)].max())


def untouched_part(found: Untouched) -> str:
    """The figures as a page of the report, in Markdown."""
    people = "; ".join(_source_text(source, found.takes[source.name]) for source in found.sources)
    rows = []
    for kind, asked in found.asked.items():
        drag = next(d for d in DRAGS if d.label == kind[:-2])
        others = [_spread(found.changed.get((kind, curve), ())) for curve in CURVES]
        shown = [f"({o})" if c in drag.led else o for c, o in zip(CURVES, others, strict=True)]
        met = cell(float(np.percentile(found.missed[kind], 95)), 2)
        rows.append([kind, str(len(asked)), cell(float(np.median(asked)), 1), met, *shown])
    calm = [
        [name, str(len(jumps)), *(cell(float(np.percentile(jumps, p)), 2) for p in (95, 99, 100))]
        for name, jumps in (
            ("the take, without edits", found.jumps["take"]),
            ("one edit adds", found.jumps["one"]),
            ("two that overlap add", found.jumps["two"]),
        )
        if jumps
    ]
    parts = [
        "# What an edit leaves alone",
        f"Takes of people: {people}. Each curve, and left and right together, is dragged up (+) "
        f"and down (−) by 1, 1.5 and 2 of its standard deviations in the take, for {HOLD:g} s at "
        f"up to {MOST} places, as in the window. Written by `faceedit experiment untouched`.",
        "The largest change of each curve that the edit does not name, in mm: the 95th percentile "
        "over all edits, and the most. In parentheses: curves that follow on purpose. *Missed* is "
        "the 95th percentile of what the mean over the hold lacks.",
        markdown_table(["edit", "edits", "asked for, median", "missed", *CURVES], rows),
        "## How calm channels stay",
        "The largest second difference of any channel, in weight per frame², around mouth edits "
        "and where two overlap. Some of it is what was asked for.",
        markdown_table(["", "places", "95 %", "99 %", "most"], calm),
    ]
    if found.closures:
        near, most = np.percentile(found.closures, (90, 100)).tolist()
        parts.append(
            f"{len(found.closures)} closures overlap another edit: nine in ten are met within "
            f"{cell(near, 1)} mm in every frame, and all within {cell(most, 1)} mm."
        )
    return "\n\n".join(parts)


def _source_text(source: TakeSource, seconds: Sequence[float]) -> str:
    known = ", which the networks learned from" if source.trained_on else ""
    count = "1 take" if len(seconds) == 1 else f"{len(seconds)} takes"
    return f"`{source.name}` ({TRACKERS[source.tracker]}{known}), {count}, {sum(seconds):.0f} s"


def _spread(changes: Sequence[float]) -> str:
    return (
        ", ".join(cell(float(np.percentile(changes, p)), 1) for p in (95, 100)) if changes else "–"
    )
