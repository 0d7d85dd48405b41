"""One-click fixes and presets: ordinary edits, put where they are wanted."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from support.sessions import demo_take, session_by_rig

from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.help.events import lip_dips, open_eyes
from faceedit_app.editing.help.fixes import apply_preset
from faceedit_app.editing.help.presets import (
    Preset,
    delete_preset,
    load_presets,
    rename_preset,
    save_preset,
)
from faceedit_app.editing.session import EditSession

HALF_BLINK, OPEN_LIPS = 4.73, 7.47  # seconds in the demo take
LIDS = [CONTROL_INDEX["left_eyelid"], CONTROL_INDEX["right_eyelid"]]
MOUTH = CONTROL_INDEX["mouth_opening"]


@lru_cache(maxsize=1)
def demo() -> EditSession:
    return session_by_rig(demo_take())


@pytest.fixture
def session() -> EditSession:
    session = demo()
    while session.can_undo:
        session.undo()
    return session


def preset(name: str) -> Preset:
    return next(p for p in load_presets(Path("nowhere"))[0] if p.id == name)


SHIPPED = [p.id for p in load_presets(Path("nowhere"))[0]]


def between(session: EditSession, start: float, end: float) -> np.ndarray:
    times = session.take.clip.times
    return (times >= start) & (times <= end)


def test_the_fixes_that_others_build_on_ship() -> None:
    assert {"close_lips", "blink", "smile", "sad_mouth"} <= {*SHIPPED}


@pytest.mark.parametrize("name", SHIPPED)
@pytest.mark.parametrize("selection", [None, (2.0, 3.0)])
def test_every_fix_is_ordinary_edits_that_do_something(
    session: EditSession, name: str, selection: tuple[float, float] | None
) -> None:
    edits = apply_preset(session, preset(name), selection, 2.5, falloff=0.2)
    assert edits
    assert all(edit.name.startswith(preset(name).name) for edit in edits)
    assert not session.edits, "it was only asked for"
    session.add(*edits)
    assert session.changed_frames() > 5
    assert session.changed_frames() < 140 or selection is None
    session.undo()
    assert session.changed_frames() == 0


def test_half_blink_near_the_playhead_is_completed_in_its_own_time(session: EditSession) -> None:
    (edit,) = apply_preset(session, preset("blink"), None, HALF_BLINK + 0.2)
    assert edit.start == pytest.approx(HALF_BLINK, abs=0.03)
    session.add(edit)
    assert session.achieved[between(session, 4.6, 5.0)][:, LIDS].min(axis=0).max() < 0.5


def test_blink_elsewhere_is_a_new_one(session: EditSession) -> None:
    (edit,) = apply_preset(session, preset("blink"), None, 2.5)
    assert edit.start < 2.5 < edit.end
    session.add(edit)
    assert session.asked[between(session, 2.45, 2.55)][:, LIDS].min() == 0
    assert (edit.falloff, edit.fade_out) == (0.09, 0.21)


def test_selection_completes_all_half_blinks_in_it(session: EditSession) -> None:
    (edit,) = apply_preset(session, preset("blink"), (0.0, 10.0), 0.0)
    assert edit.start == pytest.approx(HALF_BLINK, abs=0.03)


def test_blink_in_a_selection_without_one_keeps_its_length(session: EditSession) -> None:
    (edit,) = apply_preset(session, preset("blink"), (2.0, 3.0), 9.0, falloff=0.5)
    assert (edit.start + edit.end) / 2 == pytest.approx(2.5)
    assert edit.falloff == 0.09


def test_lips_close_where_they_nearly_met(session: EditSession) -> None:
    for selection, playhead in ((None, OPEN_LIPS - 0.2), ((6.0, 9.0), 0.0)):
        (edit,) = apply_preset(session, preset("close_lips"), selection, playhead)
        assert edit.start < OPEN_LIPS < edit.end
        session.preview(edit)
        assert session.achieved[between(session, 7.45, 7.49), MOUTH].max() < 1.2
        session.cancel()


def test_lips_close_over_a_short_selection(session: EditSession) -> None:
    (edit,) = apply_preset(session, preset("close_lips"), (2.0, 2.2), 9.0, falloff=0.1)
    assert (edit.start, edit.end, edit.falloff, edit.fade_out) == (2.0, 2.2, 0.1, 0.1)


def test_eyes_open_as_far_as_they_usually_do(session: EditSession) -> None:
    (edit,) = apply_preset(session, preset("open_eyes"), (4.6, 5.0), 0.0, falloff=0.1)
    assert edit.value == pytest.approx(
        open_eyes(session.tracked[:, LIDS].astype(np.float64)), abs=0.01
    )
    session.add(edit)
    assert session.achieved[between(session, 4.6, 5.0)][:, LIDS].min() > 6.5


def test_smile_without_a_selection_is_for_the_whole_take(session: EditSession) -> None:
    (edit,) = apply_preset(session, preset("smile"), None, 2.5, falloff=0.5)
    assert (edit.start, edit.falloff) == (0.0, 0.0)
    assert edit.end == pytest.approx(float(session.take.clip.times[-1]))


def test_calming_down_leaves_lips_closed_and_eyes_blinking(session: EditSession) -> None:
    before = session.tracked.copy()
    session.add(*apply_preset(session, preset("calm_down"), None, 0.0))
    after = session.asked
    assert after[:, MOUTH].max() < 0.8 * before[:, MOUTH].max()
    assert (after[:, MOUTH] <= before[:, MOUTH] + 1e-5).all()
    np.testing.assert_array_equal(after[:, LIDS], before[:, LIDS])


def test_surprise_leaves_blinks_shut_and_lips_meeting(session: EditSession) -> None:
    end = float(session.take.clip.times[-1])
    session.add(*apply_preset(session, preset("blink"), (0.0, end), 0.0))
    before = session.achieved.copy()
    session.add(*apply_preset(session, preset("surprise"), (0.0, end), 0.0, falloff=0.0))
    after = session.achieved
    shut, wide = before[:, LIDS] < 0.5, before[:, LIDS] > 6.0
    assert shut.sum() > 10
    assert after[:, LIDS][shut].max() < 1.0
    assert np.median((after - before)[:, LIDS][wide]) > 1.5
    assert np.median((after - before)[:, MOUTH]) > 6.0
    closures = [
        dip.frame
        for dip, _ in lip_dips(
            session.take.clip.times, before.astype(np.float64), np.zeros(len(before)), 60.0
        )
        if dip.level < 1.5
    ]
    assert len(closures) >= 3
    assert after[closures, MOUTH].max() < 2.0
    for strength in (0.4, 1.5):
        session.preview_list([replace(edit, strength=strength) for edit in session.edits])
        assert session.achieved[closures, MOUTH].max() < 2.0
    session.cancel()


def test_edits_near_the_start_of_the_take_are_placed_all_the_same(session: EditSession) -> None:
    for name in SHIPPED:
        session.add(*apply_preset(session, preset(name), None, 0.0))
        session.add(*apply_preset(session, preset(name), (0.0, 0.0), 0.0))
    assert np.isfinite(session.weights).all()


# --- the user's own ------------------------------------------------------------------------------

EDITS = (
    Edit(("mouth_opening",), Op.OFFSET, 2.0, 2.4, 0.2, 8.0),
    Edit(("mouth_width",), Op.DRAW, 2.1, 9.0, 0.1, points=((2.1, 40.0), (2.5, 45.0), (9.0, 40.0))),
    Edit(("left_corner",), Op.OFFSET, 2.0, 3.0, 0.2, 3.0, enabled=False),
    Edit(("left_corner",), Op.OFFSET, 5.0, 6.0, 0.2, 3.0),
)


def test_preset_of_a_selection_comes_back(session: EditSession, tmp_path: Path) -> None:
    folder = tmp_path / "not" / "yet"
    saved = save_preset("Größer auf!", EDITS, 2.0, 3.0, folder)
    presets, notes = load_presets(folder)
    assert (presets[-1], notes) == (saved, [])
    assert (saved.name, saved.own, saved.seconds) == ("Größer auf!", True, 1.0)
    first, second = apply_preset(session, saved, None, 6.0, falloff=3.0)
    assert replace(first, name="") == EDITS[0].shifted(4.0)
    assert (second.start, second.end, second.name) == (pytest.approx(6.1), 7.0, "Größer auf!")
    wide, _ = apply_preset(session, saved, (4.0, 6.0), 0.0, falloff=3.0)
    assert (wide.start, wide.end, wide.falloff) == (4.0, pytest.approx(4.8), 0.2)


@pytest.mark.parametrize(("length", "playhead"), [(1.0, 9.9), (1.0, 9.97), (8.5, 6.0)])
def test_a_preset_that_begins_near_the_end_of_the_take_keeps_its_times(
    session: EditSession, length: float, playhead: float, tmp_path: Path
) -> None:
    saved = save_preset("Mine", EDITS, 2.0, 2.0 + length, tmp_path)
    placed = apply_preset(session, saved, None, playhead)
    for edit, kept in zip(placed, saved.edits, strict=True):
        assert edit.end - edit.start == pytest.approx(kept.end - kept.start)
        assert edit.end - kept.end == pytest.approx(float(session.take.clip.times[-1]) - length)


def test_a_preset_of_one_moment_goes_to_the_middle_of_a_selection(
    session: EditSession, tmp_path: Path
) -> None:
    saved = save_preset("Mine", EDITS, 2.5, 2.5, tmp_path)
    assert {edit.start for edit in apply_preset(session, saved, (4.0, 6.0), 0.0)} == {5.0}


def test_presets_of_the_user_can_be_replaced_and_deleted(tmp_path: Path) -> None:
    saved = save_preset("Mine", EDITS, 2.0, 3.0, tmp_path)
    with pytest.raises(FileError, match="already a preset"):
        save_preset("mine", EDITS, 2.0, 3.0, tmp_path)
    save_preset("mine", EDITS[:1], 2.0, 3.0, tmp_path, replace_old=True)
    delete_preset(saved)
    assert not any(p.own for p in load_presets(tmp_path)[0])
    with pytest.raises(ValueError, match="ships"):
        delete_preset(preset("smile"))


def test_a_renamed_preset_is_the_same_under_its_new_name(tmp_path: Path) -> None:
    saved, other = (save_preset(name, EDITS, 2.0, 3.0, tmp_path) for name in ("Mine", "Other"))
    renamed = rename_preset(saved, " Yours ")
    assert renamed == replace(saved, id="yours", name="Yours", menu="Yours", path=renamed.path)
    assert rename_preset(renamed, "YOURS").path == renamed.path, "its file has that name already"
    with pytest.raises(FileError, match="already a preset"):
        rename_preset(other, "yours")
    with pytest.raises(FaceEditError, match="no name"):
        rename_preset(other, " ")
    with pytest.raises(FaceEditError, match="has a preset 'SMILE' of its own"):
        rename_preset(other, "SMILE")
    assert [p.name for p in load_presets(tmp_path)[0] if p.own] == ["Other", "YOURS"]


def test_nothing_to_save_is_reported(tmp_path: Path) -> None:
    with pytest.raises(FaceEditError, match="no edit in the selection"):
        save_preset("Mine", EDITS, 8.0 + 1.5, 10.0, tmp_path)
    with pytest.raises(FaceEditError, match="no name"):
        save_preset("  ", EDITS, 2.0, 3.0, tmp_path)
    with pytest.raises(FaceEditError, match="has a preset 'Smile' of its own"):
        save_preset("Smile", EDITS, 2.0, 3.0, tmp_path)
    (tmp_path / "file").write_text("")
    with pytest.raises(FileError, match="cannot be"):
        save_preset("Mine", EDITS, 2.0, 3.0, tmp_path / "file")


GOOD = {"version": 1, "name": "x", "seconds": 1.0, "edits": [
    {"control": "mouth_opening", "op": "offset", "start": 0, "end": 1, "value": 1}]}  # fmt: skip
BAD = {
    "not JSON": "{",
    "later": json.dumps(GOOD | {"version": 2}),
    "list": "[]",
    "no name": json.dumps({k: v for k, v in GOOD.items() if k != "name"}),
    "name is a number": json.dumps(GOOD | {"name": 3}),
    "no edits": json.dumps(GOOD | {"edits": []}),
    "edit is a number": json.dumps(GOOD | {"edits": [3]}),
    "edit is bad": json.dumps(GOOD | {"edits": [{"control": "nose"}]}),
    "length is a text": json.dumps(GOOD | {"seconds": "1"}),
    "length is no number": json.dumps(GOOD | {"seconds": float("nan")}),
    "unknown field": json.dumps(GOOD | {"ease": 1}),
    "unknown find": json.dumps(GOOD | {"find": "nose"}),
    "unknown alone": json.dumps(GOOD | {"alone": [1]}),
}


@pytest.mark.parametrize("name", BAD)
def test_damaged_preset_is_reported_in_one_line_and_the_others_are_there(
    name: str, tmp_path: Path
) -> None:
    (tmp_path / "bad.json").write_text(BAD[name], encoding="utf-8")
    (tmp_path / "good.json").write_text(json.dumps(GOOD), encoding="utf-8")
    presets, (note,) = load_presets(tmp_path)
    assert [p.name for p in presets if p.own] == ["x"]
    assert "bad.json" in note
    assert len(note.splitlines()) == 1
