"""Short attacks; `faceedit fuzz`, `soak` and `kill` run them for as long as one likes."""

from __future__ import annotations

import random
import sys
import threading
from pathlib import Path

import pytest
from PySide6.QtCore import qWarning
from support.reading import DEADLY, ENDLESS, pretended

from faceedit_app.cli import main
from faceedit_app.core.errors import FileError
from faceedit_app.core.resources import DEMO_TAKE, shipped
from faceedit_app.formats.registry import FORMATS
from faceedit_app.lab.attacks import fuzz as fuzzing
from faceedit_app.lab.attacks import fuzz_watch
from faceedit_app.lab.attacks.fuzz import Findings, fuzz
from faceedit_app.lab.attacks.fuzz_job import Result
from faceedit_app.lab.attacks.fuzz_process import outcome_of
from faceedit_app.lab.attacks.hands import qt_warnings_noted
from faceedit_app.lab.attacks.mutation import mutated
from faceedit_app.lab.attacks.reader import Reader
from faceedit_app.lab.attacks.readers import all_readers, readers_of
from faceedit_app.lab.attacks.soak import Soaked, judge_memory, soak
from faceedit_app.lab.attacks.valid_takes import take_readers
from faceedit_app.lab.attacks.watchdog import Watchdog


def test_the_same_seed_damages_a_file_in_the_same_way() -> None:
    content = shipped(DEMO_TAKE).read_bytes()[:5000]
    copies = [mutated(content, random.Random(seed)) for seed in (1, 1, 2)]
    assert copies[0] == copies[1] != copies[2]
    assert sum(mutated(content, random.Random(seed)) != content for seed in range(50)) > 45


def test_what_qt_warns_of_is_wrong_but_not_what_it_cannot_do_without_a_screen(
    capfd: pytest.CaptureFixture[str],
) -> None:
    with qt_warnings_noted() as warned:
        qWarning("This plugin does not support raise()")
        qWarning("edit: editing failed")
    assert warned == ["Qt: edit: editing failed"]
    said = capfd.readouterr().err
    assert "edit: editing failed" in said
    assert "plugin" not in said


def test_every_reader_reads_its_undamaged_file(tmp_path: Path) -> None:
    readers = all_readers(tmp_path)
    assert {"takes", "edits", "projects", "journals", "characters", "models", "films"} <= {
        reader.name for reader in readers
    }
    for number, reader in enumerate(readers):
        path = tmp_path / f"{number}{reader.ending}"
        path.write_bytes(reader.content)
        reader.read(path)
    (own,) = readers_of(shipped(DEMO_TAKE))
    assert own.content == shipped(DEMO_TAKE).read_bytes()


def test_every_format_of_takes_has_a_file_to_damage() -> None:
    contents = [reader.content for reader in take_readers()]
    found = {max(FORMATS, key=lambda form: form.sniff(content)).key for content in contents}
    assert found == {form.key for form in FORMATS}


def test_damaged_files_are_read_rightly_or_refused(tmp_path: Path) -> None:
    found = fuzz(170, seed=4, keep=tmp_path, jobs=1)
    assert not found.failures, found.lines()
    assert found.inputs == 170
    assert found.read.total() > 10
    assert found.refused.total() > 70


@pytest.mark.parametrize(
    ("error", "outcome"),
    [
        (None, "read"),
        (FileError("input.csv", "is damaged", "copy it"), "refused"),
        (FileError("other.csv", "is damaged", "copy it"), "its error does not name the file"),
        (KeyError("jawOpen"), "KeyError: \"'jawOpen'\""),
        (MemoryError(), "MemoryError: ''"),
    ],
)
def test_what_a_reader_raises_decides_about_an_input(
    tmp_path: Path, error: Exception | None, outcome: str
) -> None:
    def read(_path: Path) -> None:
        if error is not None:
            raise error

    reader = Reader("takes", ".csv", b"", read)
    assert outcome_of(reader, tmp_path / "input.csv").startswith(outcome)


@pytest.mark.skipif(sys.platform != "linux", reason="no processor time of other processes")
def test_a_file_that_kills_or_stops_its_reader_is_a_failure_and_all_others_are_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fuzz_watch, "_read", pretended)
    monkeypatch.setattr(fuzz_watch, "PATIENCE", 0.2)
    monkeypatch.setattr(fuzz_watch, "LOOKS", 0.02)
    monkeypatch.setattr(fuzzing, "_BLOCK", 6)
    found = fuzz(24, seed=9, keep=tmp_path, jobs=2)
    problems = {failure.number: failure for failure in found.failures}
    assert problems.keys() == {DEADLY, ENDLESS}
    assert problems[DEADLY].outcome == "ends the program"
    assert problems[ENDLESS].outcome.startswith("hangs")
    for number, failure in problems.items():
        assert failure.path is not None
        assert failure.path.read_text() == f"9 {number}"
    assert found.inputs == 24
    assert found.refused == {"takes": 8}
    assert fuzz(24, seed=9, keep=tmp_path, jobs=1, is_stopped=lambda: True).inputs == 0


def test_a_failure_is_printed_with_its_seed_and_ends_in_1(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    failed = Findings(failures=[Result(17, "takes", "KeyError", tmp_path / "fuzz_17_takes.csv")])
    monkeypatch.setattr(fuzzing, "fuzz", lambda *_: failed)
    assert main(["fuzz", "--seed", "5"]) == 1
    said = capsys.readouterr().out
    assert "input 17 (takes): KeyError" in said
    assert "1 wrong (seed 5)" in said


@pytest.mark.timeout(400)
def test_random_gestures_show_what_is_exported(qapp: object) -> None:
    found = soak(shipped(DEMO_TAKE), seconds=120, seed=3, gestures=40)
    assert not found.problems, found.lines()
    assert found.gestures >= 40
    assert found.checks >= 1


def test_a_character_that_cannot_be_read_ends_a_soak_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    character = tmp_path / "head.glb"
    character.write_bytes(b"no head")
    assert main(["soak", "--minutes", "1", "--character", str(character)]) == 2
    (line,) = [one for one in capsys.readouterr().err.splitlines() if "head.glb" in one]
    assert line.startswith("faceedit: ")


def test_growth_is_measured_once_everything_was_used() -> None:
    short = Soaked(memory=[100.0] * 40 + [400.0] * 30)
    assert short.growth is None
    assert "too short" in short.lines()[0]
    assert Soaked(memory=[100.0] * 40 + [400.0] * 40).growth == 0
    assert Soaked(memory=[100.0] * 40 + [400.0] * 20 + [500.0] * 20).growth == pytest.approx(0.25)


def test_memory_that_grows_is_wrong_and_can_be_read(tmp_path: Path) -> None:
    level = Soaked(memory=[100.0] * 40 + [400.0] * 20 + [419.0] * 20)
    judge_memory(level, tmp_path)
    assert not level.problems
    grown = Soaked(memory=[100.0] * 40 + [400.0] * 20 + [422.0] * 20)
    judge_memory(grown, tmp_path / "new")
    assert grown.problems == ["the memory has grown by 5.5%"]
    kept = (tmp_path / "new" / "memory.txt").read_text(encoding="ascii").splitlines()
    assert [float(line) for line in kept] == grown.memory


def test_a_step_that_hangs_is_named_with_the_stacks_of_all_threads(tmp_path: Path) -> None:
    ended: list[int] = []
    over = threading.Event()

    def end(code: int) -> None:
        ended.append(code)
        over.set()

    with (
        (tmp_path / "said").open("w+", encoding="utf-8") as stream,
        Watchdog(lambda: "seed 7, after “zoom”", patience=0.2, end=end, stream=stream),
    ):
        assert over.wait(60)  # where it hangs
    said = (tmp_path / "said").read_text(encoding="utf-8")
    assert ended == [1]
    assert "seed 7, after “zoom”" in said
    assert "test_a_step_that_hangs" in said


def test_steps_that_end_in_time_let_an_attack_go_on(tmp_path: Path) -> None:
    ended: list[int] = []
    with (
        (tmp_path / "said").open("w+", encoding="utf-8") as stream,
        Watchdog(lambda: "", patience=60.0, end=ended.append, stream=stream) as dog,
    ):
        dog.step()
    assert not ended
    assert (tmp_path / "said").read_text(encoding="utf-8") == ""
