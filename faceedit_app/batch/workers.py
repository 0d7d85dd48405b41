"""Do the tasks of a batch: one by one, in several processes, or on a cluster."""

from __future__ import annotations

import multiprocessing
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool

from faceedit_app.batch.log import Log, to_do
from faceedit_app.batch.tasks import Outcome, Task, perform
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.optional import require

_LOST = "the process that worked on it ended; try this take alone"


def run_here(tasks: list[Task], jobs: int) -> Iterator[Outcome]:
    """Do the tasks in `jobs` processes of this computer; outcomes as they come."""
    if jobs <= 1:
        yield from map(perform, tasks)
        return
    broken: list[Task] = []
    with _pool(jobs) as pool:
        waiting: dict[Future[Outcome], Task] = {pool.submit(perform, task): task for task in tasks}
        try:
            for future in as_completed(waiting):
                try:
                    yield future.result()
                except BrokenProcessPool:
                    broken.append(waiting[future])
        finally:  # at Ctrl+C, what was not begun is not done
            pool.shutdown(cancel_futures=True)
    for task in broken:  # one of them ended its process, and the others with it: each alone now
        with _pool(1) as pool:
            try:
                yield pool.submit(perform, task).result()
            except BrokenProcessPool:
                yield Outcome(task.name, f"{task.source}: {_LOST}")


def _pool(jobs: int) -> ProcessPoolExecutor:
    # Not by fork: the parent has threads of numpy and ONNX Runtime.
    context = multiprocessing.get_context("spawn")
    return ProcessPoolExecutor(jobs, context, initializer=_leave_ctrl_c)


def _leave_ctrl_c() -> None:
    """In a process of a batch: Ctrl+C is for the parent, which ends it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def run_on_cluster(tasks: list[Task], scheduler: str) -> Iterator[Outcome]:
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
    for outcome in found if left else ():
        log.add(outcome)
        outcomes[outcome.name] = outcome
        done += 1
        progress(outcome, done, len(tasks))
    return [outcomes[task.name] for task in tasks]
