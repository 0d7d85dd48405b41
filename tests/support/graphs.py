"""Graphs that torch has exported, kept for all processes of a test run: each takes seconds."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import Any

import onnx

from faceedit_app.core.atomic import write_atomically
from faceedit_app.lab.training import export
from faceedit_app.lab.training.architectures import Architecture

Template = Callable[..., onnx.ModelProto]


def kept_in(folder: Path) -> Template:
    """What exports a graph once, and reads it from a folder from then on."""
    exported: Template = export._template
    _know_operators()

    @lru_cache
    def kept(kind: type[Architecture], controls: int, channels: int, text: str) -> onnx.ModelProto:
        name = f"{kind.__module__}.{kind.__qualname__} {controls} {channels} {text}"
        path = folder / f"{hashlib.sha256(name.encode()).hexdigest()}.onnx"
        if not path.exists():
            write_atomically(path, exported(kind, controls, channels, text).SerializeToString())
        return onnx.load_model(path)

    return kept


def _know_operators() -> None:
    """Let torch compile its operators for ONNX once in this process, and not for each graph."""
    with suppress(ImportError, AttributeError):  # it only saves time
        from torch.onnx._internal.exporter import _registration

        registry: Any = _registration.ONNXRegistry
        known = registry.from_torchlib
        if not hasattr(known, "cache_info"):
            registry.from_torchlib = staticmethod(lru_cache(known))
