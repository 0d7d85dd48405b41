"""Use the window at random for a long time, and check that nothing goes wrong."""

from __future__ import annotations

import contextlib
import os
import random
import shutil
import statistics
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from PySide6.QtCore import QCoreApplication

from faceedit_app.editing.files import journal
from faceedit_app.lab.attacks.checks import wrong_after, wrong_when_undone
from faceedit_app.lab.attacks.hands import dialogs_cancelled, exceptions_noted, qt_warnings_noted
from faceedit_app.lab.attacks.memory import memory_of
from faceedit_app.lab.attacks.monkey import Monkey
from faceedit_app.lab.attacks.opened import close_window, open_window, session_of
from faceedit_app.lab.attacks.watchdog import Watchdog
from faceedit_app.ui.start.application import application, collecting
from faceedit_app.ui.start.window import MainWindow

BURST = 40  # gestures between two checks
MOST_EDITS = 60  # then everything is undone, so that the take is compared with its source
MOST_GROWTH = 0.05  # of the memory
_WARM_UP = 40  # checks until the caches of Qt and of OpenGL are as large as they get
_ENOUGH = 36  # checks after that: each third sees the list of edits grow and be undone twice


@dataclass
class Soaked:
    """How it went.

    Attributes:
        gestures, checks, undone: how many there were; `undone` counts undoing everything.
        memory: megabytes at each check, without pictures, see `memory_of`.
        problems: what went wrong, one line each.
    """

    gestures: int = 0
    checks: int = 0
    undone: int = 0
    memory: list[float] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)

    @property
    def growth(self) -> float | None:
        """By which share the memory has grown since the warm-up; None: too short."""
        later = self.memory[_WARM_UP:]
        if len(later) < _ENOUGH:
            return None
        third = len(later) // 3
        return statistics.median(later[-third:]) / statistics.median(later[:third]) - 1.0

    def lines(self) -> list[str]:
        """A summary, then the problems."""
        least, most = min(self.memory, default=0.0), max(self.memory, default=0.0)
        memory = f", {least:.0f} to {most:.0f} MB" if self.memory else ""
        counts = f"{self.gestures} gestures, {self.checks} checks, everything undone"
        grown = "too short to say whether it grows"
        if self.growth is not None:
            grown = f"{self.growth:+.1%} after {_WARM_UP} checks of warm-up"
        return [f"{counts} {self.undone} times{memory} ({grown})", *self.problems]


def soak(
    take: Path,
    seconds: float,
    seed: int,
    gestures: int | None = None,
    advance: Callable[[float], None] = lambda elapsed: None,
    character: Path | None = None,
    keep: Path | None = None,
    is_stopped: Callable[[], bool] = lambda: False,
) -> Soaked:
    """Use a window at random until time is up or something goes wrong.

    Args:
        take: the take, which is not changed.
        seconds: how long.
        seed: the same seed makes the same gestures.
        gestures: end after this many, if that is sooner.
        advance: called with the seconds that have passed.
        character: the user's, shown at first and now and then.
        keep: folder for the edits and the exports at the end, if anything went wrong; and for the
            megabytes at each check, if they became more.
        is_stopped: whether to end although there is time.

    Raises:
        FaceEditError: the take or the character cannot be read.
    """
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    application()
    soaked, folder_of_journals = Soaked(), journal.journal_folder
    with (
        tempfile.TemporaryDirectory() as name,
        exceptions_noted() as unexpected,
        qt_warnings_noted() as warned,
        dialogs_cancelled() as refused,
        contextlib.ExitStack() as watch,
        collecting(),
    ):
        folder = Path(name)
        journal.journal_folder = lambda: folder / "journals"
        window = open_window(take, folder, character, refused)
        try:
            began, monkey = time.monotonic(), Monkey(window, random.Random(seed))
            dog = watch.enter_context(Watchdog(lambda: f"seed {seed}, after {monkey.said}"))

            def is_over() -> bool:
                return is_stopped() or time.monotonic() - began > seconds

            while not soaked.problems and not is_over():
                if _burst(monkey, soaked, dog, lambda: [*unexpected, *refused, *warned], is_over):
                    _check(window, monkey, folder, soaked, dog)
                    dog.step()
                advance(time.monotonic() - began)
                if gestures is not None and soaked.gestures >= gestures:
                    break
            if soaked.problems and keep is not None:
                session_of(window).save_edits(folder / "edits.json")
                shutil.copytree(folder, keep, dirs_exist_ok=True)
            _undo_everything(window, folder, soaked, dog)
        finally:
            close_window(window)
            journal.journal_folder = folder_of_journals
    judge_memory(soaked, keep)
    return soaked


def judge_memory(soaked: Soaked, keep: Path | None) -> None:
    """Note growth as a problem, and keep the megabytes at each check, a line each."""
    if soaked.growth is None or soaked.growth <= MOST_GROWTH:
        return
    soaked.problems.append(f"the memory has grown by {soaked.growth:.1%}")
    if keep is not None:
        keep.mkdir(parents=True, exist_ok=True)
        lines = "".join(f"{megabytes:.1f}\n" for megabytes in soaked.memory)
        (keep / "memory.txt").write_text(lines, encoding="ascii")


def _burst(
    monkey: Monkey,
    soaked: Soaked,
    dog: Watchdog,
    complaints: Callable[[], list[str]],
    is_over: Callable[[], bool],
) -> bool:
    """Make the gestures between two checks; False if time is up or something went wrong."""
    for _ in range(BURST):
        monkey.act()
        QCoreApplication.processEvents()
        soaked.gestures += 1
        dog.step()
        if found := complaints():
            soaked.problems.append(f"{found[0]}, after {monkey.said}")
            return False
        if is_over():
            return False
    return True


def _check(window: MainWindow, monkey: Monkey, folder: Path, soaked: Soaked, dog: Watchdog) -> None:
    """Compare what is shown with what is exported, and with the same edits on a fresh session."""
    window.workspace.end_gestures()
    for wrong in wrong_after(window, folder):
        soaked.problems.append(f"{wrong}, after {monkey.said}")
    soaked.checks += 1
    soaked.memory.append(memory_of(window))
    if len(session_of(window).edits) > MOST_EDITS:
        _undo_everything(window, folder, soaked, dog)


def _undo_everything(window: MainWindow, folder: Path, soaked: Soaked, dog: Watchdog) -> None:
    """Undo all steps: an export is then the source, byte for byte."""
    window.workspace.end_gestures()
    soaked.problems += wrong_when_undone(window, folder, dog.step)
    soaked.undone += 1
