"""Waiting for what is to happen, and never for some time to pass."""

from __future__ import annotations

from threading import Barrier

from PySide6.QtCore import QCoreApplication, QDeadlineTimer, QEventLoop, QObject, QTimer

from faceedit_app.ui.state.background import Background

PATIENCE = 15.0  # seconds, far more than a busy machine needs


def run_events() -> None:
    """Run the event loop until nothing waits in it: layouts, paints, and calls that are queued."""
    for _ in range(2):  # what the first round asks for is done in the second
        loop = QEventLoop()
        QTimer.singleShot(0, loop.quit)  # its turn comes after all events
        loop.exec()


def wait_for_timers(owner: QObject) -> None:
    """Run the event loop until no single-shot timer of an object, or within it, is running."""
    deadline = QDeadlineTimer(round(1000 * PATIENCE))
    while any(t.isActive() and t.isSingleShot() for t in owner.findChildren(QTimer)):
        assert not deadline.hasExpired(), f"a timer of {owner} is started again and again"
        QCoreApplication.processEvents(QEventLoop.ProcessEventsFlag.WaitForMoreEvents)
    run_events()


def wait_for_background(background: Background) -> None:
    """Run the event loop until all that runs in threads so far is done and delivered."""
    threads = background._pool._max_workers
    together = Barrier(threads)  # passed by as many threads as there are: none works on
    passed: list[int] = []
    failed: list[Exception] = []
    for _ in range(threads):
        background.run(lambda: together.wait(PATIENCE), passed.append, failed.append)
    while len(passed) + len(failed) < threads:
        QCoreApplication.processEvents(QEventLoop.ProcessEventsFlag.WaitForMoreEvents)
    assert not failed, "what runs in the background does not end"
