"""A part of a take comes out bit for bit as in the whole, whatever else is edited or computed."""

from __future__ import annotations

from dataclasses import asdict, replace
from itertools import product

import numpy as np
import pytest
from support.chance import seeds
from support.faces import shipped_rig, talking_clip
from support.sessions import engine, session_by_networks, shipped_engine

from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.solving.chunks import CHUNK, ChunkTask
from faceedit_app.editing.solving.request import affected
from faceedit_app.editing.solving.solver import Patch, Solver
from faceedit_app.formats.gaps import find_gaps

RATES = (24.0, 25.0, 29.97, 30.0, 60.0)
OPS = (Op.OFFSET, Op.SET, Op.SCALE, Op.SMOOTH, Op.RESET)


def random_clip(random: np.random.Generator, frames: int | None = None) -> Clip:
    rate = float(random.choice(RATES))
    count = int(random.integers(1, 2200)) if frames is None else frames
    times = np.arange(count) / rate
    if random.random() < 0.3:  # a gap of up to 20 s somewhere
        times[int(random.integers(count)) :] += float(random.uniform(0.1, 20.0))
    times -= times[0]
    clip = talking_clip(count, rate, int(random.integers(1000)), times=times)
    return replace(clip, gaps=find_gaps(times, rate))


def random_edit(random: np.random.Generator, duration: float) -> Edit:
    op = Op(random.choice(OPS, p=(0.4, 0.15, 0.15, 0.2, 0.1)))
    controls = random.choice(CONTROL_IDS, int(random.integers(1, 4)), replace=False)
    wide = random.random() < 0.2
    start = float(random.uniform(-0.5, duration))
    end = start + float(random.exponential(10.0 if wide else 0.4))
    value = {
        Op.OFFSET: random.normal(0, 3.0),
        Op.SET: random.uniform(0, 40.0),
        Op.SCALE: random.uniform(0, 2.0),
        Op.SMOOTH: random.uniform(0, 0.6),
        Op.RESET: 0.0,
    }[op]
    return Edit(
        tuple(str(c) for c in controls), op, start, end, float(random.uniform(0, 0.8)), float(value)
    )


def random_edits(random: np.random.Generator, duration: float, most: int = 5) -> tuple[Edit, ...]:
    return tuple(random_edit(random, duration) for _ in range(int(random.integers(1, most + 1))))


def whole(solver: Solver, edits: tuple[Edit, ...], settings: Settings) -> list[np.ndarray]:
    """Every chunk of the take, also those that no edit affects, one after the other."""
    tasks = solver.tasks(edits, settings)
    everywhere = {}
    for chunk in range(len(solver.chunks)):
        rows = solver.chunks.slice(chunk)
        if rows.start < rows.stop:
            all_rows = (0, len(solver.clip))
            everywhere[chunk] = tasks.get(chunk) or ChunkTask(chunk, all_rows, settings, edits)
    patches: list[Patch] = [solver.solve(task) for task in everywhere.values()]
    return [
        np.concatenate([getattr(patch, name) for patch in patches])
        for name in ("weights", "asked", "controls")
    ]


@pytest.mark.parametrize("seed", seeds(24))
def test_what_is_shown_is_the_whole_take_computed(seed: int) -> None:
    random = np.random.default_rng(seed)
    clip = random_clip(random)
    edits = random_edits(random, clip.duration)
    mode = Mode.RESYNTHESIZE if random.random() < 0.2 else Mode.PRESERVE
    settings = Settings(mode, float(random.choice([0.0, 0.6, 1.0])))
    session = session_by_networks(clip, **asdict(settings))
    for i in range(len(edits)):  # as a user would: each is dragged before it is kept
        session.preview(random_edit(random, clip.duration))
        session.preview(edits[i])
        session.commit()
    fresh = Solver(clip, shipped_rig(), engine())
    weights, asked, controls = whole(fresh, edits, settings)
    np.testing.assert_array_equal(session.weights, weights)
    np.testing.assert_array_equal(session.asked, asked)
    np.testing.assert_array_equal(session.achieved, controls)


def share_what_is_known(whole: Solver, part: Solver) -> None:
    """Let a part of a take be answered by what is known of the whole take."""
    known = ("medians", "shut", "_parts", "_companions", "_across")
    for name in (*known, "_limit_arrays", "_sideways"):
        setattr(part, name, getattr(whole, name))
    for name in ("_parts", "_in_order", "_combining"):
        setattr(part._regions, name, getattr(whole._regions, name))
    part._regions._networks._layers = whole._regions._networks._layers


@pytest.mark.parametrize("seed", seeds(12))
def test_what_lies_far_away_does_not_matter(seed: int) -> None:
    """The start of a long take is answered as that start alone: same bytes."""
    random = np.random.default_rng(1000 + seed)
    clip = random_clip(random, 2000)
    cut = int(random.integers(1000, 1900))
    # The last chunk of the short take ends where the long one's goes on: look before it.
    gaps = find_gaps(clip.times[:cut], clip.rate)
    alone = Clip(clip.weights[:cut], clip.channels, clip.times[:cut], clip.rate, gaps)
    short, long = session_by_networks(alone), session_by_networks(clip)
    share_what_is_known(long._solver, short._solver)
    last = max(len(short._solver.chunks) - 2, 0)
    sure = int(short._solver.chunks.rows[last])
    edits = random_edits(random, float(clip.times[max(sure - 200, 1)]))
    narrow = [e for e in edits if affected(e)[1] + 6.0 < clip.times[sure - 1] and sure > 300]
    short.add(*narrow)
    long.add(*narrow, Edit(CONTROL_IDS, Op.OFFSET, clip.duration + 5, clip.duration + 6, 0.1, 2.0))
    np.testing.assert_array_equal(short.weights[:sure], long.weights[:sure])
    np.testing.assert_array_equal(short.achieved[:sure], long.achieved[:sure])


@pytest.mark.parametrize("frames", [1, 40, CHUNK, CHUNK + 1, 1000, 1601])
def test_chunks_answer_as_the_networks_do_over_the_whole_take(frames: int) -> None:
    """Cutting the take up costs nothing: the context on either side is enough."""
    clip, networks = talking_clip(frames, 25.0), shipped_engine()
    solver = Solver(clip, shipped_rig(), networks)
    padded = len(solver.grid) + -len(solver.grid) % networks.scale
    for region, naturalness in product(networks.models, (0.0, 0.5, 1.0)):
        at_once = networks.answer(region, solver.grid, naturalness)
        for chunk in range(len(solver.chunks)):
            first, last = solver.chunks.grid_ranges[chunk]
            answer = networks.answer(region, solver.grid[first:last], naturalness)
            rows = solver.chunks.slice(chunk)
            inner = slice(rows.start, min(rows.stop + 2, padded))
            np.testing.assert_allclose(
                answer[inner.start - first : inner.stop - first], at_once[inner], atol=2e-5
            )


@pytest.mark.parametrize("seed", seeds(6))
def test_what_waits_comes_out_as_what_was_computed_at_once(seed: int) -> None:
    """Visible part first, the rest in slices, other edits in between: nothing of it shows."""
    random = np.random.default_rng(2000 + seed)
    clip = random_clip(random, 1600)
    patient, hasty = session_by_networks(clip), session_by_networks(clip)
    hasty.live.patience = 0.0
    edits = [Edit(("mouth_opening",), Op.OFFSET, 0.0, clip.duration, 0.0, 2.0)]
    edits += random_edits(random, clip.duration)
    for edit in edits:
        frame = int(random.integers(len(clip)))
        hasty.live.look(frame, max(frame - 100, 0), min(frame + 100, len(clip) - 1))
        hasty.preview(random_edit(random, clip.duration))
        hasty.live.work(0.0)
        hasty.add(edit)
        patient.add(edit)
    done, total = hasty.live.progress
    assert 0 <= done <= total
    while hasty.live.work(0.0):
        pass
    assert hasty.live.is_complete
    np.testing.assert_array_equal(hasty.weights, patient.weights)
    np.testing.assert_array_equal(hasty.asked, patient.asked)
    assert hasty.changed_frames() == patient.changed_frames()


def test_the_frame_on_screen_comes_first_and_giving_up_leaves_nothing() -> None:
    session = session_by_networks(talking_clip(6000, 60.0))
    tracked = session.weights.copy()
    session.live.patience = 0.0
    session.live.look(3000, 2900, 3100)
    session.preview(Edit(("mouth_opening",), Op.OFFSET, 0.0, 100.0, 0.0, 3.0))
    assert not session.live.is_complete
    assert (session.weights[3000] != tracked[3000]).any()
    np.testing.assert_array_equal(session.weights[0], tracked[0])
    session.cancel()
    assert session.live.is_complete
    np.testing.assert_array_equal(session.weights, tracked)


def test_an_export_waits_for_what_is_not_computed_yet() -> None:
    session, other = (
        session_by_networks(talking_clip(3000)),
        session_by_networks(talking_clip(3000)),
    )
    session.live.patience = 0.0
    edit = Edit(("mouth_width",), Op.OFFSET, 0.0, 50.0, 0.0, -3.0)
    session.add(edit)
    other.add(edit)
    assert not session.live.is_complete
    np.testing.assert_array_equal(session.clip_weights(), other.clip_weights())


def test_moving_one_edit_computes_only_the_chunks_it_touches() -> None:
    session = session_by_networks(talking_clip(8_000, 60.0))
    session.add(Edit(("mouth_opening",), Op.OFFSET, 0.0, 400.0, 0.0, 2.0))
    session.add(Edit(("mouth_width",), Op.OFFSET, 100.0, 100.2, 0.1, 2.0))
    assert session.live.progress[1] <= 3
    session.undo()
    assert session.live.progress[1] <= 3
