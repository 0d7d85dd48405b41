"""What all tests share."""

from __future__ import annotations

import os

# Before Qt is imported by anything: tests need no display, and disturb none.
os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from windows import bench

__all__ = ["bench"]
