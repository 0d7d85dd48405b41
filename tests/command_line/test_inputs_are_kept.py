"""No command writes over a file that it reads, whatever name or link leads to it."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
from support.takes import make_livelink_csv

from faceedit_app.cli import main
from faceedit_app.core.atomic import keep_inputs
from faceedit_app.core.errors import FileError

EDIT = {"control": "mouth_opening", "op": "offset", "start": 0.3, "end": 0.6, "value": 4.0}
LINES = {
    "edits of apply": "apply take.csv edits.json -o edits.json",
    "character of apply": "apply take.csv edits.json --character head.glb -o head.glb",
    "character of convert": "convert take.csv head.glb --character head.glb",
    "link to a character": "convert take.csv link.glb --character head.glb",
    "edits of render": "render take.csv --edits edits.json -o edits.json --format mp4",
    "sound of render": "render take.csv --sound other.mp4 -o other.mp4",
    "film beside a take": "render take.csv -o take.mp4",
    "take of render": "render take.csv -o take.csv --format mp4",
    "words of words": "words take.csv --words said.json --save said.json",
    "words of a fix": "words take.csv --words said.json --fix -o said.json",
    "sound beside a take": "words take.csv --words said.json --fix -o take.wav",
    "words of another sound": "words take.csv --text hi --retime-to said.json -o said.json",
    "edits of retime": "retime take.csv --cut 0.2-0.4 --edits edits.json -o edits.json --overwrite",
    "words of retime": "retime take.csv --cut 0.2-0.4 --words n.TextGrid -o n.csv --overwrite",
    "sound of retime": "retime take.csv --cut 0.2-0.4 --sound n.wav -o n.csv --overwrite",
    "film of track": "track film.csv -o film.csv",
    "edits of track": "track other.mp4 --report out --edits edits.csv -o edits.csv",
    "film of a report": "track side_by_side.mp4 --report .",
    "scan": "character make head.glb -o head.glb",
    "points of a scan": "character make head.glb --points points.json -o points.json",
}


@pytest.fixture
def inputs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    make_livelink_csv(tmp_path / "take.csv")
    Path("edits.json").write_text(json.dumps({"version": 1, "edits": [EDIT | {"falloff": 0.1}]}))
    os.symlink("head.glb", "link.glb")
    for name in ("said.json", "points.json", "edits.csv", "film.csv", "n.TextGrid"):
        Path(name).write_text("{}")
    for name in ("take.wav", "n.wav", "head.glb", "take.mp4", "other.mp4", "side_by_side.mp4"):
        Path(name).write_bytes(b"not read before the check")
    return tmp_path


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


@pytest.mark.parametrize("line", LINES.values(), ids=LINES)
def test_a_command_refuses_to_write_over_what_it_reads(
    inputs: Path, capfd: pytest.CaptureFixture[str], line: str
) -> None:
    before = contents(inputs)
    assert main(line.split()) == 2
    [said] = capfd.readouterr().err.splitlines()
    assert "would be written over, but it is read here as well; choose another name" in said
    assert len(said) < 300
    assert contents(inputs) == before


@pytest.mark.parametrize(
    ("written", "is_kept"), [("head/jawOpen.obj", True), ("head/new.obj", False), ("a", False)]
)
def test_files_in_a_folder_that_is_read_are_kept(
    tmp_path: Path, written: str, is_kept: bool
) -> None:
    folder = tmp_path / "head"
    folder.mkdir()
    for name in ("head/jawOpen.obj", "a"):
        (tmp_path / name).write_text("v 0 0 0")

    def check() -> None:
        keep_inputs([tmp_path / written, None], [None, folder])

    if not is_kept:
        check()
        return
    with pytest.raises(FileError, match="read here"):
        check()
