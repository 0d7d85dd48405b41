"""Kill the window at random moments: finished gestures and whole files must survive."""

from __future__ import annotations

import json
import queue
import random
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

from faceedit_app.core.errors import FileError
from faceedit_app.core.resources import DEMO_TAKE, shipped
from faceedit_app.editing.files.pending import pending_journals
from faceedit_app.editing.files.project import read_project
from faceedit_app.formats.opening import open_take
from faceedit_app.lab.attacks import victim

_PATIENCE = 600.0  # seconds for a window to start on a busy machine
_LONGEST_WORK = 6.0  # seconds from the first gesture to a kill
_AT_START = 0.25  # of the kills come while the window starts


@dataclass
class Killed:
    """How it went.

    Attributes:
        kills: how many, by when: start, gestures, save, export.
        steps: finished gestures and undos.
        problems: what went wrong, one line each.
    """

    kills: dict[str, int] = field(default_factory=dict)
    steps: int = 0
    problems: list[str] = field(default_factory=list)

    def lines(self) -> list[str]:
        """A summary, then the problems."""
        when = ", ".join(f"{count} in {name}" for name, count in sorted(self.kills.items()))
        return [f"{sum(self.kills.values())} kills ({when}), {self.steps} steps", *self.problems]


@dataclass
class _Known:
    """What the victims have said so far.

    Attributes:
        state: after the last finished step.
        saved: states that were saved as a project or exported, or are being: their journal ends.
        begun: what has begun and not ended: save or export.
    """

    state: str = ""
    saved: set[str] = field(default_factory=set)
    begun: str = ""


def kill(times: int, seed: int, advance: Callable[[int], None] = lambda done: None) -> Killed:
    """Kill a window again and again; each start recovers what the last one has left.

    Args:
        times: how often.
        seed: the same seed makes the same gestures; the moments depend on the machine.
        advance: called with the number of kills done.
    """
    killed, chance = Killed(), random.Random(seed)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copy(shipped(DEMO_TAKE), folder / "take.csv")
        known = _Known()
        for number in range(times):
            _one(folder, seed + number, chance, known, killed)
            _check(folder, known, killed)
            advance(number + 1)
            if killed.problems:
                break
    return killed


def _one(folder: Path, seed: int, chance: random.Random, known: _Known, killed: Killed) -> None:
    """Start a victim, and kill it at a random moment."""
    command = [sys.executable, "-m", victim.__name__, str(folder), str(seed)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout is not None
    said: queue.Queue[dict[str, Any] | None] = queue.Queue()
    reader = threading.Thread(target=_read, args=(process.stdout, said), daemon=True)
    reader.start()
    at_start = chance.random() < _AT_START
    moment = time.monotonic() + (chance.uniform(0.0, 3.0) if at_start else _PATIENCE)
    is_ready, ended = False, False
    while (left := moment - time.monotonic()) > 0:
        try:
            line = said.get(timeout=left)
        except queue.Empty:
            break
        if line is None:
            ended = True
            break
        if line.get("did") in ("open", "recover") and not at_start:
            is_ready = True
            moment = time.monotonic() + chance.uniform(0.0, _LONGEST_WORK)
        _note(line, known, killed)
    process.kill()
    errors = process.communicate()[1]
    reader.join(10)
    while not said.empty():
        line = said.get()
        if line is not None:
            _note(line, known, killed)
    when = "start" if at_start else known.begun or "gestures"
    killed.kills[when] = killed.kills.get(when, 0) + 1
    if ended or not (is_ready or at_start):
        last = errors.strip().splitlines()[-1:] or ["no error"]
        killed.problems.append(f"the window ended by itself, or did not start: {last[0][:200]}")


def _read(stream: IO[str], said: queue.Queue[dict[str, Any] | None]) -> None:
    for line in stream:
        if line.startswith("{") and line.endswith("}\n"):
            said.put(json.loads(line))
    said.put(None)


def _note(line: dict[str, Any], known: _Known, killed: Killed) -> None:
    match line:
        case {"starts": True}:
            known.begun = ""
        case {"did": "recover", "state": str(state)} if known.state and state != known.state:
            killed.problems.append("a start has not recovered the last finished gesture")
        case {"did": "open", "state": str(state)}:
            known.state = state
            known.saved.add(state)  # nothing was to be recovered
        case {"did": "step", "state": str(state)}:
            known.state = state
            killed.steps += 1
        case {"begins": str(what), "state": str(state)}:
            known.begun = what
            known.saved.add(state)
        case {"did": "save" | "export"}:
            known.begun = ""


def _check(folder: Path, known: _Known, killed: Killed) -> None:
    """What is on the disk after a kill: the last finished gesture, and whole files."""
    pending = pending_journals(folder / "journals")
    if len(pending) > 1:
        killed.problems.append(f"{len(pending)} sessions are offered for recovery")
    states = _last_states(pending[0].path) if pending else []
    if not states and known.state not in {"", *known.saved}:
        killed.problems.append("the last finished gesture is lost")
    if states and known.state not in ("", *states):
        killed.problems.append("the journal does not hold the last finished gesture")
    known.state = states[-1] if states else known.state
    for name, read in ((victim.PROJECT, read_project), (victim.EXPORTED, open_take)):
        path = folder / name
        try:
            if path.exists():
                read(path)
        except FileError as error:
            killed.problems.append(f"a file was left half written: {error}")
    if (folder / "take.csv").read_bytes() != shipped(DEMO_TAKE).read_bytes():
        killed.problems.append("the take was changed")


def _last_states(journal: Path) -> list[str]:
    """The last two states in a journal: a gesture may be written before the victim says so."""
    content = journal.read_bytes()
    shorter = content[: content[:-1].rfind(b"\n") + 1]
    found = []
    for part in (shorter, content):
        with tempfile.TemporaryDirectory() as name:
            (Path(name) / journal.name).write_bytes(part)
            found += [victim.state_of(pending.state) for pending in pending_journals(Path(name))]
    return found
