"""`faceedit kill`: windows that are killed at random moments, and what must hold then."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import IO

import pytest

from faceedit_app.cli import main
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.files.journal import Journal
from faceedit_app.editing.steps import EditState
from faceedit_app.lab.attacks import kill as killing
from faceedit_app.lab.attacks import kill_series
from faceedit_app.lab.attacks.kill import kill
from faceedit_app.lab.attacks.kill_series import Killed, Series

_OPENS: tuple[dict[str, object], ...] = (
    {"starts": True},
    {"did": "open", "state": "opened"},
)
_STEPS: dict[str, object] = {"did": "step", "state": "changed"}


@pytest.mark.timeout(400)
@pytest.mark.skipif(sys.platform == "win32", reason="no kill -9")
def test_a_window_that_is_killed_loses_no_finished_gesture() -> None:
    found = kill(2, seed=97)
    assert not found.problems, found.lines()
    assert found.kills.total() == 2


def _pretend(monkeypatch: pytest.MonkeyPatch, *lines: dict[str, object], ends: str) -> None:
    """Instead of a window, start a process that says `lines` and then goes on with `ends`."""
    said = "\n".join(json.dumps(line) for line in lines)

    def started(_folder: Path, _seed: str, errors: IO[bytes]) -> subprocess.Popen[str]:
        code = f"import sys, threading\nprint({said!r}, flush=True)\n{ends}"
        command = [sys.executable, "-S", "-c", code]
        return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=errors, text=True)

    monkeypatch.setattr(kill_series, "_started", started)
    monkeypatch.setattr(kill_series, "_MOST_GESTURES", 0)


@pytest.mark.parametrize(
    ("lines", "ends", "problem"),
    [
        ((*_OPENS, _STEPS), "threading.Event().wait()", "the last finished gesture is lost"),
        (_OPENS, "sys.exit('no face')", "the window ended by itself: no face"),
        ((_OPENS[0],), "sys.exit()", "the window ended by itself: no error"),
    ],
)
def test_what_goes_wrong_ends_the_attack_and_is_said(
    monkeypatch: pytest.MonkeyPatch,
    lines: tuple[dict[str, object], ...],
    ends: str,
    problem: str,
) -> None:
    _pretend(monkeypatch, *lines, ends=ends)
    monkeypatch.setattr(kill_series, "_AIMS", ("nothing that comes",))
    monkeypatch.setattr(kill_series, "_PATIENCE", 60.0)
    if "wait" in ends:  # killed once it has made its step
        monkeypatch.setattr(kill_series._Plan, "moment", _at_once_after_a_step)
    found = kill(5, seed=1, jobs=1)
    assert found.problems == [f"{problem} (window “1 0”)" if "wait" in ends else problem]
    assert found.kills.total() == 1


def _at_once_after_a_step(_plan: object, line: dict[str, object], _known: object) -> float:
    return 0.0 if line == _STEPS else float("inf")


def test_the_same_seed_makes_the_same_kills_however_many_windows_there_are_at_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    kills: list[tuple[str, str]] = []

    def pretend(series: Series, seed: str, _is_over: Callable[[], bool]) -> None:
        kills.append((series._folder.name, seed))

    monkeypatch.setattr(Series, "kill", pretend)
    for jobs in (1, 3):
        kill(45, seed=7, jobs=jobs)
    assert sorted(kills[:45]) == sorted(kills[45:])
    assert {folder for folder, _ in kills} == {"0", "20", "40"}
    assert len(set(kills)) == 45


def test_a_stop_ends_at_once_and_keeps_the_count(monkeypatch: pytest.MonkeyPatch) -> None:
    _pretend(monkeypatch, *_OPENS, ends="threading.Event().wait()")
    whole = Series.kill

    def first_only(series: Series, seed: str, is_over: Callable[[], bool]) -> None:
        if series.done:
            monkeypatch.setattr(kill_series, "_AIMS", ("nothing that comes",))
        whole(series, seed, is_over)

    monkeypatch.setattr(kill_series, "_AIMS", ("gestures",))
    monkeypatch.setattr(Series, "kill", first_only)
    done: list[int] = []
    found = kill(5, 1, done.append, jobs=1, is_stopped=lambda: bool(done and done[-1]))
    assert not found.problems
    assert found.kills == {"gestures": 1}
    assert kill(5, 1, seconds=-1.0).lines() == ["0 kills, 0 steps"]


@pytest.mark.parametrize("before", ["saved", "lost"])
def test_a_gesture_that_was_written_but_not_said_is_told_from_a_lost_one(
    tmp_path: Path, before: str
) -> None:
    series = Series(tmp_path)
    series._known.state = before
    series._known.saved.add("saved")
    journal = Journal(tmp_path / "take.csv", folder=tmp_path / "journals")
    journal.record(EditState((Edit(("mouth_opening",), Op.OFFSET, 1.0, 2.0, 0.2, 3.0),)))
    content = journal.path.read_bytes()
    journal.close()
    journal.path.write_bytes(content)  # as after a kill: there, and not locked
    series._check()
    wrong = ["the journal does not hold the last finished gesture"]
    assert series.killed.problems == (wrong if before == "lost" else [])


@pytest.mark.parametrize("which", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_ends_an_attack_with_what_it_has_found_so_far(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], which: signal.Signals
) -> None:
    def attack(
        _times: int,
        _seed: int,
        _advance: object,
        jobs: int,
        seconds: float,
        is_stopped: Callable[[], bool],
    ) -> Killed:
        assert (jobs, seconds) == (3, 90.0)
        assert not is_stopped()
        signal.raise_signal(which)
        if which == signal.SIGTERM:  # as `timeout` sends it: to the process, and to its group
            signal.raise_signal(which)
        assert is_stopped()
        found = Killed(steps=9)
        found.kills["start"] += 4
        return found

    before = signal.getsignal(which)
    monkeypatch.setattr(killing, "kill", attack)
    assert main(["kill", "--times", "8", "--seed", "5", "--jobs", "3", "--minutes", "1.5"]) == 0
    said = "4 kills (4 in start), 9 steps\nNothing is wrong (seed 5)\n"
    assert capsys.readouterr().out == said
    assert signal.getsignal(which) == before
