"""Ctrl+C in a command."""

from __future__ import annotations

import _thread
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

_AGAIN = 0.05  # seconds


@contextmanager
def heard() -> Iterator[None]:
    """Raise KeyboardInterrupt at Ctrl+C, also while libraries are imported.

    Some libraries, such as trimesh, take any exception in their imports for a missing part, and go
    on without it. An interrupt that comes then is therefore raised again until it is heard here.
    """
    if threading.current_thread() is not threading.main_thread():  # only that one can hear it
        yield
        return
    is_over = threading.Event()

    def stop(_signal: int, frame: FrameType | None) -> None:
        if is_over.is_set():
            return
        if _is_importing(frame) or repeated:
            repeated.append(threading.Timer(_AGAIN, again))
            repeated[-1].daemon = True
            repeated[-1].start()
        if not isinstance(sys.exc_info()[1], KeyboardInterrupt):  # else it is on its way
            raise KeyboardInterrupt

    def again() -> None:
        if is_over.is_set():
            return
        if sys.platform == "win32":  # where os.kill ends the process
            _thread.interrupt_main()
        else:
            os.kill(os.getpid(), signal.SIGINT)

    repeated: list[threading.Timer] = []
    before = signal.signal(signal.SIGINT, stop)
    try:
        yield
    finally:
        is_over.set()
        for timer in repeated:
            timer.join()
        signal.signal(signal.SIGINT, before)


@contextmanager
def taken_as_request() -> Iterator[Callable[[], bool]]:
    """Take Ctrl+C, or SIGTERM, as a request to end soon; a second Ctrl+C ends the command at once.

    A second SIGTERM does not: some programs send it to the command, and to its process group.

    Yields:
        What says whether there was such a request.
    """
    asked = threading.Event()
    if threading.current_thread() is not threading.main_thread():  # only that one can hear it
        yield asked.is_set
        return
    before = {which: signal.getsignal(which) for which in (signal.SIGINT, signal.SIGTERM)}

    def ask(_signal: int, _frame: FrameType | None) -> None:
        asked.set()
        signal.signal(signal.SIGINT, before[signal.SIGINT])

    for which in before:
        signal.signal(which, ask)
    try:
        yield asked.is_set
    finally:
        for which, handler in before.items():
            signal.signal(which, handler)


def _is_importing(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False
