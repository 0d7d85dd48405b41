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
_MAPPING = re.compile(r"([0-9a-f]+)-([0-9a-f]+) (\S+) \S+ \S+ \S+ *(.*)")
_HEAP_OF_A_THREAD = 64 * 2**20  # glibc puts each at a multiple of this


class _Mallinfo2(ctypes.Structure):
    """glibc's `struct mallinfo2`: bytes and counts over all its heaps."""

    _fields_ = [
        (name, ctypes.c_size_t)
        for name in (
            "arena",
            "ordblks",
            "smblks",
            "hblks",
            "hblkhd",
            "usmblks",
            "fsmblks",
            "uordblks",
            "fordblks",
            "keepcost",
        )
    ]


def memory_of(window: MainWindow) -> float:
    """The memory of this process now, in megabytes, without pictures and mapped files.

    Pictures take 10 to 150 MB, by the size of the window and of the face in it: more than a leak
    would in an hour. Only those in use are left out: one that is not freed counts. Garbage, and
    freed memory that the allocators keep for later, are no growth either: 9 MB of Python's after
    some edits with thousands of points, 15 MB more of C's after a quarter of an hour.
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
    return (used - pictures_of(window) - kept_by_python() - kept_by_c()) / 2**20


def kept_by_c() -> int:
    """The bytes in memory that glibc keeps for further allocations; 0 with another C library.

    Also after `malloc_trim`, which returns whole pages only, and of what is free in the heaps
    leaves the pieces between what is in use. What glibc maps for one allocation alone is returned
    when that is freed, and is not looked at.
    """
    try:
        mallinfo2 = ctypes.CDLL(None).mallinfo2
        lines = Path("/proc/self/smaps").read_text(encoding="utf-8", errors="replace").splitlines()
    except (AttributeError, OSError):
        return 0
    mallinfo2.restype = _Mallinfo2
    return max(0, _heaps(lines) - int(mallinfo2().uordblks))


def _heaps(smaps: list[str]) -> int:
    """The bytes of all heaps that are in memory, from the lines of a `/proc/PID/smaps`.

    A thread's heap may be several mappings, one after the other: numpy asks for large pages for
    its large arrays, and the system then keeps that part as a mapping of its own.
    """
    found, is_heap, of_thread, reached = 0, False, False, 0
    for line in smaps:
        if mapping := _MAPPING.match(line):
            start, end = int(mapping[1], 16), int(mapping[2], 16)
            allowed, name = mapping[3], mapping[4]
            if start % _HEAP_OF_A_THREAD == 0:
                of_thread = not name and allowed == "rw-p"
            else:
                of_thread = of_thread and not name and start == reached
            is_heap, reached = name == "[heap]" or of_thread, end
        elif is_heap and line.startswith("Anonymous:"):
            found += int(line.split()[1]) * 2**10
    return found


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
