"""A character without the vertices of a control: that curve is still, all others work."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.faces import random_engine, shipped_rig
from support.sessions import demo_take

from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX, LIDS, MOUTH_WIDTH
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.help.fixes import apply_preset
from faceedit_app.editing.help.presets import shipped_presets
from faceedit_app.editing.help.problems import find_problems
from faceedit_app.editing.session import EditSession


def rig_without(*controls: str) -> Rig:
    rig = shipped_rig()
    pairs = rig.control_pairs.copy()
    pairs[[CONTROL_INDEX[name] for name in controls]] = -1
    return replace(rig, control_pairs=pairs)


def session_without(*controls: str, engine: bool = True) -> EditSession:
    rig = rig_without(*controls)
    return EditSession(demo_take(), rig, random_engine(rig=rig) if engine else None)


def raised(*controls: str) -> Edit:
    return Edit(controls, Op.OFFSET, 2.0, 3.0, 0.2, 2.0)


@pytest.mark.parametrize("mode", Mode)
@pytest.mark.parametrize("engine", [True, False], ids=["networks", "rig"])
@pytest.mark.parametrize("missing", CONTROL_IDS)
def test_edits_of_it_change_nothing_and_all_others_what_they_name(
    missing: str, engine: bool, mode: Mode
) -> None:
    session = session_without(missing, engine=engine)
    session.configure(Settings(mode))
    session.add(raised(missing))
    assert session.changed_frames() == 0
    session.add(raised(*CONTROL_IDS))
    held = (session.take.clip.times >= 2.0) & (session.take.clip.times <= 3.0)
    moved = (session.achieved - session.tracked)[held]
    assert np.isfinite(session.weights).all()
    for control, column in CONTROL_INDEX.items():
        if control == missing:
            assert (session.asked[:, column] == 0).all()
            assert (session.achieved[:, column] == 0).all()
        elif not engine or mode is Mode.PRESERVE:  # random networks resynthesize nonsense
            assert moved[:, column].mean() > 0.3, control


def test_what_it_leads_stays_and_what_leads_it_goes_alone() -> None:
    corner = CONTROL_INDEX["left_corner"]
    session = session_without(MOUTH_WIDTH)
    session.add(raised("left_corner"))
    change = session.asked - session.tracked
    assert change[:, corner].max() == pytest.approx(2.0, abs=1e-4)
    assert not np.delete(change, corner, axis=1).any()


@pytest.mark.parametrize("missing", [*((c,) for c in CONTROL_IDS), LIDS], ids=str)
def test_fixes_and_the_search_for_problems_do_without(missing: tuple[str, ...]) -> None:
    session = session_without(*missing, engine=False)
    find_problems(session)
    fixes = shipped_presets()
    for selection in (None, (2.0, 3.0)):
        session.add(*(e for fix in fixes for e in apply_preset(session, fix, selection, 4.7)))
    find_problems(session)
    assert np.isfinite(session.weights).all()
