"""The file of a region's networks: nothing in it is executed, and what is wrong is one line."""

from __future__ import annotations

import json
import os
import pickle
import sys
from pathlib import Path
from typing import Any

import numpy as np
import onnx
import pytest
from onnx import helper
from support.faces import shipped_rig
from support.networks import as_model, random_content, random_description
from support.region_files import OUTPUTS, TEXT, content_of, graph

from faceedit_app.core.errors import FileError
from faceedit_app.core.regions import EYELIDS
from faceedit_app.networks.description import KEY
from faceedit_app.networks.region import read_region


def complaint(path: Path) -> str:
    with pytest.raises(FileError) as caught:
        read_region(path)
    text = str(caught.value)
    assert text.startswith(str(path))
    assert len(text.splitlines()) == 1
    assert len(text.removeprefix(str(path))) < 250
    assert "; " in text, "no remedy"
    return text


def test_file_says_what_it_is(tmp_path: Path) -> None:
    description = random_description(EYELIDS, shipped_rig(), 3)
    (tmp_path / "x.onnx").write_bytes(random_content(description, 3))
    about = read_region(tmp_path / "x.onnx").description
    assert (about.region, about.controls, about.channels) == (
        EYELIDS.id,
        EYELIDS.controls,
        EYELIDS.channels,
    )
    assert about.to_json() == description.to_json()
    np.testing.assert_array_equal(about.covariance, description.covariance)


# --- no model ----------------------------------------------------------------------------------


class _Trap:
    """Unpickled, it leaves a file behind."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self) -> tuple[Any, ...]:
        return (open, (str(self.path), "w"))


def test_pickle_is_refused_and_never_executed(tmp_path: Path) -> None:
    path, trace = tmp_path / "lower.onnx", tmp_path / "executed"
    path.write_bytes(pickle.dumps(_Trap(trace)))
    complaint(path)
    assert not trace.exists()


@pytest.mark.parametrize(
    "content", [b"", b"\x89PNG\r\n\x1a\n" + bytes(80), b"hello", bytes(8), bytes(1000)]
)
def test_file_that_is_no_model_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "x.onnx").write_bytes(content)
    assert "not a FaceEdit model" in complaint(tmp_path / "x.onnx")


def test_what_cannot_be_read_is_named(tmp_path: Path) -> None:
    assert "cannot be read" in complaint(tmp_path / "none.onnx")
    assert "is not a file" in complaint(tmp_path)


@pytest.mark.skipif(sys.platform == "win32", reason="named pipes are other things there")
def test_named_pipe_does_not_keep_us_waiting(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "x.onnx")
    assert "is not a file" in complaint(tmp_path / "x.onnx")


def test_huge_file_is_refused_before_it_is_read(tmp_path: Path) -> None:
    with (tmp_path / "x.onnx").open("wb") as file:
        file.truncate(1 << 40)
    assert "too large" in complaint(tmp_path / "x.onnx")


def test_file_that_ends_early_is_refused_wherever_it_ends(tmp_path: Path) -> None:
    content = content_of(graph())
    for length in (1, 7, 8, 9, 100, 1000, len(content) // 2, len(content) - 1):
        (tmp_path / "cut").write_bytes(content[:length])
        complaint(tmp_path / "cut")


def test_onnx_of_something_else_is_refused(tmp_path: Path) -> None:
    model = as_model(graph(), TEXT)
    helper.set_model_props(model, {"author": "somebody"})
    (tmp_path / "x").write_bytes(model.SerializeToString())
    assert "not a FaceEdit model" in complaint(tmp_path / "x")


# --- descriptions ------------------------------------------------------------------------------

SAYS: dict[str, dict[str, Any]] = {
    "fewer controls": {"controls": ["left_eyelid"]},
    "the same control twice": {"controls": ["left_eyelid", "left_eyelid"]},
    "fewer channels": {"channels": ["eyeBlinkLeft"]},
    "no channels": {"channels": []},
    "nothing as controls": {"controls": None},
    "lists as controls": {"controls": [["left_eyelid"], ["right_eyelid"]]},
    "a text as scale": {"scale": "4"},
    "no scale": {"scale": 0},
    "a scale that is too coarse": {"scale": 1 << 40},
    "a context beyond reason": {"context": 1 << 40},
    "true as context": {"context": True},
    "nothing as architecture": {"architecture": None},
    "an architecture without a name": {"architecture": {"widths": [4]}},
    "a covariance that is none": {"covariance": (-np.eye(OUTPUTS)).tolist()},
    "a covariance of another size": {"covariance": [[1.0]]},
    "a ragged covariance": {"covariance": [[1.0], [1.0, 2.0]]},
    "infinity": {"low": [1e999, 0.0]},
    "a number without end": {"low": [10**400, 0]},
    "texts as numbers": {"high": ["a", "b"]},
    "another character's controls": {"made_for": {"name": "x", "controls": {}}},
    "nobody": {"made_for": None},
    "natural motion of another size": {
        "natural": {"mean": [0.0], "precision": [[1.0]], "limit": 1.0}
    },
    "no region": {"region": None},
    "a region without end": {"region": "x" * 5_000},
    "a text as version": {"version": "9" * 5_000},
    "a character that is moved by words": {
        "made_for": {
            "name": "x",
            "controls": {c: {"rest": ["a", 0, 0], "channels": {}} for c in EYELIDS.controls},
        }
    },
    "a character with other channels": {
        "made_for": {
            "name": "x",
            "controls": {
                c: {"rest": [0, 0, 0], "channels": {"noseUp": [0, 0, 0]}} for c in EYELIDS.controls
            },
        }
    },
    "nothing as version": {"version": None},
}


@pytest.mark.parametrize("name", SAYS)
def test_model_that_is_not_what_it_says_is_refused(tmp_path: Path, name: str) -> None:
    text = json.dumps(json.loads(TEXT) | SAYS[name])
    (tmp_path / "x").write_bytes(as_model(graph(), text).SerializeToString())
    complaint(tmp_path / "x")


@pytest.mark.parametrize(
    "text",
    ["", "{", "[]", "{}", "null", "[" * 100_000, '{"version": ' * 100_000, '"\\ud800"'],
    ids=lambda text: text[:12],
)
def test_description_that_is_none_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "x").write_bytes(as_model(graph(), text).SerializeToString())
    assert "not a FaceEdit model" in complaint(tmp_path / "x")


@pytest.mark.parametrize("entry", [name for name in json.loads(TEXT) if name != "natural"])
def test_description_without_an_entry_is_refused(tmp_path: Path, entry: str) -> None:
    known = json.loads(TEXT)
    del known[entry]
    (tmp_path / "x").write_bytes(as_model(graph(), json.dumps(known)).SerializeToString())
    complaint(tmp_path / "x")


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ({"version": 3}, ["version 3", "update FaceEdit"]),
        ({"controls": ["left_eyelid", "nose"]}, ["'nose'", "update FaceEdit"]),
        ({"channels": [*EYELIDS.channels[:-1], "noseUp"]}, ["'noseUp'", "update FaceEdit"]),
        ({"controls": ["left_eyelid", "n" * 500]}, ["nnn", "update FaceEdit"]),
        ({"rate": 30.0}, ["30 frames a second", "reinstall FaceEdit"]),
    ],
)
def test_what_is_too_new_or_unknown_is_named(
    tmp_path: Path, entry: dict[str, Any], words: list[str]
) -> None:
    text = json.dumps(json.loads(TEXT) | entry)
    (tmp_path / "x").write_bytes(as_model(graph(), text).SerializeToString())
    said = complaint(tmp_path / "x")
    assert all(word in said for word in words), said


def test_description_stands_in_the_file_as_plain_text() -> None:
    model = onnx.load_model_from_string(random_content(random_description(EYELIDS, shipped_rig())))
    (entry,) = model.metadata_props
    assert entry.key == KEY
    assert json.loads(entry.value)["region"] == EYELIDS.id
