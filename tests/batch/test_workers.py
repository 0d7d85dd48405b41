"""The processes of a batch: one that ends, Ctrl+C, and a cluster that is not there."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from pathlib import Path

import pytest

from faceedit_app.batch import workers
from faceedit_app.batch.recipe import Recipe
from faceedit_app.batch.tasks import Outcome, Task, plan
from faceedit_app.command_line import ctrl_c
from faceedit_app.core.errors import FaceEditError


def test_a_process_that_ends_takes_no_other_take_with_it(
    takes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, models: str
) -> None:
    monkeypatch.setattr(workers, "perform", _ends_at_bad)
    tasks, _ = plan(takes, tmp_path / "out", Recipe(models=models))
    found = {one.name: one for one in workers.run_here(tasks, 2)}
    assert set(found) == {"a.csv", "bad.csv", "day 2/b.csv"}
    assert [name for name, one in found.items() if one.error] == ["bad.csv"]
    assert "try this take alone" in found["bad.csv"].error


def test_ctrl_c_ends_all_processes_at_once_and_tidies_up(
    takes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(workers, "perform", _is_stopped)
    (tmp_path / "out").mkdir()
    tasks, _ = plan(takes, tmp_path / "out", Recipe())
    others = multiprocessing.active_children()
    with pytest.raises(KeyboardInterrupt), ctrl_c.heard():
        list(workers.run_here(tasks[:1], 2))
    assert multiprocessing.active_children() == others
    assert not tasks[0].output.exists()


def _is_stopped(task: Task) -> Outcome:
    """Ctrl+C comes in the middle of a task that would never end."""
    try:
        task.output.touch()
        os.kill(os.getppid(), signal.SIGINT)
        threading.Event().wait()
    finally:
        task.output.unlink()
    return Outcome(task.name)


def _ends_at_bad(task: Task) -> Outcome:
    if "bad" in task.name:
        os.kill(os.getpid(), signal.SIGKILL)
    return Outcome(task.name)


def test_a_cluster_that_does_not_answer_is_said_in_one_line(takes: Path, tmp_path: Path) -> None:
    pytest.importorskip("dask.distributed", reason="Dask is not installed")
    tasks, _ = plan(takes, tmp_path / "out", Recipe())
    with pytest.raises(FaceEditError, match="--scheduler nonsense: does not answer"):
        list(workers.run_on_cluster(tasks, "nonsense"))
