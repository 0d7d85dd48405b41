"""What the tests of the batch share."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.faces import models
from support.takes import make_livelink_csv, make_plain_csv

__all__ = ["models"]


@pytest.fixture
def takes(tmp_path: Path) -> Path:
    """A folder with three takes, one of them damaged, and a file that is none."""
    folder = tmp_path / "takes"
    (folder / "day 2").mkdir(parents=True)
    make_livelink_csv(folder / "a.csv")
    (folder / "bad.csv").write_text("jawOpen\n0.1\nmany\n")
    make_plain_csv(folder / "day 2" / "b.csv")
    (folder / "notes.json").write_text("{}")
    return folder
