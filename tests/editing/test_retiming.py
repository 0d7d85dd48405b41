"""A take gets another frame rate: its edits stay on their frames, and files remember the rate."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.sessions import session_by_rig
from support.takes import make_livelink_csv

from faceedit_app.core.controls import MAIN_CONTROLS
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.retiming import retimed
from faceedit_app.editing.files.fingerprint import Fingerprint
from faceedit_app.editing.files.journal import Journal
from faceedit_app.editing.files.pending import pending_journals
from faceedit_app.editing.files.project import Project, read_project, write_project
from faceedit_app.editing.steps import EditState, Origin
from faceedit_app.formats.opening import open_take

PRINT = Fingerprint(3, "0" * 64)
EDIT = Edit(("mouth_opening",), Op.OFFSET, 1.0, 2.0, 0.2, 5.0, falloff_out=0.4)


@settings(deadline=None, derandomize=True)
@given(
    own=st.sampled_from([24.0, 30.0, 60.0]),
    new=st.sampled_from([24.0, 25.0, 50.0, 120.0]),
    start=st.integers(0, 100),
    length=st.integers(0, 100),
    falloff=st.integers(0, 20),
)
def test_an_edit_acts_on_the_same_frames(
    own: float, new: float, start: int, length: int, falloff: int
) -> None:
    edit = Edit(("mouth_width",), Op.SET, start / own, (start + length) / own, falloff / own, 40.0)
    frames = np.arange(250)
    moved = retimed(edit, own / new)
    assert np.allclose(edit.mask(frames / own), moved.mask(frames / new), atol=1e-6)


def test_points_and_smooths_are_times_too() -> None:
    drawn = Edit(("mouth_width",), Op.DRAW, 1.0, 2.0, 0.1, points=((1.0, 40.0), (2.0, 44.0)))
    assert retimed(drawn, 2.0).points == ((2.0, 40.0), (4.0, 44.0))
    smooth = Edit(("mouth_width",), Op.SMOOTH, 1.0, 2.0, 0.1, 0.04)
    assert retimed(smooth, 0.5).value == pytest.approx(0.02)
    assert retimed(EDIT, 1.0) == EDIT


def test_undoing_another_rate_brings_back_to_the_bit_what_was_shown(tmp_path: Path) -> None:
    path = make_livelink_csv(tmp_path / "take.csv", 4, 60)
    session = session_by_rig(path)
    session.add(EDIT, Edit(MAIN_CONTROLS, Op.FILL, 2.5, 3.0, 0.0))
    again = session_by_rig(open_take(path, 30.0))
    again.continue_from(
        session,
        "Frame rate 30 fps",
        lambda state: replace(state, edits=tuple(retimed(edit, 2.0) for edit in state.edits)),
    )
    assert not np.array_equal(again.weights, session.weights), "as the question says"
    back = session_by_rig(path)
    back.arrive_from(again, -1)
    assert back.edits == session.edits
    assert np.array_equal(back.weights, session.weights)


@pytest.mark.parametrize("fps", [None, 30.0, 30000 / 1001])
def test_a_project_remembers_the_rate(tmp_path: Path, fps: float | None) -> None:
    path = tmp_path / "p.faceedit"
    write_project(path, Project(tmp_path / "take.csv", PRINT, fps=fps))
    assert read_project(path).fps == fps
    assert ("fps" in path.read_text()) == (fps is not None)


@pytest.mark.parametrize("fps", [None, 30.0])
@pytest.mark.parametrize("before", [None, 25.0])
def test_a_journal_remembers_the_rate_and_the_one_before_it(
    tmp_path: Path, fps: float | None, before: float | None
) -> None:
    take = tmp_path / "take.csv"
    take.write_text("x")
    journal = Journal(take, folder=tmp_path, fps=fps, origin=Origin(rate=before))
    journal.record(EditState((EDIT,)))
    (tmp_path / "copy.jsonl").write_bytes(journal.path.read_bytes())
    journal.close()
    (pending,) = pending_journals(tmp_path)
    assert (pending.fps, pending.origin) == (fps, Origin(rate=before))
