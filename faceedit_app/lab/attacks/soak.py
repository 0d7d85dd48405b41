"""Use the window at random for a long time, and check that nothing goes wrong."""

from __future__ import annotations

import os
import random
import resource
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from PySide6.QtCore import QCoreApplication

from faceedit_app.editing.files import journal
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.opening import open_take
from faceedit_app.lab.attacks.monkey import Monkey, dialogs_cancelled, exceptions_noted
from faceedit_app.lab.attacks.opened import open_window, session_of
from faceedit_app.ui.start.application import application
from faceedit_app.ui.start.window import MainWindow

BURST = 40  # gestures between two checks
MOST_EDITS = 60  # then everything is undone, so that the take is compared with its source
MOST_GROWTH = 0.05  # of the memory
_SETTLED = 4  # checks before the memory is compared
_ROUNDING = 6e-5  # of weights in files, which have at least 4 decimals


@dataclass
class Soaked:
    """How it went.

    Attributes:
        gestures, checks, undone: how many there were; `undone` counts undoing everything.
        memory: megabytes at each check.
        problems: what went wrong, one line each.
    """

    gestures: int = 0
    checks: int = 0
    undone: int = 0
    memory: list[float] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)

    @property
    def growth(self) -> float:
        """By which share the memory has grown since it had settled."""
        later = self.memory[_SETTLED:]
        if len(later) < 3 * _SETTLED:
            return 0.0
        third = len(later) // 3
        return statistics.median(later[-third:]) / statistics.median(later[:third]) - 1.0

    def lines(self) -> list[str]:
        """A summary, then the problems."""
        memory = f", {self.memory[0]:.0f} to {self.memory[-1]:.0f} MB" if self.memory else ""
        counts = f"{self.gestures} gestures, {self.checks} checks, everything undone"
        return [f"{counts} {self.undone} times{memory} ({self.growth:+.1%})", *self.problems]


def soak(
    take: Path,
    seconds: float,
    seed: int,
    gestures: int | None = None,
    advance: Callable[[float], None] = lambda elapsed: None,
) -> Soaked:
    """Use a window at random until time is up or something goes wrong.

    Args:
        take: the take, which is not changed.
        seconds: how long.
        seed: the same seed makes the same gestures.
        gestures: end after this many, if that is sooner.
        advance: called with the seconds that have passed.
    """
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    application()
    soaked, folder_of_journals = Soaked(), journal.journal_folder
    with (
        tempfile.TemporaryDirectory() as name,
        exceptions_noted() as unexpected,
        dialogs_cancelled() as refused,
    ):
        folder = Path(name)
        journal.journal_folder = lambda: folder / "journals"
        window = open_window(take, folder)
        try:
            chance, began = random.Random(seed), time.monotonic()
            monkey = Monkey(window, chance)
            while not soaked.problems and time.monotonic() - began < seconds:
                for _ in range(BURST):
                    monkey.act()
                    QCoreApplication.processEvents()
                    soaked.gestures += 1
                    if unexpected or refused:
                        said = [*unexpected, *refused][0]
                        soaked.problems.append(f"after “{monkey.last}”: {said}")
                        break
                else:
                    _check(window, monkey, folder, soaked)
                advance(time.monotonic() - began)
                if gestures is not None and soaked.gestures >= gestures:
                    break
            _undo_everything(window, folder, soaked)
        finally:
            window.leave()
            journal.journal_folder = folder_of_journals
    if soaked.growth > MOST_GROWTH:
        soaked.problems.append(f"the memory has grown by {soaked.growth:.1%}")
    return soaked


def _check(window: MainWindow, monkey: Monkey, folder: Path, soaked: Soaked) -> None:
    """Compare what is shown with what is exported, and with the same edits on a fresh session."""
    window.workspace.end_gestures()
    session = session_of(window)
    if session.is_previewing:
        soaked.problems.append(f"a preview stays after all gestures, after “{monkey.last}”")
    session.live.work()
    soaked.checks += 1
    soaked.memory.append(_memory())
    fresh = EditSession(session.take, session.rig, window.document.engine)
    fresh.begin_with(session.state)
    fresh.live.work()
    for name in ("asked", "achieved", "weights"):
        shown = getattr(session, name)
        if not np.isfinite(shown).all():
            soaked.problems.append(f"{name} is not finite")
        differs = (shown != getattr(fresh, name)).any(axis=1)
        if differs.any():
            frames = f"{differs.sum()} frames from {differs.argmax()}"
            soaked.problems.append(
                f"{name} depends on how the edits were made ({frames}, after “{monkey.last}”)"
            )
    exported = folder / f"exported{session.take.path.suffix}"
    window.document.export(exported)
    written = open_take(exported, session.take.fps).clip.weights
    if np.abs(written - session.clip_weights()).max() > _ROUNDING:
        soaked.problems.append("what is exported is not what is shown")
    if len(session.edits) > MOST_EDITS:
        _undo_everything(window, folder, soaked)


def _undo_everything(window: MainWindow, folder: Path, soaked: Soaked) -> None:
    """Undo all steps: an export is then the source, byte for byte."""
    window.workspace.end_gestures()
    session = session_of(window)
    while session.can_undo:
        session.undo()
    soaked.undone += 1
    exported = folder / f"undone{session.take.path.suffix}"
    window.document.export(exported)
    if exported.read_bytes() != session.take.path.read_bytes():
        soaked.problems.append("undoing everything does not bring back the source's bytes")


def _memory() -> float:
    """The memory of this process now, in megabytes."""
    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
        return pages * resource.getpagesize() / 2**20
    except OSError:  # not Linux: the most so far
        most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return most / (2**20 if sys.platform == "darwin" else 2**10)
