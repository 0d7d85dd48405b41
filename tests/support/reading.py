"""A process that reads inputs without any reader: one input kills it, and one stops it."""

from __future__ import annotations

import os
from multiprocessing.connection import Connection
from pathlib import Path

from faceedit_app.lab.attacks.fuzz_job import READ, REFUSED, Job, Result

DEADLY, ENDLESS = 7, 11


def pretended(pipe: Connection, job: Job, folder: Path) -> None:
    """As `fuzz_process.read_inputs`."""
    pipe.send(["takes", "edits"])
    inputs = folder / "inputs"
    inputs.mkdir()
    while True:
        try:
            numbers: range = pipe.recv()
        except EOFError:
            return
        for number in numbers:
            (inputs / "input.csv").write_text(f"{job.seed} {number}")
            if number == DEADLY:
                os._exit(3)
            while number == ENDLESS:
                pass
            pipe.send(Result(number, "takes", READ if number % 3 else REFUSED))
