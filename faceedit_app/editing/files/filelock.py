"""Locks on open files that the system lifts when a process ends, however it ends."""

from __future__ import annotations

import os
import sys

if sys.platform == "win32":
    import msvcrt

    _FAR = 1 << 30  # Windows locks bytes against reading: take one that is never there

    def _lock(file: int, mode: int) -> None:
        os.lseek(file, _FAR, os.SEEK_SET)
        msvcrt.locking(file, mode, 1)
        os.lseek(file, 0, os.SEEK_SET)

    def lock(file: int) -> None:
        """Lock an open file; raises OSError where that cannot be."""
        _lock(file, msvcrt.LK_LOCK)

    def try_lock(file: int) -> bool:
        """Whether an open file could be locked, because no other process has."""
        try:
            _lock(file, msvcrt.LK_NBLCK)
        except OSError:
            return False
        return True

else:
    import fcntl

    def lock(file: int) -> None:
        """Lock an open file; raises OSError where that cannot be."""
        fcntl.flock(file, fcntl.LOCK_EX)

    def try_lock(file: int) -> bool:
        """Whether an open file could be locked, because no other process has."""
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True
