"""Processes that read damaged files, watched from outside."""

from __future__ import annotations

import os
import shutil
import signal
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path

from faceedit_app.core.signals import signals_wait
from faceedit_app.lab.attacks.fuzz_job import Job, Result

PATIENCE = 60.0  # seconds of processor time without a result, after which a process hangs
SILENCE = 1800.0  # seconds by the clock; then it waits for something that does not come
LOOKS = 1.0  # seconds between two looks at a process
_RENEWED = 20_000  # inputs of one process: what a library leaks must not add up
_GOODBYE = 10.0  # seconds for a process that hangs to print where


@dataclass(frozen=True)
class _Look:
    """How far a process was when it last had a new result.

    Attributes:
        did: its results.
        spent: its processor time, seconds.
        when: the time of the clock, seconds.
    """

    did: int
    spent: float
    when: float


class ReadingProcess:
    """A process that reads inputs; if it dies of one, another goes on with the next.

    Args:
        job: what to do.
        folder: its own.

    Attributes:
        pipe: to the process.
        numbers: the inputs that it still has to read; it is at the first of them.
    """

    def __init__(self, job: Job, folder: Path) -> None:
        self._job, self._home, self._lives = job, folder, 0
        self.numbers = range(0)
        self._start()

    def _start(self) -> None:
        """Start a process, which goes on where the one before it has ended."""
        self._lives += 1
        self._folder = self._home / str(self._lives)
        self._folder.mkdir(parents=True)
        spawn = get_context("spawn")
        self.pipe, theirs = spawn.Pipe()
        self._process = spawn.Process(target=_read, args=(theirs, self._job, self._folder))
        with signals_wait(signal.SIGINT, signal.SIGTERM):  # the attack ends it
            self._process.start()
        theirs.close()
        self._readers: list[str] = []  # their names, once it is ready
        self._did = 0
        self._next_look, self._last = 0.0, _Look(-1, 0.0, 0.0)
        if self.numbers:
            self.pipe.send(self.numbers)

    def give(self, blocks: Iterator[range]) -> bool:
        """Let it read the next block, if there is one; it must have read what it had."""
        self.numbers = next(blocks, range(0))
        if not self.numbers:
            return False
        if self._did >= _RENEWED:
            self.end()
            self._start()
            return True
        with suppress(OSError):  # it has died, which `listen` will notice
            self.pipe.send(self.numbers)
        return True

    def listen(self) -> Result | None:
        """What it says next, or that it has died; None if that is no result.

        Raises:
            RuntimeError: it has died before it could read anything.
        """
        try:
            message = self.pipe.recv()
        except (EOFError, OSError):
            return self._lost("ends the program")
        if not isinstance(message, Result):
            self._readers = message
            return None
        self._did += 1
        if message.is_damaged:
            self.numbers = self.numbers[1:]
        return message

    def look(self) -> Result | None:
        """End it if it hangs; returns what that means for the input that it was reading.

        Raises:
            RuntimeError: it hangs before it can read anything.
        """
        now = time.monotonic()
        if now < self._next_look or not self.numbers:
            return None
        self._next_look = now + LOOKS
        spent, last = _spent(self._process.pid), self._last
        if self._did != last.did:
            self._last = _Look(self._did, spent, now)
            return None
        if spent - last.spent < PATIENCE and now - last.when < SILENCE:
            return None
        if self._process.pid is not None and hasattr(signal, "SIGABRT"):
            os.kill(self._process.pid, signal.SIGABRT)  # it prints the stacks of its threads
            self._process.join(_GOODBYE)
        return self._lost(f"hangs for {max(spent - last.spent, 0.0):.0f} s of processor time")

    def _lost(self, problem: str) -> Result | None:
        """The process has died of the input that it was reading; another one goes on."""
        if not self._readers:
            raise RuntimeError("the readers cannot be started")
        number, self.numbers = self.numbers[0], self.numbers[1:]
        reader = self._readers[number % len(self._readers)]
        path = next((self._folder / "inputs").glob("input*"), None)
        copy = None if path is None else self._job.kept(path, number, reader)
        self.end()
        self._start()
        return Result(number, reader, problem, copy)

    def end(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.join()
        self._process.close()
        self.pipe.close()
        shutil.rmtree(self._folder, ignore_errors=True)


def _read(pipe: Connection, job: Job, folder: Path) -> None:
    """The life of a process; only there are the readers imported."""
    from faceedit_app.lab.attacks.fuzz_process import read_inputs

    read_inputs(pipe, job, folder)


def _spent(pid: int | None) -> float:
    """The processor time of a process, seconds; 0 if it is not known."""
    try:
        text = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8", errors="replace")
        user, system = text.rpartition(")")[2].split()[11:13]
        return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")
    except (OSError, ValueError):  # it has ended, or the system is not Linux
        return 0.0
