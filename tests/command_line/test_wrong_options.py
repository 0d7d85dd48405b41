"""What is said about options and files that cannot be meant: what is wrong, and what to do."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

FILES = {
    "array.json": b'{"version": 1, "edits": [{},]}',
    "object.json": b'{"version": 1,\n "edits": [{"a": 1,}]}',
    "quote.json": b'{"version": 1, "edits": [}',
    "lines.ass": b"\xef\xbb\xbf[Script Info]\nTitle: x\n",
    "film.mpg": b"\0\0\x01\xba\0\0\0\x01\xe0",
    "film.mp4": b"\0\0\0\x18ftypmp42 and no more",
    "sound.wav": b"RIFF and no more",
    "scene.usdz": b"PK\x03\x04 scene.usdc",
}
CASES = (
    ("words take.csv --text", "--text is empty"),
    ("words take.csv --text a --words lines.ass", "leave one of them out"),
    ("words take.csv --words lines.ass", "holds subtitles in the format ASS; save them as SRT"),
    ("words sound.wav --text a", "or convert it to WAV and use that"),
    ("track film.mp4", "or convert it to MP4 (H.264) and use that"),
    ("info film.mpg", "is a film, not a take; faceedit track makes a take of it"),
    ("convert film.mp4 new.csv", "begins like a film or a sound, but is not whole; copy it again"),
    ("info scene.usdz", "is a USD package; save it as text (.usda): usdcat"),
    ("apply take.csv smile -o new.csv", "is a preset, not a file of edits; faceedit batch smile"),
    ("apply take.csv smiles -o new.csv", "smiles: cannot be read"),
    ("apply take.csv array.json -o new.csv", 'the comma before "]" is one too many'),
    ("apply take.csv object.json -o new.csv", 'line 2: is not JSON (the comma before "}" is one'),
    ("apply take.csv quote.json -o new.csv", "(expecting value at column 26)"),
    ("retime take.csv --cut 0.6-0.2 -o new.csv", "--cut 0.6-0.2: its end is before its start"),
    ("retime take.csv --cut 0.6-0.6 -o new.csv", "--cut 0.6-0.6: cuts nothing out"),
    ("retime take.csv --insert 1+0 -o new.csv", "--insert 1+0: inserts nothing"),
    ("convert take.csv new.csv --compact", "--compact does nothing in the format Live Link Face"),
    ("convert take.csv new.fbx --compact", "--compact does nothing in the format FBX"),
    ("convert take.csv new.csv --follow-head", "--follow-head does nothing in the format"),
    ("convert take.csv new.csv --character a.glb", "it is for glb, fbx, usd and usdz"),
)


def test_what_cannot_be_meant_is_said_with_a_remedy(
    take: Path, monkeypatch: pytest.MonkeyPatch, complaint: Callable[..., str]
) -> None:
    monkeypatch.chdir(take.parent)
    for name, content in FILES.items():
        Path(name).write_bytes(content)
    before = sorted(take.parent.iterdir())
    for command, says in CASES:
        words = command.split()
        assert says in complaint(*words, *([""] if words[-1] == "--text" else [])), command
    assert sorted(take.parent.iterdir()) == before
