"""Read damaged files one after the other, in a process that may hang or die of them."""

from __future__ import annotations

import faulthandler
import os
import random
import shutil
import sys
import time
import warnings
from collections.abc import Sequence
from multiprocessing.connection import Connection
from pathlib import Path

from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.texts import LONGEST
from faceedit_app.lab.attacks.fuzz_job import READ, REFUSED, UNDAMAGED, Job, Result
from faceedit_app.lab.attacks.mutation import mutated
from faceedit_app.lab.attacks.reader import Reader
from faceedit_app.lab.attacks.readers import all_readers, readers_of

SLOWEST = 5.0  # seconds of processor time for one small file
MOST_MEMORY = 512  # MB that one small file may take
_MEMORY = 6 << 30  # bytes of address space that the process may have


def read_inputs(pipe: Connection, job: Job, folder: Path) -> None:
    """Read inputs until the pipe closes (the whole life of the process).

    It sends the names of the readers first. Then it receives ranges of numbers of inputs, and sends
    the `Result` of each input.

    Args:
        pipe: to the attack.
        job: what to do.
        folder: where inputs are written; the attack finds in `inputs` the one that is being read.
    """
    faulthandler.enable()
    _limit_memory()
    warnings.simplefilter("ignore")  # a library's, about files that it then refuses
    readers = [*all_readers(folder), *(r for path in job.samples for r in readers_of(path))]
    inputs = folder / "inputs"
    inputs.mkdir()
    pipe.send([reader.name for reader in readers])
    while True:
        try:
            numbers: range = pipe.recv()
        except EOFError:
            return
        if numbers.start == 0:
            _check_undamaged(readers, pipe, job, inputs)
        for number in numbers:
            reader = readers[number % len(readers)]
            content = mutated(reader.content, random.Random(f"{job.seed} {number}"))
            path = _written(inputs, reader, content)
            outcome = outcome_of(reader, path)
            is_wrong = outcome not in (READ, REFUSED)
            copy = job.kept(path, number, reader.name) if is_wrong else None
            pipe.send(Result(number, reader.name, outcome, copy))


def _check_undamaged(readers: Sequence[Reader], pipe: Connection, job: Job, inputs: Path) -> None:
    """Report the valid files that are not read: damaged copies of them would be no test."""
    for reader in readers:
        path = _written(inputs, reader, reader.content)
        if outcome_of(reader, path) != READ:
            copy = job.kept(path, UNDAMAGED, reader.name)
            pipe.send(Result(UNDAMAGED, reader.name, "the undamaged file is not read", copy))


def _written(inputs: Path, reader: Reader, content: bytes) -> Path:
    """The file of an input, alone in its folder."""
    for entry in os.scandir(inputs):
        if entry.is_dir(follow_symlinks=False):
            shutil.rmtree(entry.path)
        else:
            os.unlink(entry.path)
    path = inputs / f"input{reader.ending}"
    path.write_bytes(content)
    return path


def outcome_of(reader: Reader, path: Path) -> str:
    """`READ`, `REFUSED`, or what is wrong."""
    began, memory, outcome = time.process_time(), _peak(), READ
    try:
        reader.read(path)
    except FaceEditError as error:
        outcome = REFUSED
        if len(str(error)) > LONGEST or not str(error).isprintable():
            return f"its error is not one line of up to {LONGEST} characters"
        if path.stem not in str(error):
            return f"its error does not name the file: {str(error)[:100]!r}"
    except Exception as error:  # what an attack is looking for
        return f"{type(error).__name__}: {str(error)[:100]!r}"
    took, more = time.process_time() - began, _peak() - memory
    if took > SLOWEST:
        return f"takes {took:.0f} s"
    return f"takes {more:.0f} MB" if more > MOST_MEMORY else outcome


def _peak() -> float:
    """The most memory that this process has used, MB; 0 if it is not known."""
    try:
        import resource
    except ImportError:  # Windows
        return 0.0
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1 << 20 if sys.platform == "darwin" else 1 << 10)


def _limit_memory() -> None:
    """Let a reader that asks for too much memory fail rather than the computer."""
    try:
        import resource
    except ImportError:  # Windows
        return
    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
