"""Where the project is, and where the data for building and testing lie, if they are at hand."""

from __future__ import annotations

import os
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SHARED = Path(os.environ.get("FACEEDIT_SHARED") or ROOT.parent / "shared")
