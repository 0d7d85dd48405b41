"""Networks of torch as an ONNX file, and the parameters in such a file.

The graph is written by torch's own exporter, so that a layer is described once. Parameters keep
their names: the file that the application answers with is also what training goes on from.
"""

from __future__ import annotations

import json
import logging
import warnings
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import onnx
import torch
from onnx import helper, numpy_helper
from torch import Tensor, nn

from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.lab.training.architectures import Architecture
from faceedit_app.networks.description import KEY, Description
from faceedit_app.networks.graph import INPUT
from faceedit_app.networks.region import RegionAnswer

OPSET = 20
IR_VERSION = 10  # of opset 20's time: every runtime since reads it
TOLERANCE = 1e-3  # between torch and the file, as a share of the largest answer
_PREFIX = "networks."
_TRACED = 8  # times the coarsest scale, the frames of what is traced; a file takes any number

# It warns of each vision operator that it could know if torchvision were installed.
logging.getLogger("torch.onnx._internal.exporter._registration").setLevel(logging.ERROR)


def export(networks: Architecture, description: Description) -> bytes:
    """A file's content; the same networks always give the same bytes.

    Raises:
        FaceEditError: their architecture cannot be exported as it is.
    """
    content = described(networks, description.to_json())
    _compare(networks, content, description)
    return content


def described(networks: Architecture, text: str) -> bytes:
    """A file's content with a text as its description; nothing is checked."""
    settings = json.dumps(networks.settings)
    model = onnx.ModelProto()
    kind: Any = type(networks)
    model.CopyFrom(_template(kind, networks.controls, networks.channels, settings))
    state = networks.state_dict()
    for tensor in model.graph.initializer:
        if tensor.name in state:
            values = state[tensor.name].numpy()
            tensor.CopyFrom(numpy_helper.from_array(values, tensor.name))
    helper.set_model_props(model, {KEY: text})
    content: bytes = model.SerializeToString(deterministic=True)
    return content


def parameters(content: bytes) -> dict[str, Tensor]:
    """The constants of a file by name: the state of a module, and some of the graph's own."""
    model = onnx.load_model_from_string(content)
    return {
        tensor.name: torch.from_numpy(np.array(numpy_helper.to_array(tensor)))
        for tensor in model.graph.initializer
    }


class _Graph(nn.Module):
    """The module to export: frames first, and no batch."""

    def __init__(self, networks: Architecture) -> None:
        super().__init__()
        self.networks = networks

    def forward(self, controls: Tensor) -> tuple[Tensor, ...]:
        """(T, C) mm -> (T, K) weights of each output."""
        answers = self.networks.answers(controls.T.unsqueeze(0))
        return tuple(answer.squeeze(0).T for answer in answers.values())


@lru_cache
def _template(
    kind: type[Architecture], controls: int, channels: int, settings: str
) -> onnx.ModelProto:
    """The file of networks with other parameters, and without a description."""
    networks = kind(controls, channels, **json.loads(settings)).eval()
    random = torch.Generator().manual_seed(0)
    for values in networks.state_dict().values():
        if values.is_floating_point():  # all different: the exporter keeps one of those alike
            values.copy_(torch.rand(values.shape, generator=random) + 0.5)
    traced = _traced(networks)
    graph = helper.make_graph(
        [_bare(node) for node in traced.graph.node],
        kind.name,
        [_value(INPUT, controls)],
        [_value(output.name, channels) for output in traced.graph.output],
        [
            numpy_helper.from_array(numpy_helper.to_array(tensor), _short(tensor.name))
            for tensor in traced.graph.initializer
        ],
    )
    return helper.make_model(
        graph,
        producer_name="FaceEdit",
        opset_imports=[helper.make_opsetid("", OPSET)],
        ir_version=IR_VERSION,
    )


def _traced(networks: Architecture) -> onnx.ModelProto:
    """The graph as torch exports it."""
    curves = torch.zeros(_TRACED * networks.scale, networks.controls)
    with torch.inference_mode():
        outputs = list(networks.answers(curves.T[None]))
    passes = torch.export.Dim("passes", min=1, max=1 << 20)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the exporter's own, of torch's future
        program = torch.onnx.export(
            _Graph(networks),
            (curves,),
            dynamo=True,
            verbose=False,
            opset_version=OPSET,
            input_names=[INPUT],
            output_names=outputs,
            dynamic_shapes=({0: networks.scale * passes if networks.scale > 1 else passes},),
        )
    assert program is not None
    return program.model_proto


def _bare(node: onnx.NodeProto) -> onnx.NodeProto:
    """A node without torch's notes on its source and its module."""
    bare = helper.make_node(node.op_type, [_short(name) for name in node.input], node.output)
    for attribute in node.attribute:
        bare.attribute.add().CopyFrom(attribute)
        bare.attribute[-1].ClearField("doc_string")
    return bare


def _short(name: str) -> str:
    """The name that a parameter has in the module's state."""
    return name.removeprefix(_PREFIX)


def _value(name: str, size: int) -> onnx.ValueInfoProto:
    return helper.make_tensor_value_info(name, onnx.TensorProto.FLOAT, ["frames", size])


def _compare(networks: Architecture, content: bytes, description: Description) -> None:
    """Raise if the file does not answer as the networks do."""
    try:
        answer = RegionAnswer(content, Path(f"{description.region}.onnx"))
    except FileError as error:
        raise FaceEditError(
            f"networks of the architecture {networks.name!r} cannot be exported: {error.__cause__}"
        ) from error
    frames = _TRACED * networks.scale
    curves = np.linspace(description.low, description.high, frames, dtype=np.float32)
    with torch.inference_mode():
        wanted = networks.answers(torch.from_numpy(curves).T[None])
    for name, naturalness in (("regressor", 0.0), ("system", 1.0)):
        if name in wanted:
            ours = wanted[name][0].T.numpy()
            away = np.abs(answer(curves, naturalness) - ours).max()
            if not away <= TOLERANCE * max(1.0, np.abs(ours).max()):
                raise FaceEditError(
                    f"networks of the architecture {networks.name!r} answer otherwise once "
                    f"exported, by {away:.3g}; their parameters must be used as they are"
                )
