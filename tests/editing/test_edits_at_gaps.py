"""Edits beside a gap and in one: frames come out as in the same take without it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.sessions import demo_take, session_by_networks, shipped_engine, take_of

from faceedit_app.core.arrays import Doubles, Indices, Times
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_IDS, LIDS, MOUTH_CORNERS
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.gaps import find_gaps
from faceedit_app.formats.take import LostRows


def session_of(clip: Clip, lost: tuple[float, ...] = ()) -> EditSession:
    """Answered by the shipped networks; with rows that lost the face, as `LostRows.positions`."""
    take = replace(take_of(clip), lost_rows=LostRows(lost) if lost else None)
    return session_by_networks(take, shipped_engine())


def taken(kept: Indices, times: Times) -> Clip:
    """Some frames of the demo take, at other times."""
    clip = replace(demo_take().clip, weights=demo_take().clip.weights[kept], times=times)
    return replace(clip, gaps=find_gaps(times, clip.rate), timecodes=None)


EVERY = np.arange(len(demo_take().clip))
LOST = range(240, 249)
KEPT = np.delete(EVERY, LOST)
TORN = taken(KEPT, demo_take().clip.times[KEPT])
FILLED = tuple(LOST.start - 1 + np.arange(1, 10) / 10)
FILL = Edit(CONTROL_IDS, Op.FILL, 3.99, 4.14, 0.0)
OPENING = ("mouth_opening",)


def changes(session: EditSession, *edits: Edit) -> Doubles:
    session.put(edits)
    return session.weights.astype(np.float64) - session.tracked_weights


@pytest.fixture(scope="module")
def whole() -> EditSession:
    return session_of(demo_take().clip)


@pytest.fixture(scope="module")
def torn() -> EditSession:
    return session_of(TORN)


@pytest.mark.parametrize(
    ("edit", "near"),
    [
        (Edit(MOUTH_CORNERS, Op.OFFSET, 4.15, 4.15, 0.3, 8.0), 0.03),
        (Edit(MOUTH_CORNERS, Op.OFFSET, 3.97, 3.97, 0.3, 8.0), 0.02),
        (Edit(OPENING, Op.OFFSET, 4.07, 4.07, 0.2, 8.0), 0.014),
        (Edit(LIDS, Op.OFFSET, 3.8, 3.95, 0.1, -8.0), 0.02),
        (Edit(CONTROL_IDS, Op.SMOOTH, 3.6, 4.5, 0.1, 0.06), 0.015),
        (Edit(OPENING, Op.SMOOTH, 3.6, 4.5, 0.1, 0.06), 0.01),
        (Edit((), Op.SMOOTH, 3.6, 4.5, 0.1, 0.06, channels=("jawOpen",)), 0.002),
    ],
    ids=["after", "before", "within", "lids", "smooth", "smooth of one", "smooth of a channel"],
)
def test_an_edit_at_a_gap_changes_frames_as_without_it(
    whole: EditSession, torn: EditSession, edit: Edit, near: float
) -> None:
    wanted, found = changes(whole, edit)[KEPT], changes(torn, edit)
    assert np.abs(wanted).max() > 0.03
    np.testing.assert_allclose(found, wanted, atol=near)
    untouched = ~wanted.any(axis=1)
    assert untouched.any()
    assert not found[untouched].any()


@pytest.mark.parametrize(
    "edit",
    [
        Edit(MOUTH_CORNERS, Op.OFFSET, 4.15, 4.15, 0.3, 6.0),
        Edit(CONTROL_IDS, Op.RETIME, 3.8, 5.0, 0.0, pins=((3.8, 3.8), (4.4, 4.7), (5.0, 5.0))),
    ],
    ids=["smile", "stretch"],
)
def test_motion_runs_from_edited_frames_into_filled_rows(edit: Edit) -> None:
    session = session_of(TORN, FILLED)
    session.put((FILL, edit))
    filled = session.filled_frames()
    assert filled is not None
    every = np.insert(session.weights, LOST.start, filled.weights, axis=0)
    steps = np.abs(np.diff(every, axis=0)).max(axis=1)
    assert steps[LOST.start - 5 : LOST.stop + 4].max() < 0.055


@pytest.mark.parametrize("seconds", [3.0, 6.0])
def test_an_edit_that_ends_in_a_long_gap_ends_as_without_it(
    seconds: float, whole: EditSession
) -> None:
    times = demo_take().clip.times
    session = session_of(taken(EVERY, times + np.where(EVERY > 300, seconds, 0.0)))
    smile = Edit(MOUTH_CORNERS, Op.OFFSET, 4.0, float(times[300]) + 0.1, 0.1, 6.0)
    found, wanted = changes(session, smile), changes(whole, smile)
    assert not found[301:].any()
    np.testing.assert_allclose(found[280:301], wanted[280:301], atol=0.07)


def test_a_smooth_across_a_long_gap_softens_the_jump() -> None:
    kept = np.delete(EVERY, range(260, 297))  # between two poses that differ
    times = demo_take().clip.times[kept] + np.where(kept > 260, 4.5, 0.0)
    session = session_of(taken(kept, times))
    start, end = session.take.clip.times[259:261].tolist()
    session.put((Edit(CONTROL_IDS, Op.SMOOTH, start, end, 0.1, 0.04),))
    jumps = [
        np.abs(curves[260] - curves[259]).max() for curves in (session.tracked, session.achieved)
    ]
    assert jumps[1] < 0.1 * jumps[0]
