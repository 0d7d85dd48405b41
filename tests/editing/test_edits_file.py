"""Edits in files: what is saved is read again, and what is wrong is reported in one line."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.edits import edits

from faceedit_app.core.errors import FileError
from faceedit_app.editing.edits.edit import (
    Edit,
    Op,
)
from faceedit_app.editing.files.edits_file import read_edits, write_edits

GOOD: dict[str, Any] = {
    "control": "mouth_opening",
    "op": "offset",
    "start": 2.0,
    "end": 2.4,
    "falloff": 0.2,
    "value": 8.0,
}


def without(*names: str, **changes: Any) -> dict[str, Any]:
    return {k: v for k, v in GOOD.items() if k not in names} | changes


def saved(path: Path, *entries: Any) -> Path:
    path.write_text(json.dumps({"version": 1, "edits": entries}), encoding="utf-8")
    return path


def complaint(path: Path) -> str:
    with pytest.raises(FileError) as caught:
        read_edits(path)
    text = str(caught.value)
    assert text.startswith(str(path))
    assert len(text.splitlines()) == 1
    assert "; " in text, "no remedy"
    return text


@given(st.lists(edits(), max_size=6))
@settings(
    deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
def test_edits_come_back_as_they_were_saved(tmp_path: Path, some: list[Edit]) -> None:
    path = tmp_path / "edits.json"
    write_edits(path, some)
    assert read_edits(path) == tuple(some)


def test_file_has_one_edit_a_line_for_people(tmp_path: Path) -> None:
    edit = Edit(("mouth_opening",), Op.OFFSET, 2.0, 2.4, 0.2, 8.0)
    write_edits(tmp_path / "edits.json", [edit, edit])
    lines = (tmp_path / "edits.json").read_text(encoding="utf-8").splitlines()
    assert sum('"offset"' in line for line in lines) == 2
    assert json.loads(lines[3].rstrip(",")) == GOOD


def test_documented_example_is_read(tmp_path: Path) -> None:
    path = tmp_path / "edits.json"
    path.write_text(
        '{"version": 1, "edits": [{"control": "mouth_opening", "op": "offset", "start": 2.0, '
        '"end": 2.4, "falloff": 0.2, "value": 8.0}]}',
        encoding="utf-8",
    )
    assert read_edits(path) == (Edit(("mouth_opening",), Op.OFFSET, 2.0, 2.4, 0.2, 8.0),)


def test_falloff_and_the_value_of_a_reset_may_be_left_out(tmp_path: Path) -> None:
    path = saved(tmp_path / "e.json", without("falloff"), without("value", op="reset", start=1))
    hard, reset = read_edits(path)
    assert hard.falloff == 0
    assert (reset.op, reset.start) == (Op.RESET, 1.0)


def test_windows_editors_mark_of_utf8_is_accepted(tmp_path: Path) -> None:
    path = tmp_path / "e.json"
    path.write_bytes(b'\xef\xbb\xbf{"version": 1, "edits": []}')
    assert read_edits(path) == ()


BAD_EDITS: dict[str, tuple[Any, str]] = {
    "not an object": ([1, 2], "not an object"),
    "nothing": (None, "not an object"),
    "unknown company": (without(companions="nose"), '"companions" must be one of yield, along'),
    "unknown field": (without(ease=1), 'unknown field "ease"'),
    "unknown control": (without(control="nose"), "unknown control 'nose'"),
    "misspelled control": (
        without(control="mouth_openning"),
        "unknown control 'mouth_openning' (did you mean mouth_opening",
    ),
    "a label as control": (without(control="Mouth opening"), "(did you mean mouth_opening"),
    "misspelled channel": (without("control", channel="jawOpn"), "(did you mean jawOpen"),
    "no control": (without("control"), '"control"'),
    "number as control": (without(control=5), '"control"'),
    "both spellings": (without(controls=["mouth_width"]), '"control"'),
    "empty controls": (without("control", controls=[]), "has no control"),
    "number among controls": (without("control", controls=["mouth_width", 1]), '"controls"'),
    "a control twice": (without("control", controls=["mouth_width"] * 2), "twice"),
    "unknown op": (without(op="shake"), "offset, set, scale, smooth, reset"),
    "list as op": (without(op=["set"]), '"op"'),
    "no op": (without("op"), '"op"'),
    "no start": (without("start"), '"start" is missing'),
    "no end": (without("end"), '"end" is missing'),
    "no value": (without("value"), '"value" is missing'),
    "text as start": (without(start="2.0"), '"start" is not a number'),
    "truth as value": (without(value=True), '"value" is not a number'),
    "nothing as falloff": (without(falloff=None), '"falloff" is not a number'),
    "end before start": (without(end=1.0), "end lies before its start"),
    "negative falloff": (without(falloff=-0.1), "falloff is negative"),
    "negative scale": (without(op="scale", value=-1), "at least 0"),
    "negative smooth": (without(op="smooth", value=-1), "at least 0"),
    "endless smooth": (without(op="smooth", value=1e5), "at most 10 seconds"),
    "infinite": (without(value=float("inf")), "must be between"),
    "not a number": (without(start=float("nan")), "must be between"),
    "beyond all sums": (without(start=-1e308, falloff=1e308), "must be between"),
    "endless name": (without(name="x" * 1001), '"name" is longer than 1,000 characters'),
    "endless control": (without(control="[" * 900), "unknown control '[[["),
    "half a character": (without(name="\ud83d"), '"name" has a damaged character'),
    "beyond all floats": (without(value=10**400), "must be between"),
}


@pytest.mark.parametrize("name", BAD_EDITS)
def test_bad_edit_is_reported_with_its_number(tmp_path: Path, name: str) -> None:
    entry, reason = BAD_EDITS[name]
    text = complaint(saved(tmp_path / "edits.json", GOOD, entry, GOOD))
    assert "edit 2: " in text
    assert reason in text


BAD_FILES: dict[str, tuple[bytes, str]] = {
    "empty": (b"", "not JSON"),
    "PNG": (b"\x89PNG\r\n\x1a\n\x00\xff", "not a valid edits file"),
    "cut off": (b'{"version": 1,\n "edits": [', "line 2"),
    "list": (b"[]", "not a valid edits file"),
    "edits are an object": (b'{"version": 1, "edits": {}}', '"edits"'),
    "no version": (b'{"edits": []}', "version None"),
    "later version": (b'{"version": 2, "edits": []}', "version 2"),
    "endless lists": (b"[" * 100_000, "not a valid edits file"),
    "endless number": (b'{"version": ' + b"1" * 5000 + b', "edits": []}', "not a valid edits file"),
}


@pytest.mark.parametrize("name", BAD_FILES)
def test_file_that_lists_no_edits_is_reported(tmp_path: Path, name: str) -> None:
    content, reason = BAD_FILES[name]
    (tmp_path / "edits.json").write_bytes(content)
    assert reason in complaint(tmp_path / "edits.json")


def test_missing_file_and_folder_are_reported(tmp_path: Path) -> None:
    assert "cannot be read" in complaint(tmp_path / "none.json")
    assert "cannot be read" in complaint(tmp_path)
