"""A control that the networks were not trained with: they load, and reach answers it alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support.faces import shipped_rig, talking_clip
from support.networks import random_content, random_description, write_models
from support.takes import NoFile

from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX
from faceedit_app.core.regions import REGIONS
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.settings import Settings
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.take import Take
from faceedit_app.networks.engine import Engine

START, END = 1.0, 1.5


def engine_without(folder: Path, control: str) -> Engine:
    """Networks of which none has heard of a control."""
    write_models(folder, shipped_rig())
    for region in REGIONS:
        known = tuple(c for c in region.controls if c != control)
        description = random_description(region, shipped_rig(), controls=known)
        (folder / f"{region.id}.onnx").write_bytes(random_content(description))
    return Engine.load(folder, shipped_rig())


def session_with(engine: Engine) -> EditSession:
    take = Take(Path("x.csv"), "Test", talking_clip(), (), (), NoFile())
    return EditSession(take, shipped_rig(), engine)


@pytest.mark.parametrize("control", ["mouth_opening", "lower_lip", "left_eyelid"])
def test_control_that_the_networks_do_not_know_is_answered_by_reach(
    tmp_path: Path, control: str
) -> None:
    session = session_with(engine_without(tmp_path, control))
    session.add(Edit((control,), Op.OFFSET, START, END, 0.1, 1.0))
    times = session.take.clip.times
    held = (times >= START) & (times <= END)
    column = CONTROL_INDEX[control]
    missed = np.abs(session.achieved - session.asked)[held, column]
    assert np.median(missed) < 0.3
    assert np.isfinite(session.weights).all()


def test_networks_do_not_answer_to_what_they_do_not_know(tmp_path: Path) -> None:
    session = session_with(engine_without(tmp_path, "left_eyelid"))
    session.configure(Settings(reach=0.0))
    session.add(Edit(("left_eyelid",), Op.OFFSET, START, END, 0.1, 1.0))
    np.testing.assert_allclose(
        session.weights, session.take.clip.arkit_weights(), rtol=0, atol=1e-6
    )


def test_what_the_networks_know_they_answer_as_before(tmp_path: Path) -> None:
    engine = engine_without(tmp_path, "left_eyelid")
    assert set(engine.models["eyelids"].description.controls) == {"right_eyelid"}
    whole = np.random.default_rng(0).uniform(0, 30, (40, len(CONTROL_IDS)))
    changed = whole.copy()
    changed[:, CONTROL_INDEX["left_eyelid"]] += 5.0
    for region in REGIONS:
        np.testing.assert_array_equal(
            engine.answer(region.id, whole, 1.0), engine.answer(region.id, changed, 1.0)
        )
    session = session_with(engine)
    session.configure(Settings(reach=0.0))
    session.add(Edit(("right_eyelid",), Op.OFFSET, START, END, 0.1, 1.0))
    assert session.changed_frames() > 0
