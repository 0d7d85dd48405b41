"""What further controls do (run by tests/test_where_to_add.py).

The table has three rows more: `outer_brow`, in the upper face, and `tongue_out` and `lips_side`,
which are optional and have regions of their own. The character and the models that ship know
nothing of them.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from support.faces import random_engine, shipped_rig
from support.rigs import tiny_session
from support.windows import Bench, bench, drag_curve

from faceedit_app.characters.glb import read_rig
from faceedit_app.characters.glb_writing import write_rig
from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.controls import (
    CONTROL_IDS,
    CONTROL_INDEX,
    LIDS,
    MAIN_CONTROLS,
    MIRRORED_CONTROL,
)
from faceedit_app.core.regions import EYELIDS, LOWER, UPPER
from faceedit_app.core.resources import shipped
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edits.describe import describe
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.opening import open_take
from faceedit_app.networks.engine import Engine
from faceedit_app.ui.state import loading

__all__ = ["bench"]

BROW, TONGUE, LIPS = map(CONTROL_INDEX.__getitem__, ("outer_brow", "tongue_out", "lips_side"))
UPPER_CHANNELS = [ARKIT_INDEX[channel] for channel in UPPER.channels]
RAISED = Edit(("outer_brow",), Op.OFFSET, 2.0, 3.0, 0.2, 3.0)


@lru_cache(maxsize=1)
def rig_with_points() -> Rig:
    """The shipped character with the vertices that the new controls join."""
    rig = shipped_rig()
    lid = rig.control_pairs[CONTROL_INDEX["left_eyelid"], 1]
    lifts = rig.deltas[rig.channel_index["browOuterUpLeft"], :, 1]
    pairs = rig.control_pairs.copy()
    pairs[BROW] = lid, int(np.argmax(lifts))
    tip = int(np.argmax(rig.deltas[rig.channel_index["tongueOut"], :, 2]))
    pairs[TONGUE] = int(np.argmin(rig.neutral[:, 2])), tip
    pairs[LIPS] = rig.control_pairs[CONTROL_INDEX["upper_lip"]]
    return replace(rig, control_pairs=pairs)


def session_on(rig: Rig, engine: Engine | None) -> EditSession:
    return EditSession(open_take(shipped("assets/demo_take.csv")), rig, engine)


def changed_columns(session: EditSession) -> set[int]:
    changed = session.weights != session.take.clip.arkit_weights()
    return set(np.flatnonzero(changed.any(axis=0)).tolist())


def test_it_is_the_ninth_and_no_eyelid() -> None:
    assert CONTROL_IDS[-1:] == ("outer_brow",) == MAIN_CONTROLS[8:]
    assert UPPER.own == ("outer_brow",)
    assert UPPER.controls == (*LIDS, "outer_brow")
    assert EYELIDS.controls == LIDS == ("left_eyelid", "right_eyelid")
    assert "outer_brow" not in LOWER.controls
    assert MIRRORED_CONTROL["outer_brow"] == "outer_brow", "there is no right one"
    assert describe(RAISED) == "Outer brow height +3.0 mm"
    assert describe(replace(RAISED, op=Op.SET, value=0.0)) == "Outer brow height to 0.0 mm"


def test_the_character_that_ships_opens_without_it() -> None:
    rig = shipped_rig()
    assert {*rig.missing_controls} == {"outer_brow", "tongue_out", "lips_side"}
    assert "“Outer brow height”" in rig.missing_note
    session = session_on(rig, Engine.load(shipped("models"), rig))
    session.add(RAISED)
    assert session.changed_frames() == 0
    both = replace(RAISED, controls=("outer_brow", "mouth_opening"))
    session.add(both)
    assert session.changed_frames() > 0
    assert not {*UPPER_CHANNELS} & changed_columns(session)
    for array in (session.tracked, session.asked, session.achieved):
        assert (array[:, BROW] == 0).all()
        assert np.isfinite(array).all()


def test_the_character_comes_back_from_its_file(tmp_path: Path) -> None:
    write_rig(tmp_path / "brow.glb", rig_with_points())
    rig = read_rig(tmp_path / "brow.glb")
    assert rig.missing_controls == ()
    np.testing.assert_array_equal(rig.control_pairs, rig_with_points().control_pairs)


def engine_of(networks: str) -> Engine | None:
    match networks:
        case "shipped":
            return Engine.load(shipped("models"), rig_with_points())
        case "listening":
            return random_engine(rig=rig_with_points())
    return None


@pytest.mark.parametrize("networks", ["none", "shipped", "listening"])
@pytest.mark.parametrize("millimetres", [3.0, 1000.0])
def test_it_moves_the_brow_and_nothing_else(networks: str, millimetres: float) -> None:
    session = session_on(rig_with_points(), engine_of(networks))
    lift = session.tracked[:, BROW].copy()
    session.add(replace(RAISED, value=millimetres))
    held = (session.take.clip.times >= 2.0) & (session.take.clip.times <= 3.0)
    went = (session.achieved[:, BROW] - lift)[held]
    assert changed_columns(session) <= {*UPPER_CHANNELS}
    assert 0 <= session.weights.min() <= session.weights.max() <= 1.05
    if networks != "listening" or millimetres > 100:  # those answer nonsense
        assert went.mean() > 1.5


def test_a_model_that_listens_to_it_answers_to_it() -> None:
    engine = random_engine(rig=rig_with_points())
    curves = np.full((40, len(CONTROL_IDS)), 20.0)
    raised = curves.copy()
    raised[:, BROW] += 3.0
    for region in (UPPER, EYELIDS, LOWER):
        plain, moved = (engine.answer(region.id, c, 1.0) for c in (curves, raised))
        assert (plain == moved).all() == (region is not UPPER)


@pytest.mark.parametrize("networks", ["none", "shipped"])
@pytest.mark.parametrize(
    ("control", "millimetres", "channels"),
    [
        ("tongue_out", 4.0, {"tongueOut"}),
        ("lips_side", 1.5, {"mouthLeft", "mouthRight"}),
        ("lips_side", -1.5, {"mouthLeft", "mouthRight"}),
    ],
)
def test_an_optional_one_moves_the_channels_of_its_region(
    networks: str, control: str, millimetres: float, channels: set[str]
) -> None:
    session = session_on(rig_with_points(), engine_of(networks))
    column = CONTROL_INDEX[control]
    before = session.tracked[:, column].copy()
    session.add(replace(RAISED, controls=(control,), value=millimetres))
    held = (session.take.clip.times >= 2.0) & (session.take.clip.times <= 3.0)
    went = (session.achieved[:, column] - before)[held]
    np.testing.assert_allclose(went, millimetres, atol=0.2)
    assert changed_columns(session) <= {ARKIT_INDEX[channel] for channel in channels}


def test_blinks_close_the_eyes_as_before() -> None:
    session = tiny_session()
    session.add(Edit(LIDS, Op.SET, 1.0, 1.2, 0.1, 0.0))
    assert changed_columns(session) <= {ARKIT_INDEX[channel] for channel in EYELIDS.channels}
    assert session.changed_frames() > 0


def test_it_is_the_ninth_curve_and_says_why_it_cannot_be_edited(bench: Bench) -> None:
    window = bench.editing()
    assert window.editor is not None
    session = window.document.session
    assert session is not None
    assert [plot.control.id for plot in window.editor.curves.plots] == list(CONTROL_IDS)
    assert "“Outer brow height”" in window.banner.text.text()
    assert window.editor.curves.group_head.text() == "Brows, jaw, tongue and lips"
    legend = window.editor.curves.legend.toolTip()
    assert "yellow for upper face" in legend
    assert "red for tongue and lips" in legend
    drag_curve(window, BROW, 1.0, 40)
    assert session.changed_frames() == 0


def test_dragging_the_ninth_curve_moves_the_face(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(loading, "load_character", rig_with_points)
    window = bench.editing()
    session = window.document.session
    assert session is not None
    assert window.banner.text.text().count("Outer brow") == 0
    drag_curve(window, BROW, 1.0, 40)
    assert session.edits[0].controls == ("outer_brow",)
    assert changed_columns(session)
    assert changed_columns(session) <= {*UPPER_CHANNELS}
