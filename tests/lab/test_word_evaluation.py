"""Alignment and closures are measured against published times."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.sessions import shipped_engine
from support.speech import mumbling_take, needs_espeak

from faceedit_app.core.errors import FileError
from faceedit_app.lab.evaluation.words import evaluate_words, report
from faceedit_app.words.files import write_words


@needs_espeak
def test_figures_of_a_take_whose_times_are_known(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("faceedit_app.lab.evaluation.words.NOISES", (None, 0.0))  # dB
    monkeypatch.setattr("faceedit_app.lab.evaluation.words._SEEDS", 2)
    take, words = mumbling_take(tmp_path)
    write_words(tmp_path / "mumble.TextGrid", words, 3.0)
    figures = evaluate_words([take], tmp_path, shipped_engine())
    clean, noisy = figures.alignment
    assert (clean.noise, clean.edges, clean.refused) == (None, len(words.words), 0)
    assert clean.worst < 1e-3
    assert clean.within == 1.0
    assert noisy.noise == 0.0
    assert noisy.worst > 0.04 or noisy.refused
    tracked, opened = figures.closing
    for row in (tracked, opened):
        assert (row.closures, row.open_before, row.open_after, row.false) == (6, 6, 0, 0)
        assert row.gap_after <= 0.5 < row.gap_before
    assert opened.gap_before > tracked.gap_before + 1.0
    text = report(figures)
    assert "| as recorded | 8 | 0 | 0 ms | 0 ms | 0 ms | 100 % |" in text
    assert "| as tracked | 6 | 6 | 0 |" in text


@needs_espeak
def test_a_wrong_time_counts_as_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("faceedit_app.lab.evaluation.words.NOISES", (None,))
    take, words = mumbling_take(tmp_path)
    moved = words.with_edge(words.words[3].start, words.words[3].start + 1.0)
    write_words(tmp_path / "mumble.json", moved, 3.0)
    clean = evaluate_words([take], tmp_path, shipped_engine()).alignment[0]
    assert clean.worst == pytest.approx(moved.words[3].start - words.words[3].start, abs=1e-3)
    assert clean.worst > 0.01


@needs_espeak
def test_missing_words_are_named(tmp_path: Path) -> None:
    take, _ = mumbling_take(tmp_path)
    with pytest.raises(FileError, match="no words of mumble"):
        evaluate_words([take], tmp_path, shipped_engine())
    (tmp_path / "mumble.wav").unlink()
    with pytest.raises(FileError, match="no sound beside it"):
        evaluate_words([take], tmp_path, shipped_engine())
