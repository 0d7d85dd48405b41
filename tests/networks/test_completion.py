"""Files of completion networks: read as data, refused in one line, safe whatever they answer."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import onnx
import pytest
from onnx import numpy_helper
from support.completions import COUNT, completion_description, random_completion, write_completion
from support.faces import random_rig, shipped_rig, talking_clip
from support.networks import random_content, random_description, write_models
from support.sessions import take_of

from faceedit_app.core.controls import LIP_OPENING
from faceedit_app.core.errors import FileError
from faceedit_app.core.regions import EYELIDS, LOWER
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.opening import open_session
from faceedit_app.networks.completion import FEATURES, LARGEST, read_completion
from faceedit_app.networks.engine import Engine, load_completion

RIG = shipped_rig()


def features(frames: int = 37) -> np.ndarray:
    return np.random.default_rng(0).normal(size=(frames, FEATURES * COUNT))


def complaint(path: Path) -> str:
    with pytest.raises(FileError) as caught:
        read_completion(path)
    text = str(caught.value)
    assert text.startswith(str(path))
    assert len(text.splitlines()) == 1
    assert "; " in text, "no remedy"
    return text


def test_any_number_of_frames_is_answered(tmp_path: Path) -> None:
    network = read_completion(write_completion(tmp_path, RIG))
    for frames in (1, 4, 37):
        share, further = network(features(frames))
        assert (share.shape, further.shape) == ((frames,), (frames, COUNT))
        assert ((share >= 0) & (share <= 1)).all()


def test_file_says_what_it_is(tmp_path: Path) -> None:
    about = read_completion(write_completion(tmp_path, RIG)).description
    assert about.to_json() == completion_description(LOWER, RIG).to_json()


def test_answers_that_are_no_numbers_are_harmless(tmp_path: Path) -> None:
    model = onnx.load_model_from_string(random_completion(LOWER, RIG))
    for tensor in model.graph.initializer:
        if tensor.name == "regressed.w":
            huge = np.full(tuple(tensor.dims), 3e38, np.float32)
            tensor.CopyFrom(numpy_helper.from_array(huge, tensor.name))
    path = tmp_path / "lower.onnx"
    path.write_bytes(model.SerializeToString())
    share, further = read_completion(path)(100 * features())
    assert np.isfinite(share).all()
    assert np.abs(further).max() <= LARGEST


@pytest.mark.parametrize("content", [b"", b"no model", b"\x08\x0a" * 40])
def test_other_files_are_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "lower.onnx"
    path.write_bytes(content)
    complaint(path)


def test_networks_of_a_region_are_no_completion(tmp_path: Path) -> None:
    path = tmp_path / "lower.onnx"
    path.write_bytes(random_content(random_description(LOWER, RIG)))
    complaint(path)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ('"completion": 1', '"completion": 2'),
        ('"rate": 25.0', '"rate": 30.0'),
        ('"scale": 4', '"scale": 0'),
        ('"mouth_width"', '"nose_width"'),
    ],
)
def test_descriptions_that_do_not_fit_are_refused(tmp_path: Path, field: str, value: str) -> None:
    text = completion_description(LOWER, RIG).to_json()
    model = onnx.load_model_from_string(random_completion(LOWER, RIG))
    assert field.replace(" ", "") in text.replace(" ", "")
    entry = model.metadata_props[0]
    entry.value = entry.value.replace(field, value).replace(
        field.replace(" ", ""), value.replace(" ", "")
    )
    assert entry.value != text
    path = tmp_path / "lower.onnx"
    path.write_bytes(model.SerializeToString())
    complaint(path)


def test_the_engine_takes_a_model_with_and_without_completion(tmp_path: Path) -> None:
    folder = write_models(tmp_path / "models", RIG)
    assert not Engine.load(folder, RIG).completions
    write_completion(folder, RIG)
    assert set(Engine.load(folder, RIG).completions) == {LOWER.id}


def test_a_network_of_another_region_is_refused(tmp_path: Path) -> None:
    write_completion(tmp_path, RIG).rename(tmp_path / "completion" / f"{EYELIDS.id}.onnx")
    with pytest.raises(FileError, match="holds the region 'lower'"):
        load_completion(tmp_path, EYELIDS, RIG)


def test_a_region_with_a_new_curve_is_not_completed(tmp_path: Path) -> None:
    folder = write_models(tmp_path / "models", RIG)
    about = replace(completion_description(LOWER, RIG), controls=LOWER.own[::-1])
    write_completion(folder, RIG).write_bytes(random_completion(LOWER, RIG, about=about))
    edit = Edit((LIP_OPENING,), Op.OFFSET, 1.0, 1.5, 0.1, 5.0)
    sessions = [
        open_session(take_of(talking_clip()), RIG, Engine(networks.models, completions))
        for networks in [Engine.load(folder, RIG)]
        for completions in (networks.completions, {})
    ]
    for session in sessions:
        session.add(edit)
    np.testing.assert_array_equal(sessions[0].weights, sessions[1].weights)


def test_a_network_for_another_character_is_refused(tmp_path: Path) -> None:
    write_completion(tmp_path, RIG)
    with pytest.raises(FileError, match="made for another character"):
        load_completion(tmp_path, LOWER, random_rig())
