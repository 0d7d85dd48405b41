"""The models that ship with FaceEdit, on the demo take: what a user asks for is what happens."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.faces import shipped_rig

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.controls import CONTROL_INDEX, MAIN_CONTROLS
from faceedit_app.core.resources import shipped
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.opening import open_take
from faceedit_app.formats.take import Take
from faceedit_app.networks.engine import Engine

START, END = 4.0, 4.4
LIDS = ("left_eyelid", "right_eyelid")


@pytest.fixture(scope="module")
def engine() -> Engine:
    return Engine.load(shipped("models"), shipped_rig())


@pytest.fixture(scope="module")
def demo() -> Take:
    return open_take(shipped("assets/demo_take.csv"))


def edited(take: Take, engine: Engine, *edits: Edit, how: Settings | None = None) -> EditSession:
    session = EditSession(take, shipped_rig(), engine)
    session.configure(how or Settings())
    session.add(*edits)
    return session


def held(session: EditSession) -> np.ndarray:
    times = session.take.clip.times
    return (times >= START) & (times <= END)


def change(session: EditSession, control: str) -> float:
    """Mean change of a control over the edit, mm."""
    column = CONTROL_INDEX[control]
    return float((session.achieved - session.tracked)[held(session), column].mean())


@pytest.mark.parametrize(
    ("control", "millimetres"),
    [
        ("mouth_opening", 8.0),
        ("mouth_opening", 3.0),
        ("mouth_width", -3.0),
        ("left_corner", 2.0),
        ("right_corner", 2.0),
        ("upper_lip", -1.0),
        ("lower_lip", 1.0),
        ("left_eyelid", -4.0),
        ("right_eyelid", 1.0),
    ],
)
def test_control_goes_the_way_it_was_dragged(
    demo: Take, engine: Engine, control: str, millimetres: float
) -> None:
    session = edited(demo, engine, Edit((control,), Op.OFFSET, START, END, 0.2, millimetres))
    asked = (session.asked - session.tracked)[held(session), CONTROL_INDEX[control]].mean()
    got = change(session, control)
    assert np.sign(got) == np.sign(millimetres)
    assert abs(got) > 0.5 * abs(asked)
    assert abs(got) < 1.5 * abs(asked) + 0.2


def test_opening_the_mouth_opens_the_jaw_and_leaves_the_eyes(demo: Take, engine: Engine) -> None:
    session = edited(demo, engine, Edit(("mouth_opening",), Op.OFFSET, START, END, 0.2, 8.0))
    moved = session.weights - session.take.clip.arkit_weights()
    assert moved[held(session), ARKIT_INDEX["jawOpen"]].mean() > 0.1
    assert not moved[:, [ARKIT_INDEX["eyeBlinkLeft"], ARKIT_INDEX["eyeBlinkRight"]]].any()


@pytest.mark.parametrize("side", ["Left", "Right"])
def test_closing_one_eye_closes_that_eye(demo: Take, engine: Engine, side: str) -> None:
    name = f"{side.lower()}_eyelid"
    session = edited(demo, engine, Edit((name,), Op.SET, START, END, 0.15, 0.0))
    inside = held(session)
    assert np.median(session.achieved[inside, CONTROL_INDEX[name]]) < 1.5
    blink = session.weights[:, ARKIT_INDEX[f"eyeBlink{side}"]]
    assert np.median(blink[inside]) > 0.6
    other = CONTROL_INDEX[LIDS[side == "Left"]]
    assert np.abs((session.achieved - session.tracked)[inside, other]).mean() < 1.5


def test_closing_the_lips_brings_them_together(demo: Take, engine: Engine) -> None:
    session = edited(demo, engine, Edit(("mouth_opening",), Op.SET, START, END, 0.1, 0.3))
    assert np.median(session.achieved[held(session), CONTROL_INDEX["mouth_opening"]]) < 1.5


WILD = {
    "mouth": Edit(("mouth_opening",), Op.OFFSET, START, START + 1 / 30, 0.0, 80.0),
    "lids": Edit(LIDS, Op.OFFSET, -1.0, 1e3, 0.0, -20.0),
}


@pytest.mark.parametrize("mode", list(Mode))
@pytest.mark.parametrize("name", WILD)
def test_wild_edit_stays_a_face(demo: Take, engine: Engine, name: str, mode: Mode) -> None:
    session = edited(demo, engine, WILD[name], how=Settings(mode))
    assert np.isfinite(session.weights).all()
    assert session.weights.min() >= 0
    assert session.weights.max() <= 1
    close, jaw = (
        session.weights[:, ARKIT_INDEX["mouthClose"]],
        session.weights[:, ARKIT_INDEX["jawOpen"]],
    )
    tracked = demo.clip.arkit_weights()
    slack = np.maximum(
        tracked[:, ARKIT_INDEX["mouthClose"]] - tracked[:, ARKIT_INDEX["jawOpen"]], 0
    )
    assert (close <= jaw + slack + 1e-6).all()
    # No control ends farther apart than faces go.
    main = len(MAIN_CONTROLS)
    most = np.maximum(session.tracked.max(axis=0)[:main], [50, 70, 48, 48, 62, 42, 13, 13])
    assert (session.achieved.max(axis=0)[:main] <= most).all()


def test_resynthesis_without_a_change_is_near_the_take(demo: Take, engine: Engine) -> None:
    nothing = Edit(("mouth_opening", *LIDS), Op.OFFSET, START, END, 0.2, 0.0)
    session = edited(demo, engine, nothing, how=Settings(Mode.RESYNTHESIZE))
    error = np.abs(session.achieved - session.tracked)
    assert np.median(error) < 1.0
    preserved = edited(demo, engine, nothing)
    np.testing.assert_allclose(preserved.weights, demo.clip.arkit_weights(), atol=2e-3)


def test_model_card_names_every_model(engine: Engine) -> None:
    card = Path(shipped("models")) / "README.md"
    text = card.read_text(encoding="utf-8")
    for region in engine.models:
        assert f"{region}.onnx" in text


OPEN = Edit(("mouth_opening",), Op.OFFSET, START, END, 0.1, 5.0)
CORNERS = [CONTROL_INDEX["left_corner"], CONTROL_INDEX["right_corner"]]


def smiling(take: Take, start: float, end: float, ease: float) -> Take:
    """A take with a smile between two times that comes and goes in some seconds."""
    times = take.clip.times
    away = np.clip(np.minimum(times - start, end - times) / ease, 0.0, 1.0)
    weights = take.clip.weights.copy()
    for side in ("Left", "Right"):
        column = take.clip.channels.index(f"mouthSmile{side}")
        weights[:, column] = np.clip(weights[:, column] + 0.7 * away, 0.0, 1.0)
    return replace(take, clip=replace(take.clip, weights=weights))


def smile_lost(take: Take, engine: Engine) -> float:
    """Mean mm that completion takes from the corners when only the opening is dragged."""
    session = edited(take, engine, OPEN)
    plain = edited(take, Engine(engine.models), OPEN)
    lost = (plain.achieved - session.achieved)[held(session)][:, CORNERS]
    return float(lost.mean())


def test_a_smile_stays_when_the_jaw_drops(demo: Take, engine: Engine) -> None:
    assert abs(smile_lost(smiling(demo, 1.0, 7.0, 0.4), engine)) < 0.5


def test_a_smile_that_was_pasted_under_the_edit_goes(demo: Take, engine: Engine) -> None:
    assert smile_lost(smiling(demo, START, END, 0.08), engine) > 1.5
