"""FaceEdit's own files with anything in them: they open, or are refused in one line."""

from __future__ import annotations

import contextlib
import json
import os
import random
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.places import SHARED
from support.rigs import tiny_session

from faceedit_app.core.errors import FileError
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.edit import to_json as edit_to_json
from faceedit_app.editing.files.edits_file import read_edits
from faceedit_app.editing.files.pending import pending_journals
from faceedit_app.editing.files.project import read_project
from faceedit_app.editing.help.presets import read_preset

HOSTILE = SHARED / "cases" / "hostile"
ENTRIES = [
    edit_to_json(edit)
    for edit in (
        Edit(("mouth_opening",), Op.SET, 7.45, 7.48, 0.15, 0.5, 0.1, name="Close lips"),
        Edit(("left_corner", "right_corner"), Op.OFFSET, 0.0, 9.98, 0.0, 3.0, strength=0.8),
        Edit(("upper_lip",), Op.DRAW, 0.0, 1.0, 0.0, points=((0.0, 1.0), (1.0, 2.0))),
    )
]
EDITS = {"version": 1, "edits": ENTRIES}
PRESET = EDITS | {
    "name": "x",
    "hint": "y",
    "seconds": 1.0,
    "find": "lips",
    "stretch": True,
    "alone": "take",
    "menu": "&x",
    "key": "Ctrl+0",
    "icon": "lips",
    "button": True,
}
PROJECT = EDITS | {
    "take": {"path": "take.csv", "size": 1, "sha256": "00"},
    "settings": {"mode": "preserve", "naturalness": 1.0, "reach": 1.0},
    "view": {
        "playhead": 1.0,
        "visible": [0.0, 1.0],
        "selection": None,
        "falloff": 0.2,
        "ui": {"unit": "frames", "falloff_out": 0.3},
    },
    "audio": {"path": "a.mov", "offset": 0.0},
    "film": {"path": "a.mov", "offset": 0.0},
}
HEAD = {
    "version": 1,
    "take": "/t/x.csv",
    "project": "/t/p.faceedit",
    "fingerprint": {"size": 1, "sha256": "00"},
}
MEDIA = {"sound": {"path": "/a.wav", "offset": 0.5}, "film": None}
FIRST = {"step": 1, "edits": ENTRIES, "settings": PROJECT["settings"], "media": MEDIA}
SECOND = {"step": 2, "at": 1, "drop": 1, "add": ENTRIES[:1], "settings": PROJECT["settings"]}
JOURNAL = [HEAD, FIRST, SECOND]

ODD: tuple[Any, ...] = (
    None, True, 0, -1, 7, 1.5, 1e18, 10**400, float("nan"), float("-inf"), "", "x" * 5000,
    "\ud800", "a\0b", [], [[]], [1, 2], {}, {"a": 1}, "<img src=x>",
    json.loads("[" * 90 + "]" * 90),
)  # fmt: skip


def places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Every container in a document, with a key of each of its values."""
    keys = value.keys() if isinstance(value, dict) else range(len(value))
    for key in list(keys):
        yield value, key
        if isinstance(value[key], dict | list):
            yield from places(value[key])


def mutants(document: Any, count: int, seed: int) -> Iterator[Any]:
    """The document with one to three values replaced, dropped or doubled."""
    chance = random.Random(seed)
    for _ in range(count):
        mutant = json.loads(json.dumps(document))
        for _ in range(chance.randint(1, 3)):
            if found := list(places(mutant)):
                container, key = chance.choice(found)
                match chance.randrange(8):
                    case 0:
                        del container[key]
                    case 1 if isinstance(container, dict):
                        container[chance.choice(("x", "\ud800", "<b>", "y" * 999))] = 1
                    case 2 if isinstance(container, list):
                        container.append(container[key])
                    case _:
                        container[key] = chance.choice(ODD)
        yield mutant


READERS: dict[str, tuple[Any, Callable[[Path], object]]] = {
    "edits": (EDITS, read_edits),
    "preset": (PRESET, read_preset),
    "project": (PROJECT, read_project),
}


@pytest.mark.parametrize("kind", READERS)
def test_document_of_any_shape_opens_or_is_refused_in_one_line(tmp_path: Path, kind: str) -> None:
    document, read = READERS[kind]
    path = tmp_path / "a.json"
    path.write_text(json.dumps(document), encoding="utf-8")
    read(path)
    opened = 0
    for mutant in mutants(document, 600, seed=1):
        path.write_text(json.dumps(mutant), encoding="utf-8")
        try:
            read(path)
            opened += 1
        except FileError as error:
            text = str(error)
            assert text.startswith(str(path))
            assert len(text.splitlines()) == 1
            assert len(text) < 350 + len(str(path))
            assert "; " in text, "no remedy"
    assert 0 < opened < 600


def test_journal_of_any_shape_never_stops_the_start(tmp_path: Path) -> None:
    path = tmp_path / "a.jsonl"
    found = []
    for mutant in mutants(JOURNAL, 600, seed=2):
        lines = mutant if isinstance(mutant, list) else [mutant]
        path.write_text("".join(json.dumps(line) + "\n" for line in lines), encoding="utf-8")
        found.append(len(pending_journals(tmp_path)))
    assert {*found} == {0, 1}


def test_journal_that_is_not_understood_is_kept(tmp_path: Path) -> None:
    path = tmp_path / "a.jsonl"
    later = json.dumps(HEAD | {"version": 2}) + "\n" + json.dumps(FIRST) + "\n"
    for content, kept in ((later, True), (json.dumps(HEAD) + "\n", False)):
        path.write_text(content, encoding="utf-8")
        os.utime(path, (0, 0))
        assert pending_journals(tmp_path) == []
        assert path.exists() is kept


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such files")
def test_pipe_among_the_journals_does_not_stop_the_start(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.jsonl")
    assert pending_journals(tmp_path) == []


def test_edits_that_scale_without_end_ask_for_numbers() -> None:
    session = tiny_session()
    edit = Edit(("mouth_opening",), Op.SCALE, 0.0, 10.0, 0.0, 1e6, about=0.0)
    session.add(*[edit] * 60)
    for array in (session.asked, session.achieved, session.weights):
        assert np.isfinite(array).all()
    assert session.weights.max() <= 1.0


@pytest.mark.parametrize("name", ["half \ud83d", "x" * 5000, " caf\udce9 "])
def test_any_name_that_the_user_gives_an_edit_comes_back_from_a_file(
    tmp_path: Path, name: str
) -> None:
    session = tiny_session()
    session.add(Edit(("mouth_opening",), Op.OFFSET, 0.0, 1.0, 0.0, 1.0))
    session.rename(0, name)
    assert session.edits[0].name.startswith(name.strip()[:3])
    session.save_edits(tmp_path / "e.json")
    assert read_edits(tmp_path / "e.json") == session.edits


def _hostile(*patterns: str) -> list[Path]:
    found = sorted(path for pattern in patterns for path in HOSTILE.glob(pattern))
    assert found, patterns
    return found


@pytest.mark.skipif(not HOSTILE.is_dir(), reason="the samples of hostile files are not at hand")
def test_samples_that_once_broke_a_reader_do_so_no_more(tmp_path: Path) -> None:
    for path in _hostile("*.faceedit", "*edits*.json"):
        with contextlib.suppress(FileError):
            (read_project if path.suffix == ".faceedit" else read_edits)(path)
    for path in _hostile("*.jsonl"):
        (tmp_path / path.name).write_bytes(path.read_bytes())
        pending_journals(tmp_path)
