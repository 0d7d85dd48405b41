"""Signals that a process keeps from the processes that it starts."""

from __future__ import annotations

import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker


@contextmanager
def signals_wait(*which: signal.Signals) -> Iterator[None]:
    """Let signals wait, and never reach processes and threads that begin meanwhile.

    A terminal sends Ctrl+C to all processes of a command, but the first one decides what happens.

    Args:
        which: the signals. On Windows, they are not held back.
    """
    if sys.platform == "win32":
        yield
        return
    resource_tracker.ensure_running()  # beginning later, it would let Ctrl+C through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, which)  # processes inherit it
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
