"""A model belongs to one character, and is refused with another one."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.faces import random_rig, shipped_rig
from support.networks import random_content, random_description, write_models

from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX
from faceedit_app.core.errors import FileError
from faceedit_app.core.fields import Fields
from faceedit_app.core.regions import EYELIDS, LOWER, UPPER
from faceedit_app.core.resources import shipped
from faceedit_app.core.rig import Rig
from faceedit_app.networks.engine import Engine, load_region
from faceedit_app.networks.made_for import TOLERANCE, MadeFor


def scaled(rig: Rig, by: float) -> Rig:
    size = np.asarray(by, np.float32)
    return replace(rig, neutral=size * rig.neutral, deltas=size * rig.deltas)


def test_same_character_is_recognised_wherever_it_stands() -> None:
    rig = shipped_rig()
    made_for = MadeFor.of(rig, CONTROL_IDS)
    assert made_for.difference(rig) == ""
    moved = replace(
        rig, neutral=rig.neutral + np.array([0.3, 1.5, -2.0], np.float32), name="elsewhere"
    )
    assert made_for.difference(moved) == ""


def test_what_no_control_depends_on_may_differ() -> None:
    rig = shipped_rig()
    deltas = rig.deltas.copy()
    others = np.setdiff1d(np.arange(len(rig.neutral)), rig.control_pairs)
    deltas[:, others] *= 1.5
    colors = np.zeros_like(rig.colors)
    assert MadeFor.of(rig, CONTROL_IDS).difference(replace(rig, deltas=deltas, colors=colors)) == ""


@pytest.mark.parametrize("by", [0.7, 0.99, 1.01, 25.4])
def test_same_head_in_another_size_is_another_character(by: float) -> None:
    rig = shipped_rig()
    said = MadeFor.of(rig, CONTROL_IDS).difference(scaled(rig, by))
    assert "at rest is" in said


@pytest.mark.parametrize("control", CONTROL_IDS)
def test_other_blendshapes_are_another_character(control: str) -> None:
    rig = shipped_rig()
    vertex = rig.control_pairs[CONTROL_INDEX[control], 1]
    deltas = rig.deltas.copy()
    deltas[rig.channel_index["jawOpen"], vertex] += 2 * TOLERANCE / 1000
    changed = replace(rig, deltas=deltas)
    assert MadeFor.of(rig, [control]).difference(changed)
    moved_by_it = set(np.flatnonzero((rig.control_pairs == vertex).any(axis=1)))
    rest = [c for c in CONTROL_IDS if CONTROL_INDEX[c] not in moved_by_it]
    assert MadeFor.of(rig, rest).difference(changed) == ""


def test_character_that_lacks_a_channel_is_another_one() -> None:
    rig = shipped_rig()
    keep = [i for i, channel in enumerate(rig.channels) if channel != "jawOpen"]
    lacking = replace(rig, channels=tuple(rig.channels[i] for i in keep), deltas=rig.deltas[keep])
    assert MadeFor.of(rig, CONTROL_IDS).difference(lacking)


def test_it_comes_back_from_json() -> None:
    made_for = MadeFor.of(shipped_rig(), CONTROL_IDS)
    back = MadeFor.from_json(Fields(json.loads(json.dumps(made_for.to_json()))), CONTROL_IDS)
    assert back.name == shipped_rig().name
    for control, vectors in made_for.controls.items():
        np.testing.assert_array_equal(vectors, back.controls[control])


def test_shipped_models_are_refused_with_another_character() -> None:
    for other in (scaled(shipped_rig(), 0.7), random_rig()):
        with pytest.raises(FileError) as caught:
            Engine.load(shipped("models"), other)
        text = str(caught.value)
        assert text.startswith(str(shipped("models") / "lower.onnx"))
        assert "was made for another character, 'Mira'" in text
        assert "a model made for this one" in text
        assert len(text.splitlines()) == 1


def test_one_region_made_for_another_character_is_found(tmp_path: Path) -> None:
    folder = write_models(tmp_path, shipped_rig())
    other = random_description(EYELIDS, scaled(shipped_rig(), 0.7))
    (folder / "eyelids.onnx").write_bytes(random_content(other))
    with pytest.raises(FileError, match=r"eyelids\.onnx: was made for another character"):
        Engine.load(folder, shipped_rig())
    for region in (LOWER, UPPER):
        load_region(folder, region, shipped_rig())


def test_character_that_lacks_a_control_is_another_one() -> None:
    rig = shipped_rig()
    pairs = rig.control_pairs.copy()
    pairs[CONTROL_INDEX["upper_lip"]] = -1
    lacking = replace(rig, control_pairs=pairs)
    assert "this one does not" in MadeFor.of(rig, CONTROL_IDS).difference(lacking)
    others = [control for control in CONTROL_IDS if control != "upper_lip"]
    assert MadeFor.of(rig, others).difference(lacking) == ""
