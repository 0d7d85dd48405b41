"""Runs slow work in the background."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, TypeVar

from PySide6.QtCore import QObject, Qt, Signal

Result = TypeVar("Result")


class Background(QObject):
    """Runs functions in threads, and delivers their results in the GUI thread."""

    _finished = Signal(object, object, object)  # done, failed, future

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._pool = ThreadPoolExecutor(max_workers=2, thread_name_prefix="faceedit")
        self._closed = False
        self._finished.connect(self._deliver, Qt.ConnectionType.QueuedConnection)

    def run(
        self,
        work: Callable[[], Result],
        done: Callable[[Result], None],
        failed: Callable[[Exception], None],
    ) -> None:
        """Call `work` in a thread, then `done` or `failed` in the GUI thread."""

        def report(future: Future[Result]) -> None:
            with contextlib.suppress(RuntimeError):  # the window was just closed
                if not self._closed:
                    self._finished.emit(done, failed, future)

        self._pool.submit(work).add_done_callback(report)

    def _deliver(self, done: Any, failed: Any, future: Future[Any]) -> None:
        if self._closed:
            return
        error = future.exception()
        if error is None:
            done(future.result())
        elif isinstance(error, Exception):
            failed(error)

    def close(self) -> None:
        """Deliver nothing any more; forget what is still running."""
        self._closed = True
        self._pool.shutdown(wait=False, cancel_futures=True)
