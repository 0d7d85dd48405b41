"""Brows and a sideways jaw: reach answers them, and nothing else asks for them."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from support.faces import shipped_rig
from support.places import ROOT

from faceedit_app.characters.glb import read_rig
from faceedit_app.characters.glb_writing import write_rig
from faceedit_app.core.arkit import ARKIT_INDEX, mirrored_channel
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import (
    CONTROL_IDS,
    CONTROL_INDEX,
    MAIN_CONTROLS,
    MIRRORED_CONTROL,
    OPTIONAL_CONTROLS,
)
from faceedit_app.core.regions import BROWS, JAW
from faceedit_app.core.resources import shipped
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edits.describe import describe
from faceedit_app.editing.edits.edit import Edit, Op, from_json, to_json
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.help.clipboard import Copied, copy_range
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.opening import open_take
from faceedit_app.formats.take import Take
from faceedit_app.networks.engine import Engine

LEFT, RIGHT, SIDE = OPTIONAL_CONTROLS
BOTH = (LEFT, RIGHT)
COLUMN = {name: CONTROL_INDEX[name] for name in OPTIONAL_CONTROLS}


@lru_cache(maxsize=1)
def networks() -> Engine:
    return Engine.load(shipped("models"), shipped_rig())


@lru_cache(maxsize=1)
def demo() -> Take:
    return open_take(ROOT / "assets" / "demo_take.csv")


def session(take: Take | None = None, rig: Rig | None = None, engine: bool = True) -> EditSession:
    return EditSession(take or demo(), rig or shipped_rig(), networks() if engine else None)


MIRROR = [demo().clip.channels.index(mirrored_channel(c)) for c in demo().clip.channels]


def edit(controls: tuple[str, ...], millimetres: float, op: Op = Op.OFFSET) -> Edit:
    return Edit(controls, op, 2.0, 3.0, 0.2, millimetres)


def held(open_session: EditSession) -> np.ndarray:
    times = open_session.take.clip.times
    return (times >= 2.0) & (times <= 3.0)


def went(open_session: EditSession, control: str) -> float:
    change = (open_session.achieved - open_session.tracked)[held(open_session)]
    return float(change[:, COLUMN[control]].mean())


def changed_channels(open_session: EditSession) -> set[str]:
    changed = (open_session.weights != open_session.take.clip.arkit_weights()).any(axis=0)
    return {channel for channel, i in ARKIT_INDEX.items() if changed[i]}


def with_weights(**weights: float) -> Take:
    """The demo take with some channels held at a weight."""
    take = demo()
    values = take.clip.weights.copy()
    for channel, weight in weights.items():
        values[:, take.clip.channels.index(channel)] = weight
    return replace(take, clip=replace(take.clip, weights=values))


def only(*channels: str) -> Take:
    """The demo take with no more than some channels."""
    clip = demo().clip
    columns = [clip.channels.index(channel) for channel in channels]
    kept = Clip(np.ascontiguousarray(clip.weights[:, columns]), channels, clip.times, clip.rate)
    return replace(demo(), clip=kept)


@pytest.mark.parametrize("engine", [True, False], ids=["networks", "reach alone"])
@pytest.mark.parametrize("millimetres", [2.5, -2.5])
def test_brows_go_where_they_are_asked_to_and_nothing_else_moves(
    engine: bool, millimetres: float
) -> None:
    open_session = session(engine=engine)
    open_session.add(edit(BOTH, millimetres))
    for brow in BOTH:
        assert went(open_session, brow) == pytest.approx(millimetres, abs=0.2)
    assert changed_channels(open_session) <= {*BROWS.channels}


def test_one_brow_leaves_the_other() -> None:
    open_session = session()
    open_session.add(edit((LEFT,), 1.0))
    assert went(open_session, LEFT) > 0.6
    assert changed_channels(open_session) <= {"browOuterUpLeft", "browDownLeft"}


@pytest.mark.parametrize("millimetres", [3.0, -3.0])
def test_the_jaw_goes_to_one_side_or_the_other(millimetres: float) -> None:
    open_session = session()
    open_session.add(edit((SIDE,), millimetres))
    assert went(open_session, SIDE) == pytest.approx(millimetres, abs=0.05)
    assert changed_channels(open_session) <= {*JAW.channels}
    towards = "jawLeft" if millimetres > 0 else "jawRight"
    assert open_session.weights[held(open_session)][:, ARKIT_INDEX[towards]].min() > 0.2


def test_a_jaw_that_is_to_the_right_is_released_before_it_goes_to_the_left() -> None:
    open_session = session(with_weights(jawRight=0.5))
    assert open_session.tracked[:, COLUMN[SIDE]].max() < -2.0
    open_session.add(edit((SIDE,), 2.0))
    jaw = open_session.weights[held(open_session)]
    assert jaw[:, ARKIT_INDEX["jawLeft"]].max() < 0.01
    assert jaw[:, ARKIT_INDEX["jawRight"]].max() < 0.3


@pytest.mark.parametrize("millimetres", [1e6, -1e6])
@pytest.mark.parametrize("controls", [BOTH, (LEFT,), (SIDE,), OPTIONAL_CONTROLS])
def test_wild_drags_stop_where_faces_stop(controls: tuple[str, ...], millimetres: float) -> None:
    open_session = session()
    open_session.add(edit(controls, millimetres))
    assert open_session.weights.min() >= min(float(demo().clip.weights.min()), 0.0)
    assert open_session.weights.max() <= max(float(demo().clip.weights.max()), 1.0)
    for control in controls:
        low, high = open_session.limits[COLUMN[control]]
        asked = open_session.asked[:, COLUMN[control]]
        assert low - 1e-3 <= asked.min() <= asked.max() <= high + 1e-3
        assert high - low < 25.0, "what a face can do"


@pytest.mark.parametrize("millimetres", [2.0, -2.0, 1e6, -1e6])
def test_a_symmetric_request_on_a_symmetric_take_is_answered_symmetrically(
    millimetres: float,
) -> None:
    clip = demo().clip
    even = 0.5 * (clip.weights + clip.weights[:, MIRROR])
    open_session = session(replace(demo(), clip=replace(clip, weights=even)))
    open_session.add(edit(BOTH, millimetres))
    assert open_session.changed_frames() > 40
    mirrored = open_session.clip_weights()[:, MIRROR]
    np.testing.assert_allclose(open_session.clip_weights(), mirrored, atol=1e-5)


def test_the_jaw_to_the_left_mirrors_the_jaw_to_the_right() -> None:
    take = with_weights(jawLeft=0.0, jawRight=0.0, mouthLeft=0.0, mouthRight=0.0)
    answers = []
    for millimetres in (3.0, -3.0):
        open_session = session(take)
        open_session.add(edit((SIDE,), millimetres))
        columns = [ARKIT_INDEX[c] for c in JAW.channels]
        answers.append(open_session.weights[:, columns])
    np.testing.assert_allclose(answers[0], answers[1][:, [1, 0, 3, 2]], atol=1e-5)


def test_mirroring_swaps_brows_and_turns_the_jaw() -> None:
    open_session = session()
    open_session.add(edit((LEFT,), 1.0), edit((SIDE,), 3.0))
    copied = copy_range(open_session, 2.0, 3.0, OPTIONAL_CONTROLS, Copied.CHANGE)
    pasted = {e.controls: e for e in copied.mirrored().paste(6.0)}
    assert pasted.keys() == {(MIRRORED_CONTROL[LEFT],), (SIDE,)}
    assert max(mm for _, mm in pasted[(SIDE,)].points) < -2.9
    assert edit((SIDE,), 3.0).mirrored() == edit((SIDE,), -3.0)
    assert copied.mirrored().mirrored() == copied


@pytest.mark.parametrize("mode", list(Mode))
def test_resynthesis_keeps_brows_that_no_network_hears(mode: Mode) -> None:
    open_session = session()
    open_session.configure(Settings(mode=mode))
    open_session.add(edit(BOTH, 2.0), edit((SIDE,), 2.0))
    for control in OPTIONAL_CONTROLS:
        assert went(open_session, control) == pytest.approx(2.0, abs=0.2)
    far = np.abs(open_session.take.clip.times - 2.5) > 1.0
    same = open_session.weights[far] == open_session.take.clip.arkit_weights()[far]
    assert same.all()


def test_a_smooth_of_a_shaking_brow_makes_no_channel_shake() -> None:
    take = demo()
    weights = take.clip.weights.copy()
    shake = 0.1 * np.random.default_rng(0).random(len(weights))
    for channel in ("browDownLeft", "browDownRight"):
        weights[:, take.clip.channels.index(channel)] += shake
    open_session = session(replace(take, clip=replace(take.clip, weights=weights)))
    before = np.abs(np.diff(open_session.weights, 2, axis=0)).mean(axis=0)
    open_session.add(Edit(BOTH, Op.SMOOTH, 0.0, 10.0, 0.0, 0.1))
    after = np.abs(np.diff(open_session.weights, 2, axis=0)).mean(axis=0)
    assert after[ARKIT_INDEX["browDownLeft"]] < 0.4 * before[ARKIT_INDEX["browDownLeft"]]
    assert (after - before).max() < 0.002


def test_edits_of_other_curves_do_not_depend_on_them() -> None:
    """The same bytes with a character that has never heard of them."""
    pairs = shipped_rig().control_pairs.copy()
    pairs[[CONTROL_INDEX[control] for control in OPTIONAL_CONTROLS]] = -1
    bare = replace(shipped_rig(), control_pairs=pairs)
    edits = (
        edit(("mouth_opening", "left_eyelid"), 3.0),
        Edit(("left_corner", "right_corner"), Op.SCALE, 0.5, 4.0, 0.2, 1.4),
        Edit(MAIN_CONTROLS, Op.SMOOTH, 4.0, 7.0, 0.2, 0.05),
        Edit(MAIN_CONTROLS, Op.FILL, 7.5, 8.5, 0.0),
    )
    for mode in Mode:
        results = []
        for rig in (shipped_rig(), bare):
            open_session = EditSession(demo(), rig, networks())
            open_session.configure(Settings(mode=mode))
            open_session.add(*edits)
            results.append(open_session.weights.tobytes())
        assert results[0] == results[1]


def test_undo_brings_back_the_bytes() -> None:
    open_session = session()
    before = open_session.weights.tobytes()
    open_session.add(edit(OPTIONAL_CONTROLS, 2.0))
    open_session.undo()
    assert open_session.weights.tobytes() == before
    open_session.redo()
    open_session.reset(0.0, 10.0)
    assert open_session.weights.tobytes() == before


def test_a_character_without_their_vertices_says_so(tmp_path: Path) -> None:
    pairs = shipped_rig().control_pairs.copy()
    pairs[CONTROL_INDEX[RIGHT]] = -1
    write_rig(tmp_path / "head.glb", replace(shipped_rig(), control_pairs=pairs))
    rig = read_rig(tmp_path / "head.glb")
    assert rig.missing_controls == (RIGHT,)
    assert "“Right brow height”" in rig.missing_note
    open_session = session(rig=rig)
    open_session.add(edit(BOTH, 1.0))
    assert went(open_session, LEFT) > 0.5
    open_session.add(edit((RIGHT,), 1.0))
    assert (open_session.achieved[:, COLUMN[RIGHT]] == 0).all()


def test_a_take_without_their_channels_says_which() -> None:
    open_session = session(only("jawOpen", "mouthSmileLeft", "mouthSmileRight", "browInnerUp"))
    assert "browDownLeft" in str(open_session.lacks[LEFT])
    assert "jawLeft" in str(open_session.lacks[SIDE])
    open_session.add(edit(OPTIONAL_CONTROLS, 2.0))
    assert open_session.changed_frames() == 0


def test_brows_that_the_take_never_moves_can_still_be_raised() -> None:
    idle = dict.fromkeys((*BROWS.channels, *JAW.channels), 0.0)
    open_session = session(with_weights(**idle))
    open_session.add(edit(BOTH, 2.0), edit((SIDE,), 2.0))
    for control in OPTIONAL_CONTROLS:
        assert went(open_session, control) > 1.5


def test_edits_of_them_are_named_written_and_read() -> None:
    raised = edit(BOTH, 2.0)
    assert describe(raised) == "Brow height +2.0 mm"
    assert describe(edit((SIDE,), -3.0)) == "Jaw to the side −3.0 mm"
    assert describe(edit((SIDE,), -0.01, Op.SET)) == "Jaw to the side to 0.0 mm"
    assert describe(edit((SIDE,), -2.0, Op.SET)) == "Jaw to the side to −2.0 mm"
    assert from_json(to_json(raised)) == raised
    for controls in (MAIN_CONTROLS, CONTROL_IDS):
        assert describe(Edit(controls, Op.SMOOTH, 0, 1, 0, 0.04)) == "Smooth all curves (40 ms)"
        assert describe(Edit(controls, Op.FILL, 0, 1, 0)) == "Fill"


def test_copying_a_range_leaves_them_unless_they_are_named() -> None:
    open_session = session()
    copied = copy_range(open_session, 1.0, 2.0, what=Copied.CURVE)
    assert [control for control, _ in copied.curves] == list(MAIN_CONTROLS)
