"""What a command will write is checked before it reads or works."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest


def no_edits(folder: Path) -> Path:
    path = folder / "edits.json"
    path.write_text('{"version": 1, "edits": []}', encoding="utf-8")
    return path


def test_output_that_cannot_be_written_is_reported(
    take: Path, models: str, complaint: Callable[..., str]
) -> None:
    edits = no_edits(take.parent)
    for out in (take.parent / "none" / "out.csv", take.parent):
        text = complaint("apply", take, edits, "-o", out, "--models", models)
        assert f"{out}: cannot be written" in text
    assert sorted(p.name for p in take.parent.iterdir()) == ["edits.json", "take.csv"]


@pytest.mark.parametrize(
    "line",
    [
        "apply none.csv none.json -o {out}",
        "convert none.csv {out}",
        "render none.csv -o {out}",
        "render none.csv -o {out} --format mp4",
        "retime none.csv --cut 1-2 -o {out}",
        "words none.csv --text hello --save {out}",
        "words none.csv --text hello --fix -o {out}",
        "character make none.obj -o {out}",
        "evaluate-words none.csv --words none --report {out}",
        "evaluate-tracking none.csv --json {out}",
    ],
)
def test_output_is_checked_before_anything_is_read(
    line: str, tmp_path: Path, complaint: Callable[..., str]
) -> None:
    (tmp_path / "file").touch()
    folders = {"no": "its folder does not exist", "file": "not a directory"}
    for folder, why in folders.items():
        out = tmp_path / folder / "out.png"
        text = complaint(*line.format(out=out).split())
        assert f"{out}: cannot be written ({why})" in text


def test_what_an_output_is_called_is_checked_before_anything_is_read(
    tmp_path: Path, complaint: Callable[..., str]
) -> None:
    for line, says in (
        ("words none.csv --text hello --save {}/words.doc", "has no ending for words"),
        ("words none.wav --text hello --fix -o {}/new.csv", "is a sound; --fix and --retime-to"),
        ("apply none.csv none.json -o {}/new.mp4", "is the name of a film"),
        ("render none.csv -o {}/new.mp4 --view all", "--view all: must be face"),
        ("render none.csv -o {}/new.mp4 --film-fps 0", "give 1 to 1000"),
    ):
        assert says in complaint(*line.format(tmp_path).split())


def test_output_folders_are_checked_before_anything_is_read(
    tmp_path: Path, complaint: Callable[..., str]
) -> None:
    (file := tmp_path / "file").touch()
    for line in (
        "render none.csv --format png -o",
        "synthesize -o",
        "train --data none -o",
        "experiment card -o",
        "evaluate none.csv --report",
    ):
        assert f"{file}: cannot be a folder (file is a file)" in complaint(*line.split(), file)


def test_output_that_is_a_device_is_left_alone(
    take: Path, models: str, complaint: Callable[..., str]
) -> None:
    device = Path("/dev/null")
    if not device.is_char_device():
        pytest.skip("this system has no /dev/null")
    edits = no_edits(take.parent)
    assert "cannot be written" in complaint("apply", take, edits, "-o", device, "--models", models)
    assert device.is_char_device()
