"""`faceedit apply` says what is surely a mistake."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.takes import make_livelink_csv

from faceedit_app.cli import main


def edits_at(folder: Path, start: float) -> Path:
    entry = {"control": "mouth_opening", "op": "offset", "start": start, "end": start + 0.4}
    path = folder / "edits.json"
    text = json.dumps({"version": 1, "edits": [entry | {"falloff": 0.2, "value": 6.0}]})
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("start", "warning"),
    [
        (100.0, "edit 1: begins at 99.800 s, after the take's end"),
        (-5.0, "edit 1: ends at -4.400 s, before the take begins"),
        (1.0, ""),
    ],
)
def test_an_edit_outside_the_take_is_named(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], start: float, warning: str
) -> None:
    take, out = make_livelink_csv(tmp_path / "take.csv"), tmp_path / "out.csv"
    assert main(["apply", str(take), str(edits_at(tmp_path, start)), "-o", str(out)]) == 0
    said = capfd.readouterr().err
    assert said == (f"faceedit: warning: {warning}\n" if warning else "")
    assert (out.read_bytes() == take.read_bytes()) == bool(warning)


def test_a_take_is_not_written_under_the_name_of_a_film(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    take, out = make_livelink_csv(tmp_path / "take.csv"), tmp_path / "out.mp4"
    assert main(["apply", str(take), str(edits_at(tmp_path, 1.0)), "-o", str(out)]) == 2
    assert "is the name of a film; use faceedit render" in capfd.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize("decimals", [2, 4, 10])
def test_as_many_frames_are_changed_as_the_command_says(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], decimals: int
) -> None:
    """A change below the file's digits is in no row."""
    take = make_livelink_csv(tmp_path / "take.csv", decimals=decimals)
    out = tmp_path / "out.csv"
    assert main(["apply", str(take), str(edits_at(tmp_path, 1.0)), "-o", str(out)]) == 0
    pairs = zip(take.read_text().splitlines(), out.read_text().splitlines(), strict=True)
    rows = sum(1 for before, after in pairs if before != after)
    assert rows > 0
    assert f", {rows} of 120 frames changed" in capfd.readouterr().out
