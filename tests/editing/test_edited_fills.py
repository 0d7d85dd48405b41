"""Edits of rows that a fill gave a face: they act there as on any other frame."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support.faces import random_engine
from support.sessions import session_by_rig
from support.takes import make_livelink_csv

from faceedit_app.core.arrays import Floats
from faceedit_app.core.controls import CONTROL_IDS, LIDS, MOUTH_CORNERS
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.session import EditSession

LOST = range(120, 150)  # 2.0 to 2.5 s
FILL = Edit(CONTROL_IDS, Op.FILL, 1.8, 2.7, 0.0)
OPENED = Edit(("mouth_opening",), Op.OFFSET, 2.2, 2.3, 0.1, 5.0)


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
