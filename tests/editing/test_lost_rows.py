"""Rows without a face: a fill gives them one in the export."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.faces import shipped_rig
from support.sessions import session_by_rig
from support.takes import make_livelink_csv

from faceedit_app.characters.closure import Openings
from faceedit_app.core.controls import CONTROL_IDS, LIDS, LIP_OPENING
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.media import Placement
from faceedit_app.editing.edits.splice import Splice
from faceedit_app.editing.exporting import choose, export_session
from faceedit_app.editing.filming import shown_by
from faceedit_app.editing.help.fill import filled_briefly, filled_message
from faceedit_app.editing.session import EditSession
from faceedit_app.editing.splicing import write_spliced
from faceedit_app.formats.opening import open_take

LOST = range(120, 150)
FILL = Edit(CONTROL_IDS, Op.FILL, 1.8, 2.7, 0.0)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """Eight seconds at 60 fps; half a second lost the face, and three frames have no row."""
    return make_livelink_csv(tmp_path / "take.csv", 8.0, untracked=LOST, dropped=(300, 301, 302))


def exported(session: EditSession) -> Path:
    out = session.take.path.with_name("own.csv")
    session.export(out)
    return out


def test_rows_without_a_face_get_one_and_the_motion_runs_through_them(path: Path) -> None:
    session = session_by_rig(path)
    session.add(FILL)
    before, after = session.take.clip, open_take(exported(session)).clip
    assert len(after) == len(before) + len(LOST)
    found = np.flatnonzero(~np.isin(after.times.round(3), before.times.round(3)))
    assert len(found) == len(LOST)
    seen = session.filled_frames()
    assert seen is not None
    np.testing.assert_allclose(seen.times, after.times[found], atol=1e-3)
    np.testing.assert_array_equal(seen.before + np.arange(1, len(LOST) + 1), found)
    steps = np.abs(np.diff(after.weights, axis=0)).max(axis=1)
    usual = np.abs(np.diff(before.weights[:110], axis=0)).max()
    assert steps[found[0] - 12 : found[-1] + 12].max() <= 1.5 * usual
    assert after.weights[found].std(axis=0).max() > 0.01


@pytest.mark.parametrize("key", [None, "livelink", "csv", "glb"])
def test_rows_that_got_a_face_are_in_every_format(path: Path, key: str | None) -> None:
    session = session_by_rig(path)
    session.add(FILL)
    out = path.with_name("out.glb" if key == "glb" else "out.csv")
    export_session(session, out, choose(out, key, session.take))
    there = open_take(exported(session)).clip
    clip = open_take(out).clip
    assert len(clip) == len(there)
    np.testing.assert_allclose(clip.times, there.times, atol=1e-3)
    np.testing.assert_allclose(clip.arkit_weights(), there.arkit_weights(), atol=1e-5)


def test_rows_that_got_a_face_keep_it_in_a_shorter_take(path: Path) -> None:
    session = session_by_rig(path)
    session.add(FILL)
    there = open_take(exported(session)).clip
    out, filled = path.with_name("out.csv"), session.filled_rows()
    cut = [Splice(0.5, 1.0)]
    write_spliced(session.take, session.edited_clip(), cut, out, Placement(), filled=filled)
    clip = open_take(out).clip
    assert len(clip) == len(there) - 30
    np.testing.assert_allclose(clip.weights[40:], there.weights[70:], atol=1e-6)


def test_a_shorter_take_keeps_the_rows_that_no_fill_reached_ready_to_be_filled(path: Path) -> None:
    session = session_by_rig(path)
    session.add(replace(FILL, end=2.2))  # of 2.0 to 2.5 s
    out, filled = path.with_name("out.csv"), session.filled_rows()
    cut = [Splice(0.5, 1.0)]
    write_spliced(session.take, session.edited_clip(), cut, out, Placement(), filled=filled)
    take = open_take(out)
    assert take.lost_rows is not None
    left = take.lost_rows.times(take.clip)
    assert len(left) == len(LOST) - 13
    np.testing.assert_allclose(left, np.arange(133, 150) / 60 - 0.5, atol=1e-3)
    old, new = path.read_bytes().splitlines(), out.read_bytes().splitlines()
    assert len(new) == len(old) - 30
    assert [line.partition(b",")[2] for line in new[1 + 103 : 1 + 120]] == [b"0"] * len(left)
    again = session_by_rig(out)
    again.add(replace(FILL, start=1.5, end=2.2))
    assert len(open_take(exported(again)).clip) == len(take.clip) + len(left)


def test_every_other_row_keeps_its_bytes(path: Path) -> None:
    session = session_by_rig(path)
    session.add(FILL)
    old, new = path.read_bytes().splitlines(), exported(session).read_bytes().splitlines()
    times = np.arange(480) / 60.0
    rows = np.delete(times, (300, 301, 302))
    for line, (one, other) in enumerate(zip(old[1:], new[1:], strict=True)):
        if not 1.79 < rows[line] < 2.71:
            assert one == other
        assert one.split(b",")[0] == other.split(b",")[0]


def test_without_a_fill_the_rows_stay_as_they_are(path: Path) -> None:
    session = session_by_rig(path)
    session.add(Edit((LIP_OPENING,), Op.OFFSET, 1.8, 2.7, 0.1, 2.0))
    old, new = path.read_bytes().splitlines(), exported(session).read_bytes().splitlines()
    assert new[1 + LOST.start : 1 + LOST.stop] == old[1 + LOST.start : 1 + LOST.stop]


@pytest.mark.parametrize(
    "edits",
    [
        (replace(FILL, enabled=False),),
        (replace(FILL, controls=LIDS),),
        (FILL, Edit(CONTROL_IDS, Op.RESET, 1.8, 2.7, 0.0)),
    ],
    ids=["off", "some curves", "reset"],
)
def test_a_fill_that_does_not_make_a_whole_face_leaves_them_lost(
    path: Path, edits: tuple[Edit, ...]
) -> None:
    session = session_by_rig(path)
    session.put(edits)
    assert len(open_take(exported(session)).clip) == len(session.take.clip)


def test_edits_on_top_of_a_fill_reach_its_rows(path: Path) -> None:
    plain, edited = session_by_rig(path), session_by_rig(path)
    plain.add(FILL)
    edited.put((FILL, Edit((LIP_OPENING,), Op.OFFSET, 1.5, 3.0, 0.1, 3.0)))
    one = open_take(exported(plain)).clip
    other = open_take(exported(edited)).clip
    jaw = one.channels.index("jawOpen")
    assert (other.weights[125:145, jaw] > one.weights[125:145, jaw]).all()
    assert np.abs(np.diff(other.weights[110:160, jaw])).max() < 0.1


def test_an_exported_fill_opens_as_it_was_shown(path: Path) -> None:
    session = session_by_rig(path)
    session.add(FILL)
    before, after = session.take.clip, open_take(exported(session)).clip
    kept = np.isin(after.times.round(3), before.times.round(3))
    assert np.abs(after.weights[kept] - session.clip_weights()).max() < 1e-6


def test_the_message_says_what_the_export_gets(path: Path) -> None:
    take = open_take(path)
    assert "30 rows without a face get one" in filled_message(take, 1.8, 2.7, heard=False)
    assert filled_briefly(take, 1.8, 2.7) == "30 rows get a face"
    assert "no row for 3 lost frames" in filled_message(take, 4.5, 5.5, heard=False)


def test_films_show_the_rows_that_were_filled(path: Path) -> None:
    session = session_by_rig(path)
    assert shown_by(session)[0] is session.take
    session.add(FILL)
    take, weights, rotations = shown_by(session)
    assert len(take.clip) == len(weights) == len(session.take.clip) + len(LOST)
    assert rotations is not None
    assert rotations.shape == (len(weights), 9)
    lost = slice(LOST.start, LOST.stop)
    assert np.ptp(weights[lost], axis=0).max() > 0.01
    straight = np.diff(take.clip.weights[lost].astype(float), n=2, axis=0)
    assert np.abs(straight).max() < 1e-5  # as tracked there is nothing between both sides


def test_filled_rows_close_on_the_users_character(path: Path) -> None:
    """Theirs needs more of a blink than ours."""
    session, rig = session_by_rig(path), shipped_rig()
    weak = rig.deltas.copy()
    for channel in ("eyeBlinkLeft", "eyeBlinkRight"):
        weak[rig.channel_index[channel]] *= 0.8
    theirs = Openings.of(replace(rig, deltas=weak))
    blinks = Edit(LIDS, Op.OFFSET, 1.8, 2.7, 0.1, -20.0)
    session.put((FILL, blinks))
    found = session.filled_rows()
    assert found is not None

    def lids(found: np.ndarray) -> np.ndarray:
        clip = replace(session.take.clip, weights=found, times=np.arange(len(found)) / 60.0)
        return theirs.measure(clip.arkit_weights())[5:-5, 1:]

    assert lids(found).max() > 1.0
    session.use_character(replace(rig, deltas=weak))
    again = session.filled_rows()
    assert again is not None
    assert lids(again).max() < 0.5
