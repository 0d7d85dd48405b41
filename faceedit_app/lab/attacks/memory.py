"""How much memory the process has in use, apart from pictures, which are as large as the window."""

from __future__ import annotations

import contextlib
import ctypes
import gc
import resource
import sys
from functools import cache
from pathlib import Path

from PySide6.QtWidgets import QWidget

from faceedit_app.core.errors import Unavailable
from faceedit_app.render import contexts
from faceedit_app.ui.start.window import MainWindow

_COLOR = 4  # bytes of a pixel
_IN_SOFTWARE = ("llvmpipe", "softpipe", "swrast", "software")


def memory_of(window: MainWindow) -> float:
    """The memory of this process now, in megabytes, without pictures and mapped files.

    Pictures take 10 to 150 MB, by the size of the window and of the face in it: more than a leak
    would in an hour. Only those in use are left out: one that is not freed counts. Garbage, and
    freed memory that the allocator keeps for later, are no growth either.
    """
    gc.collect()
    with contextlib.suppress(AttributeError, OSError):  # another C library than glibc
        ctypes.CDLL(None).malloc_trim(0)
    try:
        status = Path("/proc/self/status").read_text(encoding="ascii")
        used = int(status.split("RssAnon:")[1].split()[0]) * 2**10
    except (OSError, IndexError):  # not Linux: the most so far
        most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return most / (2**20 if sys.platform == "darwin" else 2**10)
    return (used - pictures_of(window)) / 2**20


def pictures_of(window: MainWindow) -> int:
    """The bytes of the window's picture, of the face's, and of what that is drawn in."""
    shown: list[QWidget] = [window]
    if window.editor is not None:
        shown.append(window.editor.face.viewport)
    return framebuffers() + sum(_picture_of(widget) for widget in shown)


def _picture_of(widget: QWidget) -> int:
    ratio = widget.devicePixelRatioF()
    return round(_COLOR * widget.width() * widget.height() * ratio**2)


def framebuffers() -> int:
    """The bytes of all framebuffers in use, if they are in the memory of this process."""
    targets = sys.modules.get("faceedit_app.render.targets")
    if targets is None or not _draws_in_software():  # nothing was drawn, or by a graphics card
        return 0
    return sum(one.bytes for one in gc.get_objects() if isinstance(one, targets.Target))


@cache
def _draws_in_software() -> bool:
    try:
        name = contexts.drawn_by().lower()
    except Unavailable:
        return False
    return any(part in name for part in _IN_SOFTWARE)
