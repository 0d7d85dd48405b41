"""Graphs that torch has exported, kept for all processes of a test run: each takes seconds."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import onnx
import torch
from onnx import numpy_helper

from faceedit_app.core.atomic import write_atomically
from faceedit_app.lab.training import export
from faceedit_app.lab.training.architectures import Architecture

Template = Callable[..., onnx.ModelProto]

exported: Template = export._template  # as torch writes it


def kept_in(folder: Path) -> Template:
    """What exports a graph once, and reads it from a folder from then on.

    Networks that differ in the numbers of their controls and channels share a graph. Where that is
    wrong, `export` says that the file answers otherwise than torch.
    """
    _know_operators()

    @lru_cache
    def kept(kind: type[Architecture], controls: int, channels: int, text: str) -> onnx.ModelProto:
        name = f"{kind.__module__}.{kind.__qualname__} {text}"
        path = folder / f"{hashlib.sha256(name.encode()).hexdigest()}.onnx"
        if not path.exists():
            write_atomically(path, exported(kind, controls, channels, text).SerializeToString())
        return of_size(onnx.load_model(path), kind, controls, channels, text)

    return kept


def of_size(
    model: onnx.ModelProto, kind: type[Architecture], controls: int, channels: int, text: str
) -> onnx.ModelProto:
    """A graph, changed to one for other numbers of controls and channels; all parameters are 0."""
    with torch.device("meta"):  # shapes are enough
        state = kind(controls, channels, **json.loads(text)).state_dict()
    for tensor in model.graph.initializer:
        if tensor.name in state:
            zeros = np.zeros(state[tensor.name].shape, numpy_helper.to_array(tensor).dtype)
            tensor.CopyFrom(numpy_helper.from_array(zeros, tensor.name))
    for value, size in [
        (model.graph.input[0], controls),
        *((o, channels) for o in model.graph.output),
    ]:
        value.type.tensor_type.shape.dim[1].dim_value = size
    return model


def _know_operators() -> None:
    """Let torch compile its operators for ONNX once in this process, and not for each graph."""
    with suppress(ImportError, AttributeError):  # it only saves time
        from torch.onnx._internal.exporter import _registration

        registry: Any = _registration.ONNXRegistry
        known = registry.from_torchlib
        if not hasattr(known, "cache_info"):
            registry.from_torchlib = staticmethod(lru_cache(known))
