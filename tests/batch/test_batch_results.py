"""What a batch does about results that are there, and about files that are not its takes."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from support.takes import make_livelink_csv

from faceedit_app.batch.log import Log
from faceedit_app.batch.report import summary
from faceedit_app.batch.tasks import LOG, Outcome
from faceedit_app.cli import main

Batch = Callable[..., tuple[int, str]]


@pytest.fixture
def batch(tmp_path: Path, models: str, capfd: pytest.CaptureFixture[str]) -> Batch:
    """Runs `faceedit batch WHAT takes -o out` on two takes, and gives its code and its text."""
    for name in ("a.csv", "b.csv"):
        (tmp_path / "takes").mkdir(exist_ok=True)
        make_livelink_csv(tmp_path / "takes" / name, seconds=1)

    def run(what: str = "none", takes: str = "takes", out: str = "out") -> tuple[int, str]:
        folders = [str(tmp_path / takes), "-o", str(tmp_path / out)]
        code = main(["batch", what, *folders, "--models", models])
        found = capfd.readouterr()
        return code, found.out + found.err

    return run


def test_results_that_were_removed_or_changed_are_made_again(batch: Batch, tmp_path: Path) -> None:
    out = tmp_path / "out"
    batch()
    good = (out / "a.csv").read_bytes()
    for content, says, kept in (
        (None, "the result was removed", None),
        (b"", "the result was changed", None),
        (good[:-9], "the result was changed; the file that was there is now a.csv.bak", good[:-9]),
        (good + b"mine\n", "now a.csv.bak2", good + b"mine\n"),
    ):
        if content is None:
            (out / "a.csv").unlink()
        else:
            (out / "a.csv").write_bytes(content)
        code, said = batch()
        assert code == 0
        assert "[2/2] a.csv: 0 of 60 frames changed; made again, because" in said
        assert says in said
        assert "b.csv" not in said
        assert (out / "a.csv").read_bytes() == good
        backups = sorted(out.glob("*.bak*"))
        assert (backups[-1].read_bytes() if backups else None) == kept
    code, said = batch()
    assert "a.csv" not in said
    code, said = batch("smile")  # as a batch wrote them: they may go
    assert "made again" not in said
    assert len(list(out.glob("*.bak*"))) == 2


def test_a_log_that_does_not_say_what_was_written_is_not_trusted(
    batch: Batch, tmp_path: Path
) -> None:
    batch()
    log = tmp_path / "out" / LOG
    older = [json.loads(line) for line in log.read_text().splitlines()]
    for entry in older:
        del entry["made"], entry["again"]
    damaged = b'[1]\n\xff\n{"name": "a.csv", "tracked": ["x"]}\n{"name": {}}\n' + b"[" * 9999
    log.write_bytes("".join(json.dumps(entry) + "\n" for entry in older).encode() + damaged)
    (tmp_path / "out" / "a.csv").write_text("mine")
    code, said = batch()
    assert code == 0
    assert "now a.csv.bak" in said
    assert [path.read_text() for path in (tmp_path / "out").glob("*.bak")] == ["mine"]


@pytest.mark.parametrize("value", ["9" * 400, "-1e300", "NaN", '"1"'])
def test_numbers_in_a_log_that_are_none_are_damage(tmp_path: Path, value: str) -> None:
    kept = '{"name": "b.csv", "seconds": 2}\n'  # a whole number may be written so
    for field in ("seconds", "frames"):
        (tmp_path / LOG).write_text(f'{kept}{{"name": "a.csv", "{field}": {value}}}\n')
        log = Log(tmp_path)
        assert set(log.outcomes()) == {"b.csv"}
        log.close()


def test_what_earlier_batches_wrote_is_not_taken_for_takes(batch: Batch, tmp_path: Path) -> None:
    batch("none", out="takes/earlier")
    (tmp_path / "takes" / "prices.csv").write_text("item,price\nbread,2\n")
    (tmp_path / "takes" / "empty.csv").touch()  # may have been a take
    code, said = batch("none")
    assert code == 1
    assert "empty.csv: is empty" in said
    assert "skipped earlier: holds the results of another batch" in said
    assert "skipped prices.csv: holds no ARKit channel" in said
    assert "3 takes: 2 written, 1 failed; 0 problems fixed; 2 other files skipped" in said
    code, said = batch("none", "out", "next")  # one batch after another
    assert code == 0
    assert "skipped faceedit_report.csv: is a report of FaceEdit" in said
    assert "2 takes: 2 written, 0 failed" in said


def test_problems_that_an_edit_makes_are_not_fixed_ones() -> None:
    found = [Outcome("a.csv", problems=1, left=2), Outcome("b.csv", problems=3, left=2)]
    assert summary(found) == "2 takes: 2 written, 0 failed; 1 problem fixed, 1 new"
