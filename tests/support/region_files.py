"""Files of a region's networks, and why they are refused."""

from __future__ import annotations

from pathlib import Path

import onnx
import pytest

from faceedit_app.core.errors import FileError
from faceedit_app.core.regions import EYELIDS
from faceedit_app.networks.region import RegionAnswer
from support.faces import shipped_rig
from support.networks import as_model, random_description, random_graph

INPUTS, OUTPUTS = len(EYELIDS.controls), len(EYELIDS.channels)
TEXT = random_description(EYELIDS, shipped_rig()).to_json()


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
