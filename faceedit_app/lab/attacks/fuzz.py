"""Feed damaged files to every reader: each is read rightly or refused in one line."""

from __future__ import annotations

import os
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import chain
from multiprocessing.connection import wait
from pathlib import Path

from faceedit_app.lab.attacks import fuzz_watch
from faceedit_app.lab.attacks.fuzz_job import READ, REFUSED, Job, Result

_BLOCK = 100  # inputs that a process is given at a time


@dataclass
class Findings:
    """What an attack found.

    Attributes:
        read, refused: how many inputs each reader read, and refused, by its name.
        failures: the inputs that a reader did not cope with.
    """

    read: Counter[str] = field(default_factory=Counter)
    refused: Counter[str] = field(default_factory=Counter)
    failures: list[Result] = field(default_factory=list)

    @property
    def inputs(self) -> int:
        """How many damaged files were tried."""
        damaged = sum(failure.is_damaged for failure in self.failures)
        return self.read.total() + self.refused.total() + damaged

    def note(self, result: Result) -> None:
        """Count a result."""
        if result.outcome == READ:
            self.read[result.reader] += 1
        elif result.outcome == REFUSED:
            self.refused[result.reader] += 1
        else:
            self.failures.append(result)

    def lines(self) -> list[str]:
        """A line for each reader, then one for each failure."""
        names = sorted(self.read | self.refused)
        counts = [f"{n}: {self.read[n]} read, {self.refused[n]} refused" for n in names]
        failures = sorted(self.failures, key=lambda failure: failure.number)
        wrong = [f"input {f.number} ({f.reader}): {f.outcome}: {f.path}" for f in failures]
        return [*counts, f"{self.inputs} inputs in all", *wrong]


def fuzz(
    inputs: int,
    seed: int,
    keep: Path,
    samples: Sequence[Path] = (),
    advance: Callable[[int], None] = lambda done: None,
    jobs: int | None = None,
    seconds: float | None = None,
    is_stopped: Callable[[], bool] = lambda: False,
) -> Findings:
    """Damage valid files at random, and read them in processes of their own.

    Args:
        inputs: how many.
        seed: the same seed makes the same inputs, however many processes read them.
        keep: the folder for inputs that a reader did not cope with.
        samples: further valid files.
        advance: called with the number of inputs done.
        jobs: how many processes; None = one for each processor.
        seconds: after these, no further inputs are begun; None = all are tried.
        is_stopped: whether to begin no further inputs, although there is time.
    """
    findings, blocks = Findings(), _blocks(inputs, seconds, is_stopped)
    with tempfile.TemporaryDirectory() as name:
        job = Job(seed, keep.absolute(), tuple(path.absolute() for path in samples))
        count = min(jobs or os.cpu_count() or 1, -(-inputs // _BLOCK))
        team = [fuzz_watch.ReadingProcess(job, Path(name) / str(n)) for n in range(count)]
        try:
            while busy := [one for one in team if one.numbers or one.give(blocks)]:
                ready = set(wait([process.pipe for process in busy], fuzz_watch.LOOKS))
                heard = [process.listen() for process in busy if process.pipe in ready]
                for result in chain(heard, (process.look() for process in busy)):
                    if result is not None:
                        findings.note(result)
                advance(findings.inputs)
        finally:
            for process in team:
                process.end()
    return findings


def _blocks(inputs: int, seconds: float | None, is_stopped: Callable[[], bool]) -> Iterator[range]:
    """The numbers of the inputs, in parts, until the time is over."""
    began = time.monotonic()
    for at in range(0, inputs, _BLOCK):
        if is_stopped() or (seconds is not None and time.monotonic() - began > seconds):
            return
        yield range(at, min(at + _BLOCK, inputs))
