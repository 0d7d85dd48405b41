"""Graphs that could do harm never get to the runtime."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import onnx
import pytest
from onnx import helper, numpy_helper
from support.networks import as_model, random_graph
from support.region_files import INPUTS, OUTPUTS, TEXT, content_of, graph, refused

from faceedit_app.core.errors import FileError
from faceedit_app.networks.graph import LARGEST, OPERATORS, read_graph
from faceedit_app.networks.region import RegionAnswer

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
    with pytest.raises(FileError, match="not a FaceEdit model") as caught:
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
    with pytest.raises(FileError, match="not a FaceEdit model"):
        RegionAnswer(content_of(changed), Path("x.onnx"))


@pytest.mark.parametrize("gain", [1e9, 3e38])  # the second is infinity minus infinity in the end
def test_networks_that_answer_no_weights_are_refused(gain: float) -> None:
    changed = graph()
    tensor = next(t for t in changed.initializer if t.name == "gain")
    tensor.CopyFrom(numpy_helper.from_array(np.array(gain, np.float32), tensor.name))
    assert "not weights" in refused(content_of(changed))


def test_answer_is_finite_whatever_is_asked(tmp_path: Path) -> None:
    answer = RegionAnswer(content_of(graph()), tmp_path)
    asked = np.full((8, INPUTS), 3e38, np.float32)
    assert np.isfinite(answer(asked, 0.5)).all()


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
