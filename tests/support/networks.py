"""Small random networks as files: they answer, and what they answer is nonsense."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import onnx
from onnx import helper, numpy_helper

from faceedit_app.core.regions import REGIONS, Region
from faceedit_app.core.rig import Rig
from faceedit_app.networks.description import KEY, Description
from faceedit_app.networks.engine import ENDING
from faceedit_app.networks.made_for import MadeFor
from faceedit_app.networks.region import RegionAnswer

FEATURES = 6
SCALE, CONTEXT = 4, 12


def random_description(region: Region, rig: Rig, seed: int = 0, **changes: Any) -> Description:
    """Of networks for a region, with a random covariance; `changes` are fields of it."""
    controls = changes.get("controls", region.controls)
    count, inputs = len(region.channels), len(controls)
    mixing = np.random.default_rng(seed).normal(0, 0.2, (count, count)) / np.sqrt(count)
    description = Description(
        region=region.id,
        controls=controls,
        channels=region.channels,
        made_for=MadeFor.of(rig, controls),
        architecture={"name": "random"},
        scale=SCALE,
        context=CONTEXT,
        covariance=mixing @ mixing.T + 0.01 * np.eye(count),
        low=np.full(inputs, 0.2),
        high=np.full(inputs, 60.0),
        notes="random",
    )
    return replace(description, **changes)


def random_graph(controls: int, channels: int, seed: int = 0) -> onnx.GraphProto:
    """Two scales of time with a skip layer, then a residual layer in place of an autoencoder."""
    random = np.random.default_rng(seed)
    constants = []

    def constant(name: str, values: Any, kind: type = np.float32) -> str:
        constants.append(numpy_helper.from_array(np.asarray(values, kind), name))
        return name

    def convolution(name: str, value: str, inputs: int, outputs: int) -> onnx.NodeProto:
        weights = random.normal(0, 1 / np.sqrt(3 * inputs), (outputs, inputs, 3))
        names = (
            constant(f"{name}.w", weights),
            constant(f"{name}.b", random.normal(0, 0.3, outputs)),
        )
        return helper.make_node("Conv", [value, *names], [name], kernel_shape=[3], pads=[1, 1])

    batch = constant("batch", [0], np.int64)
    nodes = [
        helper.make_node(
            "Sub", ["controls", constant("mean", np.full((1, controls), 25.0))], ["a"]
        ),
        helper.make_node("Mul", ["a", constant("gain", 0.1)], ["b"]),
        helper.make_node("Transpose", ["b"], ["c"], perm=[1, 0]),
        helper.make_node("Unsqueeze", ["c", batch], ["d"]),
        convolution("fine", "d", controls, FEATURES),
        helper.make_node("Elu", ["fine"], ["e"]),
        helper.make_node("MaxPool", ["e"], ["f"], kernel_shape=[SCALE], strides=[SCALE]),
        convolution("coarse", "f", FEATURES, FEATURES),
        helper.make_node("Elu", ["coarse"], ["g"]),
        helper.make_node(
            "Resize",
            ["g", "", constant("scales", [1, 1, SCALE])],
            ["h"],
            mode="nearest",
            coordinate_transformation_mode="asymmetric",
            nearest_mode="floor",
        ),
        helper.make_node("Concat", ["h", "e"], ["i"], axis=1),
        convolution("regressed", "i", 2 * FEATURES, channels),
        convolution("changed", "regressed", channels, channels),
        helper.make_node("Add", ["regressed", "changed"], ["cleaned"]),
        helper.make_node("Squeeze", ["regressed", batch], ["j"]),
        helper.make_node("Transpose", ["j"], ["regressor"], perm=[1, 0]),
        helper.make_node("Squeeze", ["cleaned", batch], ["k"]),
        helper.make_node("Transpose", ["k"], ["system"], perm=[1, 0]),
    ]
    return helper.make_graph(
        nodes,
        "random",
        [helper.make_tensor_value_info("controls", onnx.TensorProto.FLOAT, ["frames", controls])],
        [
            helper.make_tensor_value_info(name, onnx.TensorProto.FLOAT, ["frames", channels])
            for name in ("regressor", "system")
        ],
        constants,
    )


def as_model(graph: onnx.GraphProto, text: str, **more: Any) -> onnx.ModelProto:
    """An ONNX file with a description."""
    model = helper.make_model(
        graph,
        **({"opset_imports": [helper.make_opsetid("", 20)], "ir_version": 10} | more),
    )
    helper.set_model_props(model, {KEY: text})
    return model


def random_content(description: Description, seed: int = 0) -> bytes:
    """The content of a file with random networks that fit a description."""
    graph = random_graph(len(description.controls), len(description.channels), seed)
    content: bytes = as_model(graph, description.to_json()).SerializeToString()
    return content


def random_region(region: Region, rig: Rig, seed: int = 0, **changes: Any) -> RegionAnswer:
    """Random networks of a region, ready to answer."""
    description = random_description(region, rig, seed, **changes)
    return RegionAnswer(random_content(description, seed), Path(f"{region.id}{ENDING}"))


def write_models(folder: Path, rig: Rig, seed: int = 0) -> Path:
    """Random networks for every region as a folder of models."""
    folder.mkdir(parents=True, exist_ok=True)
    for i, region in enumerate(REGIONS):
        content = random_content(random_description(region, rig, seed + i), seed + i)
        (folder / f"{region.id}{ENDING}").write_bytes(content)
    return folder
