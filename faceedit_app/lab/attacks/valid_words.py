"""Valid files of words: those that FaceEdit writes, captions, and what speech recognisers write."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from faceedit_app.lab.attacks.reader import Reader, Wrong
from faceedit_app.words.files import WRITE_ENDINGS, read_words, write_words
from faceedit_app.words.transcript import Phoneme, Transcript, Word

SAID = Transcript(
    (
        Word("blue", 0.2, 0.5, (Phoneme("B", 0.2, 0.3), Phoneme("UW", 0.3, 0.5))),
        Word("map", 1.2, 1.5, (Phoneme("M", 1.2, 1.5),)),
    ),
    sounds_like=(("blue", "bloo"),),
)
_SHORT_TEXTGRID = """File type = "ooTextFile"
Object class = "TextGrid"

0
2
<exists>
1
"IntervalTier"
"words"
0
2
3
0
0.5
""
0.5
0.9
"blue"
0.9
2
"map"
"""


def word_readers(folder: Path) -> Iterator[Reader]:
    """The reader of words, once for each format and dialect.

    Args:
        folder: where files are made.
    """
    for ending in WRITE_ENDINGS:
        write_words(folder / f"words{ending}", SAID, 2.0)
        yield Reader("words", ending, (folder / f"words{ending}").read_bytes(), read_timed_words)
    yield Reader("words", ".TextGrid", _SHORT_TEXTGRID.encode("utf-16"), read_timed_words)
    captions = "WEBVTT\n\nNOTE x\n\n00:00.200 --> 00:00.500\n<v Bob>blue<00:00.300> &amp;\n"
    yield Reader("words", ".vtt", captions.encode(), read_timed_words)
    yield Reader(
        "words", ".txt", "Blue map, “blue” — 12 maps & 3 %.\n".encode("cp1252"), read_timed_words
    )
    for document in _recognised():
        yield Reader("words", ".json", json.dumps(document).encode(), read_timed_words)


def read_timed_words(path: Path) -> None:
    """Read words; their times must run forward."""
    found = read_words(path)
    for line in found.lines:
        if line.start is not None and not abs(line.start) < 1e7:
            raise Wrong(f"a line begins at {line.start} s")
    words = found.transcript.words if found.transcript is not None else ()
    if any(not word.start <= word.end for word in words):
        raise Wrong("a word ends before it begins")


def _recognised() -> Iterator[Any]:
    """What Whisper, whisper.cpp, Gentle, Deepgram, AssemblyAI, Amazon and Vosk write."""
    times = {"start": 0.2, "end": 0.5}
    word = {"word": "blue", **times, "probability": 0.9}
    segment = {"id": 0, "start": 0.2, "end": 1.5, "text": " blue map", "words": [word]}
    yield {"text": "blue map", "segments": [segment]}
    clocks = {"from": "00:00:00,200", "to": "00:00:01,500"}
    offsets = {"from": 200, "to": 1500}
    yield {"transcription": [{"timestamps": clocks, "offsets": offsets, "text": " blue map"}]}
    phones = [{"duration": 0.1, "phone": "b_B"}]
    yield {"transcript": "blue", "words": [{"case": "success", **word, "phones": phones}]}
    heard = {"transcript": "blue map", "words": [{**word, "punctuated_word": "Blue."}]}
    yield {"results": {"channels": [{"alternatives": [heard]}]}}
    yield {"text": "blue", "words": [{"text": "blue", "start": 200, "end": 500}]}
    choice = [{"confidence": "0.9", "content": "blue"}]
    item = {"start_time": "0.2", "end_time": "0.5", "alternatives": choice, "type": "pronunciation"}
    yield {"results": {"transcripts": [{"transcript": "blue"}], "items": [item]}}
    yield {"result": [{"conf": 1.0, **times, "word": "blue"}], "text": "blue"}
    yield {"chunks": [{"text": " blue map", "timestamp": [0.2, 1.5]}]}
