"""`faceedit retime`: a shorter or longer take, and one line for everything that is wrong."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
from support.films import make_wav
from support.speech import said
from support.takes import make_plain_csv

from faceedit_app.cli import main
from faceedit_app.formats.opening import open_take
from faceedit_app.words.files import read_words, write_words


@pytest.fixture
def complaint(complaint: Callable[..., str]) -> Callable[..., str]:
    return partial(complaint, "retime")


def test_a_take_is_cut_and_lengthened_with_sound_and_words(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    take = make_plain_csv(tmp_path / "take.csv", 3.0)
    make_wav(tmp_path / "take.wav", 3.0)
    write_words(tmp_path / "take.TextGrid", said(("map", "M AE P"), start=1.6), 3.0)
    new = tmp_path / "new.csv"
    splices = ("--cut", "0.5-1.0", "--insert", "1.2+0.4", "--insert", "2.5+1")
    words = ("--words", tmp_path / "take.TextGrid")
    assert main(["retime", *map(str, (take, *splices, *words, "-o", new))]) == 0
    assert (
        f"{new}: 117 frames, 3.90 s; wrote new.csv, new.wav, new.TextGrid" in capfd.readouterr().out
    )
    assert open_take(new).clip.duration == pytest.approx(3.9)
    found = read_words(tmp_path / "new.TextGrid").transcript
    assert found is not None
    assert found.words[0].start == pytest.approx(1.5, abs=1e-3)


def test_words_stay_in_step_with_the_sound_of_a_take_that_has_no_face_at_first(
    tmp_path: Path,
) -> None:
    take, new = make_plain_csv(tmp_path / "take.csv", 3.0), tmp_path / "new.csv"
    head, *rows = take.read_text().splitlines()
    for row in range(6):
        rows[row] = rows[row].split(",")[0] + "," * head.count(",")
    take.write_text("\n".join([head, *rows]) + "\n")
    make_wav(tmp_path / "take.wav", 3.0)
    grid = tmp_path / "take.TextGrid"
    write_words(grid, said(("map", "M AE P"), start=1.6), 3.0)
    arguments = (take, "--cut", "0.5-1.0", "--words", grid, "-o", new)
    assert main(["retime", *map(str, arguments)]) == 0
    found = read_words(tmp_path / "new.TextGrid").transcript
    assert found is not None
    assert found.words[0].start == pytest.approx(1.1, abs=1e-3)
    assert open_take(new).lead == open_take(take).lead == 0.2


def test_a_new_take_is_replaced_only_if_asked_and_described_as_json(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], complaint: Callable[..., str]
) -> None:
    take = make_plain_csv(tmp_path / "take.csv", 3.0)
    make_wav(tmp_path / "take.wav", 3.0)
    new = make_plain_csv(tmp_path / "new.csv", 1.0)
    old = make_wav(tmp_path / "new.wav", 1.0).read_bytes()
    arguments = (take, "--cut", "0.5-1.0", "-o", new)
    assert "exists" in complaint(*arguments)
    assert main(["retime", *map(str, arguments), "--overwrite", "--json"]) == 0
    out, said = capfd.readouterr()
    assert f"{new}: the file that was there is now {tmp_path / 'new.wav.bak'}" in said
    facts = json.loads(out)
    assert (facts["path"], facts["take"], facts["frames"]) == (str(new), str(take), 75)
    assert [facts[key] for key in ("sound", "film", "words")] == [
        str(tmp_path / "new.wav"),
        None,
        None,
    ]
    assert open_take(new).clip.duration == pytest.approx(2.5)
    assert (tmp_path / "new.wav.bak").read_bytes() == old


def test_the_take_and_its_sound_are_never_replaced(
    tmp_path: Path, complaint: Callable[..., str]
) -> None:
    take = make_plain_csv(tmp_path / "take.csv", 3.0)
    make_wav(tmp_path / "take.wav", 3.0)
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    for name in ("take.csv", "take.json"):  # the sound of the second is take.wav as well
        said = complaint(take, "--cut", "0-1", "--overwrite", "-o", tmp_path / name)
        assert "is read here as well" in said
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_wrong_usage_is_reported_and_nothing_is_written(
    tmp_path: Path, complaint: Callable[..., str]
) -> None:
    take, new = make_plain_csv(tmp_path / "take.csv"), tmp_path / "new.csv"
    lines = tmp_path / "lines.txt"
    lines.write_text("map")
    there = sorted(tmp_path.iterdir())
    assert "--cut START-END or --insert" in complaint(take, "-o", new)
    for wrong in ("1", "a-b", "1.0-", "-1-2", "1e3-2", "1-2-3", ""):
        assert "must be START-END" in complaint(take, f"--cut={wrong}", "-o", new)
    assert "must be AT+SECONDS" in complaint(take, "--insert", "1-2", "-o", new)
    assert "outside the take" in complaint(take, "--cut", "1-9", "-o", new)
    assert "try 1-1.5" in complaint(take, "--cut", "1.5-1", "-o", new)
    assert f"{take}: would be written over" in complaint(take, "--cut", "1-1.5", "-o", take)
    assert "does not say when" in complaint(take, "--cut", "0-1", "--words", lines, "-o", new)
    assert "none.csv" in complaint(tmp_path / "none.csv", "--cut", "1-1.5", "-o", new)
    assert ".fbx" in complaint(take, "--cut", "1-1.5", "-o", tmp_path / "new.xyz")
    missing = complaint(take, "--cut", "1-1.5", "-o", tmp_path / "no" / "new.csv")
    assert "its folder does not exist" in missing
    assert sorted(tmp_path.iterdir()) == there


def test_a_cut_and_a_pause_where_the_face_is_lost_say_what_became_of_them(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    take, new = make_plain_csv(tmp_path / "take.csv", 3.0), tmp_path / "new.csv"
    rows = take.read_text().splitlines()
    take.write_text("\n".join(rows[:16] + rows[46:]) + "\n")  # 0.5 to 1.5 s are lost
    splices = ("--cut", "0-0.8", "--insert", "2+1", "--cut", "2.2-2.4")
    assert main(["retime", *map(str, (take, *splices, "-o", new))]) == 0
    first, *remarks = capfd.readouterr().out.splitlines()
    assert "69 frames, 2.30 s" in first
    assert remarks == [
        "  the take would begin where the face is lost, so 0.00 to 1.50 s is cut out"
    ]
    assert main(["retime", *map(str, (take, "--insert", "1+1", "-o", new, "--overwrite"))]) == 0
    first, *remarks = capfd.readouterr().out.splitlines()
    assert "60 frames, 4.00 s" in first
    assert remarks == ["  the face is lost at 1 s: that gap is longer now"]
