"""Feed damaged files to every reader: each is read rightly or refused in one line."""

from __future__ import annotations

import multiprocessing
import os
import random
import shutil
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path

from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.texts import LONGEST
from faceedit_app.lab.attacks.mutation import mutated
from faceedit_app.lab.attacks.readers import Reader, all_readers, readers_of
from faceedit_app.lab.attacks.watchdog import PATIENCE, Watchdog

SLOWEST = 5.0  # seconds of processor time for one small file
_SILENCE = 1800.0  # seconds without a word from the readers' process: it has to be stuck as a whole
_MEMORY = 6 << 30  # bytes of address space that the readers' process may have
_BATCH = 500  # inputs of one process


@dataclass(frozen=True)
class Failure:
    """An input that a reader did not cope with.

    Attributes:
        number: of the input; the same seed and number make it again.
        reader: what was read.
        problem: what went wrong, one line.
        path: a copy of the input.
    """

    number: int
    reader: str
    problem: str
    path: Path


@dataclass
class Findings:
    """What an attack found.

    Attributes:
        read, refused: how many inputs each reader read, and refused, by its name.
    """

    read: Counter[str] = field(default_factory=Counter)
    refused: Counter[str] = field(default_factory=Counter)
    failures: list[Failure] = field(default_factory=list)

    def lines(self) -> list[str]:
        """A line for each reader, then one for each failure."""
        names = sorted(self.read | self.refused)
        counts = [f"{n}: {self.read[n]} read, {self.refused[n]} refused" for n in names]
        wrong = [f"input {f.number} ({f.reader}): {f.problem}: {f.path}" for f in self.failures]
        return [*counts, *wrong]


def fuzz(
    inputs: int,
    seed: int,
    keep: Path,
    samples: Sequence[Path] = (),
    advance: Callable[[int], None] = lambda done: None,
) -> Findings:
    """Damage valid files at random, and read them in a process of its own.

    Args:
        inputs: how many.
        seed: the same seed makes the same inputs.
        keep: the folder for inputs that a reader did not cope with.
        samples: further valid files.
        advance: called with the number of inputs done.
    """
    findings = Findings()
    spawn = multiprocessing.get_context("spawn")
    done = 0
    while done < inputs:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            ours, theirs = spawn.Pipe(duplex=False)
            count = min(_BATCH, inputs - done)
            job = (theirs, folder, keep, seed, done, count, tuple(samples))
            worker = spawn.Process(target=_work, args=job)
            worker.start()
            theirs.close()
            done = _listen(ours, done, findings, folder, keep, advance)
            worker.kill()
            worker.join()
    return findings


def _listen(
    pipe: Connection,
    done: int,
    findings: Findings,
    folder: Path,
    keep: Path,
    advance: Callable[[int], None],
) -> int:
    """Collect the results of a worker until it ends; returns the number of the next input."""
    reader, number = "start", done
    while True:
        try:
            if not pipe.poll(_SILENCE):
                _fail(findings, number, reader, f"hangs for {_SILENCE:.0f} s", folder, keep)
                return number + 1
            message = pipe.recv()
        except EOFError:  # the worker has ended, or died
            if number < done:
                return done
            _fail(findings, number, reader, "ends the program", folder, keep)
            return number + 1
        match message:
            case ("begin", int(number), str(reader)):
                pass
            case ("hang",):
                _fail(findings, number, reader, f"hangs for {PATIENCE:.0f} s", folder, keep)
                return number + 1
            case ("end", "read" | "refused" as result):
                getattr(findings, result)[reader] += 1
                done = number + 1
                advance(done)
            case ("wrong", str(problem), Path() as path):
                findings.failures.append(Failure(number, reader, problem, path))
                done = number + 1
                advance(done)


def _fail(
    findings: Findings, number: int, reader: str, problem: str, folder: Path, keep: Path
) -> None:
    """Note that the worker is at its end, with a copy of the input that it was reading."""
    inputs = sorted(folder.glob("inputs/*"))
    if not inputs:
        raise RuntimeError("the readers cannot be started")
    copy = _kept(inputs[0], number, reader, keep)
    findings.failures.append(Failure(number, reader, problem, copy))


def _kept(path: Path, number: int, reader: str, keep: Path) -> Path:
    """A copy of an input."""
    keep.mkdir(parents=True, exist_ok=True)
    copy = keep / f"fuzz_{number}_{reader}{path.suffix}"
    shutil.copy(path, copy)
    return copy


def _work(
    pipe: Connection,
    folder: Path,
    keep: Path,
    seed: int,
    first: int,
    count: int,
    samples: Sequence[Path],
) -> None:
    """Read inputs one after the other, and report each (in a process of its own)."""
    _limit_memory()
    warnings.simplefilter("ignore")  # a library's, about files that it then refuses
    readers = [*all_readers(folder), *(r for path in samples for r in readers_of(path))]
    inputs = folder / "inputs"
    for reader in readers if first == 0 else ():
        inputs.mkdir(exist_ok=True)
        path = inputs / f"input{reader.ending}"
        path.write_bytes(reader.content)
        if _result(reader, path) != "read":  # damaged copies of it would be no test
            copy = _kept(path, -1, reader.name, keep)
            pipe.send(("begin", -1, reader.name))
            pipe.send(("wrong", "the undamaged file is not read", copy))
    number = first

    def hangs(code: int) -> None:
        pipe.send(("hang",))
        os._exit(code)

    with Watchdog(lambda: f"input {number}", end=hangs) as dog:
        for number in range(first, first + count):
            chance = random.Random(f"{seed} {number}")
            reader = readers[number % len(readers)]
            shutil.rmtree(inputs, ignore_errors=True)
            inputs.mkdir()
            path = inputs / f"input{reader.ending}"
            path.write_bytes(mutated(reader.content, chance))
            pipe.send(("begin", number, reader.name))
            result = _result(reader, path)
            if result in ("read", "refused"):
                pipe.send(("end", result))
            else:
                pipe.send(("wrong", result, _kept(path, number, reader.name, keep)))
            dog.step()


def _result(reader: Reader, path: Path) -> str:
    """`read`, `refused`, or what is wrong."""
    began, result = time.process_time(), "read"
    try:
        reader.read(path)
    except FaceEditError as error:
        result = "refused"
        if len(str(error)) > LONGEST or not str(error).isprintable():
            return f"its error is not one line of up to {LONGEST} characters"
    except Exception as error:  # what an attack is looking for
        return f"{type(error).__name__}: {str(error)[:100]!r}"
    took = time.process_time() - began
    return result if took < SLOWEST else f"takes {took:.0f} s"


def _limit_memory() -> None:
    """Let a reader that asks for too much memory fail rather than the computer."""
    try:
        import resource
    except ImportError:  # Windows
        return
    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
