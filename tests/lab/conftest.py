"""What the tests of the laboratory share."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterator
from functools import lru_cache

import onnx
import pytest

from faceedit_app.core.atomic import write_atomically
from faceedit_app.lab.training import export
from faceedit_app.lab.training.architectures import Architecture


@pytest.fixture(scope="session", autouse=True)
def graphs(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Graphs that torch has exported, kept for all processes of this run: each takes seconds."""
    base = tmp_path_factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "graphs"
    folder.mkdir(exist_ok=True)
    exported: Callable[..., onnx.ModelProto] = export._template

    @lru_cache
    def kept(kind: type[Architecture], controls: int, channels: int, text: str) -> onnx.ModelProto:
        name = f"{kind.__module__}.{kind.__qualname__} {controls} {channels} {text}"
        path = folder / f"{hashlib.sha256(name.encode()).hexdigest()}.onnx"
        if not path.exists():
            write_atomically(path, exported(kind, controls, channels, text).SerializeToString())
        return onnx.load_model(path)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(export, "_template", kept)
        yield
