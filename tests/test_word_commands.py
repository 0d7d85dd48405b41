"""`faceedit words`: what it prints and writes, and one line for everything that is wrong."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from support.films import make_wav
from support.speech import SENTENCE, mumbling_take, needs_espeak, speak
from support.takes import make_livelink_csv

from faceedit_app.cli import main
from faceedit_app.formats.opening import open_take
from faceedit_app.words.files import read_words

Run = Callable[..., dict[str, Any]]


@pytest.fixture
def run(capfd: pytest.CaptureFixture[str]) -> Run:
    """Runs `faceedit words --json`, and gives what it prints."""

    def run(*arguments: object) -> dict[str, Any]:
        capfd.readouterr()
        assert main(["words", *map(str, arguments), "--json"]) == 0
        found: dict[str, Any] = json.loads(capfd.readouterr().out)
        return found

    return run


@pytest.fixture
def complaint(capfd: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """Runs it where it must fail, and gives its one line."""

    def run(*arguments: object) -> str:
        capfd.readouterr()
        assert main(["words", *map(str, arguments)]) == 2
        out, err = capfd.readouterr()
        assert (out, len(err.splitlines())) == ("", 1), err
        return err

    return run


@needs_espeak
def test_words_of_a_sound(tmp_path: Path, run: Run) -> None:
    found = run(speak(tmp_path / "said.wav"), "--text", SENTENCE)
    assert [word["text"] for word in found["words"]] == SENTENCE.split()
    assert found["phonemes"][0]["text"] == "M"
    assert found["closures"] == []
    assert all(part["start"] < part["end"] for part in found["words"] + found["phonemes"])


@needs_espeak
def test_closures_of_a_take_are_found_and_fixed(tmp_path: Path, run: Run) -> None:
    take, _ = mumbling_take(tmp_path)
    before = run(take, "--text", SENTENCE)["closures"]
    assert [c["phoneme"] for c in before] == ["M", "M", "M", "B", "P", "P"]
    assert all(c["gap_mm"] > 0.5 and not c["fixed"] for c in before)
    out = tmp_path / "fixed.csv"
    after = run(take, "--text", SENTENCE, "--fix", "-o", out)["closures"]
    assert all(c["fixed"] and c["gap_after_mm"] <= 0.5 for c in after)
    assert [c["gap_mm"] for c in after] == [c["gap_mm"] for c in before]
    old, new = open_take(take).clip, open_take(out).clip
    assert (old.weights != new.weights).any()
    words = tmp_path / "words.json"
    run(take, "--text", SENTENCE, "--save", words)
    assert all(c["gap_mm"] <= 0.5 for c in run(out, "--words", words)["closures"])


@needs_espeak
def test_words_from_a_file_need_no_sound(tmp_path: Path, run: Run) -> None:
    take, words = mumbling_take(tmp_path)
    grid = tmp_path / "words.TextGrid"
    run(take, "--text", SENTENCE, "--save", grid)
    assert read_words(grid).transcript is not None
    (tmp_path / "mumble.wav").unlink()
    found = run(take, "--words", grid)
    assert len(found["closures"]) == 6
    assert found["words"][1]["start"] == pytest.approx(words.words[1].start, abs=1e-3)


@needs_espeak
def test_subtitles_are_aligned_to_the_sound(tmp_path: Path, run: Run) -> None:
    take, words = mumbling_take(tmp_path)
    srt = tmp_path / "words.srt"
    srt.write_text(f"1\n00:00:00,000 --> 00:00:02,600\n{SENTENCE}\n")
    found = run(take, "--words", srt)["words"]
    assert found[3]["start"] == pytest.approx(words.words[3].start, abs=0.05)


@needs_espeak
def test_a_spelling_helps_with_an_unknown_word(
    tmp_path: Path, run: Run, complaint: Callable[..., str]
) -> None:
    sound, text = speak(tmp_path / "said.wav"), SENTENCE.replace("soup", "zoop")
    assert "“zoop”; give English words, such as --sounds-like zoop=" in complaint(
        sound, "--text", text
    )
    assert run(sound, "--text", text, "--sounds-like", "zoop=soup")["words"][-1]["text"] == "zoop"
    assert "WORD=SPELLING" in complaint(sound, "--text", text, "--sounds-like", "zoop")


def test_wrong_usage_and_bad_input_are_reported(
    tmp_path: Path, complaint: Callable[..., str]
) -> None:
    take, sound = make_livelink_csv(tmp_path / "take.csv"), make_wav(tmp_path / "beep.wav")
    assert "--text" in complaint(take)
    assert "--text" in complaint(take, "--text", "a", "--words", take)
    assert "-o" in complaint(take, "--text", "hello", "--fix")
    assert "-o" in complaint(take, "--text", "hello", "-o", tmp_path / "out.csv")
    assert "is a sound" in complaint(sound, "--text", "a", "--fix", "-o", tmp_path / "out.csv")
    assert f"{take}: has no sound beside it" in complaint(take, "--text", "hello there")
    assert f"{sound}: The words do not fit" in complaint(sound, "--text", "my mother made apple")
    assert "cannot be said" in complaint(sound, "--text", "word " * 50)
    assert "none.srt" in complaint(take, "--words", tmp_path / "none.srt")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["beep.wav", "take.csv"]
