"""A training that several processes share, and one that cannot begin."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from support.performances import folder_of_takes

from faceedit_app.cli import main
from faceedit_app.lab.training.processes import Processes, processes


@pytest.mark.timeout(600)  # three interpreters import torch
def test_two_processes_give_the_same_networks_and_figures_as_one(tmp_path: Path) -> None:
    takes = folder_of_takes(tmp_path / "someone", seconds=14.0)
    alone, shared = (tmp_path / name / "models" for name in ("alone", "shared"))
    train = ["train", "--data", str(takes), "--epochs", "1", "--no-baseline", "-o"]
    assert main([*train, str(alone)]) == 0
    torchrun = [sys.executable, "-m", "torch.distributed.run", "--standalone"]
    command = [*torchrun, "--nproc-per-node", "2", "-m", "faceedit_app", *train, str(shared)]
    root = Path(__file__).parents[2]
    path = os.pathsep.join([str(root), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        command, env=os.environ | {"PYTHONPATH": path}, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr
    written = sorted(file.relative_to(alone) for file in alone.rglob("*") if file.is_file())
    assert len(written) == 6
    for file in written:
        assert (shared / file).read_bytes() == (alone / file).read_bytes(), file
    assert not (shared / "checkpoint").exists()


def test_without_torchrun_there_is_one_process() -> None:
    with processes() as alone:
        assert alone == Processes(0, 1)
        assert all(alone.takes(job) for job in range(6))
        assert alone.gather("all") == ["all"]


@pytest.mark.parametrize("count", [1, 2, 3, 6, 8])
def test_each_job_belongs_to_one_process(count: int) -> None:
    everyone = [Processes(number, count) for number in range(count)]
    assert all(sum(one.takes(job) for one in everyone) == 1 for job in range(6))


def test_a_training_without_takes_leaves_no_folder(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "models"
    missing = str(tmp_path / "missing")
    assert main(["train", "--data", missing, "-o", str(output), "--fresh"]) != 0
    assert missing in capsys.readouterr().err
    assert not output.exists()
