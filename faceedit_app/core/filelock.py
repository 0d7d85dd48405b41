"""Locks on open files, which the system releases when the process ends, even by a crash."""

from __future__ import annotations

import os
import sys

if sys.platform == "win32":
    import msvcrt

    _FAR = 1 << 30  # Windows locks bytes against reading: lock one far beyond the content

    def _lock(file: int, mode: int) -> None:
        os.lseek(file, _FAR, os.SEEK_SET)
        msvcrt.locking(file, mode, 1)
        os.lseek(file, 0, os.SEEK_SET)

    def lock(file: int) -> None:
        """Lock an open file; raises OSError if that fails."""
        _lock(file, msvcrt.LK_LOCK)

    def try_lock(file: int) -> bool:
        """Lock an open file unless another process holds the lock; False if it does."""
        try:
            _lock(file, msvcrt.LK_NBLCK)
        except OSError:
            return False
        return True

else:
    import fcntl

    def lock(file: int) -> None:
        """Lock an open file; raises OSError if that fails."""
        fcntl.flock(file, fcntl.LOCK_EX)

    def try_lock(file: int) -> bool:
        """Lock an open file unless another process holds the lock; False if it does."""
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True
