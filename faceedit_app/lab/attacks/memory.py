"""How much memory the process has in use, apart from pictures, which are as large as the window."""

from __future__ import annotations

import contextlib
import ctypes
import gc
import os
import re
import resource
import sys
import tempfile
from functools import cache
from pathlib import Path

from PySide6.QtWidgets import QWidget

from faceedit_app.core.errors import Unavailable
from faceedit_app.render import contexts
from faceedit_app.ui.start.window import MainWindow

_COLOR = 4  # bytes of a pixel
_IN_SOFTWARE = ("llvmpipe", "softpipe", "swrast", "software")
_FREE = re.compile(r"(?:bytes in available blocks|unused pools \* \d+ bytes) *= *([\d,]+)")
_STDERR = 2


def memory_of(window: MainWindow) -> float:
    """The memory of this process now, in megabytes, without pictures and mapped files.

    Pictures take 10 to 150 MB, by the size of the window and of the face in it: more than a leak
    would in an hour. Only those in use are left out: one that is not freed counts. Garbage, and
    freed memory that the allocators keep for later, are no growth either: after some
    edits with thousands of points, that is 9 MB.
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
    return (used - pictures_of(window) - kept_by_python()) / 2**20


def kept_by_python() -> int:
    """The bytes that Python's own allocator keeps for further objects; 0 if it does not say.

    It returns memory only in pieces of 1 MB that hold no object at all.
    """
    with contextlib.suppress(AttributeError, OSError), tempfile.TemporaryFile() as said:
        before = os.dup(_STDERR)
        try:
            os.dup2(said.fileno(), _STDERR)
            sys._debugmallocstats()  # it prints, and there is no other way to ask
        finally:
            os.dup2(before, _STDERR)
            os.close(before)
        said.seek(0)
        found = _FREE.findall(said.read().decode(errors="replace"))
        return sum(int(count.replace(",", "")) for count in found)
    return 0


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
