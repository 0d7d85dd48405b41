"""`faceedit words`: what it prints and writes, and one line for everything that is wrong."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.films import make_wav
from support.speech import SENTENCE, mumbling_clip, mumbling_take, needs_espeak, said, speak
from support.takes import make_livelink_csv

from faceedit_app.cli import main
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.formats.opening import open_take
from faceedit_app.words.files import read_words, write_words
from faceedit_app.words.transcript import Transcript

Run = Callable[..., dict[str, Any]]


@pytest.fixture
def run(printed: Run) -> Run:
    return partial(printed, "words")


@pytest.fixture
def complaint(complaint: Callable[..., str]) -> Callable[..., str]:
    return partial(complaint, "words")


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


def test_times_in_files_count_from_the_beginning_of_the_sound(tmp_path: Path, run: Run) -> None:
    take = make_livelink_csv(
        tmp_path / "take.csv", untracked=range(30)
    )  # no face for half a second
    make_wav(tmp_path / "take.wav")
    words, saved = said(("map", "M AE P"), start=0.7), tmp_path / "saved.json"
    write_words(tmp_path / "given.json", words, 2.0)
    found = run(take, "--words", tmp_path / "given.json", "--save", saved)
    assert found["words"][0]["start"] == pytest.approx(0.2, abs=1e-3)  # of the take
    assert read_words(saved).transcript == words
    saved.write_text(json.dumps(found))  # what is printed can be read as well
    assert read_words(saved).transcript == words


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
    assert "--fix" in complaint(take, "--text", "hello", "-o", tmp_path / "out.csv")
    assert "--words said.srt" in complaint(take, "--text", "said.srt")
    assert "-o" in complaint(take, "--text", "hello", "-o", tmp_path / "out.csv")
    assert "is a sound" in complaint(sound, "--text", "a", "--fix", "-o", tmp_path / "out.csv")
    assert f"{take}: has no sound beside it" in complaint(take, "--text", "hello there")
    assert f"{sound}: The words do not fit" in complaint(sound, "--text", "my mother made apple")
    assert "cannot be said" in complaint(sound, "--text", "word " * 50)
    assert "none.srt" in complaint(take, "--words", tmp_path / "none.srt")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["beep.wav", "take.csv"]


def flat_take(folder: Path, words: Transcript) -> Path:
    """A take without a sound whose mouth says some words."""
    clip = mumbling_clip(words, 4.0)
    lines = [",".join(["time_s", *ARKIT_CHANNELS])]
    for seconds, row in zip(clip.times, clip.weights, strict=True):
        lines.append(",".join([f"{seconds:.4f}", *(f"{weight:.5f}" for weight in row)]))
    path = folder / "flat.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="")
    return path


def test_a_take_is_retimed_to_the_times_in_a_file(tmp_path: Path, run: Run) -> None:
    pairs = (("map", "M AE P"), ("boom", "B UW M"), ("fish", "F IH SH"))
    ours, theirs = said(*pairs, start=0.6), said(*pairs, start=1.0, each=0.15)
    take, out = flat_take(tmp_path, ours), tmp_path / "out.csv"
    for name, transcript in (("ours", ours), ("theirs", theirs)):
        write_words(tmp_path / f"{name}.TextGrid", transcript, 4.0)
    files = ("--words", tmp_path / "ours.TextGrid", "--retime-to", tmp_path / "theirs.TextGrid")
    found = run(take, *files, "--their-start", "0.1", "-o", out)
    assert (found["retime"]["matched"], found["retime"]["phonemes"]) == (9, 9)
    assert found["retime"]["their_start"] == 0.1
    assert found["words"][0]["start"] == pytest.approx(1.1, abs=1e-3)
    before, after = open_take(take).clip, open_take(out).clip
    middles = [
        [round(30 * (p.start + p.end + 2 * shift)) for _, p in side.phonemes()]
        for side, shift in ((ours, 0.0), (theirs, 0.1))
    ]
    jaw = before.channels.index("jawOpen")
    assert after.weights[middles[1], jaw] == pytest.approx(
        before.weights[middles[0], jaw], abs=0.03
    )
    assert np.array_equal(after.weights[-30:], before.weights[-30:])
    assert len(after) == len(before)


def test_a_fix_says_what_it_wrote_and_how_much_it_closed(
    tmp_path: Path, run: Run, capfd: pytest.CaptureFixture[str]
) -> None:
    words = said(("map", "M AE P"), ("boom", "B UW M"), start=0.6)
    take, out = flat_take(tmp_path, words), tmp_path / "out.csv"
    write_words(tmp_path / "ours.TextGrid", words, 4.0)
    given = (take, "--words", tmp_path / "ours.TextGrid", "--fix", "-o", out)
    found = run(*given)
    fixed = sum(closure["fixed"] for closure in found["closures"])
    assert fixed > 1
    assert found["path"] == str(out)
    assert main(["words", *map(str, given)]) == 0
    last = capfd.readouterr().out.splitlines()[-1]
    assert last == f"{out}: the edited take, {fixed} closures fixed"


@needs_espeak
def test_a_take_is_retimed_to_another_sound(tmp_path: Path, run: Run) -> None:
    take, words = mumbling_take(tmp_path)
    (tmp_path / "other").mkdir()
    slower = speak(tmp_path / "other" / "dub.wav", SENTENCE, pace=120)
    out = tmp_path / "out.csv"
    found = run(take, "--text", SENTENCE, "--retime-to", slower, "--fix", "-o", out)
    assert found["retime"]["matched"] == len(list(words.phonemes()))
    assert all(closure["gap_after_mm"] <= 0.5 for closure in found["closures"])
    assert len(open_take(out).clip) == len(open_take(take).clip)


def test_what_cannot_be_retimed_is_one_line(tmp_path: Path, complaint: Callable[..., str]) -> None:
    ours = said(("map", "M AE P"), ("boom", "B UW M"), start=0.6)
    take, out = flat_take(tmp_path, ours), tmp_path / "out.csv"
    grid, other, lines = (tmp_path / name for name in ("a.TextGrid", "b.TextGrid", "c.txt"))
    write_words(grid, ours, 4.0)
    write_words(other, said(("sky", "S K AY"), ("green", "G R IY N")), 4.0)
    lines.write_text("map boom")
    mine = (take, "--words", grid)
    assert "-o" in complaint(*mine, "--retime-to", grid)
    assert "--their-start" in complaint(*mine, "--their-start", "1", "--fix", "-o", out)
    assert f"{other}: Only" in complaint(*mine, "--retime-to", other, "-o", out)
    assert f"{lines}: does not say when" in complaint(*mine, "--retime-to", lines, "-o", out)
    sound = make_wav(tmp_path / "beep.wav")
    assert f"{sound}: The words do not fit" in complaint(*mine, "--retime-to", sound, "-o", out)
    assert "need a take" in complaint(sound, "--text", "a", "--retime-to", grid, "-o", out)
    assert "none.wav" in complaint(
        *mine, "--retime-to", tmp_path / "none.wav", "--their-text", "a", "-o", out
    )
    assert not out.exists()
