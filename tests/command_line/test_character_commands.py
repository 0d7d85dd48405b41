"""`faceedit character`, and --character where other commands take it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from support.character_files import write_glb
from support.takes import make_livelink_csv

from faceedit_app.cli import main
from faceedit_app.formats.opening import open_take


@pytest.fixture(scope="module")
def head(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_glb(tmp_path_factory.mktemp("head") / "head.glb")


@pytest.fixture
def take(tmp_path: Path) -> Path:
    return make_livelink_csv(tmp_path / "take.csv")


def test_inspect_as_json(head: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["character", "inspect", str(head), "--json"]) == 0
    facts = json.loads(capfd.readouterr().out)
    assert len(facts["matched"]) == 52
    assert facts["missing"] == facts["dead"] == []
    assert len(facts["points"]) == 16
    assert facts["vertices"] > 2000
    assert facts["scale_mm"] == pytest.approx(1000, rel=1e-3)


def test_inspect_for_people(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = write_glb(tmp_path / "a.glb", lambda n: None if n == "jawForward" else n)
    assert main(["character", "inspect", str(path)]) == 0
    text = capfd.readouterr().out
    for part in (
        str(path),
        "51 of ARKit's 52",
        "Missing: jawForward",
        "inner upper lip",
        "1000 mm",
    ):
        assert part in text


def test_names_from_a_file_give_the_terminal_no_orders(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    path = write_glb(tmp_path / "a.glb", lambda n: "\x1b[31mred" if n == "jawLeft" else n)
    assert main(["character", "inspect", str(path)]) == 0
    text = capfd.readouterr().out
    assert "\x1b" not in text
    assert "[31mred" in text


def test_a_map_is_written_once(
    head: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "own.glb"
    path.write_bytes(head.read_bytes())
    assert main(["character", "inspect", str(path), "--write-map"]) == 0
    stored = json.loads((tmp_path / "own.glb.map.json").read_text())
    assert stored["channels"]["jawOpen"] == ["jawOpen"]
    assert len(stored["points"]) == 16
    assert main(["character", "inspect", str(path), "--write-map"]) == 2
    assert "exists" in capfd.readouterr().err


def test_seal_says_before_and_after(
    head: Path, take: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert main(["character", "seal", str(head), str(take), "--json"]) == 0
    facts = json.loads(capfd.readouterr().out)
    assert facts["frames"] == len(open_take(take).clip)
    for share in ("lips_open_share", "lids_open_share"):
        assert 0 <= facts[share]["after"] <= facts[share]["before"] <= 1
        assert facts["before"][share] == facts[share]["before"]
    assert main(["character", "seal", str(head), str(take)]) == 0
    assert "Lips" in capfd.readouterr().out


def test_seal_writes_closed_takes_and_replaces_none(
    head: Path, take: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "closed"
    folder.mkdir()
    command = ["character", "seal", str(head), str(take), "-o", str(folder)]
    assert main(command) == 0
    before, after = open_take(take).clip, open_take(folder / "take.csv").clip
    assert before.channels == after.channels
    np.testing.assert_array_equal(before.times, after.times)
    assert main(command) == 2
    assert main([*command[:-1], str(tmp_path)]) == 2
    assert "exists" in capfd.readouterr().err


def test_apply_with_a_character_changes_edited_frames_only(
    head: Path, take: Path, tmp_path: Path
) -> None:
    edit = {"control": "mouth_opening", "op": "set", "start": 0.6, "end": 1.0, "value": 0.5}
    edits = tmp_path / "edits.json"
    edits.write_text(json.dumps({"version": 1, "edits": [{**edit, "falloff": 0.1}]}))
    out = tmp_path / "out.csv"
    assert main(["apply", str(take), str(edits), "-o", str(out), "--character", str(head)]) == 0
    before, after = (path.read_text().splitlines() for path in (take, out))
    changed = [i for i, (a, b) in enumerate(zip(before, after, strict=True)) if a != b]
    times = open_take(take).clip.times
    assert changed
    assert all(0.2 < times[i - 1] < 1.4 for i in changed)


def test_render_draws_the_character(head: Path, take: Path, tmp_path: Path) -> None:
    pictures = []
    for name, more in (("own", []), ("ours", ["--character", str(head)])):
        out = tmp_path / f"{name}.png"
        assert main(["render", str(take), "-o", str(out), "--size", "160x160", *more]) == 0
        pictures.append(out.read_bytes())
    assert pictures[0] != pictures[1]


@pytest.mark.parametrize("command", [["inspect"], ["seal"]])
def test_a_bad_character_is_one_line(
    command: list[str], take: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.glb").write_bytes(b"glTF")
    arguments = ["character", *command, str(tmp_path / "a.glb")]
    assert main([*arguments, str(take)] if command == ["seal"] else arguments) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert len(err.splitlines()) == 1
    assert "a.glb" in err
