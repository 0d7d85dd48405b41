"""The benchmark of edits: what users do to takes, done to held-out takes by the real editing code.

The list is fixed by the takes' names: the same takes are always edited in the same places.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Bools, Doubles
from faceedit_app.core.controls import CONTROL_INDEX, LIDS, LIP_OPENING, MOUTH_CORNERS, MOUTH_WIDTH
from faceedit_app.core.regions import REGIONS
from faceedit_app.core.resample import grid_length, to_grid
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.opening import open_session
from faceedit_app.editing.session import EditSession
from faceedit_app.editing.solving.request import affected
from faceedit_app.formats.take import Take
from faceedit_app.lab.evaluation.metrics import boundary_jump, clipped_share
from faceedit_app.networks.engine import Engine

NATURALNESS = (0.0, 0.5, 1.0)
SHORTEST_TAKE = 2.0  # seconds
SEED = 2019
GOALS = ("closure", "blink")
"""The kinds of edit that must be reached: any face can do them."""


@dataclass(frozen=True)
class Trial:
    """One edit of the benchmark."""

    kind: str
    edits: tuple[Edit, ...]


@dataclass(frozen=True)
class TrialResult:
    """The result of one trial.

    Attributes:
        kind: of the trial.
        mode, naturalness: how it was answered.
        reached_mm: mean distance of the asked-for controls from what was asked, in the hold.
        changed_outside: largest weight change where no edit reaches.
        boundary_jump: largest jump of velocity where the edit's influence begins and ends, in
            weight per frame.
        clipped: share of the changed weights that ended at 0 or 1.
        distance: largest distance from natural motion over the regions, as a share of the limit;
            NaN where the models do not say what is natural.
    """

    kind: str
    mode: str
    naturalness: float
    reached_mm: float
    changed_outside: float
    boundary_jump: float
    clipped: float
    distance: float


def trials(take: Take, controls: Doubles) -> list[Trial]:
    """The edits for one take, whose controls are (T, C) mm; some need a face that fits."""
    duration = take.clip.duration
    if duration < SHORTEST_TAKE:
        return []
    random = np.random.default_rng([SEED, zlib.crc32(take.path.name.encode())])
    times = take.clip.times
    inside = (times > 0.6) & (times < duration - 0.8)

    def moment(control: str, above: float) -> float | None:
        """A time at which a control is above some mm."""
        at = np.flatnonzero(inside & (controls[:, CONTROL_INDEX[control]] > above))
        return float(times[random.choice(at)]) if len(at) else None

    left, right = MOUTH_CORNERS
    anywhere = float(random.uniform(0.6, duration - 0.8))
    frame = float(times[take.clip.frame_at(anywhere)])
    out = [
        Trial("spike", (Edit((LIP_OPENING,), Op.OFFSET, frame, frame, 0.0, 15.0),)),
        Trial("smile", (Edit(MOUTH_CORNERS, Op.OFFSET, 0.0, duration, 0.0, 4.0),)),
        Trial(
            "conflict",
            (
                Edit((left,), Op.OFFSET, anywhere, anywhere + 0.4, 0.15, 8.0),
                Edit((right,), Op.OFFSET, anywhere, anywhere + 0.4, 0.15, -8.0),
                Edit((MOUTH_WIDTH,), Op.OFFSET, anywhere, anywhere + 0.4, 0.15, -10.0),
            ),
        ),
        Trial("wild", (Edit((LIP_OPENING,), Op.OFFSET, frame, frame + 0.24, 0.0, 40.0),)),
    ]
    for _ in range(3):
        if (at := moment(LIP_OPENING, 4.0)) is not None:
            out.append(Trial("closure", (Edit((LIP_OPENING,), Op.SET, at, at + 0.2, 0.15, 0.5),)))
        if (at := moment(LIDS[0], 5.0)) is not None:
            out.append(Trial("blink", (Edit(LIDS, Op.SET, at, at + 0.1, 0.15, 0.5),)))
    return out


def run_benchmark(
    takes: Sequence[Take],
    rig: Rig,
    engine: Engine | None,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> list[TrialResult]:
    """Every trial of every take, in both modes, at each naturalness."""
    out = []
    for number, take in enumerate(takes):
        progress(number, len(takes))
        session = open_session(take, rig, engine)
        for trial in trials(take, session.tracked.astype(np.float64)):
            for mode in Mode:
                for naturalness in NATURALNESS:
                    session.configure(Settings(mode, naturalness))
                    session.add(*trial.edits)
                    outcome = _outcome(session, trial, engine)
                    session.undo()
                    session.undo()
                    out.append(replace(outcome, mode=mode.value, naturalness=naturalness))
    return out


def _outcome(session: EditSession, trial: Trial, engine: Engine | None) -> TrialResult:
    times = session.take.clip.times
    before = session.take.clip.arkit_weights().astype(np.float64)
    after = session.weights.astype(np.float64)
    misses = []
    for edit in trial.edits:
        hold = edit.mask(times) >= 1.0
        columns = [CONTROL_INDEX[c] for c in edit.controls]
        missed = np.abs(session.achieved - _within_reach(session))
        misses.append(missed[hold][:, columns].mean())
    first = min(affected(edit)[0] for edit in trial.edits)
    last = max(affected(edit)[1] for edit in trial.edits)
    inside = (times >= first - 1e-9) & (times <= last + 1e-9)
    outside = np.abs(after - before)[~inside]
    ends = [int(i) for i in np.flatnonzero(np.diff(inside.astype(int)))]
    touched = [
        r.id for r in REGIONS if any(set(edit.controls) & set(r.own) for edit in trial.edits)
    ]
    columns = [ARKIT_INDEX[c] for r in REGIONS if r.id in touched for c in r.channels]
    return TrialResult(
        kind=trial.kind,
        mode="",
        naturalness=0.0,
        reached_mm=float(np.max(misses)),
        changed_outside=float(outside.max()) if outside.size else 0.0,
        boundary_jump=boundary_jump(before, after, [f for e in ends for f in (e, e + 1)]),
        clipped=clipped_share(before[inside][:, columns], after[inside][:, columns]),
        distance=_distance(session, engine, touched, inside),
    )


def _within_reach(session: EditSession) -> Doubles:
    """(T, C) mm, what is asked for; of lips no more than the take's own closed opening."""
    asked, lips = session.asked.astype(np.float64), CONTROL_INDEX[LIP_OPENING]
    closed = np.minimum(session.closed, session.tracked[:, lips])
    asked[:, lips] = np.maximum(asked[:, lips], closed)
    return asked


def _distance(
    session: EditSession, engine: Engine | None, regions: Sequence[str], inside: Bools
) -> float:
    """How far the edited part is from natural motion at worst, by the limit of real takes."""
    if engine is None:
        return float("nan")
    clip = session.take.clip
    grid = to_grid(clip.times, session.weights, 0, grid_length(clip.times))
    span = clip.times[inside]
    rows = slice(int(span[0] * 25.0), int(span[-1] * 25.0) + 2)
    far = [float("nan")]
    for region in REGIONS:
        natural = engine.models[region.id].description.natural
        if region.id in regions and natural is not None:
            columns = [ARKIT_INDEX[c] for c in region.channels]
            far.append(float(natural.distance(grid[:, columns])[rows].max()) / natural.limit)
    return float(np.nanmax(far)) if len(far) > 1 else float("nan")
