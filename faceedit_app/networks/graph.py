"""Check an ONNX file as data before the runtime loads it: it may come from anywhere.

An ONNX file is a protobuf message with operators, their constants, and texts. It is parsed by a
schema of the few fields that `faceedit train` writes. Anything else, such as external data, custom
operators or nested graphs, is an unknown field and refused. Nothing in a file is executed except
the operators listed here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from google.protobuf.message import DecodeError, Message
from google.protobuf.unknown_fields import UnknownFieldSet

LARGEST = 8_000_000  # bytes; a larger model would be too slow for a drag
INPUT = "controls"
OUTPUTS = ("regressor", "system")

# Operators that our architectures use, and others that a model may need. None of them loops, draws
# random numbers or reads files. `region.py` limits their memory.
_LAYERS = (
    "AveragePool",
    "BatchNormalization",
    "Conv",
    "ConvTranspose",
    "Gemm",
    "MaxPool",
    "Resize",
)
_POINTWISE = ("Add", "Clip", "Elu", "Gelu", "LeakyRelu", "Mul", "Relu", "Sigmoid", "Sub", "Tanh")
_PLACES = ("Concat", "Identity", "Slice", "Split", "Squeeze", "Transpose", "Unsqueeze")
OPERATORS = frozenset((*_LAYERS, *_POINTWISE, *_PLACES))
OPSETS = range(13, 24)
MOST_NODES = 2_000
LARGEST_ATTRIBUTE = 256  # kernels, strides, padding, axes
MOST_NUMBERS = 16  # in an attribute
_COUNTS = frozenset(("dilations", "group", "kernel_shape", "strides"))
MOST_DIMENSIONS = 8
_FLOAT, _INT64 = 1, 7  # TensorProto.DataType
_TYPES: dict[int, np.dtype[Any]] = {_FLOAT: np.dtype("<f4"), _INT64: np.dtype("<i8")}

# The names are ours, the numbers are those of `onnx.proto`; a star marks a repeated field.
_SCHEMA: dict[str, dict[str, tuple[int, str]]] = {
    "Model": {
        "ir_version": (1, "int64"),
        "producer_name": (2, "string"),
        "graph": (7, "Graph"),
        "opset_import": (8, "Opset*"),
        "metadata_props": (14, "Entry*"),
    },
    "Opset": {"domain": (1, "string"), "version": (2, "int64")},
    "Entry": {"key": (1, "string"), "value": (2, "string")},
    "Graph": {
        "node": (1, "Node*"),
        "name": (2, "string"),
        "initializer": (5, "Tensor*"),
        "input": (11, "Value*"),
        "output": (12, "Value*"),
    },
    "Node": {
        "input": (1, "string*"),
        "output": (2, "string*"),
        "name": (3, "string"),
        "op_type": (4, "string"),
        "attribute": (5, "Attribute*"),
    },
    "Attribute": {
        "name": (1, "string"),
        "f": (2, "float"),
        "i": (3, "int64"),
        "s": (4, "bytes"),
        "ints": (8, "int64*"),
        "type": (20, "int32"),
    },
    "Tensor": {
        "dims": (1, "int64*"),
        "data_type": (2, "int32"),
        "name": (8, "string"),
        "raw_data": (9, "bytes"),
    },
    "Value": {"name": (1, "string"), "type": (2, "Type")},
    "Type": {"tensor_type": (1, "TensorType")},
    "TensorType": {"elem_type": (1, "int32"), "shape": (2, "Shape")},
    "Shape": {"dim": (1, "Dimension*")},
    "Dimension": {"dim_value": (1, "int64"), "dim_param": (2, "string")},
}


@dataclass(frozen=True)
class Graph:
    """An ONNX file that is safe to load.

    Attributes:
        texts: its metadata (`metadata_props`).
        controls: C of its input `controls`, (T, C) mm.
        weights: K of its outputs, (T, K).
        outputs: their names: `system`, and `regressor` if there are two networks.
    """

    texts: dict[str, str]
    controls: int
    weights: int
    outputs: frozenset[str]


def read_graph(content: bytes) -> Graph:
    """Check an ONNX file.

    Raises:
        ValueError: it holds anything but the allowed operators on its input; the text says what.
    """
    if len(content) > LARGEST:
        raise ValueError(f"{len(content)} bytes")
    try:
        model: Any = _message().FromString(content)
    except DecodeError as error:
        raise ValueError("not a protobuf message") from error
    graph = model.graph
    if max(len(graph.node), len(graph.initializer)) > MOST_NODES:
        raise ValueError(f"{len(graph.node)} operators, {len(graph.initializer)} constants")
    _refuse_unknown(model)
    if [entry.domain for entry in model.opset_import] != [""]:
        raise ValueError("custom operators")
    if model.opset_import[0].version not in OPSETS:
        raise ValueError(f"version {model.opset_import[0].version} of the operators")
    for tensor in graph.initializer:
        _check_tensor(tensor)
    _check_nodes(graph.node)
    inputs, outputs = _sizes(graph.input), _sizes(graph.output)
    if list(inputs) != [INPUT] or "system" not in outputs or not set(outputs) <= set(OUTPUTS):
        raise ValueError(f"from {list(inputs)} to {list(outputs)}")
    if len(set(outputs.values())) > 1:
        raise ValueError(f"outputs of several sizes: {outputs}")
    texts = {entry.key: entry.value for entry in model.metadata_props}
    return Graph(texts, inputs[INPUT], outputs["system"], frozenset(outputs))


@cache
def _message() -> Any:
    """The message class of the schema."""
    field = descriptor_pb2.FieldDescriptorProto
    file = descriptor_pb2.FileDescriptorProto(
        name="faceedit_onnx.proto", package="faceedit", syntax="proto3"
    )
    for message, fields in _SCHEMA.items():
        described = file.message_type.add(name=message)
        for name, (number, kind) in fields.items():
            label = field.LABEL_REPEATED if kind.endswith("*") else field.LABEL_OPTIONAL
            kind = kind.rstrip("*")
            entry = described.field.add(name=name, number=number, label=label)
            if kind in _SCHEMA:
                entry.type, entry.type_name = field.TYPE_MESSAGE, f".faceedit.{kind}"
            else:
                entry.type = getattr(field, f"TYPE_{kind.upper()}")
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName("faceedit.Model"))


def _refuse_unknown(message: Message) -> None:
    unknown = UnknownFieldSet(message)
    if len(unknown):
        number = unknown[0].field_number
        raise ValueError(f"field {number} of a {message.DESCRIPTOR.name.lower()}")
    fields = _SCHEMA[message.DESCRIPTOR.name]
    for field, value in message.ListFields():
        if field.message_type is not None:
            for part in value if fields[field.name][1].endswith("*") else (value,):
                _refuse_unknown(part)


def _check_tensor(tensor: Any) -> None:
    """Check that a constant fits its shape and is finite."""
    kind, dims = _TYPES.get(tensor.data_type), tensor.dims
    if kind is None or len(dims) > MOST_DIMENSIONS or min(dims, default=1) < 1:
        raise ValueError(f"constant {tensor.name}: type {tensor.data_type}, {len(dims)} dimensions")
    if math.prod(dims) * kind.itemsize != len(tensor.raw_data):
        raise ValueError(f"constant {tensor.name}: {len(tensor.raw_data)} bytes")
    if not np.isfinite(np.frombuffer(tensor.raw_data, kind)).all():
        raise ValueError(f"constant {tensor.name}: not finite")


def _check_nodes(nodes: Any) -> None:
    """Check that all operators are known and depend on the input."""
    alive = {INPUT}
    for node in nodes:
        if node.op_type not in OPERATORS:
            raise ValueError(f"the operator {node.op_type!r}")
        # An operator on constants alone would be computed while loading, without limits.
        if not alive.intersection(node.input):
            raise ValueError(f"{node.op_type} of constants, or before its input")
        alive.update(name for name in node.output if name)
        for attribute in node.attribute:
            numbers = list(attribute.ints) or [attribute.i]
            least = 1 if attribute.name in _COUNTS else -LARGEST_ATTRIBUTE
            if (
                len(numbers) > MOST_NUMBERS
                or min(numbers) < least
                or max(numbers) > LARGEST_ATTRIBUTE
            ):
                raise ValueError(f"{node.op_type}: {attribute.name} {numbers[:MOST_NUMBERS]}")


def _sizes(values: Any) -> dict[str, int]:
    """n of the (frames, n) float32 tensors, by name."""
    found = {}
    for value in values:
        kind = value.type.tensor_type
        dims = [dim.dim_value for dim in kind.shape.dim]
        if kind.elem_type != _FLOAT or len(dims) != 2 or dims[0] != 0 or dims[1] < 1:
            raise ValueError(f"{value.name}: type {kind.elem_type}, {dims}")
        found[value.name] = int(dims[1])
    return found
