"""A curve that the take's channels cannot answer is named and left alone; no other channel pays."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.faces import shipped_rig
from support.takes import speech_like

from faceedit_app.cli import main
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.arrays import Floats
from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.core.resources import shipped
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.session import EditSession
from faceedit_app.editing.solving.answerable import find_lacks, unanswerable
from faceedit_app.formats.opening import open_take
from faceedit_app.formats.take import Take
from faceedit_app.networks.engine import Engine

MIDDLE = tuple(name for name in ARKIT_CHANNELS if not name.endswith(("Left", "Right")))
CLOSE_EYES = Edit(("left_eyelid", "right_eyelid"), Op.SET, 0.9, 1.1, 0.1, 0.0)
WIDER = Edit(("mouth_width",), Op.OFFSET, 0.9, 1.1, 0.1, 6.0)
OPEN = Edit(("mouth_opening",), Op.OFFSET, 0.9, 1.1, 0.1, 8.0)


@pytest.fixture(scope="module")
def engine() -> Engine:
    return Engine.load(shipped("models"), shipped_rig())


@pytest.fixture
def take_with(tmp_path: Path) -> Callable[..., Take]:
    def write(*channels: str) -> Take:
        weights = speech_like(60, 30, channels)
        lines = [",".join(["time_s", *channels])]
        for n, row in enumerate(weights):
            lines.append(",".join([f"{n / 30:.4f}", *(f"{value:.5f}" for value in row)]))
        path = tmp_path / "take.csv"
        path.write_text("\n".join(lines) + "\n")
        return open_take(path)

    return write


def missing(*stems: str) -> tuple[str, ...]:
    return tuple(name for name in ARKIT_CHANNELS if not name.startswith(stems))


def answer(take: Take, engine: Engine, *edits: Edit) -> dict[str, Floats]:
    """How far each channel that the edits change is changed, (T,) by channel."""
    session = EditSession(take, shipped_rig(), engine)
    session.add(*edits)
    change = np.abs(session.clip_weights() - take.clip.weights)
    moved = change.max(axis=0) > 0
    return {c: change[:, k] for k, c in enumerate(take.clip.channels) if moved[k]}


def test_a_take_with_all_channels_answers_everything(engine: Engine) -> None:
    assert find_lacks(ARKIT_CHANNELS, shipped_rig().arkit_distances, engine) == {}


@pytest.mark.parametrize(
    ("channels", "lacking"),
    [
        (MIDDLE, {*CONTROL_IDS} - {"mouth_opening", "lower_lip", "upper_lip"}),
        (missing("eyeBlink"), {"left_eyelid", "right_eyelid"}),
        (missing("eyeBlinkLeft"), {"left_eyelid"}),
        (missing("jawOpen"), {"mouth_opening", "lower_lip"}),
        (missing("mouthSmile", "mouthStretch"), {"mouth_width", "left_corner", "right_corner"}),
        (missing("eyeSquint", "eyeWide", "mouthPress", "tongueOut", "cheek"), set()),
        (missing("mouthStretch"), set()),
    ],
)
def test_curves_without_their_means_are_found(
    channels: tuple[str, ...], lacking: set[str], engine: Engine
) -> None:
    lacks = find_lacks(channels, shipped_rig().arkit_distances, engine)
    assert set(lacks) - {"upper_lip", "lower_lip"} == lacking - {"upper_lip", "lower_lip"}


def test_what_is_missing_is_named(take_with: Callable[..., Take], engine: Engine) -> None:
    take = take_with(*missing("eyeBlink"))
    first, second = unanswerable(CLOSE_EYES, take, shipped_rig(), engine)
    assert str(first) == "“Left eye opening” cannot be changed: the take has no eyeBlinkLeft"
    assert second.channels == ("eyeBlinkRight",)
    assert unanswerable(OPEN, take, shipped_rig(), engine) == ()
    for op in (Op.FILL, Op.RESET):  # of whatever channels the take has
        assert unanswerable(replace(CLOSE_EYES, op=op), take, shipped_rig(), engine) == ()


@pytest.mark.parametrize(
    ("channels", "edit"),
    [(MIDDLE, CLOSE_EYES), (MIDDLE, WIDER), (missing("mouth"), WIDER), (("jawOpen",), CLOSE_EYES)],
)
def test_an_edit_that_cannot_be_answered_changes_nothing(
    channels: tuple[str, ...], edit: Edit, take_with: Callable[..., Take], engine: Engine
) -> None:
    assert answer(take_with(*channels), engine, edit) == {}


def test_the_rest_of_an_edit_is_answered(take_with: Callable[..., Take], engine: Engine) -> None:
    both = Edit(("mouth_opening", "mouth_width"), Op.OFFSET, 0.9, 1.1, 0.1, 6.0)
    moved = answer(take_with(*MIDDLE), engine, both)
    assert moved["jawOpen"].max() > 0.05
    alone = Edit(("mouth_opening",), Op.OFFSET, 0.9, 1.1, 0.1, 6.0)
    assert np.array_equal(moved["jawOpen"], answer(take_with(*MIDDLE), engine, alone)["jawOpen"])


@pytest.mark.parametrize("gone", ["mouthSmile", "mouthStretch", "mouthPress", "mouthPucker"])
def test_a_missing_companion_makes_the_jaw_pay_little(
    gone: str, take_with: Callable[..., Take], engine: Engine
) -> None:
    moved = answer(take_with(*missing(gone)), engine, WIDER)
    # As far as the opening of the lips needs it, from which a funnel goes.
    assert moved["jawOpen"].max() < 0.12


@pytest.mark.parametrize(
    ("channels", "control", "by"),
    [
        # Smiles that are already 0 cannot narrow the mouth, and what purses the lips is missing.
        (missing("mouthPucker", "mouthFunnel", "mouthClose"), "mouth_width", -4.0),
        (missing("mouthPucker", "mouthFunnel", "mouthRoll", "mouthPress"), "mouth_width", -4.0),
        (("jawOpen", "mouthClose", "eyeBlinkLeft", "eyeBlinkRight"), "lower_lip", -4.0),
        (("jawOpen", "mouthSmileLeft", "mouthFunnel", "mouthPucker"), "upper_lip", 4.0),
    ],
)
def test_what_a_curve_lacks_does_not_open_the_mouth(
    channels: tuple[str, ...],
    control: str,
    by: float,
    take_with: Callable[..., Take],
    engine: Engine,
) -> None:
    edit = Edit((control,), Op.OFFSET, 0.9, 1.1, 0.1, by)
    moved = answer(take_with(*channels), engine, edit)
    assert moved.get("jawOpen", np.zeros(1)).max() < 0.16
    assert moved.get("mouthClose", np.zeros(1)).max() < 0.16


@pytest.mark.parametrize("seed", range(5))
def test_any_channels_give_finite_weights_and_undo_gives_the_take(
    seed: int, take_with: Callable[..., Take], engine: Engine
) -> None:
    drawn = np.random.default_rng(seed)
    share = drawn.uniform(0.1, 0.9)
    channels = [name for name in ARKIT_CHANNELS if drawn.uniform() < share] or ["jawOpen"]
    take = take_with(*channels)
    session = EditSession(take, shipped_rig(), engine)
    for control in CONTROL_IDS:
        for op, value in ((Op.OFFSET, 12.0), (Op.OFFSET, -12.0), (Op.SCALE, 3.0)):
            session.add(Edit((control,), op, 0.5, 1.2, 0.1, value))
            weights = session.clip_weights()
            assert np.isfinite(weights).all()
            assert np.isfinite(session.achieved).all()
            if control != "mouth_opening" and "jawOpen" in channels:
                jaw = channels.index("jawOpen")
                change = np.abs(weights - take.clip.weights)[:, jaw].max()
                assert change < 0.16
            session.undo()
    np.testing.assert_array_equal(session.clip_weights(), take.clip.weights)


def test_a_blink_alone_closes_the_eyes(take_with: Callable[..., Take], engine: Engine) -> None:
    take = take_with(*missing("eyeSquint", "eyeWide"))
    session = EditSession(take, shipped_rig(), engine)
    session.add(CLOSE_EYES)
    frame = take.clip.frame_at(1.0)
    assert session.achieved[frame, [CONTROL_IDS.index(c) for c in CLOSE_EYES.controls]].max() < 0.5


def test_apply_warns_and_writes_the_take_as_it_was(
    take_with: Callable[..., Take], capfd: pytest.CaptureFixture[str]
) -> None:
    take = take_with(*MIDDLE)
    edits, out = take.path.with_name("edits.json"), take.path.with_name("out.csv")
    entry = {"op": "set", "start": 0.9, "end": 1.1, "falloff": 0.1, "value": 0}
    entry |= {"controls": ["left_eyelid", "right_eyelid"]}
    edits.write_text(json.dumps({"version": 1, "edits": [entry]}))
    assert main(["apply", str(take.path), str(edits), "-o", str(out)]) == 0
    said = capfd.readouterr()
    assert "0 of 60 frames changed" in said.out
    assert "edit 1: “Left eye opening” cannot be changed: the take has no eyeBlinkLeft" in said.err
    assert out.read_bytes() == take.path.read_bytes()
