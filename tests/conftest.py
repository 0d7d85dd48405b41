"""What all tests share."""

from __future__ import annotations

import contextlib
import os

# Torch's builds for graphics cards bring triton, which has an LLVM of its own and crashes if it is
# loaded after the one that software OpenGL brings. Nothing but a test run has both in a process.
with contextlib.suppress(ImportError):
    import triton  # noqa: F401

# Before Qt is imported by anything: tests need no display, and disturb none.
os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from support.media import devices
from support.windows import bench

__all__ = ["bench", "devices"]
