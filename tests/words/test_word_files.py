"""Words from and to TextGrid, SRT, WebVTT, JSON and plain text."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.speech import said

from faceedit_app.core.errors import FileError
from faceedit_app.words.aligning import Line
from faceedit_app.words.files import READ_ENDINGS, read_words, spread, write_words

WORDS = said(("Blue", "B L UW"), ("map", "M AE P")).shifted(0.1)
MFA = """File type = "ooTextFile"
Object class = "TextGrid"

xmin = 0
xmax = 2
tiers? <exists>
size = 2
item []:
    item [1]:
        class = "IntervalTier"
        name = "Bob - words"
        xmin = 0
        xmax = 2
        intervals: size = 3
        intervals [1]:
            xmin = 0
            xmax = 0.5
            text = ""
        intervals [2]:
            xmin = 0.5
            xmax = 0.9
            text = "bé"
        intervals [3]:
            xmin = 0.9
            xmax = 2
            text = "sil"
    item [2]:
        class = "IntervalTier"
        name = "Bob - phones"
        xmin = 0
        xmax = 2
        intervals: size = 4
        intervals [1]:
            xmin = 0
            xmax = 0.5
            text = ""
        intervals [2]:
            xmin = 0.5
            xmax = 0.6
            text = "b"
        intervals [3]:
            xmin = 0.6
            xmax = 0.9
            text = "e"
        intervals [4]:
            xmin = 0.9
            xmax = 2
            text = "sil"
"""


@pytest.mark.parametrize("ending", [".TextGrid", ".json"])
def test_what_is_written_is_read_again(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"words{ending}"
    write_words(path, WORDS, 3.0)
    assert read_words(path).transcript == WORDS


def test_subtitles_break_at_pauses(tmp_path: Path) -> None:
    words = said(("Blue", "B L UW")).joined(said(("map", "M AE P"), start=2.0))
    write_words(tmp_path / "words.srt", words, 3.0)
    assert read_words(tmp_path / "words.srt").lines == (
        Line("Blue", 0.4, 0.76),
        Line("map", 2.0, 2.36),
    )


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_textgrids_of_other_programs_and_languages_are_read(tmp_path: Path, encoding: str) -> None:
    path = tmp_path / "mfa.TextGrid"
    path.write_bytes(MFA.encode(encoding))
    found = read_words(path).transcript
    assert found is not None
    (word,) = found.words
    assert (word.text, word.start, word.end) == ("bé", 0.5, 0.9)
    assert [p.symbol for p in word.phonemes] == ["b", "e"]


def test_a_textgrid_of_words_alone_has_the_phonemes_of_the_dictionary(tmp_path: Path) -> None:
    path = tmp_path / "words.TextGrid"
    write_words(path, said(("map", "M AE P")), 2.0)
    path.write_text(path.read_text().replace('"phones"', '"notes"'))
    found = read_words(path).transcript
    assert found is not None
    assert [p.symbol for p in found.words[0].phonemes] == ["M", "AE", "P"]


def test_webvtt_and_old_subtitles_are_read(tmp_path: Path) -> None:
    vtt = tmp_path / "a.vtt"
    vtt.write_text("WEBVTT\n\n00:00:01.000 --> 00:00:02.000\n<v Bob>Hi, <i>there</i>!\n")
    assert read_words(vtt).lines == (Line("Hi, there!", 1.0, 2.0),)
    srt = tmp_path / "a.srt"
    srt.write_bytes("1\n00:00:01,000 --> 00:00:02,500\nÉtude\n".encode("cp1252"))
    assert read_words(srt).lines == (Line("Étude", 1.0, 2.5),)


def test_words_are_spread_over_their_lines() -> None:
    words = spread((Line("hi there", 1.0, 2.0), Line("bob", 2.5, 3.1)), 9.0).words
    assert [(word.start, word.end) for word in words] == [(1.0, 1.4), (1.4, 2.0), (2.5, 3.1)]
    assert [p.symbol for p in words[2].phonemes] == ["B", "AA", "B"]


@pytest.mark.parametrize("ending", READ_ENDINGS)
@pytest.mark.parametrize("content", [b"", b"\0\1\2", b"{}", b"[1]", b"..."], ids=repr)
def test_files_without_words_are_refused_in_one_line(
    tmp_path: Path, ending: str, content: bytes
) -> None:
    path = tmp_path / f"bad{ending}"
    path.write_bytes(content)
    with pytest.raises(FileError) as caught:
        read_words(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_words_that_overlap_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "bad.json"
    path.write_text(
        '{"version": 1, "words": [{"text": "a", "start": 0, "end": 2},'
        ' {"text": "b", "start": 1, "end": 3}]}'
    )
    with pytest.raises(FileError, match="order of time"):
        read_words(path)


def test_a_wrong_ending_and_a_missing_file_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="ending"):
        write_words(tmp_path / "words.doc", WORDS, 3.0)
    for path in (tmp_path, tmp_path / "none.srt"):
        with pytest.raises(FileError, match="missing or not a file"):
            read_words(path)
