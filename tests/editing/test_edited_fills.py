"""Edits of rows that a fill gave a face: they act there as on any other frame."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.faces import random_engine
from support.sessions import session_by_rig
from support.speech import said
from support.takes import make_livelink_csv

from faceedit_app.core.arrays import Floats
from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX, LIDS, LIP_OPENING, MOUTH_CORNERS
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.help.articulation import articulate
from faceedit_app.editing.help.calibrating import neutral_at
from faceedit_app.editing.help.clipboard import TOLERANCE, Copied, copy_range
from faceedit_app.editing.help.fixes import apply_preset
from faceedit_app.editing.help.presets import find_preset
from faceedit_app.editing.help.spoken import closing_edits, shaping_edits
from faceedit_app.editing.session import EditSession

LOST = range(120, 150)  # 2.0 to 2.5 s
FILL = Edit(CONTROL_IDS, Op.FILL, 1.8, 2.7, 0.0)
OPENED = Edit(("mouth_opening",), Op.OFFSET, 2.2, 2.3, 0.1, 5.0)
SMILE = Edit(MOUTH_CORNERS[:1], Op.OFFSET, 2.15, 2.15, 0.12, 2.5)
SHUT = Edit(("mouth_opening",), Op.SET, 2.2, 2.22, 0.08, 1.2)
NEARLY = Edit(("mouth_opening",), Op.SET, 2.34, 2.36, 0.06, 4.8)
WORDS = said(("bob", "B AA B"), ("fur", "F W"), start=1.98, each=0.1)
OPENING = CONTROL_INDEX[LIP_OPENING]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return make_livelink_csv(tmp_path / "take.csv", 8.0, untracked=LOST)


@pytest.fixture
def session(path: Path) -> EditSession:
    """With the rows filled."""
    session = session_by_rig(path)
    session.add(FILL)
    return session


def rows_of(session: EditSession) -> Floats:
    rows = session.filled_rows()
    assert rows is not None
    return rows


@pytest.mark.parametrize(
    ("edit", "near"),
    [
        (OPENED, 1e-4),
        (Edit(LIDS, Op.OFFSET, 2.1, 2.3, 0.1, -6.0), 1e-3),
        (Edit(MOUTH_CORNERS, Op.OFFSET, 0.0, 8.0, 0.0, 2.0), 0.02),
        (Edit((), Op.OFFSET, 2.1, 2.6, 0.1, 0.3, channels=("jawOpen",)), 1e-5),
    ],
    ids=["within", "lids", "everywhere", "channel"],
)
def test_a_row_is_edited_as_if_it_had_always_had_its_face(
    session: EditSession, edit: Edit, near: float
) -> None:
    whole = session.take.path.with_name("whole.csv")
    session.export(whole)
    before = rows_of(session)
    session.add(edit)
    other = session_by_rig(whole)  # the same rows, tracked
    other.add(edit)
    rows = rows_of(session)
    assert np.abs(rows - before).max() > 0.05
    np.testing.assert_allclose(rows, other.clip_weights()[LOST.start : LOST.stop], atol=near)
    frames, there = session.all_frames(), slice(LOST.start, LOST.stop)
    np.testing.assert_allclose(frames.times, other.take.clip.times)
    np.testing.assert_array_equal(frames.weights[there], frames.clip.arkit_weights()[there])
    np.testing.assert_allclose(frames.weights[there], other.weights[there], atol=near)
    np.testing.assert_allclose(frames.asked[there], other.asked[there], atol=40 * near)
    np.testing.assert_allclose(frames.achieved[there], other.achieved[there], atol=40 * near)


def copied(session: EditSession) -> tuple[Edit, ...]:
    return copy_range(session, 1.9, 2.6, CONTROL_IDS, Copied.CURVE).paste(4.0)


def copied_within(session: EditSession) -> tuple[Edit, ...]:
    return copy_range(session, 2.05, 2.4, what=Copied.CURVE).paste(4.0)


def mirrored(session: EditSession) -> tuple[Edit, ...]:
    return copy_range(session, 2.05, 2.4, MOUTH_CORNERS, Copied.CURVE).mirrored().paste(2.05)


def surprised(session: EditSession) -> tuple[Edit, ...]:
    """Between the closures that are there."""
    return apply_preset(session, find_preset("surprise"), (2.0, 2.48), 2.3)


def closed(session: EditSession) -> tuple[Edit, ...]:
    """Where lips nearly met."""
    return apply_preset(session, find_preset("close_lips"), (2.0, 2.48), 2.3)


def said_clearly(session: EditSession) -> tuple[Edit, ...]:
    return articulate(session, WORDS, (2.04, 2.46), 1.0)


@pytest.mark.parametrize(
    "command",
    [
        copied,
        copied_within,
        mirrored,
        surprised,
        closed,
        closing_edits,
        shaping_edits,
        said_clearly,
    ],
)
def test_what_a_command_reads_there_is_what_the_face_does(
    session: EditSession, command: Callable[[EditSession], tuple[Edit, ...]]
) -> None:
    """It does the same with the rows of the gap as if they had been tracked."""
    session.export(session.take.path.with_name("whole.csv"))
    tracked = session_by_rig(session.take.path.with_name("whole.csv"))
    for each in (session, tracked):
        each.say(WORDS)
        each.add(SMILE, SHUT, NEARLY)
    edits, before = command(session), tracked.asked.copy()
    assert edits
    tracked.add(*edits)
    found = tracked.asked.copy()
    assert np.abs(found - before).max() > 1.0
    tracked.undo()
    tracked.add(*command(tracked))
    np.testing.assert_allclose(found, tracked.asked, atol=0.2)


def test_changes_of_filled_rows_are_copied_with_what_the_fill_did(session: EditSession) -> None:
    """As those of frames are: the change is that from the line between the frames around."""
    session.add(OPENED)
    for start, end in ((1.9, 2.6), (2.05, 2.4)):
        frames = session.all_frames()
        rows = (frames.times > start - 1e-6) & (frames.times < end + 1e-6)
        change = (frames.asked - frames.tracked)[rows]
        assert np.abs(change[:, OPENING]).max() > 3.0
        for control, points in copy_range(session, start, end).curves:
            seconds, mm = np.array(points).T
            copied = np.interp(frames.times[rows] - start, seconds, mm)
            wanted = change[:, CONTROL_INDEX[control]]
            np.testing.assert_allclose(copied, wanted, atol=1.1 * TOLERANCE)


def test_rows_without_a_face_are_not_copied(path: Path) -> None:
    session = session_by_rig(path)
    assert copy_range(session, 2.05, 2.4, what=Copied.CURVE).is_empty
    session.add(replace(FILL, start=2.1, end=2.2))
    assert len(session.all_frames().times) == len(session.take.clip) + 7
    (_, points), *_ = copy_range(session, 2.05, 2.4, what=Copied.CURVE).curves
    assert (points[0][0], points[-1][0]) == (pytest.approx(0.05), pytest.approx(0.15))


def test_a_filled_frame_is_made_neutral(session: EditSession) -> None:
    edit = neutral_at(session, 2.25, 0.0, session.take.clip.duration)
    session.export(session.take.path.with_name("whole.csv"))
    other = session_by_rig(session.take.path.with_name("whole.csv"))
    same = neutral_at(other, 2.25, 0.0, session.take.clip.duration)
    assert edit is not None
    assert same is not None
    assert edit.channels == same.channels
    np.testing.assert_allclose(edit.amounts, same.amounts, atol=1e-5)
    session.add(edit)
    assert rows_of(session)[15].max() < 1e-3


def test_an_edit_beside_a_gap_does_not_reach_through_it(session: EditSession) -> None:
    before = rows_of(session)
    session.add(Edit(("mouth_opening",), Op.OFFSET, 2.6, 2.6, 0.15, 8.0))
    rows = rows_of(session)
    assert np.abs(rows - before)[-3:].max() > 0.001, "its falloff begins at 2.45 s"
    np.testing.assert_array_equal(rows[:20], before[:20])


def test_an_edit_elsewhere_leaves_all_rows(session: EditSession) -> None:
    before = rows_of(session)
    session.add(Edit(("mouth_opening",), Op.OFFSET, 5.0, 6.0, 0.2, 8.0))
    np.testing.assert_array_equal(rows_of(session), before)


def test_a_reset_of_edits_brings_back_what_the_fill_made(session: EditSession) -> None:
    before = rows_of(session)
    session.put((FILL, OPENED, Edit(("mouth_opening",), Op.RESET, 1.0, 3.5, 0.0)))
    within = slice(7, -7)  # beside the frames, whose curve is as tracked now, rows go over into it
    np.testing.assert_array_equal(rows_of(session)[within], before[within])


def test_what_an_edit_changes_goes_over_from_frames_into_rows(session: EditSession) -> None:
    """On the rows' own take, which has no gap, networks answer an edit with another result."""
    session.use_engine(random_engine())
    before = np.insert(session.clip_weights(), LOST.start, rows_of(session), axis=0)
    session.add(Edit(("mouth_opening",), Op.SMOOTH, 1.5, 3.25, 0.2, 0.1))
    change = np.insert(session.clip_weights(), LOST.start, rows_of(session), axis=0) - before
    steps, edges = np.abs(np.diff(change, axis=0)).max(axis=1), [LOST.start - 1, LOST.stop - 1]
    assert steps[edges].max() <= np.delete(steps, edges).max()


def test_rows_are_generated_again_with_the_rest_of_the_take(session: EditSession) -> None:
    session.use_engine(random_engine())
    before = rows_of(session)
    session.add(Edit(("mouth_opening",), Op.OFFSET, 6.0, 7.0, 0.2, 2.0))
    np.testing.assert_array_equal(rows_of(session), before)
    session.configure(Settings(mode=Mode.RESYNTHESIZE))
    assert np.abs(rows_of(session) - before).max() > 0.01


def test_rows_do_not_depend_on_the_way_to_the_edits(path: Path) -> None:
    first, again = session_by_rig(path), session_by_rig(path)
    first.put((FILL, OPENED))
    for edits in ((OPENED,), (FILL,), (OPENED, FILL), (FILL, OPENED)):
        again.put(edits)
        again.filled_rows()
    np.testing.assert_array_equal(rows_of(first), rows_of(again))
