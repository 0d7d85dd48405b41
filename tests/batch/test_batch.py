"""Many takes at once: what is done, what is reported, and what a stop or a lost process leaves."""

from __future__ import annotations

import csv
import json
import os
import signal
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from support.character_files import parts_of, write_glb
from support.places import ROOT
from support.takes import make_livelink_csv

from faceedit_app.batch import workers
from faceedit_app.batch.log import Log, to_do
from faceedit_app.batch.recipe import Recipe, parse_recipe
from faceedit_app.batch.report import write_reports
from faceedit_app.batch.tasks import LOG, Outcome, Task, perform, plan
from faceedit_app.cli import main
from faceedit_app.editing.files.project import Project, write_project
from faceedit_app.editing.opening import open_session
from faceedit_app.formats.files import read_bytes
from faceedit_app.formats.opening import open_take

DEMO = ROOT / "assets" / "demo_take.csv"


def edits_in(folder: Path) -> Path:
    path = folder / "edits.json"
    edit = {"control": "mouth_opening", "op": "offset", "start": 0.3, "end": 0.6, "value": 4.0}
    path.write_text(json.dumps({"version": 1, "edits": [edit | {"falloff": 0.1}]}))
    return path


def command(what: object, takes: Path, out: Path, models: str, *more: object) -> int:
    words = ["batch", what, takes, "-o", out, "--models", models, *more]
    return main([str(word) for word in words])


def outcomes_in(out: Path) -> list[Any]:
    return [json.loads(line) for line in (out / LOG).read_text().splitlines()]


def test_one_bad_file_stops_nothing(
    takes: Path, tmp_path: Path, models: str, capfd: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert command(edits_in(tmp_path), takes, out, models) == 1
    said = capfd.readouterr().out
    assert "3 takes: 2 written, 1 failed" in said
    assert "bad.csv, line 3" in said
    for name in ("a.csv", "day 2/b.csv"):
        before, after = open_take(takes / name).clip, open_take(out / name).clip
        assert before.channels == after.channels
        assert (before.weights != after.weights).any()
    assert not (out / "bad.csv").exists()
    with (out / "faceedit_report.csv").open(newline="") as file:
        rows = {row["take"]: row for row in csv.DictReader(file)}
    assert rows["bad.csv"]["result"] == "failed"
    assert int(rows["a.csv"]["changed"]) > 0
    page = (out / "faceedit_report.html").read_text()
    assert page.count('<polyline class="new" points="1') == 2
    assert "bad.csv, line 3" in page


def test_what_is_done_is_not_done_again(
    takes: Path, tmp_path: Path, models: str, capfd: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    (takes / "bad.csv").unlink()
    assert command("none", takes, out, models) == 0
    written = {
        path: path.stat().st_mtime_ns for path in out.rglob("*.csv") if "report" not in path.name
    }
    capfd.readouterr()
    make_livelink_csv(takes / "new.csv", seconds=1)
    assert command("none", takes, out, models) == 0
    said = capfd.readouterr().out
    assert "[3/3] new.csv" in said
    assert "[2/3]" not in said
    assert {path: path.stat().st_mtime_ns for path in written} == written
    assert "3 takes: 3 written" in said
    # Another recipe, a changed take or a deleted result is done again.
    (out / "a.csv").unlink()
    make_livelink_csv(takes / "new.csv", seconds=2)
    assert command("none", takes, out, models) == 0
    assert capfd.readouterr().out.count("frames changed") == 2
    assert command("smile", takes, out, models) == 0
    assert capfd.readouterr().out.count("frames changed") == 3


def test_a_stop_loses_nothing(takes: Path, tmp_path: Path, models: str) -> None:
    (takes / "bad.csv").unlink()
    tasks, _ = plan(takes, tmp_path / "out", Recipe(models=models))
    log = Log(tmp_path / "out")

    def stop(_outcome: Outcome, _done: int, _of: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        workers.run(tasks, log, progress=stop)
    log.close()
    with (tmp_path / "out" / LOG).open("a") as file:
        file.write('{"name": "day 2/b.c')  # as a crash leaves it
    log = Log(tmp_path / "out")
    seen: list[str] = []
    outcomes = workers.run(tasks, log, progress=lambda one, _done, _of: seen.append(one.name))
    log.close()
    assert seen == ["day 2/b.csv"]
    assert [one.name for one in outcomes] == ["a.csv", "day 2/b.csv"]
    log = Log(tmp_path / "out")
    assert to_do(tasks, log) == []
    log.close()


def test_problems_are_found_and_fixed(tmp_path: Path) -> None:
    out = tmp_path / "demo.csv"
    one = perform(Task("demo.csv", DEMO, out, parse_recipe("fix:lips,blinks")))
    assert (one.problems, one.left, one.error) == (2, 0, "")
    assert 0 < one.changed < one.frames
    assert one.tracked != one.edited


def test_files_that_are_no_takes_are_reported_and_skipped(
    takes: Path, tmp_path: Path, models: str, capfd: pytest.CaptureFixture[str]
) -> None:
    (takes / "bad.csv").unlink()
    (takes / "scene.json").write_text('{"scene": []}')
    (takes / "day 2" / "emotions.json").write_text('{"emotionNames": ["joy"]}')
    out = tmp_path / "out"
    assert command("none", takes, out, models) == 0
    said = capfd.readouterr().out
    assert "skipped scene.json: holds no ARKit channel" in said
    assert "2 takes: 2 written, 0 failed; 0 problems fixed; 3 other files skipped" in said
    with (out / "faceedit_report.csv").open(newline="") as file:
        rows = {row["take"]: row for row in csv.DictReader(file)}
    assert rows["scene.json"]["result"] == "skipped"
    assert "emotions" in rows["day 2/emotions.json"]["error"]
    assert "skipped: holds the emotions" in (out / "faceedit_report.html").read_text()


def test_a_batch_reads_no_file_twice_before_it_begins(
    takes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (takes / "out").mkdir()
    make_livelink_csv(takes / "out" / "a.csv")  # of an earlier run, which is not read at all
    (takes / "out" / LOG).touch()
    read: list[str] = []

    def counted(path: Path) -> bytes:
        read.append(path.name)
        return read_bytes(path)

    monkeypatch.setattr("faceedit_app.formats.registry.read_bytes", counted)
    tasks, others = plan(takes, takes / "out", Recipe())
    assert [task.name for task in tasks] == ["a.csv", "bad.csv", "day 2/b.csv"]
    assert [other.name for other in others] == ["notes.json"]
    assert sorted(read) == ["a.csv", "b.csv", "bad.csv", "notes.json"]


def test_results_have_one_name_each(takes: Path, tmp_path: Path, models: str) -> None:
    (takes / "bad.csv").unlink()
    source = {"facsNames": ["jawOpen"], "weightMat": [[0.1]] * 30, "exportFps": 30}
    (takes / "a.json").write_text(json.dumps(source))
    out = tmp_path / "out"
    assert command("none", takes, out, models, "--format", "glb", "--fps", "24") == 0
    assert {path.name for path in out.rglob("*.glb")} == {"a.glb", "a_json.glb", "b.glb"}
    assert {open_take(path).clip.rate for path in out.rglob("*.glb")} == {24}


def test_files_that_no_batch_wrote_are_kept(
    takes: Path, tmp_path: Path, models: str, capfd: pytest.CaptureFixture[str]
) -> None:
    (takes / "bad.csv").unlink()
    out = tmp_path / "out"
    (out / "day 2").mkdir(parents=True)
    (out / "day 2" / "b.csv").write_text("mine")
    (out / "a.csv").write_bytes((takes / "a.csv").read_bytes())  # what is written anyway
    for what in ("none", edits_in(tmp_path)):  # what a batch wrote may go
        assert command(what, takes, out, models) == 0
        assert (out / "day 2" / "b.csv.bak").read_text() == "mine"
        assert {path.name for path in out.rglob("*.bak*")} == {"b.csv.bak"}
        said = capfd.readouterr().out
        assert ("that was there is now day 2/b.csv.bak" in said) == (what == "none")


def test_a_result_is_named_by_its_path(
    takes: Path, tmp_path: Path, models: str, capfd: pytest.CaptureFixture[str]
) -> None:
    (takes / "bad.csv").unlink()
    out = tmp_path / "out"
    assert command("none", takes, out, models, "--json") == 0
    facts = {one["name"]: one for one in json.loads(capfd.readouterr().out)["takes"]}
    assert facts["day 2/b.csv"]["path"] == str(out / "day 2" / "b.csv")
    assert [line["written"] for line in outcomes_in(out)] == ["a.csv", "day 2/b.csv"]
    with (out / "faceedit_report.csv").open(newline="") as file:
        assert [row["written"] for row in csv.DictReader(file)][:2] == ["a.csv", "day 2/b.csv"]
    assert "<td>day 2/b.csv</tr>" in (out / "faceedit_report.html").read_text()


@pytest.mark.parametrize("kind", ["edits", "take", "project"])
def test_a_result_is_not_written_over_what_is_read(
    takes: Path, tmp_path: Path, models: str, capfd: pytest.CaptureFixture[str], kind: str
) -> None:
    (takes / "bad.csv").unlink()
    out, what = tmp_path / "out", str(edits_in(tmp_path))
    (kept := out / "a.csv").parent.mkdir()
    if kind == "edits":
        source = {"facsNames": ["jawOpen"], "weightMat": [[0.1]] * 30, "exportFps": 30}
        (takes / "edits.json").write_text(json.dumps(source))
        kept = Path(what).rename(out / "edits.json")
        what = str(kept)
    elif kind == "take":
        kept.symlink_to(takes / "a.csv")
    else:
        opened = open_session(make_livelink_csv(kept))
        project = Project(kept, opened.fingerprint, opened.state)
        write_project(out / "mine.faceedit", project)
    before = kept.read_bytes()
    assert command(what, takes, out, models) == (1 if kind == "project" else 2)
    found = capfd.readouterr()
    assert "choose another folder for the results" in found.out + found.err
    assert kept.read_bytes() == before
    assert not list(tmp_path.rglob("*.bak"))


def test_heads_of_characters_follow_only_if_asked(tmp_path: Path, models: str) -> None:
    takes = tmp_path / "takes"
    takes.mkdir()
    path = make_livelink_csv(takes / "a.csv")
    rows = [line.split(",") for line in path.read_text().splitlines()]
    yaw = rows[0].index("HeadYaw")
    for number, row in enumerate(rows[1:]):
        row[yaw] = f"{0.01 * number:.3f}"
    path.write_text("\n".join(map(",".join, rows)) + "\n")
    head = write_glb(tmp_path / "head.glb")
    for name, more in (("still", ()), ("turned", ("--follow-head",))):
        out = tmp_path / name
        form = "--format", "glb", "--character", head
        assert command("none", takes, out, models, *form, *more) == 0
        document, _ = parts_of((out / "a.glb").read_bytes())
        paths = {c["target"]["path"] for c in document["animations"][-1]["channels"]}
        assert ("rotation" in paths) is bool(more)


def test_several_processes_give_the_same_bytes(takes: Path, tmp_path: Path, models: str) -> None:
    edits = edits_in(tmp_path)
    assert command(edits, takes, tmp_path / "one", models) == 1
    assert command(edits, takes, tmp_path / "two", models, "--jobs", 2) == 1
    for name in ("a.csv", "day 2/b.csv"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()
    assert len(outcomes_in(tmp_path / "two")) == 3


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["grimace", "takes"], "no such preset"),
        (["blink", "takes"], "acts at a place"),
        (["fix:", "takes"], "fix: names nothing to fix; give one or more of lips, blinks"),
        (["none", "takes", "--format", "glb", "--fps", "1e9"], "give 1 to 1000"),
        (["fix:teeth", "takes"], "teeth must be one of lips, blinks, shaking, gaps"),
        (["nowhere.json", "takes"], "nowhere.json"),
        (["none", "nowhere"], "is not a folder"),
        (["none", "empty"], "holds no takes"),
        (["none", "out"], "choose another folder for results"),
        (["none", "takes", "--fps", "30"], "--fps needs --format"),
        (["none", "takes", "--format", "bvh"], "must be one of livelink"),
        (["none", "takes", "--jobs", "0"], "--jobs"),
    ],
)
def test_wrong_words_are_said_in_one_line(
    words: list[str],
    says: str,
    takes: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty").mkdir()
    (tmp_path / "out").mkdir()
    make_livelink_csv(tmp_path / "out" / "a.csv")
    assert main(["batch", *words, "-o", "out"]) == 2
    err = capfd.readouterr().err
    assert says in err
    assert len(err.splitlines()) == 1
    assert not list((tmp_path / "out").glob("*.jsonl"))


def test_names_in_a_report_are_only_text(tmp_path: Path) -> None:
    one = Outcome("<b>.csv", error="<i>")
    _, page = write_reports(tmp_path, [one])
    assert "<b>.csv" not in page.read_text()
    assert "<i>" not in page.read_text()


@pytest.mark.filterwarnings("ignore")
@pytest.mark.timeout(110)
def test_a_cluster_loses_nothing_and_does_nothing_twice(
    tmp_path: Path, models: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    distributed = pytest.importorskip("dask.distributed", reason="Dask is not installed")
    folder = tmp_path / "takes"
    folder.mkdir()
    for number in range(8):
        make_livelink_csv(folder / f"{number}.csv", seconds=1 + number % 2)
    recipe = Recipe(edits=str(edits_in(tmp_path)), models=models)
    tasks, _ = plan(folder, tmp_path / "out", recipe)
    log = Log(tmp_path / "out")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as cluster:
        kill = _killer([worker.pid for worker in cluster.workers.values()])
        outcomes = workers.run(tasks, log, scheduler=cluster.scheduler_address, progress=kill)
    log.close()
    assert [one.name for one in outcomes] == [task.name for task in tasks]
    assert [one.error for one in outcomes] == [""] * 8
    assert set(Counter(entry["name"] for entry in outcomes_in(tmp_path / "out")).values()) == {1}
    for task in tasks:
        alone = tmp_path / "alone.csv"
        perform(Task(task.name, task.source, alone, recipe))
        assert task.output.read_bytes() == alone.read_bytes()


def _killer(workers: list[int]) -> Callable[[Outcome, int, int], None]:
    """Kills one worker after the first outcome."""

    def progress(_outcome: Outcome, done: int, _of: int) -> None:
        if done == 1:
            os.kill(workers[0], signal.SIGKILL)

    return progress


def test_a_take_without_a_rate_says_which_option_gives_it(tmp_path: Path, models: str) -> None:
    folder, out = tmp_path / "takes", tmp_path / "out"
    folder.mkdir()
    (folder / "a.csv").write_text("jawOpen,eyeBlinkLeft\n" + "0.1,0.2\n" * 20)
    assert command("none", folder, out, models) == 1
    assert "--take-fps" in outcomes_in(out)[0]["error"]
    assert command("none", folder, out, models, "--take-fps", 30) == 0


@pytest.mark.skipif(os.name == "nt", reason="Windows has no named pipes in folders")
def test_pipes_devices_and_links_in_a_circle_stop_nothing(tmp_path: Path, models: str) -> None:
    folder, out = tmp_path / "takes", tmp_path / "out"
    folder.mkdir()
    make_livelink_csv(folder / "good.csv")
    os.mkfifo(folder / "pipe.csv")
    (folder / "endless.csv").symlink_to("/dev/zero")
    (folder / "circle.csv").symlink_to("circle.csv")
    (folder / "folder.csv").mkdir()
    assert command("none", folder, out, models) == 1
    said = {outcome["name"]: outcome["error"] for outcome in outcomes_in(out)}
    assert said.pop("good.csv") == ""
    assert sorted(said) == ["circle.csv", "endless.csv", "folder.csv", "pipe.csv"]
    for error in said.values():
        assert "Error:" not in error
        assert len(error) <= 300
    assert (out / "good.csv").read_bytes() == (folder / "good.csv").read_bytes()


def test_every_take_keeps_its_ending(tmp_path: Path, models: str) -> None:
    folder, out = tmp_path / "takes", tmp_path / "out"
    folder.mkdir()
    frames = [{"time": n / 30, "blendshapes": {"jawOpen": 0.01 * n}} for n in range(40)]
    (folder / "lines.jsonl").write_text("".join(json.dumps(frame) + "\n" for frame in frames))
    rows = "".join(f"{n / 30:.4f}\t{0.01 * n:.3f}\n" for n in range(40))
    (folder / "tabs.tsv").write_text("time_s\tjawOpen\n" + rows)
    assert command("none", folder, out, models) == 0
    for name in ("lines.jsonl", "tabs.tsv"):
        assert (out / name).read_bytes() == (folder / name).read_bytes()
