"""The file of a region's networks: nothing in it is executed, and what is wrong is one line."""

from __future__ import annotations

import json
import os
import pickle
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import onnx
import pytest
from onnx import helper, numpy_helper
from support.faces import shipped_rig
from support.networks import as_model, random_content, random_description, random_graph

from faceedit_app.core.errors import FileError
from faceedit_app.core.regions import EYELIDS
from faceedit_app.networks.description import KEY
from faceedit_app.networks.graph import LARGEST, OPERATORS, read_graph
from faceedit_app.networks.region import RegionAnswer, read_region

INPUTS, OUTPUTS = len(EYELIDS.controls), len(EYELIDS.channels)
TEXT = random_description(EYELIDS, shipped_rig()).to_json()


def complaint(path: Path) -> str:
    with pytest.raises(FileError) as caught:
        read_region(path)
    text = str(caught.value)
    assert text.startswith(str(path))
    assert len(text.splitlines()) == 1
    assert len(text.removeprefix(str(path))) < 250
    assert "; " in text, "no remedy"
    return text


def refused(content: bytes) -> str:
    """Why a file is refused before the runtime sees it."""
    with pytest.raises(FileError, match="is not a FaceEdit model") as caught:
        RegionAnswer(content, Path("x.onnx"))
    assert isinstance(caught.value.__cause__, ValueError), caught.value.__cause__
    return str(caught.value.__cause__)


def graph() -> onnx.GraphProto:
    return random_graph(INPUTS, OUTPUTS)


def content_of(changed: onnx.GraphProto) -> bytes:
    content: bytes = as_model(changed, TEXT).SerializeToString()
    return content


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
    assert "no FaceEdit model" in complaint(tmp_path / "x.onnx")


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
    assert "no FaceEdit model" in complaint(tmp_path / "x")


# --- graphs that could do harm -----------------------------------------------------------------


def test_constant_from_another_file_is_refused(tmp_path: Path) -> None:
    secret = tmp_path / "secret"
    secret.write_bytes(bytes(4))
    changed = graph()
    tensor = next(t for t in changed.initializer if t.name == "gain")
    tensor.ClearField("raw_data")
    tensor.data_location = onnx.TensorProto.EXTERNAL
    tensor.external_data.add(key="location", value=str(secret))
    assert "field 13 of a tensor" in refused(content_of(changed))


def _loop(changed: onnx.GraphProto) -> None:
    body = helper.make_graph([], "body", [], [])
    changed.node.insert(0, helper.make_node("Loop", ["controls"], ["looped"], body=body))


def _own_operator(changed: onnx.GraphProto) -> None:
    changed.node[0].domain = "com.example"


def _unknown_operator(changed: onnx.GraphProto) -> None:
    changed.node[0].op_type = "RandomNormalLike"


def _constants_alone(changed: onnx.GraphProto) -> None:
    changed.node.insert(0, helper.make_node("Resize", ["gain", "", "scales"], ["grown"]))


def _wide_kernel(changed: onnx.GraphProto) -> None:
    pool = next(node for node in changed.node if node.op_type == "MaxPool")
    pool.attribute[0].ints[:] = [1 << 40]


def _no_stride(changed: onnx.GraphProto) -> None:
    pool = next(node for node in changed.node if node.op_type == "MaxPool")
    next(a for a in pool.attribute if a.name == "strides").ints[:] = [0]


def _constant_of_nothing(changed: onnx.GraphProto) -> None:
    changed.initializer.append(numpy_helper.from_array(np.zeros((0, 3), np.float32), "none"))


def _shape_of_more(changed: onnx.GraphProto) -> None:
    changed.initializer[0].dims[:] = [1 << 40]


def _not_finite(changed: onnx.GraphProto) -> None:
    tensor = next(t for t in changed.initializer if t.name == "gain")
    tensor.CopyFrom(numpy_helper.from_array(np.array(np.nan, np.float32), "gain"))


def _text_as_constant(changed: onnx.GraphProto) -> None:
    changed.initializer.append(
        onnx.TensorProto(name="t", dims=[1], data_type=onnx.TensorProto.STRING)
    )


def _other_input(changed: onnx.GraphProto) -> None:
    changed.input[0].name = "curves"


def _second_input(changed: onnx.GraphProto) -> None:
    changed.input.append(helper.make_tensor_value_info("b", onnx.TensorProto.FLOAT, [None, 2]))


def _fixed_length(changed: onnx.GraphProto) -> None:
    changed.input[0].type.tensor_type.shape.dim[0].dim_value = 64


def _no_answer(changed: onnx.GraphProto) -> None:
    del changed.output[1]


def _many_nodes(changed: onnx.GraphProto) -> None:
    changed.node.extend([helper.make_node("Identity", ["controls"], ["i"])] * 5_000)


HARM: list[Callable[[onnx.GraphProto], None]] = [
    _loop,
    _own_operator,
    _unknown_operator,
    _constants_alone,
    _wide_kernel,
    _no_stride,
    _constant_of_nothing,
    _shape_of_more,
    _not_finite,
    _text_as_constant,
    _other_input,
    _second_input,
    _fixed_length,
    _no_answer,
    _many_nodes,
]


@pytest.mark.parametrize("harm", HARM, ids=lambda harm: harm.__name__.strip("_"))
def test_graph_that_could_do_harm_never_gets_to_the_runtime(
    harm: Callable[[onnx.GraphProto], None],
) -> None:
    changed = graph()
    harm(changed)
    with pytest.raises(ValueError, match=r"\w"):
        read_graph(content_of(changed))
    refused(content_of(changed))


@pytest.mark.parametrize(
    "opsets",
    [
        [],
        [helper.make_opsetid("", 3)],
        [helper.make_opsetid("", 999)],
        [helper.make_opsetid("", 20), helper.make_opsetid("ai.onnx.ml", 3)],
    ],
)
def test_operators_of_other_versions_and_sets_are_refused(
    opsets: list[onnx.OperatorSetIdProto],
) -> None:
    model = as_model(graph(), TEXT, opset_imports=opsets or [helper.make_opsetid("", 20)])
    if not opsets:
        del model.opset_import[:]
    refused(model.SerializeToString())


def test_functions_are_refused() -> None:
    model = as_model(graph(), TEXT)
    model.functions.add(name="f", domain="x")
    assert "field 25 of a model" in refused(model.SerializeToString())


def test_graph_that_wants_much_memory_is_refused_without_taking_it() -> None:
    changed = graph()
    grow = next(node for node in changed.node if node.op_type == "Resize")
    for i in range(30):  # 2**30 times as long, and the answer is of the right size again
        before, after = ("g", "g0") if i == 0 else (f"g{i - 1}", f"g{i}")
        node = onnx.NodeProto()
        node.CopyFrom(grow)
        node.input[0], node.output[0] = before, after
        changed.node.insert(list(changed.node).index(grow), node)
    grow.input[0] = "g29"
    with pytest.raises(FileError, match="no FaceEdit model") as caught:
        RegionAnswer(content_of(changed), Path("x.onnx"))
    assert "BFCArena" in str(caught.value.__cause__)


def test_empty_messages_by_the_million_do_not_fill_memory() -> None:
    nodes = b"\x0a\x00" * (LARGEST // 2 - 10)
    size = len(nodes)
    header = bytes([0x3A, *(size >> shift & 127 | 128 for shift in (0, 7, 14)), size >> 21])
    assert "operators" in refused(header + nodes)


@pytest.mark.parametrize("size", [3, OUTPUTS + 1])
def test_graph_of_another_size_than_it_says_is_refused(size: int) -> None:
    content = as_model(random_graph(INPUTS, size), TEXT).SerializeToString()
    refused(content)


def test_graph_whose_sizes_do_not_fit_is_refused() -> None:
    changed = graph()
    tensor = next(t for t in changed.initializer if t.name == "coarse.w")
    tensor.CopyFrom(numpy_helper.from_array(np.zeros((6, 5, 3), np.float32), tensor.name))
    with pytest.raises(FileError, match="no FaceEdit model"):
        RegionAnswer(content_of(changed), Path("x.onnx"))


@pytest.mark.parametrize("gain", [1e9, 3e38])  # the second is infinity minus infinity in the end
def test_networks_that_answer_no_weights_are_refused(gain: float) -> None:
    changed = graph()
    tensor = next(t for t in changed.initializer if t.name == "gain")
    tensor.CopyFrom(numpy_helper.from_array(np.array(gain, np.float32), tensor.name))
    assert "no weights" in refused(content_of(changed))


def test_answer_is_finite_whatever_is_asked(tmp_path: Path) -> None:
    answer = RegionAnswer(content_of(graph()), tmp_path)
    asked = np.full((8, INPUTS), 3e38, np.float32)
    assert np.isfinite(answer(asked, 0.5)).all()


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
    assert "no FaceEdit model" in complaint(tmp_path / "x")


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
        ({"rate": 30.0}, ["30 frames a second", "faceedit train"]),
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


# --- files that chance has damaged -------------------------------------------------------------


@pytest.mark.parametrize("seed", range(8))
def test_damaged_file_is_refused_or_answers(seed: int) -> None:
    random, whole = np.random.default_rng(seed), content_of(graph())
    for _ in range(40):
        content = bytearray(whole)
        for place in random.integers(len(content), size=random.integers(1, 6)):
            content[place] = random.integers(256)
        cut = random.integers(len(content)) if random.random() < 0.2 else len(content)
        try:
            answer = RegionAnswer(bytes(content[:cut]), Path("x.onnx"))
        except FileError as error:
            assert len(str(error).splitlines()) == 1  # noqa: PT017
            continue
        curves = np.full((answer.description.scale, len(answer.columns)), 9.0, np.float32)
        assert np.isfinite(answer(curves, 0.5)).all()


@pytest.mark.parametrize("seed", range(8))
def test_graph_of_other_operators_is_refused_or_answers(seed: int) -> None:
    random = np.random.default_rng(seed)
    for _ in range(40):
        changed = graph()
        names = [name for node in changed.node for name in node.output]
        for _ in range(random.integers(1, 4)):
            node = changed.node[random.integers(len(changed.node))]
            if random.random() < 0.5:
                node.op_type = str(random.choice(sorted(OPERATORS)))
            else:
                node.input[random.integers(len(node.input))] = str(random.choice(names))
        try:
            answer = RegionAnswer(content_of(changed), Path("x.onnx"))
        except FileError:
            continue
        assert np.isfinite(answer(np.full((8, INPUTS), 9.0, np.float32), 0.5)).all()
