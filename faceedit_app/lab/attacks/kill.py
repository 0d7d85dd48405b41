"""Kill the window at random moments: finished gestures and whole files must survive."""

from __future__ import annotations

import os
import signal
import tempfile
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from pathlib import Path

from faceedit_app.core.signals import signals_wait
from faceedit_app.lab.attacks.kill_series import Killed, Series

_LONGEST = 20  # kills in a series
_LOOKS = 0.2  # seconds between two looks at the series


def kill(
    times: int,
    seed: int,
    advance: Callable[[int], None] = lambda done: None,
    jobs: int | None = None,
    seconds: float | None = None,
    is_stopped: Callable[[], bool] = lambda: False,
) -> Killed:
    """Kill a window again and again, in series of twenty.

    Args:
        times: how often.
        seed: the same seed makes the same gestures, and kills after as many of them, however many
            windows there are at once; at which instruction depends on the machine.
        advance: called with the number of kills done.
        jobs: how many windows at once; None = one for each processor.
        seconds: after these, no further window is started; None = all are.
        is_stopped: whether to end at once; kills that are under way do not count.
    """
    parts = [range(at, min(at + _LONGEST, times)) for at in range(0, times, _LONGEST)]
    until = time.monotonic() + seconds if seconds is not None else None
    is_over, killed = threading.Event(), Killed()

    def work(series: Series, numbers: range) -> None:
        for number in numbers:
            is_late = until is not None and time.monotonic() > until
            if is_late or is_over.is_set() or series.killed.problems:
                return
            series.kill(f"{seed} {number}", is_over.is_set)

    with (
        tempfile.TemporaryDirectory() as name,
        ThreadPoolExecutor(min(jobs or os.cpu_count() or 1, len(parts))) as pool,
    ):
        all_series = [Series(_new_folder(Path(name), part)) for part in parts]
        with signals_wait(signal.SIGINT, signal.SIGTERM):  # windows end when they are killed
            working = [pool.submit(work, *both) for both in zip(all_series, parts, strict=True)]
        try:
            while wait(working, _LOOKS).not_done:
                advance(sum(series.done for series in all_series))
                if is_stopped() or any(series.killed.problems for series in all_series):
                    is_over.set()
        finally:
            is_over.set()
        for future, series in zip(working, all_series, strict=True):
            future.result()
            killed.add(series.killed)
    return killed


def _new_folder(parent: Path, numbers: range) -> Path:
    folder = parent / str(numbers.start)
    folder.mkdir()
    return folder
