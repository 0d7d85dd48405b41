"""Ends an attack that hangs, and says where it was."""

from __future__ import annotations

import faulthandler
import os
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import IO

PATIENCE = 60.0  # seconds for one step, in which the process could run
_SURELY = (
    1800.0  # seconds by the clock; then a thread that keeps Python's lock has to be what hangs
)
_LOOKS = 1.0  # seconds between two looks
_LATEST = 2.0  # seconds after the last look; a later one comes because the process was stopped


class Watchdog:
    """Ends the process with exit code 1 and the stacks of all threads if no step ends for a while.

    Use it in a `with` statement in the thread that it watches, and call `step` after each step.

    Args:
        doing: what the attack was doing, for the message; called in another thread.
        patience: seconds for one step.
        end: called with the exit code after the message.
        stream: for the message; it has a file descriptor.
    """

    def __init__(
        self,
        doing: Callable[[], str],
        patience: float = PATIENCE,
        end: Callable[[int], object] = os._exit,
        stream: IO[str] | None = None,
    ) -> None:
        self._doing, self._patience, self._end = doing, patience, end
        self._stream = sys.__stderr__ if stream is None else stream
        self._native = threading.get_native_id()
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="watchdog", daemon=True)
        self._passed = 0.0  # seconds of this step

    def __enter__(self) -> Watchdog:
        self.step()
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._stopped.set()
        self._thread.join()
        faulthandler.cancel_dump_traceback_later()

    def step(self) -> None:
        """A step has ended."""
        self._passed = 0.0
        if self._stream is not None:
            faulthandler.dump_traceback_later(_SURELY, exit=True, file=self._stream)

    def _watch(self) -> None:
        """Look again and again whether the step still ends in time (in a thread of its own)."""
        before = self._now()
        while not self._stopped.wait(min(_LOOKS, self._patience / 4)):
            now = self._now()
            self._passed += min(now - before, _LATEST)
            before = now
            if self._passed > self._patience:
                self._report()
                self._end(1)
                return

    def _report(self) -> None:
        """Print what hangs."""
        if self._stream is not None:
            hangs = f"No step has ended for {self._patience:.0f} s: {self._doing()}"
            print(hangs, file=self._stream, flush=True)
            faulthandler.dump_traceback(self._stream, all_threads=True)

    def _now(self) -> float:
        """The time in seconds, without what the watched thread has waited for a free processor."""
        return time.monotonic() - _waited(self._native)


def _waited(native: int) -> float:
    """The seconds that a thread was ready to run, but others had the processor; 0 if unknown."""
    try:
        text = Path(f"/proc/self/task/{native}/schedstat").read_text(encoding="ascii")
        return int(text.split()[1]) / 1e9
    except (OSError, IndexError, ValueError):  # not Linux
        return 0.0
