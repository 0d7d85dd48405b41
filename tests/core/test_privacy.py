"""FaceEdit tells nobody that it is used."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

LOAD = """
from faceedit_app.core.resources import shipped
from faceedit_app.networks.region import RegionAnswer

path = shipped("models/upper.onnx")
RegionAnswer(path.read_bytes(), path)
"""


def test_networks_leave_nothing_in_the_home_folder(tmp_path: Path) -> None:
    """ONNX Runtime would write an identifier of the machine there, and send it."""
    own = ("ORT_DISABLE_TELEMETRY", "XDG_CACHE_HOME")
    env = {name: value for name, value in os.environ.items() if name not in own}
    subprocess.run([sys.executable, "-c", LOAD], env=env | {"HOME": str(tmp_path)}, check=True)
    assert not list(tmp_path.iterdir())
