"""A series of kills: windows that are started and killed, one after the other, in one folder."""

from __future__ import annotations

import json
import math
import os
import queue
import random
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
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

_PATIENCE = 600.0  # seconds for a window to start, or to make a gesture, on a busy machine
_MOST_GESTURES = 30  # before a kill in gestures
_NO_WRITE = 60  # gestures without saving or exporting after which a window is killed anyway
_LOOKS = 0.2  # seconds between two looks whether the series is over
_GOODBYE = 10.0  # seconds for the last lines of a window that was killed
_START, _GESTURES, _WRITE = "start", "gestures", "write"
_AIMS = (_START, _GESTURES, _GESTURES, _WRITE)  # when kills come, equally often
_TAKES = {_START: 2.0, _GESTURES: 0.2, "save": 0.03, "export": 0.03}  # seconds, as first guesses

_Line = dict[str, Any]  # what a window says


@dataclass
class Killed:
    """How it went.

    Attributes:
        kills: how many, by what was going on: start, gestures, save, export.
        steps: finished gestures and undos.
        problems: what went wrong, one line each.
    """

    kills: Counter[str] = field(default_factory=Counter)
    steps: int = 0
    problems: list[str] = field(default_factory=list)

    def add(self, other: Killed) -> None:
        """Count what went on elsewhere."""
        self.kills += other.kills
        self.steps += other.steps
        self.problems += other.problems

    def lines(self) -> list[str]:
        """A summary, then the problems."""
        when = ", ".join(f"{count} in {name}" for name, count in sorted(self.kills.items()))
        total = f"{self.kills.total()} kills ({when})" if self.kills else "0 kills"
        return [f"{total}, {self.steps} steps", *self.problems]


@dataclass
class _Known:
    """What the windows have said so far.

    Attributes:
        state: after the last finished step.
        saved: states that were saved as a project or exported, or are being: their journal ends.
        begun: what has begun and not ended: start, save, export or gestures.
        since: when it began, seconds of the clock.
        takes: how long each of them took last, seconds; for gestures, a single one.
        gestures: that the running window has made.
    """

    state: str = ""
    saved: set[str] = field(default_factory=set)
    begun: str = _GESTURES
    since: float = 0.0
    takes: dict[str, float] = field(default_factory=_TAKES.copy)
    gestures: int = 0

    def begin(self, what: str) -> None:
        """Something begins."""
        self.begun, self.since = what, time.monotonic()

    def end(self) -> None:
        """It has ended; gestures follow."""
        self.takes[self.begun] = time.monotonic() - self.since
        self.begin(_GESTURES)


@dataclass(frozen=True)
class _Plan:
    """When a window is to be killed.

    Attributes:
        aim: what is to be going on.
        gestures: how many before it, if gestures are.
        share: of that, before the kill, from 0 to 1.
    """

    aim: str
    gestures: int
    share: float

    def moment(self, line: _Line, known: _Known) -> float:
        """The latest moment for the kill, seconds of the clock, after a line of the window.

        Args:
            known: also by this line.
        """
        match self.aim, line:
            case ("start", {"starts": True}) | ("write", {"begins": _}):
                return time.monotonic() + self.share * known.takes[known.begun]
            case "gestures", {"did": "open" | "recover" | "gesture"}:
                if known.gestures >= self.gestures:
                    return time.monotonic() + self.share * known.takes[_GESTURES]
            case "write", {"did": "gesture"} if known.gestures >= _NO_WRITE:
                return 0.0
        return math.inf


class Series:
    """Windows in one folder; each start recovers what the last one has left.

    Args:
        folder: an empty one.

    Attributes:
        done: how many windows were killed.
        killed: how it went.
    """

    def __init__(self, folder: Path) -> None:
        self._folder, self._known = folder, _Known()
        self.done, self.killed = 0, Killed()
        shutil.copy(shipped(DEMO_TAKE), folder / "take.csv")

    def kill(self, seed: str, is_over: Callable[[], bool]) -> None:
        """Start a window, kill it at a random moment, and look at what it has left.

        Args:
            seed: decides what the window does, and when it is killed.
            is_over: whether to end at once; such a kill does not count.
        """
        chance = random.Random(seed)
        plan = _Plan(chance.choice(_AIMS), chance.randint(0, _MOST_GESTURES), chance.random())
        said: queue.Queue[_Line | None] = queue.Queue()
        with tempfile.TemporaryFile() as errors:
            process = _started(self._folder, seed, errors)
            assert process.stdout is not None
            reader = threading.Thread(target=_read, args=(process.stdout, said), daemon=True)
            reader.start()
            try:
                problem = self._watch(said, plan, is_over)
            finally:
                process.kill()
                process.wait()
            reader.join(_GOODBYE)
            while not said.empty():
                if (line := said.get()) is not None:
                    self._note(line)
            if is_over():
                return
            if problem:
                errors.seek(0)
                last = errors.read().decode(errors="replace").strip().splitlines()[-1:]
                self.killed.problems.append(f"{problem}: {(last or ['no error'])[0][:200]}")
        self.killed.kills[self._known.begun] += 1
        found = len(self.killed.problems)
        self._check()
        for at, wrong in enumerate(self.killed.problems[found:], start=found):
            self.killed.problems[at] = f"{wrong} (window “{seed}”)"
        self.done += 1

    def _watch(
        self, said: queue.Queue[_Line | None], plan: _Plan, is_over: Callable[[], bool]
    ) -> str:
        """Wait for the moment of the kill; returns what went wrong before it, or ""."""
        moment, patience = math.inf, time.monotonic() + _PATIENCE
        while (left := min(moment, patience) - time.monotonic()) > 0 and not is_over():
            try:
                line = said.get(timeout=min(left, _LOOKS))
            except queue.Empty:
                continue
            if line is None:
                return "the window ended by itself"
            self._note(line)
            moment = min(moment, plan.moment(line, self._known))
            patience = time.monotonic() + _PATIENCE
        return "the window hangs, or did not start" if moment == math.inf else ""

    def _note(self, line: _Line) -> None:
        known = self._known
        match line:
            case {"starts": True}:
                known.gestures = 0
                known.begin(_START)
            case {"did": "recover", "state": str(state)}:
                known.end()
                if known.state and state != known.state:
                    lost = "a start has not recovered the last finished gesture"
                    self.killed.problems.append(lost)
            case {"did": "open", "state": str(state)}:
                known.end()
                known.state = state
                known.saved.add(state)  # nothing was to be recovered
            case {"did": "step", "state": str(state)}:
                known.state = state
                self.killed.steps += 1
            case {"begins": str(what), "state": str(state)}:
                known.begin(what)
                known.saved.add(state)
            case {"did": "gesture"}:
                known.gestures += 1
                known.end()
            case {"did": "save" | "export"}:
                known.end()

    def _check(self) -> None:
        """What is on the disk after a kill: the last finished gesture, and whole files."""
        known, problems = self._known, self.killed.problems
        pending = pending_journals(self._folder / "journals")
        if len(pending) > 1:
            problems.append(f"{len(pending)} sessions are offered for recovery")
        states = _last_states(pending[0].path) if pending else []
        if not states and known.state not in {"", *known.saved}:
            problems.append("the last finished gesture is lost")
        # The first gesture after a save or a start may be written before the window says so.
        is_first = len(states) == 1 and known.state in known.saved
        if states and not is_first and known.state not in ("", *states):
            problems.append("the journal does not hold the last finished gesture")
        known.state = states[-1] if states else known.state
        for name, read in ((victim.PROJECT, read_project), (victim.EXPORTED, open_take)):
            path = self._folder / name
            try:
                if path.exists():
                    read(path)
            except FileError as error:
                problems.append(f"a file was left half written: {error}")
        if (self._folder / "take.csv").read_bytes() != shipped(DEMO_TAKE).read_bytes():
            problems.append("the take was changed")


def _started(folder: Path, seed: str, errors: IO[bytes]) -> subprocess.Popen[str]:
    """A window that works in a folder."""
    command = [sys.executable, "-m", victim.__name__, str(folder), seed]
    # Modules are compiled once, as those of an installed program are.
    env = os.environ | {"PYTHONDONTWRITEBYTECODE": ""}
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=errors, text=True, env=env)


def _read(stream: IO[str], said: queue.Queue[_Line | None]) -> None:
    with stream:
        for line in stream:
            if line.startswith("{") and line.endswith("}\n"):
                said.put(json.loads(line))
    said.put(None)


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
