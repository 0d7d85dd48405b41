"""A training that several processes share, and one that cannot begin."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from datetime import timedelta
from pathlib import Path

import pytest
from support.performances import folder_of_takes, smallest

from faceedit_app.cli import main
from faceedit_app.lab.training.processes import Processes, processes
from faceedit_app.lab.training.settings import RECIPES

# `faceedit` with small networks, and graphs that the test has exported.
SCRIPT = """
import sys
from pathlib import Path
from support.graphs import kept_in
from support.performances import smallest
from faceedit_app.cli import main
from faceedit_app.lab.training import export, run
export._template = kept_in(Path(sys.argv[1]))
run.RECIPES = {name: smallest(name) for name in run.RECIPES}
sys.exit(main(sys.argv[2:]))
"""


def free_port() -> int:
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return int(listener.getsockname()[1])


@pytest.mark.timeout(400)  # one more interpreter imports torch
def test_two_processes_give_the_same_networks_and_figures_as_one(
    tmp_path: Path, graphs: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    takes = folder_of_takes(tmp_path / "someone", seconds=14.0)
    alone, shared = (tmp_path / name / "models" for name in ("alone", "shared"))
    train = ["train", "--data", str(takes), "--epochs", "1", "--no-baseline", "-o"]
    small = {name: smallest(name) for name in RECIPES}
    monkeypatch.setattr("faceedit_app.lab.training.run.RECIPES", small)
    assert main([*train, str(alone)]) == 0
    monkeypatch.setattr("faceedit_app.lab.training.processes._PATIENCE", timedelta(minutes=3))
    # What `torchrun` tells each process; this one is the first, which spares importing torch twice.
    told = {"TORCHELASTIC_RUN_ID": "test", "WORLD_SIZE": "2", "MASTER_ADDR": "127.0.0.1"}
    told |= {"MASTER_PORT": str(free_port())}
    for name, value in (told | {"RANK": "0"}).items():
        monkeypatch.setenv(name, value)
    script = tmp_path / "small.py"
    script.write_text(SCRIPT)
    tests = Path(__file__).parents[1]
    paths = [str(tests.parent), str(tests), os.environ.get("PYTHONPATH", "")]
    second = subprocess.Popen(
        [sys.executable, str(script), str(graphs), *train, str(shared)],
        env=os.environ | told | {"RANK": "1", "PYTHONPATH": os.pathsep.join(paths)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert main([*train, str(shared)]) == 0
        _, said = second.communicate(timeout=200)
    finally:
        second.kill()
    assert second.returncode == 0, said
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
