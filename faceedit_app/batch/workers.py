"""Do the tasks of a batch: one by one, in several processes, or on a cluster."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager
from types import FrameType

from faceedit_app.batch.log import Log, to_do
from faceedit_app.batch.tasks import Outcome, Task, perform
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.optional import require
from faceedit_app.core.signals import signals_wait

_LOST = "the process that worked on it ended; try this take alone"


def run_here(tasks: list[Task], jobs: int) -> Generator[Outcome]:
    """Do the tasks in `jobs` processes of this computer; outcomes as they come.

    If it is closed, or at Ctrl+C, the processes end at once; what they had not written is not
    written.
    """
    if jobs <= 1:
        yield from map(perform, tasks)
        return
    broken: list[Task] = []
    with _working(tasks, jobs) as waiting:
        for future in as_completed(waiting):
            try:
                yield future.result()
            except BrokenProcessPool:
                broken.append(waiting[future])
    for task in broken:  # one of them ended its process, and the others with it: each alone now
        with _working([task], 1) as waiting:
            try:
                yield next(iter(waiting)).result()
            except BrokenProcessPool:
                yield Outcome(task.name, f"{task.source}: {_LOST}")


@contextmanager
def _working(tasks: list[Task], jobs: int) -> Iterator[dict[Future[Outcome], Task]]:
    """The outcomes to come, from processes that end with the block, at once after an exception."""
    # Not by fork: the parent has threads of numpy and ONNX Runtime.
    context = multiprocessing.get_context("spawn")
    others = set(multiprocessing.active_children())
    with ProcessPoolExecutor(jobs, context, initializer=_end_when_asked) as pool:
        try:
            with signals_wait(signal.SIGINT):  # the parent ends them
                waiting = {pool.submit(_work, perform, task): task for task in tasks}
            yield waiting
        except BaseException:
            for process in set(multiprocessing.active_children()) - others:
                process.terminate()
            pool.shutdown(cancel_futures=True)
            raise


class _End(SystemExit):
    """The parent ends this process."""


def _end_when_asked() -> None:
    """In a process of a batch: end when the parent says so, and tidy up first."""

    def end(_signal: int, _frame: FrameType | None) -> None:
        raise _End

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, end)


def _work(do: Callable[[Task], Outcome], task: Task) -> Outcome:
    """Do a task in a process of a batch."""
    try:
        return do(task)
    except _End:  # the pool would go on with the next task
        os._exit(0)


def run_on_cluster(tasks: list[Task], scheduler: str) -> Generator[Outcome]:
    """Do the tasks on a Dask cluster whose workers see the same folders; outcomes as they come.

    Dask gives the task of a lost worker to another one. Writing is atomic and gives the same bytes,
    so a task that was done but not reported may be done again without harm.

    Raises:
        Unavailable: Dask is not installed.
        FaceEditError: the scheduler does not answer.
    """
    require("dask.distributed", extra="cluster")
    from dask import distributed

    try:
        client = distributed.Client(scheduler, timeout=10)  # type: ignore[no-untyped-call]
    except (OSError, ValueError, TimeoutError) as error:
        raise FaceEditError(f"--scheduler {scheduler}: does not answer ({error})") from error
    with client:
        futures = {client.submit(perform, task, pure=False): task for task in tasks}
        for future in distributed.as_completed(futures):  # type: ignore[no-untyped-call]
            if future.status == "finished":
                yield future.result()
            else:
                yield Outcome(futures[future].name, f"{futures[future].source}: {_LOST}")


def run(
    tasks: list[Task],
    log: Log,
    jobs: int = 1,
    scheduler: str | None = None,
    progress: Callable[[Outcome, int, int], None] = lambda outcome, done, all_: None,
) -> list[Outcome]:
    """Do what is left to do, and return the outcome of every task, in order.

    Args:
        tasks: all of them.
        log: what is done, and gets what will be.
        jobs: how many processes work here.
        scheduler: the address of a Dask scheduler to use instead.
        progress: called with each new outcome, how many there are now, and how many there will be.
    """
    outcomes, left = log.outcomes(), to_do(tasks, log)
    done = len(tasks) - len(left)
    found = run_on_cluster(left, scheduler) if scheduler else run_here(left, jobs)
    with closing(found):  # the processes end before what went wrong is reported
        for outcome in found if left else ():
            log.add(outcome)
            outcomes[outcome.name] = outcome
            done += 1
            progress(outcome, done, len(tasks))
    return [outcomes[task.name] for task in tasks]
