"""Words from and to TextGrid, SRT, WebVTT, JSON and plain text."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.speech import said

from faceedit_app.core.errors import FileError
from faceedit_app.words.aligning import TextLine
from faceedit_app.words.files import READ_ENDINGS, read_words, write_words
from faceedit_app.words.imported import spread

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
        TextLine("Blue", 0.4, 0.76),
        TextLine("map", 2.0, 2.36),
    )


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-32"])
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


@pytest.mark.parametrize(
    ("words", "symbols"),
    [
        ((("neu", "n OY"), ("Schuh", "S u:")), "n OY ʃ u:"),
        ((("say", "S EY1"), ("zoo", "Z UW1")), "S EY1 Z UW1"),
    ],
    ids=["SAMPA", "ARPABET"],
)
def test_s_is_sh_only_where_all_symbols_are_those_of_sampa(
    tmp_path: Path, words: tuple[tuple[str, str], ...], symbols: str
) -> None:
    for ending in (".TextGrid", ".json"):
        path = tmp_path / f"words{ending}"
        write_words(path, said(*words), 2.0)
        found = read_words(path).transcript
        assert found is not None
        assert [p.symbol for _, p in found.phonemes()] == symbols.split()


def test_webvtt_and_old_subtitles_are_read(tmp_path: Path) -> None:
    vtt = tmp_path / "a.vtt"
    vtt.write_text("WEBVTT\n\n00:00:01.000 --> 00:00:02.000\n<v Bob>Hi, <i>there</i>!\n")
    assert read_words(vtt).lines == (TextLine("Hi, there!", 1.0, 2.0),)
    vtt.write_text(vtt.read_text().removeprefix("WEBVTT\n\n").replace("00:00:0", "00:0"))
    assert read_words(vtt).lines == (TextLine("Hi, there!", 1.0, 2.0),)
    srt = tmp_path / "a.srt"
    srt.write_bytes("1\n00:00:01,000 --> 00:00:02,500\nÉtude\n".encode("cp1252"))
    assert read_words(srt).lines == (TextLine("Étude", 1.0, 2.5),)


def test_names_of_speakers_in_subtitles_are_left_out(tmp_path: Path) -> None:
    path = tmp_path / "a.srt"
    path.write_text(
        "1\n00:00:01,000 --> 00:00:02,000\nMRS. O'NEIL: Hi!\n- BOB 2: NASA: ok\nWARNING: FIRE\n"
    )
    assert read_words(path).lines == (TextLine("Hi!\nNASA: ok\nWARNING: FIRE", 1.0, 2.0),)


def test_words_are_spread_over_their_lines() -> None:
    words = spread((TextLine("hi there", 1.0, 2.0), TextLine("bob", 2.5, 3.1)), 9.0).words
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


SRT = "2\n00:00:03,000 --> 00:00:04,000\na bowl\n\n1\n00:00:01,000 --> 00:00:03,500\nMy mother\n"
LINES = (TextLine("My mother", 1.0, 3.5), TextLine("a bowl", 3.0, 4.0))


@pytest.mark.parametrize("ending", [".srt", ".vtt", ".txt"])
@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"], ids=repr)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16-le", "utf-16-be", "utf-32", "cp1252"])
def test_subtitles_are_known_by_their_content(
    tmp_path: Path, ending: str, newline: str, encoding: str
) -> None:
    path = tmp_path / f"lines{ending}"
    path.write_bytes(SRT.replace("\n", newline).encode(encoding))
    assert read_words(path).lines == LINES


@pytest.mark.parametrize(("text", "encoding"), [("Привет, мир", "cp1251"), ("こんにちは", "sjis")])
def test_letters_that_would_be_wrong_are_refused(tmp_path: Path, text: str, encoding: str) -> None:
    path = tmp_path / "lines.srt"
    subtitles = f"1\n00:00:01,000 --> 00:00:02,500\n{text}\n"
    path.write_bytes(subtitles.encode(encoding))
    with pytest.raises(FileError, match="unknown encoding; save it again as UTF-8"):
        read_words(path)
    path.write_text(subtitles, encoding="utf-8")
    assert read_words(path).lines == (TextLine(text, 1.0, 2.5),)


def test_captions_that_roll_up_are_said_once(tmp_path: Path) -> None:
    path = tmp_path / "captions.vtt"
    path.write_text(
        "WEBVTT\nKind: captions\n\n00:00:00.500 --> 00:00:02.000 align:start\n"
        "my<00:00:00.900><c> mother</c>\n\n"
        "00:00:02.000 --> 00:00:02.010\nmy mother\n\n"
        "00:00:02.010 --> 00:00:04.000\nmy mother\nmade salt &amp; soup\n\n"
        "NOTE nothing\n\n00:00:04.000 --> 00:00:05.000\n♪ ♪\n"
    )
    assert read_words(path).lines == (
        TextLine("my mother", 0.5, 2.0),
        TextLine("made salt & soup", 2.01, 4.0),
    )


@pytest.mark.parametrize(
    "content",
    [
        '{"text": "hi there", "segments": [{"id": 0, "start": 1.0, "end": 2.0, "text": " hi there",'
        ' "words": [{"word": " hi", "start": 1.1, "end": 1.4}]}], "language": "en"}',
        '[{"word": "hi", "start": "1s", "end": "1.5"}, {"word": "there", "start": 1.6, "end": 2}]',
        '{"chunks": [{"timestamp": [1.0, 2.0], "text": " hi there"}]}',
        '{"results": [{"alternatives": [{"transcript": "hi there", "words": ['
        '{"word": "hi", "startTime": "1s", "endTime": "1.2s"},'
        ' {"word": "there", "startTime": "1.2s", "endTime": "2s"}]}]}]}',
        '{"fragments": [{"begin": "1.000", "end": "2.000", "lines": ["x"], "text": "hi there"}]}',
        '{"transcription": [{"timestamps": {"from": "00:00:01,000", "to": "00:00:02,000"},'
        ' "offsets": {"from": 1000, "to": 2000}, "text": " hi there"}]}',
        '{"results": {"items": [{"start_time": "1.0", "end_time": "1.4", "alternatives": '
        '[{"content": "hi"}]}, {"start_time": "1.4", "end_time": "2.0", "alternatives": '
        '[{"content": "there"}]}, {"type": "punctuation", "alternatives": [{"content": "."}]}]}}',
        '{"words": [{"text": "hi", "start": 1000, "end": 1400},'
        ' {"text": "there", "start": 1400, "end": 2000}], "text": "hi there"}',
    ],
)
def test_json_of_speech_recognisers_gives_lines(tmp_path: Path, content: str) -> None:
    path = tmp_path / "said.json"
    path.write_text(content)
    assert read_words(path).lines == (TextLine("hi there", 1.0, 2.0),)


@pytest.mark.parametrize(
    "content",
    [
        '{"text": "hi there"}',
        '[{"text": "%shi", "start": 1, "end": 2}]' % (10_000 * "!"),  # too long, then without words
    ],
)
def test_json_without_texts_with_times_is_refused(tmp_path: Path, content: str) -> None:
    path = tmp_path / "said.json"
    path.write_text(content)
    with pytest.raises(FileError, match="no texts with times that FaceEdit knows; save it as SRT"):
        read_words(path)


def grid(*tiers: tuple[str, list[tuple[float, float, str]]], kind: str = "IntervalTier") -> str:
    """A TextGrid in Praat's short form."""
    rows = ['File type = "ooTextFile"', 'Object class = "TextGrid"', "", "0", "2", "<exists>"]
    rows.append(str(len(tiers)))
    for name, entries in tiers:
        rows += [f'"{kind}"', f'"{name}"', "0", "2", str(len(entries))]
        rows += [f'{start}\n{end}\n"{text}"' for start, end, text in entries]
    return "\n".join(rows) + "\n"


BE, MAP = (0.0, 1.0, "be"), (1.0, 2.0, "map")


@pytest.mark.parametrize(
    "text",
    [
        grid(("words", [BE, MAP])),
        grid(("words", [MAP, BE])),
        grid(("what Ann says", [BE, MAP])),
        grid(("notes", [(0.0, 2.0, "x")]), ("Ann - words", [BE, MAP]), ("Bob - words", [])),
    ],
)
def test_textgrids_are_read_short_unsorted_and_by_speaker(tmp_path: Path, text: str) -> None:
    path = tmp_path / "words.TextGrid"
    path.write_text(text)
    found = read_words(path).transcript
    assert found is not None
    assert [(w.text, w.start, w.end) for w in found.words] == [("be", 0.0, 1.0), ("map", 1.0, 2.0)]


def test_intervals_of_several_words_are_lines(tmp_path: Path) -> None:
    path = tmp_path / "words.TextGrid"
    path.write_text(grid(("words", [(0.0, 1.0, "be my map"), MAP])))
    found = read_words(path)
    assert found.transcript is None
    assert found.lines == (TextLine("be my map", 0.0, 1.0), TextLine("map", 1.0, 2.0))


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (grid(("words", [BE, (0.5, 2.0, "map")])), "overlap in time"),
        (grid(("words", [(1.0, 0.5, "be")])), "cannot occur after"),
        (grid(("words", [])), "holds no words"),
        (grid(("words", [(0.0, 2.0, "sil")])), "holds no words"),
        (grid(("words", []), kind="TextTier"), "no intervals, only points"),
        (grid(("a", [BE]), ("b", [MAP])), "no tier of words or phones, only: a, b"),
        (grid(("Ann - words", [BE]), ("Bob - words", [MAP])), "several speakers: Ann, Bob"),
        (grid(("words", [BE]))[:60], "not a TextGrid"),
        (grid(("words", [(float("nan"), 1.0, "be")])), "not a number"),
        (grid(("words", [BE])).replace('"words"\n0', '"words"\n' + 400 * "1"), "not a TextGrid"),
        (grid(("words", [(10**400, 1.0, "be")])), "cannot occur after"),
        ('{"a":' * 3000, "not a TextGrid"),
    ],
)
def test_textgrids_that_are_wrong_say_how(tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "words.TextGrid"
    path.write_text(text)
    with pytest.raises(FileError, match=says) as caught:
        read_words(path)
    assert "\n" not in str(caught.value)


def test_rich_text_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "words.txt"
    path.write_text(r"{\rtf1\ansi hello}")
    with pytest.raises(FileError, match="plain text"):
        read_words(path)
