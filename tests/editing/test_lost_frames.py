"""Gaps: what their fixes fill, and what they leave as it was tracked."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.sessions import (
    demo_take,
    session_by_networks,
    session_by_rig,
    shipped_engine,
    take_of,
)
from support.takes import make_livelink_csv

from faceedit_app.core.arrays import Indices
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import MAIN_CONTROLS
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.help.fill import cannot_fill, faces_given, fill_edit
from faceedit_app.editing.help.lost_frames import IN_PARTS, lost_frames
from faceedit_app.editing.help.problems import Kind, find_problems
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.gaps import find_gaps
from faceedit_app.formats.opening import open_take
from faceedit_app.formats.take import LostRows

SECONDS, RATE = 4, 60


def some_frames(pattern: str) -> Indices:
    """Frames to lose, some of them in a row."""
    rng = np.random.default_rng(5)
    lost = rng.random(SECONDS * RATE) < {"every fourth": 0.25, "few": 0.03, "one": 0.0}[pattern]
    lost[100:130] |= pattern != "every fourth"
    lost[[0, 1, -2, -1]] = False
    return np.flatnonzero(lost)


def gap_fixes(session: EditSession) -> tuple[Edit, ...]:
    found = [p for p in find_problems(session) if p.kind is Kind.DROPPED]
    assert found
    return tuple(edit for problem in found for edit in problem.fix)


@pytest.mark.parametrize("pattern", ["every fourth", "few", "one"])
def test_frames_between_gaps_stay_as_they_were_tracked(pattern: str, tmp_path: Path) -> None:
    lost = some_frames(pattern)
    take = open_take(make_livelink_csv(tmp_path / "take.csv", SECONDS, RATE, untracked=lost))
    session = session_by_rig(take)
    session.add(*gap_fixes(session))
    assert np.array_equal(session.weights, take.clip.arkit_weights())
    filled = session.filled_rows()
    assert filled is not None
    assert np.isfinite(filled).all()
    assert not [p for p in find_problems(session) if p.kind is Kind.DROPPED]
    before = (tmp_path / "take.csv").read_bytes().splitlines()
    session.export(tmp_path / "out.csv")
    after = (tmp_path / "out.csv").read_bytes().splitlines()
    changed = [i - 1 for i, (a, b) in enumerate(zip(before, after, strict=True)) if a != b]
    assert changed == lost.tolist()


def test_a_fill_between_two_frames_joins_them() -> None:
    """Position and velocity run through, as if no frame had been lost."""
    clip = demo_take().clip
    kept = np.r_[0:240, 270 : len(clip)]
    weights, times = clip.weights[kept], clip.times[kept]
    gaps = find_gaps(times, clip.rate)
    without = take_of(replace(clip, weights=weights, times=times, gaps=gaps, timecodes=None))
    places = 239 + np.arange(1, 31) / 31
    session = session_by_rig(replace(without, lost_rows=LostRows(tuple(places.tolist()))))
    (fix,) = gap_fixes(session)
    session.add(fix)
    filled = session.filled_rows()
    assert filled is not None
    whole = np.concatenate([session.weights[236:240], filled, session.weights[240:244]])
    own = np.abs(np.diff(session.weights[:240].astype(np.float64), n=2, axis=0)).max()
    assert np.abs(np.diff(whole.astype(np.float64), n=2, axis=0)).max() <= own


@pytest.mark.parametrize("step", [1, 2])
def test_pictures_that_a_film_lacks_are_neither_filled_nor_shaking(step: int) -> None:
    clip = demo_take().clip
    rows = np.arange(0, len(clip), step)
    kept = rows[(np.random.default_rng(2).random(len(rows)) > 0.25) | (rows == 0)]
    uneven = replace(clip, weights=clip.weights[kept], times=clip.times[kept], timecodes=None)
    uneven = replace(uneven, rate=clip.rate / step)
    session = session_by_rig(replace(uneven, gaps=find_gaps(uneven.times, uneven.rate)))
    assert len(session.take.clip.gaps) > 30
    assert gap_fixes(session) == ()
    assert Kind.JITTER not in {problem.kind for problem in find_problems(session)}


def jumping(seconds: float) -> Clip:
    """A face that moves 10 mm across a gap, for which the file has no rows."""
    clip = demo_take().clip
    times = clip.times + np.where(np.arange(len(clip)) > 300, seconds, 0.0)
    return replace(clip, times=times, gaps=find_gaps(times, clip.rate), timecodes=None)


@pytest.mark.parametrize(("seconds", "fix"), [(0.1, None), (1.0, Op.FILL), (5.0, Op.SMOOTH)])
def test_only_across_a_long_gap_without_rows_the_motion_beside_it_changes(
    seconds: float, fix: Op | None
) -> None:
    clip = jumping(seconds)
    curves = np.zeros((len(clip), len(MAIN_CONTROLS)))
    curves[301:] = 10.0
    (gap,) = lost_frames(clip, curves)
    assert [edit.op for edit in gap.fix] == ([] if fix is None else [fix])
    assert ("a jump in" in gap.message) == (fix is not None)
    if fix is Op.FILL:
        assert gap.fix[0].start == pytest.approx(clip.times[300] - 0.04, abs=1e-3)
        assert gap.fix[0].end == pytest.approx(clip.times[301] + 0.04, abs=1e-3)


def test_unsure_frames_beside_a_gap_are_filled_with_it_and_sure_ones_are_not() -> None:
    clip = jumping(0.5)
    curves = np.zeros((len(clip), len(MAIN_CONTROLS)))
    confidence = np.ones(len(clip))
    confidence[[295, 299, 300, 301, *range(302, 340)]] = 0.6
    (gap,) = lost_frames(clip, curves, [300.25, 300.5], confidence)
    (edit,) = gap.fix
    inside = np.flatnonzero((clip.times >= edit.start) & (clip.times <= edit.end))
    assert inside[0] == 299
    assert clip.times[inside[-1]] == pytest.approx(clip.times[301] + 0.15, abs=0.02)


def test_a_selection_within_a_gap_can_be_filled_if_the_file_has_rows_there() -> None:
    clip = jumping(0.5)
    start = float(clip.times[300])
    take = take_of(clip)
    assert "no frame" in cannot_fill(take, start + 0.1, start + 0.4)
    with_rows = replace(take, lost_rows=LostRows((300.5,)))
    assert cannot_fill(with_rows, start + 0.1, start + 0.4) == ""
    assert "no frame" in cannot_fill(with_rows, start + 0.1, start + 0.2)
    (row,) = LostRows((300.7001,)).times(clip)
    assert round(row, 4) < row
    at_its_end = replace(take, lost_rows=LostRows((300.7001,)))
    assert cannot_fill(at_its_end, start + 0.1, row) == "", "an end at the row is enough"
    edit = fill_edit(session_by_rig(at_its_end), start + 0.1, row)
    assert edit.end >= row, "also if it is rounded"
    assert faces_given(at_its_end, (edit,)).startswith("1 row ")


@pytest.mark.parametrize("has_rows", [False, True])
def test_a_jump_across_a_gap_too_long_to_fill_is_softened_once_in_all_curves_around_it(
    has_rows: bool,
) -> None:
    """Smoothing some curves of a mouth made others jump, which were then offered in turn."""
    clip = demo_take().clip
    kept = np.r_[0:260, 297 : len(clip)]  # between two poses that differ
    times = clip.times[kept] + np.where(kept > 260, 4.5, 0.0)
    gaps = find_gaps(times, clip.rate)
    torn = replace(clip, weights=clip.weights[kept], times=times, gaps=gaps, timecodes=None)
    take, places = take_of(torn), 259 + np.arange(1, 300) / 300
    if has_rows:
        take = replace(take, lost_rows=LostRows(tuple(places.tolist())))
    session = session_by_networks(take, shipped_engine())
    session.add(*gap_fixes(session))
    (gap,) = (problem for problem in find_problems(session) if problem.kind is Kind.DROPPED)
    assert gap.fix == ()
    assert "its jump is softened" in gap.why_unfixed
    assert ("Fill replaces up to 4 s of it at a time" in gap.why_unfixed) == has_rows


def test_a_gap_that_was_filled_in_parts_is_found_only_until_all_its_rows_have_a_face() -> None:
    clip = jumping(6.0)
    start, end = float(clip.times[300]), float(clip.times[301])
    places = (300 + np.arange(1, 60) / 60).tolist()  # ten a second
    curves = np.zeros((len(clip), len(MAIN_CONTROLS)))
    first = Edit(MAIN_CONTROLS, Op.FILL, start, start + 3.95, 0.0)
    (gap,) = lost_frames(clip, curves, places)
    assert (gap.fix, gap.instead) == ((), IN_PARTS)
    lips = replace(first, controls=("mouth_opening",))
    assert lost_frames(clip, curves, places, edits=[lips]) == [gap]
    (gap,) = lost_frames(clip, curves, places, edits=[first])
    assert "39 of them are filled" in gap.message
    (rest,) = gap.fix
    assert start + 3.85 < rest.start <= start + 4.0
    assert end - 0.1 < rest.end < end
    assert lost_frames(clip, curves, places, edits=[first, rest]) == []
    assert lost_frames(clip, curves, places, edits=[first, replace(rest, enabled=False)]) == [gap]
